"""Maneuvers, their counts, ranks and probabilities, as text, JSON and tables."""
