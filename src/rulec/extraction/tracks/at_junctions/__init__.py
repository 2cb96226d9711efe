"""Junctions of a recording: their ways, who took which of them when, and roundabouts."""
