"""TODO logic/english."""
