"""Lanes made from centre lines and from tables of centre lines."""
