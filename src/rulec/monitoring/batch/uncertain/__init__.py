"""Verification of many traces with unknown values."""
