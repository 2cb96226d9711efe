"""Explanations of violations, and the nearest trace that keeps the rule."""
