"""Marks in px, their styles, and the files that pictures are written to."""
