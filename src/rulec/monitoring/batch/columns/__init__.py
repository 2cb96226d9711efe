"""Columns: made of states or of tables, and read by rules as digits."""
