"""Columns of values by state, and the digits that rules read."""
