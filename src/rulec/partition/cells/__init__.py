"""Dividing the road into the cells of one layer."""
