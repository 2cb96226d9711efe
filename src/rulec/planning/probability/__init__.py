"""TODO planning/probability."""
