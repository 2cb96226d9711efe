"""Parses a text again after an edit, reading only the items that differ."""
