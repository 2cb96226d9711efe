"""Verdicts with unknown values, or with an unobserved past or future."""
