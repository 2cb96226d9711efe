"""TODO rulebook/names."""
