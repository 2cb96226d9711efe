"""Compiled rulebooks as monitors in C."""
