"""Formats of recorded traffic, as lists and tables."""
