"""Resolves rules, exemptions, examples and axioms."""
