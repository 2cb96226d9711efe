"""Reads Lanelet2 maps as lanelets of a recording."""
