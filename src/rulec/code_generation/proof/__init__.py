"""Monitors in C, held against the tables that they were made of."""
