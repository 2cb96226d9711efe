"""Lanes from centre lines, and from tables of them."""
