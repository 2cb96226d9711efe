"""Recordings that are worse than they should be, and verdicts on them held against the whole."""
