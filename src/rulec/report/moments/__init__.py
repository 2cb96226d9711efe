"""Moments at which a formula holds, as text, JSON and tables."""
