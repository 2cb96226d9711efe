"""Findings of verdicts: one for each violation, open verdict and rule that was not judged."""
