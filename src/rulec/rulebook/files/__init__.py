"""TODO rulebook/files."""
