"""The lanelets and the road that vehicles drove."""
