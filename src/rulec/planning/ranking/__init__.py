"""TODO planning/ranking."""
