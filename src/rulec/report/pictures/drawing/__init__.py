"""Marks in px, their styles, and writers of picture files."""
