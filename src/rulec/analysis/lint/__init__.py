"""TODO analysis/lint."""
