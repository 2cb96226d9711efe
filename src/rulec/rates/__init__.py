"""Rates of violations with intervals, computed from the rows of findings."""
