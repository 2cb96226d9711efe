"""Diagnostics and codes, as text and in the formats of other tools."""
