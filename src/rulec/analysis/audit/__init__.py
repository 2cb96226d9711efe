"""Audit of a rulebook's basis: sources, examples, gaps."""
