"""Explanations of violations, and the nearest trace that satisfies the rule."""
