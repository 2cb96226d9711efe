"""Formulas into automata: Spot, tables, HOA, and the compiled rulebook's format."""
