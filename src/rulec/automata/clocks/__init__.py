"""Machines that read clocks: the same for bounds of any length."""
