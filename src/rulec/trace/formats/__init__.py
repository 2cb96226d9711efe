"""TODO trace/formats."""
