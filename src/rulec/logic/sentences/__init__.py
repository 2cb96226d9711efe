"""Formulas as sentences in English, German and French: atoms, temporal operators, layout."""
