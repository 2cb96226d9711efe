"""Outcomes of examples and their coverage, as text, JSON and JUnit XML."""
