"""TODO monitoring/explain."""
