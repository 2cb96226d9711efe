"""Verdicts of compiled rulebooks on traces: whole, many together, or still running."""
