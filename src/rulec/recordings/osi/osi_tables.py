"""The fields of ASAM OSI messages that are read, by their numbers in the standard.

ASAM OSI 3.0 to 3.8, https://opensimulationinterface.github.io/osi-antora-documentation/; numbers
never change their meaning within a major version. Enumerations are those of the fields' own
messages; a number added by a later version is ``other``.
"""

from __future__ import annotations

from rulec.recordings.encodings.wire_format import Field, Kind, Table, Words


def _words(text: str) -> Words:
    """Words numbered from 0, in the order of an enumeration; ``-`` for unused numbers."""
    names = enumerate(text.split())
    return Words({number: name for number, name in names if name != "-"}, other="other")


def _numbered(text: str) -> Words:
    """Words with their numbers."""
    pairs = (pair.split() for pair in text.replace("\n", " ").split(","))
    return Words({int(number): name for number, name in pairs}, other="other")


def _numbers(names: str, kind: Kind = "double") -> Table:
    return {number: Field(name, kind) for number, name in enumerate(names.split(), 1)}


ID: Table = {1: Field("value", "uint")}
TIME: Table = {1: Field("seconds", "int"), 2: Field("nanos", "uint")}
VECTOR = _numbers("x y")
ORIENTATION: Table = {1: Field("roll", "double"), 2: Field("pitch", "double")}
ORIENTATION = {**ORIENTATION, 3: Field("yaw", "double")}
SIZE = _numbers("length width height")
IDS_OF_LANES = Field("assigned_lane_id", ID, many=True)
LOGICAL_LANES = Field("logical_lane_assignment", {1: Field("assigned_lane_id", ID)}, many=True)

BASE: Table = {
    1: Field("dimension", SIZE),
    2: Field("position", VECTOR),
    3: Field("orientation", ORIENTATION),
}
STANDING_BASE: Table = {**BASE, 4: Field("base_polygon", VECTOR, many=True)}
MOVING_BASE: Table = {
    1: Field("dimension", _numbers("length width")),
    2: Field("position", VECTOR),
    3: Field("orientation", {3: Field("yaw", "double")}),
    4: Field("velocity", VECTOR),
    5: Field("acceleration", VECTOR),
}

OBJECTS = _words("unknown other vehicle pedestrian animal")
ROLES = _words(
    "unknown other civil ambulance fire police public_transport road_assistance"
    " garbage_collection road_construction military"
)
VEHICLES = _words(
    "unknown other small_car compact_car car luxury_car van heavy_truck semitrailer trailer"
    " motorbike bicycle bus tram train wheelchair semitractor standup_scooter"
    " micromobility_device work_machine watercraft aircraft land_vehicle"
)
INDICATORS = _words("unknown other off left right warning")
LAMPS = _words("unknown other off on flashing_blue flashing_blue_and_red flashing_amber")
VEHICLE: Table = {
    1: Field("type", VEHICLES),
    2: Field(
        "light_state",
        {
            1: Field("indicator_state", INDICATORS),
            2: Field("front_fog_light", LAMPS),
            3: Field("rear_fog_light", LAMPS),
            4: Field("head_light", LAMPS),
            5: Field("high_beam", LAMPS),
            7: Field("brake_light_state", _words("unknown other off normal strong")),
            9: Field("emergency_vehicle_illumination", LAMPS),
        },
    ),
    5: Field("role", ROLES),
}
MOVING_OBJECT: Table = {
    1: Field("id", ID),
    2: Field("base", MOVING_BASE),
    3: Field("type", OBJECTS),
    6: Field("vehicle_classification", VEHICLE),
}
STATIONARY_OBJECT: Table = {
    1: Field("id", ID),
    2: Field("base", STANDING_BASE),
    3: Field(
        "classification",
        {
            1: Field(
                "type",
                _words(
                    "unknown other bridge building pole pylon delineator tree barrier vegetation"
                    " curbstone wall vertical_structure rectangular_structure overhead_structure"
                    " reflective_structure construction_site_element speed_bump"
                    " emitting_structure"
                ),
            )
        },
    ),
}

PAIRING: Table = {1: Field("antecessor_lane_id", ID), 2: Field("successor_lane_id", ID)}
LANE: Table = {
    1: Field("id", ID),
    2: Field(
        "classification",
        {
            1: Field("type", _words("unknown other driving nondriving intersection")),
            3: Field("centerline", VECTOR, many=True),
            4: Field("centerline_is_driving_direction", "bool"),
            5: Field("left_adjacent_lane_id", ID, many=True),
            6: Field("right_adjacent_lane_id", ID, many=True),
            7: Field("lane_pairing", PAIRING, many=True),
            8: Field("right_lane_boundary_id", ID, many=True),
            9: Field("left_lane_boundary_id", ID, many=True),
            10: Field("free_lane_boundary_id", ID, many=True),
            11: Field(
                "road_condition",
                {2: Field("surface_water_film", "double"), 4: Field("surface_ice", "double")},
            ),
            12: Field(
                "subtype",
                _words(
                    "unknown other normal biking sidewalk parking stop restricted border shoulder"
                    " exit entry onramp offramp connectingramp"
                ),
            ),
        },
    ),
}
LANE_BOUNDARY: Table = {
    1: Field("id", ID),
    2: Field("boundary_line", {1: Field("position", VECTOR)}, many=True),
    3: Field(
        "classification",
        {
            1: Field(
                "type",
                _words(
                    "unknown other no_line solid_line dashed_line botts_dots road_edge snow_edge"
                    " grass_edge gravel_edge soil_edge guard_rail curb structure barrier"
                    " sound_barrier"
                ),
            )
        },
    ),
}

UNITS = _numbered("0 unknown, 1 other, 2 no_unit, 3 kmh, 4 mph")
SIGN_VALUE: Table = {1: Field("value", "double"), 2: Field("value_unit", UNITS)}
SIGNS = _numbered(
    """0 unknown, 1 other, 16 give_way, 17 stop, 18 priority_to_opposite_direction, 29 roundabout,
    34 bus_lane, 35 bus_lane_begin, 52 speed_limit_begin, 53 speed_limit_zone_begin,
    56 overtaking_ban_begin, 57 overtaking_ban_for_trucks_begin,
    67 right_of_way_next_intersection, 68 right_of_way_begin, 70 priority_over_opposite_direction,
    72 town_begin, 73 town_end, 77 living_street_begin, 79 tunnel, 82 highway_begin,
    84 expressway_begin, 87 zebra_crossing, 92 traffic_light_green_arrow, 187 oneway_street"""
)
SUPPLEMENTS: Table = {2: Field("classification", {2: Field("type", _numbered("2 no_sign"))})}
TRAFFIC_SIGN: Table = {
    1: Field("id", ID),
    2: Field(
        "main_sign",
        {
            2: Field(
                "classification",
                {
                    2: Field("type", SIGNS),
                    3: Field("value", SIGN_VALUE),
                    5: IDS_OF_LANES,
                    7: Field("is_out_of_service", "bool"),
                    12: LOGICAL_LANES,
                },
            )
        },
    ),
    3: Field("supplementary_sign", SUPPLEMENTS, many=True),
}
ROAD_MARKING: Table = {
    1: Field("id", ID),
    2: Field("base", BASE),
    3: Field(
        "classification",
        {
            1: Field(
                "type",
                _words(
                    "unknown other painted_traffic_sign symbolic_traffic_sign"
                    " textual_traffic_sign generic_symbol generic_line generic_text"
                ),
            ),
            2: Field("traffic_main_sign_type", SIGNS),
            6: IDS_OF_LANES,
            7: Field("is_out_of_service", "bool"),
            12: LOGICAL_LANES,
        },
    ),
}
TRAFFIC_LIGHT: Table = {
    1: Field("id", ID),
    2: Field("base", {2: Field("position", VECTOR)}),
    3: Field(
        "classification",
        {
            1: Field("color", _words("unknown other red yellow green blue white")),
            2: Field(
                "icon",
                _words(
                    "unknown other none straight_ahead left diag_left straight_ahead_left right"
                    " diag_right straight_ahead_right left_right down down_left down_right cross"
                    " pedestrian walk dont_walk bicycle pedestrian_and_bicycle countdown_seconds"
                    " countdown_percent tram bus bus_and_tram"
                ),
            ),
            3: Field("mode", _words("unknown other off constant flashing counting")),
            5: IDS_OF_LANES,
            6: Field("is_out_of_service", "bool"),
            7: LOGICAL_LANES,
        },
    ),
}
ENVIRONMENT: Table = {
    1: Field(
        "ambient_illumination",
        _words(
            "unknown other level1 level2 level3 level4 level5 level6 level7 level8 level9",
        ),
    ),
    6: Field(
        "precipitation",
        _words("unknown other none very_light light moderate heavy very_heavy extreme"),
    ),
    7: Field("fog", _words("unknown other excellent good moderate poor mist light thick dense")),
}

REFERENCE_LINE: Table = {
    1: Field("id", ID),
    2: Field(
        "poly_line",
        {1: Field("world_position", VECTOR), 2: Field("s_position", "double")},
        many=True,
    ),
}
LOGICAL_BOUNDARY: Table = {
    1: Field("id", ID),
    2: Field("boundary_line", {1: Field("position", VECTOR)}, many=True),
    4: Field("physical_boundary_id", ID, many=True),
    5: Field("passing_rule", _words("unknown other none_allowed increasing decreasing both")),
}
RELATION: Table = {1: Field("other_lane_id", ID)}
TRAFFIC_RULE: Table = {
    1: Field("traffic_rule_type", Words({0: "speed_limit"}, other="other")),
    2: Field("traffic_rule_validity", {3: Field("valid_for_type", {}, many=True)}),
    3: Field("speed_limit", {1: Field("speed_limit_value", SIGN_VALUE)}),
}
LOGICAL_LANE: Table = {
    1: Field("id", ID),
    2: Field(
        "type",
        _words(
            "unknown other normal biking sidewalk parking stop restricted border shoulder exit"
            " entry onramp offramp connectingramp median curb rail tram"
        ),
    ),
    4: Field("physical_lane_reference", {1: Field("physical_lane_id", ID)}, many=True),
    5: Field("reference_line_id", ID),
    6: Field("start_s", "double"),
    7: Field("end_s", "double"),
    8: Field("move_direction", _words("unknown other increasing decreasing both")),
    9: Field("right_adjacent_lane", RELATION, many=True),
    10: Field("left_adjacent_lane", RELATION, many=True),
    11: Field("overlapping_lane", RELATION, many=True),
    12: Field("right_boundary_id", ID, many=True),
    13: Field("left_boundary_id", ID, many=True),
    14: Field("predecessor_lane", RELATION, many=True),
    15: Field("successor_lane", RELATION, many=True),
    17: Field("traffic_rule", TRAFFIC_RULE, many=True),
    18: Field(
        "road_type",
        _words(
            "unknown other lowspeed motorway pedestrian rural town_arterial town_collector"
            " town_expressway town_local town_play_street town_private town bicycle"
        ),
    ),
}

STATIC: dict[str, Table] = {
    "stationary_object": STATIONARY_OBJECT,
    "traffic_sign": TRAFFIC_SIGN,
    "road_marking": ROAD_MARKING,
    "lane_boundary": LANE_BOUNDARY,
    "lane": LANE,
    "reference_line": REFERENCE_LINE,
    "logical_lane_boundary": LOGICAL_BOUNDARY,
    "logical_lane": LOGICAL_LANE,
}
"""Static content: only the first message of each id counts, and it is decoded once."""

GROUND_TRUTH: Table = {
    2: Field("timestamp", TIME),
    3: Field("host_vehicle_id", ID),
    4: Field("stationary_object", "bytes", many=True),
    5: Field("moving_object", MOVING_OBJECT, many=True),
    6: Field("traffic_sign", "bytes", many=True),
    7: Field("traffic_light", TRAFFIC_LIGHT, many=True),
    8: Field("road_marking", "bytes", many=True),
    9: Field("lane_boundary", "bytes", many=True),
    10: Field("lane", "bytes", many=True),
    12: Field("environmental_conditions", ENVIRONMENT),
    13: Field("country_code", "uint"),
    17: Field("reference_line", "bytes", many=True),
    18: Field("logical_lane_boundary", "bytes", many=True),
    19: Field("logical_lane", "bytes", many=True),
}
SENSOR_VIEW: Table = {
    2: Field("timestamp", TIME),
    7: Field("global_ground_truth", GROUND_TRUTH),
    8: Field("host_vehicle_id", ID),
}
SENSOR_DATA: Table = {
    2: Field("timestamp", TIME),
    8: Field("sensor_view", SENSOR_VIEW, many=True),
}
MESSAGES = {"GroundTruth": GROUND_TRUTH, "SensorView": SENSOR_VIEW, "SensorData": SENSOR_DATA}
"""The message types that have, or may have, ground truth in them."""

LIKE_TRUTH: Table = {
    2: Field("timestamp", TIME),
    **{number: Field("static", "bytes", many=True) for number in (7, 8, 9, 10, 19)},
}
"""The fields that distinguish ground truth from a light or a mounting position.

Those have other fields, or none, at these numbers.
"""

VIEWS: Table = {8: Field("view", {7: Field("truth", "bytes", many=True)}, many=True)}
TRUTHS: Table = {7: Field("truth", "bytes", many=True)}
