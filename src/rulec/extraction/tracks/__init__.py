"""Tracks of participants, map matching, and the road that ego drove."""
