"""Rates of violations with intervals, from the rows of findings."""
