"""TODO rulebook/examples."""
