"""Completions at the cursor and quick fixes of mistakes."""
