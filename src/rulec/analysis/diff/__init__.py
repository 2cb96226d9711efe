"""TODO analysis/diff."""
