"""Expressions as written to formulas and numbers, with all checks of types."""
