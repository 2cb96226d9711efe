"""The fields of Waymo's scenarios that are read, by their numbers.

They are those of ``scenario.proto`` and ``map.proto``, which are public:
https://github.com/waymo-research/waymo-open-dataset/tree/master/src/waymo_open_dataset/protos
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rulec.recordings.encodings.wire_format import Field, Table, Words
from rulec.recordings.recording import LaneMark

POINT: Table = {1: Field("x", "double"), 2: Field("y", "double"), 3: Field("z", "double")}

OBJECT_TYPES = Words({1: "vehicle", 2: "pedestrian", 3: "bicycle", 4: "unknown"}, other="unknown")
"""Object types as participants' types; a cyclist is a bicycle."""

STATE: Table = {
    2: Field("center_x", "double"),
    3: Field("center_y", "double"),
    4: Field("center_z", "double"),
    5: Field("length", "float"),
    6: Field("width", "float"),
    8: Field("heading", "float"),
    9: Field("velocity_x", "float"),
    10: Field("velocity_y", "float"),
    11: Field("valid", "bool"),
}
TRACK: Table = {
    1: Field("id", "int"),
    2: Field("object_type", OBJECT_TYPES),
    3: Field("states", STATE, many=True),
}

COLOURS = Words(
    {
        **dict.fromkeys((1, 4), "red"),
        **dict.fromkeys((2, 5), "yellow"),
        **dict.fromkeys((3, 6), "green"),
    },
    other="unknown",
)
"""Colours of lights and arrows; a flashing light has none of them and is unknown."""

LANE_STATE: Table = {
    1: Field("lane", "int"),
    2: Field("state", COLOURS),
    3: Field("stop_point", POINT),
}
MAP_STATE: Table = {1: Field("lane_states", LANE_STATE, many=True)}

MARKS: Mapping[str, LaneMark | None] = MappingProxyType(
    {
        **dict.fromkeys(("broken_white", "broken_yellow", "broken_double_yellow"), "broken"),
        **dict.fromkeys(("solid_white", "solid_yellow"), "solid"),
        **dict.fromkeys(("solid_double_white", "solid_double_yellow"), "double_solid"),
        # Broken on one side: since the side is unknown, it provides no information
        "passing_double_yellow": None,
        # Road edges have it, too
        "unknown": None,
    }
)
LINE_TYPES = Words(
    {
        1: "broken_white",
        2: "solid_white",
        3: "solid_double_white",
        4: "broken_yellow",
        5: "broken_double_yellow",
        6: "solid_yellow",
        7: "solid_double_yellow",
        8: "passing_double_yellow",
    },
    other="unknown",
)

BOUNDARY: Table = {
    1: Field("lane_start_index", "int"),
    2: Field("lane_end_index", "int"),
    3: Field("boundary_feature_id", "int"),
    4: Field("boundary_type", LINE_TYPES),
}
NEIGHBOUR: Table = {
    1: Field("feature_id", "int"),
    2: Field("self_start_index", "int"),
    3: Field("self_end_index", "int"),
    4: Field("neighbor_start_index", "int"),
    5: Field("neighbor_end_index", "int"),
}

LANE_TYPES = Words({1: "highway", 3: "bicycleLane"}, other="unknown")
"""Lane types as lanelets' types; a surface street is any lane but a freeway or a cycle lane."""

LANE: Table = {
    1: Field("speed_limit_mph", "double"),
    2: Field("type", LANE_TYPES),
    8: Field("polyline", POINT, many=True),
    9: Field("entry_lanes", "int", many=True),
    10: Field("exit_lanes", "int", many=True),
    11: Field("left_neighbors", NEIGHBOUR, many=True),
    12: Field("right_neighbors", NEIGHBOUR, many=True),
    13: Field("left_boundaries", BOUNDARY, many=True),
    14: Field("right_boundaries", BOUNDARY, many=True),
}
LINE: Table = {2: Field("polyline", POINT, many=True)}
"""The fields shared by road lines and road edges."""

STOP_SIGN: Table = {1: Field("lane", "int", many=True)}
CROSSWALK: Table = {1: Field("polygon", POINT, many=True)}
MAP_FEATURE: Table = {
    1: Field("id", "int"),
    3: Field("lane", LANE),
    4: Field("road_line", LINE),
    5: Field("road_edge", LINE),
    7: Field("stop_sign", STOP_SIGN),
    8: Field("crosswalk", CROSSWALK),
}

SCENARIO: Table = {
    1: Field("timestamps_seconds", "double", many=True),
    2: Field("tracks", TRACK, many=True),
    5: Field("scenario_id", "text"),
    6: Field("sdc_track_index", "int"),
    7: Field("dynamic_map_states", MAP_STATE, many=True),
    8: Field("map_features", MAP_FEATURE, many=True),
}
SCENARIO_ID: Table = {5: Field("scenario_id", "text")}
"""The field read first from a record that may not be wanted."""
