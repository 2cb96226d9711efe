"""Encoding of states for rules: shapes, values, and the digits that rules read."""
