"""TODO rulebook/overlay."""
