"""Probabilities that maneuvers keep rules."""
