"""Verdicts and explained violations, as text and JSON."""
