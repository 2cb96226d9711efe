"""Cells of one layer of the road."""
