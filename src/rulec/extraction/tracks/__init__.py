"""TODO extraction/tracks."""
