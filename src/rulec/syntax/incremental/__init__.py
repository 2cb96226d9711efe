"""Parsing a text anew after an edit, by reading only what is near it."""
