"""Formulas as English: sentences, phrases of time, phrases of atoms."""
