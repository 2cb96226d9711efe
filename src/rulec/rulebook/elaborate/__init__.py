"""Turns written expressions into formulas and numbers, with all type checks."""
