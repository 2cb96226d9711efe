"""Recordings of traffic, and reading them from the field's formats."""
