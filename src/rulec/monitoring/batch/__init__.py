"""Batch verification: one step of many traces at a time."""
