"""Monitors in C, compiled by the user's compiler and run from Python."""
