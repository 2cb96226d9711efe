"""Where verdicts are not right yet: some violation is missed or open, or somebody is accused.

Kind of world -> rules. Everywhere else every verdict has to be right. What has been mended is taken
out; nothing is added.
"""

STORED = {
    "grid": {"following_distance", "speed_limit"},
    "spider_left": {"red_light"},
    "priority": {"give_way_sign"},
    "all_way_stop": {"following_distance"},
    "motorway": {"near_side_passing", "speed_limit"},
}
SIMULATED = {}
LABELS = {}
"""Rule -> how many are accused falsely, and missed, in all of the recordings that are at hand."""
