"""TODO analysis/lineage."""
