"""TODO extraction/selection."""
