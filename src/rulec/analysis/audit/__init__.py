"""Audit what a rulebook rests on: sources, examples, gaps."""
