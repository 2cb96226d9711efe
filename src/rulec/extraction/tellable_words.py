"""The words that files of a format can supply."""

from __future__ import annotations

from collections.abc import Mapping

_EITHER = frozenset(
    (
        *("acceleration", "all_way_stop", "distance_to_junction", "distance_to_stop_line"),
        "hazard_lights",
        *("cause_to_brake", "driving_side", "impedes_traffic", "joins_road", "nearest_to_crossing"),
        *("holds_up_oncoming", "on_shoulder", "reversing", "turns_in_way_of", "u_turn"),
        *(
            "apart_from_far_lane",
            "lane_number",
            "other_arrived_first",
            "time_to_collision",
            "time_to_stop_line",
        ),
        *("CONGESTED", "about_to_overtake", "abreast_at_narrowing", "accelerating", "ahead_for"),
        *("arrived_together", "being_overtaken", "braking_hard", "broken_on_own_side"),
        *("built_up", "came_up_beside", "can_stop_at_once", "compulsory_roundabout"),
        "conflict_from_left",
        *("conflict_from_right", "conflict_on_roundabout", "conflict_with_rail_from_side"),
        *("congested", "crosses_light_line"),
        *("crosses_side_road", "crosses_stop_line", "crossing_kind", "crossing_use"),
        *("crossing_zone", "dense_all_lanes", "distance_to_crossing", "divided", "ego_length"),
        *(
            "ego_on_call",
            "ego_type",
            "emergency_vehicle_near",
            "enters_junction",
            "enters_roundabout",
        ),
        *("exit_clear", "far_lane_queue", "gap", "give_way_sign", "goes_across", "in_the_road"),
        *("in_way_of_oncoming", "indicator", "junction_zone", "lane", "lane_change"),
        *(
            "lane_is_clear",
            "lane_kind",
            "lane_position",
            "lanes",
        ),
        *("lateral", "lateral_gap", "light", "limit", "marked_lanes", "merged", "narrowing"),
        "near_lane_is_free",
        *("needs_access", "obstructed", "on_call", "on_priority_road", "on_solid_line"),
        *("begins_to_overtake", "leads_elsewhere", "one_between", "own_lane_queue"),
        *("oncoming", "oncoming_clear", "one_way", "other_in_junction", "other_lane_available"),
        *("other_road_ends", "overtaking", "own_road_ends", "parked", "parts_soon", "position"),
        "precedes",
        *("preparing_to_leave", "road_class", "room_on_near_side", "roundabout"),
        *("roundabout_signed", "safe_gap", "single_line", "speed", "speed_difference", "station"),
        *("stop_sign", "stopped", "stopped_for_pedestrian", "straddling", "surface"),
        *("time_headway", "turn", "turn_on_red_sign", "turning_far", "two_wheeled"),
        *("unregulated_junction", "walking_pace_flow", "warning_lights", "way_cleared"),
    )
)
_COMMONROAD_ONLY = frozenset(
    (
        *("icy", "minimum_limit", "night", "no_overtaking_sign", "no_turn_on_red_sign", "raining"),
        *("visibility", "wet"),
    )
)
_SUMO_ONLY = frozenset(
    (
        *("boarding", "conflict_with_rail", "enters_level_crossing", "guarded", "leaving_stop"),
        *("level_crossing_zone", "past_level_crossing_sign", "told_to_go", "told_to_stop"),
        *("tracks_at_kerb", "tunnel"),
    )
)
_SIGNED = frozenset(
    (
        *("crosses_stop_line", "give_way_sign", "limit", "on_priority_road", "stop_sign"),
        *("all_way_stop", "distance_to_stop_line", "time_to_stop_line", "turn_on_red_sign"),
    )
)
_LAMPS = frozenset(("hazard_lights", "indicator", "warning_lights"))
_OWN_LAMPS = frozenset(("front_fog_lamps", "headlamps", "rear_fog_lamps"))
_ROAD_KINDS = frozenset(("built_up", "lane_kind", "road_class"))
_ARGOVERSE = _EITHER - _SIGNED - _LAMPS - _ROAD_KINDS
"""Argoverse maps have lanes, marks and crossings; objects have places, kinds and sizes."""

_NOT_BY_LANE_CENTRES = frozenset(
    (
        *("give_way_sign", "on_priority_road", "turn_on_red_sign", "lane_kind"),
        *_LAMPS,
    )
)
"""Signs other than stop signs, lamps, and the kinds of a motorway's lanes."""
_ON_ANY_MAP = frozenset(
    (
        *("minimum_limit", "no_overtaking_sign", "no_turn_on_red_sign", "conflict_with_rail"),
        *("enters_level_crossing", "guarded", "level_crossing_zone", "past_level_crossing_sign"),
        *("tracks_at_kerb", "tunnel"),
    )
)
"""Tables also accept SUMO nets as maps, which have every sign and track."""

_BY_LAMPS = _LAMPS
_BY_SIGNS_AND_LINES = frozenset(
    (
        *("crosses_stop_line", "give_way_sign", "lane_kind", "on_priority_road", "stop_sign"),
        *("all_way_stop", "distance_to_stop_line", "time_to_stop_line", "turn_on_red_sign"),
    )
)
"""highD has neither signs nor stop lines, and only the marks of its ramps."""

TELLABLE_WORDS: Mapping[str, frozenset[str]] = {
    "commonroad": _EITHER | _COMMONROAD_ONLY,
    "commonroad-protobuf": _EITHER | _COMMONROAD_ONLY,
    "sumo": _EITHER | _SUMO_ONLY,
    "waymo": _EITHER - _NOT_BY_LANE_CENTRES,
    "scenarionet": _EITHER - _NOT_BY_LANE_CENTRES,
    "tracks": _EITHER | _ON_ANY_MAP | _OWN_LAMPS | {"boarding", "leaving_stop"},
    **dict.fromkeys(
        ("levelx", "interaction", "ngsim", "omega-prime"), (_EITHER | _ON_ANY_MAP) - _BY_LAMPS
    ),
    "highd": _EITHER - _BY_LAMPS - _BY_SIGNS_AND_LINES,
    "osi": _EITHER
    | _OWN_LAMPS
    | {"icy", "night", "no_overtaking_sign", "raining", "visibility", "wet"},
    "argoverse-motion": _ARGOVERSE,
    "argoverse-sensor": _ARGOVERSE,
}
"""Format -> words that some file of it can supply; one may lack signs, lamps or weather."""
