"""TODO planning/product."""
