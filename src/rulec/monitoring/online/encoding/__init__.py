"""Encoding of states: shapes, values, and digits of letters."""
