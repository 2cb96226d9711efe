"""Lanelet2 maps, read as lanelets of a recording."""
