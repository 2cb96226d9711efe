"""Tracks with the short faults of detectors and trackers mended."""
