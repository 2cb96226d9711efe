"""TODO analysis/audit."""
