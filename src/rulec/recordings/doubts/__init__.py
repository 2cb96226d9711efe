"""Plausibility checks of recordings of all formats."""
