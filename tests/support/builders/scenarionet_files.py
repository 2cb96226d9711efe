"""ScenarioNet's dictionaries, made of Waymo's scenarios as ScenarioNet's converter makes them.

Places stay numbers of 64 bits, where the converter writes 32.
"""

import pickle

import numpy as np

from rulec.recordings.encodings.wire_format import Field, Words
from rulec.recordings.waymo import waymo_file as tables

TYPES = {1: "VEHICLE", 2: "PEDESTRIAN", 3: "CYCLIST", 4: "OTHER"}
STATES = [
    *("UNKNOWN", "ARROW_STOP", "ARROW_CAUTION", "ARROW_GO", "STOP", "CAUTION", "GO"),
    *("FLASHING_STOP", "FLASHING_CAUTION"),
]
LANES = ["UNKNOWN", "FREEWAY", "SURFACE_STREET", "BIKE_LANE"]
LINES = [
    *("UNKNOWN", "BROKEN_SINGLE_WHITE", "SOLID_SINGLE_WHITE", "SOLID_DOUBLE_WHITE"),
    *("BROKEN_SINGLE_YELLOW", "BROKEN_DOUBLE_YELLOW", "SOLID_SINGLE_YELLOW"),
    *("SOLID_DOUBLE_YELLOW", "PASSING_DOUBLE_YELLOW"),
]


def _raw(table):
    """The same fields with the numbers of enumerations."""
    found = {}
    for number, field in table.items():
        holds = field.holds
        holds = "int" if isinstance(holds, Words) else holds
        holds = _raw(holds) if isinstance(holds, dict) else holds
        found[number] = Field(field.name, holds, many=field.many)
    return found


SCENARIO = _raw(tables.SCENARIO)


def _plain(message):
    found = {}
    for item in message.fields:
        value = item.value if not hasattr(item.value, "fields") else _plain(item.value)
        found.setdefault(item.field.name, []).append(value)
    return found


def _points(messages):
    rows = [[point[key][0] for key in "xyz"] for point in messages]
    return np.array(rows, dtype=float).reshape(-1, 3)


def _boundaries(parts):
    keys = ("lane_start_index", "lane_end_index", "boundary_feature_id")
    return [
        {key: str(part.get(key, [0])[0]) for key in keys}
        | {"boundary_type": "ROAD_LINE_" + LINES[part.get("boundary_type", [0])[0]]}
        for part in parts
    ]


def _neighbours(parts):
    keys = ("feature_id", "self_start_index", "self_end_index")
    keys += ("neighbor_start_index", "neighbor_end_index")
    return [
        {key: str(part.get(key, [0])[0]) for key in keys} | {"boundaries": []} for part in parts
    ]


def _feature(feature):
    if "lane" in feature:
        (lane,) = feature["lane"]
        mph = lane.get("speed_limit_mph", [0.0])[0]
        return {
            "type": "LANE_" + LANES[lane.get("type", [0])[0]],
            "speed_limit_mph": mph,
            "speed_limit_kmh": mph * 1.609344,
            "polyline": _points(lane.get("polyline", [])),
            "interpolating": False,
            "entry_lanes": lane.get("entry_lanes", []),
            "exit_lanes": lane.get("exit_lanes", []),
            "left_boundaries": _boundaries(lane.get("left_boundaries", [])),
            "right_boundaries": _boundaries(lane.get("right_boundaries", [])),
            "left_neighbor": _neighbours(lane.get("left_neighbor", [])),
            "right_neighbor": _neighbours(lane.get("right_neighbor", [])),
        }
    for kind, type_ in (("road_line", "ROAD_LINE_UNKNOWN"), ("road_edge", "ROAD_EDGE_BOUNDARY")):
        if kind in feature:
            return {"type": type_, "polyline": _points(feature[kind][0].get("polyline", []))}
    if "stop_sign" in feature:
        lanes = feature["stop_sign"][0].get("lane", [])
        return {"type": "STOP_SIGN", "lane": lanes, "position": np.zeros(3)}
    if "crosswalk" in feature:
        return {"type": "CROSSWALK", "polygon": _points(feature["crosswalk"][0]["polygon"])}
    return {"type": "SPEED_BUMP", "polygon": np.zeros((4, 3))}


def _track(track):
    states = track["states"]

    def column(key):
        values = [state.get(key, [0.0])[0] for state in states]
        return np.array(values, dtype=float)

    type_ = TYPES.get(track["object_type"][0], "UNSET")
    return {
        "type": type_,
        "state": {
            "position": np.stack([column(f"center_{axis}") for axis in "xyz"], axis=1),
            "length": column("length"),
            "width": column("width"),
            "heading": column("heading"),
            "velocity": np.stack([column(f"velocity_{axis}") for axis in "xy"], axis=1),
            "valid": np.array([bool(state.get("valid", [0])[0]) for state in states]),
        },
        "metadata": {"type": type_, "object_id": str(track["id"][0]), "dataset": "waymo"},
    }


def _lights(map_states, count):
    lights = {}
    for step, state in enumerate(map_states):
        for shown in state.get("lane_states", []):
            name = str(shown["lane"][0])
            (point,) = shown["stop_point"]
            entry = lights.setdefault(
                name,
                {
                    "type": "TRAFFIC_LIGHT",
                    "state": {"object_state": [None] * count},
                    "lane": shown["lane"][0],
                    "stop_point": np.array([point[key][0] for key in "xyz"]),
                },
            )
            entry["state"]["object_state"][step] = "LANE_STATE_" + STATES[shown["state"][0]]
    return lights


def from_waymo(wire_file):
    """The dictionary for a scenario of Waymo's, from its bytes as a ``WireFile``."""
    found = {}
    for item in wire_file.fields(SCENARIO):
        value = _plain(item.value) if hasattr(item.value, "fields") else item.value
        found.setdefault(item.field.name, []).append(value)
    (name,), times = found["scenario_id"], found["timestamps_seconds"]
    tracks = [_track(track) for track in found["tracks"]]
    ids = [track["metadata"]["object_id"] for track in tracks]
    return {
        "id": name,
        "version": "v1.2",
        "length": len(times),
        "tracks": dict(zip(ids, tracks, strict=True)),
        "dynamic_map_states": _lights(found.get("dynamic_map_states", []), len(times)),
        "map_features": {
            str(feature["id"][0]): _feature(feature) for feature in found.get("map_features", [])
        },
        "metadata": {
            "id": name,
            "coordinate": "waymo",
            "ts": np.array(times),
            "sdc_id": ids[found["sdc_track_index"][0]],
            "dataset": "waymo",
        },
    }


def write(path, value, protocol=4):
    """A pickle of it."""
    path.write_bytes(pickle.dumps(value, protocol))
    return path
