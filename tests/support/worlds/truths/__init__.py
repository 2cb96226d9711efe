"""Who broke which rule in a simulated world, by lanes, places and lights of the simulator."""

from functools import partial

from support.worlds.truths.crossing_truths import pedestrian_facts
from support.worlds.truths.following_truths import following_facts
from support.worlds.truths.light_truths import red_light_facts
from support.worlds.truths.passing_truths import near_side_facts
from support.worlds.truths.priority_truths import (
    give_way_facts,
    oncoming_facts,
    right_facts,
    roundabout_facts,
    stop_give_way_facts,
)
from support.worlds.truths.speed_truths import speed_facts
from support.worlds.truths.stop_truths import stop_facts

TRUTHS = {
    "red_light": red_light_facts,
    "speed_limit": speed_facts,
    "following_distance": following_facts,
    "near_side_passing": near_side_facts,
    "junction_priority": right_facts,
    "oncoming_priority": oncoming_facts,
    "give_way_sign": give_way_facts,
    "roundabout_priority": roundabout_facts,
    "stop_sign": stop_facts,
    "stop_sign_give_way": partial(stop_give_way_facts, rule="stop_sign_give_way"),
    "stop_sign_giving_way": partial(stop_give_way_facts, rule="stop_sign_giving_way"),
    "give_way_to_pedestrians": pedestrian_facts,
}
"""Rule -> its facts in a world."""
