"""TODO witnesses."""
