"""Roads given by the centres of their lanes, as lanelets; tracks of boxes."""
