"""Runs of Mealy monitors over columns of letters."""
