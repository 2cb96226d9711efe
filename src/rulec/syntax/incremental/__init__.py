"""Parses a text again after an edit, reading only the part near the edit."""
