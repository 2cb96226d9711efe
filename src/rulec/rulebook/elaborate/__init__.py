"""TODO rulebook/elaborate."""
