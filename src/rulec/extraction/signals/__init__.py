"""TODO extraction/signals."""
