"""Rules, exemptions, examples and axioms as written to those as meant."""
