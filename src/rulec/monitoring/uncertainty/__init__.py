"""Verdicts where values are unknown, or what is before or after has not been seen."""
