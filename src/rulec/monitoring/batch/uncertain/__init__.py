"""Verification of many traces of which not all is known."""
