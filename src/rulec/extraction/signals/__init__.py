"""Signals of a drive, derived from tracks, extents and the map."""
