"""The words that files of a format can supply, or that follow from these by definition."""

from __future__ import annotations

from collections.abc import Mapping

_EITHER = frozenset(
    (
        *("CONGESTED", "about_to_overtake", "abreast_at_narrowing", "accelerating", "acceleration"),
        *("ahead_for", "all_way_stop", "apart_from_far_lane", "arrived_together"),
        *("begins_to_overtake", "being_overtaken", "braking_hard", "broken_on_own_side"),
        *("built_up", "came_up_beside", "can_stop_at_once", "cause_to_brake"),
        *("compulsory_roundabout", "conflict_from_left", "conflict_from_right"),
        *("conflict_on_roundabout", "conflict_with_rail_from_side", "congested"),
        *("crosses_light_line", "crosses_side_road", "crosses_stop_line", "crossing_kind"),
        *("crossing_use", "crossing_zone", "dense_all_lanes", "distance_to_crossing"),
        *("distance_to_junction", "distance_to_stop_line", "divided", "driving_side", "ego_length"),
        *("ego_on_call", "ego_type", "emergency_vehicle_near", "enters_junction"),
        *("enters_roundabout", "exit_clear", "far_lane_queue", "gap", "give_way_sign"),
        *("goes_across", "hazard_lights", "holds_up_oncoming", "impedes_traffic", "in_the_road"),
        *("in_way_of_oncoming", "indicator", "joins_road", "junction_zone", "lane", "lane_change"),
        *("lane_is_clear", "lane_kind", "lane_number", "lane_position", "lanes", "lateral"),
        *("lateral_gap", "leads_elsewhere", "light", "limit", "marked_lanes", "merged"),
        *("narrowing", "near_lane_is_free", "nearest_to_crossing", "needs_access", "obstructed"),
        *("on_call", "on_priority_road", "on_shoulder", "on_solid_line", "oncoming"),
        *("oncoming_clear", "one_between", "one_way", "other_arrived_first", "other_in_junction"),
        *("other_lane_available", "other_road_ends", "overtaking", "own_lane_queue"),
        *("own_road_ends", "parked", "parts_soon", "position", "precedes", "preparing_to_leave"),
        *("reversing", "road_class", "room_on_near_side", "roundabout", "roundabout_signed"),
        *("safe_gap", "single_line", "speed", "speed_difference", "station", "stop_sign"),
        *("stopped", "stopped_for_pedestrian", "straddling", "surface", "time_headway"),
        *("time_to_collision", "time_to_stop_line", "turn", "turn_on_red_sign", "turning_far"),
        *("turns_in_way_of", "two_wheeled", "u_turn", "unregulated_junction", "walking_pace_flow"),
        *("warning_lights", "way_cleared"),
    )
)
_WEATHER = frozenset(("icy", "night", "raining", "visibility", "wet"))
_OTHER_SIGNS = frozenset(("minimum_limit", "no_overtaking_sign", "no_turn_on_red_sign"))
_RAILS = frozenset(
    (
        *("conflict_with_rail", "enters_level_crossing", "guarded", "level_crossing_zone"),
        *("past_level_crossing_sign", "tracks_at_kerb", "tunnel"),
    )
)
_DOORS = frozenset(("boarding", "leaving_stop"))
_SIGNS_AND_LINES = frozenset(
    (
        *("all_way_stop", "crosses_stop_line", "distance_to_stop_line", "give_way_sign"),
        *("on_priority_road", "stop_sign", "time_to_stop_line", "turn_on_red_sign"),
    )
)
_LIMITS = frozenset(("limit", "impedes_traffic"))
_LAMPS = frozenset(("hazard_lights", "indicator", "warning_lights"))
_OWN_LAMPS = frozenset(("front_fog_lamps", "headlamps", "rear_fog_lamps"))
_ROAD_KINDS = frozenset(("built_up", "lane_kind", "road_class"))
_COMMONROAD = _EITHER | _WEATHER | _OTHER_SIGNS
_ON_ANY_MAP = _EITHER | _OTHER_SIGNS | _RAILS
"""Tables also accept SUMO nets as maps, which have every sign and track."""

_BY_LANE_CENTRES = _EITHER - _LAMPS.union(
    ("give_way_sign", "on_priority_road", "turn_on_red_sign", "lane_kind")
)
"""Without signs other than stop signs, and the kinds of a motorway's lanes."""

_ARGOVERSE = _EITHER - _SIGNS_AND_LINES - _LIMITS - _LAMPS - _ROAD_KINDS
"""Argoverse maps have lanes, marks and crossings; objects have places, kinds and sizes."""

TELLABLE_WORDS: Mapping[str, frozenset[str]] = {
    "commonroad": _COMMONROAD,
    "commonroad-protobuf": _COMMONROAD,
    "sumo": _EITHER | _RAILS | _DOORS | {"told_to_go", "told_to_stop"},
    "waymo": _BY_LANE_CENTRES,
    "scenarionet": _BY_LANE_CENTRES,
    "tracks": _ON_ANY_MAP | _OWN_LAMPS | _DOORS,
    **dict.fromkeys(("levelx", "interaction", "ngsim", "omega-prime"), _ON_ANY_MAP - _LAMPS),
    # highD has neither signs nor stop lines, and only the marks of its ramps
    "highd": _EITHER - _LAMPS - _SIGNS_AND_LINES - {"lane_kind"},
    "osi": _EITHER | _OWN_LAMPS | _WEATHER | {"no_overtaking_sign"},
    "argoverse-motion": _ARGOVERSE,
    "argoverse-sensor": _ARGOVERSE,
}
"""Format -> words that some file of it can supply; one may lack signs, lamps or weather."""
