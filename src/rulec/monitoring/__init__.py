"""Judges traces by compiled rulebooks: single traces, many at once, or still running."""
