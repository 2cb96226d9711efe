"""Scenes in the scenario format that tests of several rooms read."""

CHILD_AT_THE_KERB = """
horizon_s = 2.0

[road]
s = [-20.0, 80.0]
lanes = [-1.75, 1.75]

[[road.surface]]
type = "crossing"
s = [20.0, 24.0]

[ego]
s = 0.0
d = 0.0

[[obstacle]]
id = "child"
type = "pedestrian"
length = 0.5
width = 0.5
s = 22.0
d = -2.5
walking_direction = 90

[[obstacle.prediction]]
weight = 0.75

[[obstacle.prediction]]
weight = 0.25
lateral_speed = 0.6
"""
"""A child stands beside a crossing, and perhaps steps on it."""

BEHIND_A_VAN = """[road]
s = [-30.0, 60.0]
lanes = [-1.75, 1.75, 5.25]
[ego]
s = 0.0
d = 3.5
[[obstacle]]
id = "van"
type = "vehicle"
length = 6.0
width = 2.2
s = 14.0
d = 3.5
"""
"""Ego is on the left of two lanes, 11 m behind a van; what it does comes after that."""
