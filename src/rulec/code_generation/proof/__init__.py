"""Proofs of monitors in C against the tables that they were made from."""
