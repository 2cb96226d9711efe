"""Waymo's motion data: files with many scenarios, each read as a recording.

A scenario is put into the words and the form of ScenarioNet's, and both are read in one way.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.tfrecord import TfRecord, tfrecords
from rulec.recordings.encodings.wire_format import Fields, WireFile, fields_of, tables_of
from rulec.recordings.recording import Recording
from rulec.recordings.scenarionet.data_sets import data_set
from rulec.recordings.scenarionet.scenario_dictionary import KeyedValue
from rulec.recordings.scenarionet.scenarionet_file import scenario_recording

# The words are ScenarioNet's, for what is known of them there: a flashing light has no colour, and
# of a line that is broken on one side only, the side is unknown.
_TABLES = tables_of(
    """
Point: 1 x double, 2 y double, 3 z double

ObjectType = 1 VEHICLE, 2 PEDESTRIAN, 3 CYCLIST
State: 2 center_x double, 3 center_y double, 4 center_z double, 5 length float, 6 width float,
  8 heading float, 9 velocity_x float, 10 velocity_y float, 11 valid bool
Track: 1 id int, 2 object_type ObjectType, 3 states State*

Colour = 1 LANE_STATE_ARROW_STOP, 2 LANE_STATE_ARROW_CAUTION, 3 LANE_STATE_ARROW_GO,
  4 LANE_STATE_STOP, 5 LANE_STATE_CAUTION, 6 LANE_STATE_GO
LaneState: 1 lane int, 2 state Colour, 3 stop_point Point
MapState: 1 lane_states LaneState*

LineType = 1 BROKEN_SINGLE_WHITE, 2 SOLID_SINGLE_WHITE, 3 SOLID_DOUBLE_WHITE,
  4 BROKEN_SINGLE_YELLOW, 5 BROKEN_DOUBLE_YELLOW, 6 SOLID_SINGLE_YELLOW, 7 SOLID_DOUBLE_YELLOW
Boundary: 1 lane_start_index int, 2 lane_end_index int, 3 boundary_feature_id int,
  4 boundary_type LineType
Neighbour: 1 feature_id int, 2 self_start_index int, 3 self_end_index int,
  4 neighbor_start_index int, 5 neighbor_end_index int
LaneType = 1 FREEWAY, 3 BIKE_LANE
Lane: 1 speed_limit_mph double, 2 type LaneType, 8 polyline Point*, 9 entry_lanes int*,
  10 exit_lanes int*, 11 left_neighbor Neighbour*, 12 right_neighbor Neighbour*,
  13 left_boundaries Boundary*, 14 right_boundaries Boundary*
Line: 2 polyline Point*
StopSign: 1 lane int*
Crosswalk: 1 polygon Point*
MapFeature: 1 id int, 3 lane Lane, 4 road_line Line, 5 road_edge Line, 7 stop_sign StopSign,
  8 crosswalk Crosswalk

ScenarioId: 5 scenario_id text
Scenario: 1 timestamps_seconds double*, 2 tracks Track*, ScenarioId, 6 sdc_track_index int,
  7 dynamic_map_states MapState*, 8 map_features MapFeature*
""",
    "unknown",
    {},
)
SCENARIO = _TABLES["Scenario"]

SCENARIO_ID = _TABLES["ScenarioId"]
"""The field read first from a record that may not be wanted."""

WAYMO = BinaryFormat(
    "scenarios of Waymo's Open Motion Dataset",
    "they are the files `*.tfrecord-*` below `scenario/`, not those below `tf_example/`",
    100_000_000,
)

MOST_STATES = 2_000_000
"""Limit on the states of a scenario; Waymo's have 200 times 200."""

_LINES = ("road_line", "road_edge")
_INDICES = dict.fromkeys(
    (f"{of}_{end}_index" for of in ("lane", "self", "neighbor") for end in ("start", "end")), 0
)
"""Protocol Buffers omit numbers that are 0."""


def read_waymo(path: Path, scenario_id: str | None = None) -> Iterator[Recording]:
    """The scenarios in a file, or the one with the given id.

    Records after a broken one are still read. Raises RulecError R0610 after the last good record if
    some are broken, R0701 if the file cannot be opened.
    """
    broken: list[RulecError] = []
    for record in tfrecords(path, WAYMO):
        scenario = _read(record, path, scenario_id)
        if isinstance(scenario, RulecError):
            broken.append(scenario)
        elif scenario is not None:
            yield scenario
    if broken:
        raise RulecError(diagnostic for error in broken for diagnostic in error.diagnostics)


def _read(
    record: TfRecord | RulecError, path: Path, scenario_id: str | None
) -> Recording | RulecError | None:
    """The scenario in a record, the error, or None if the scenario has another id."""
    if isinstance(record, RulecError):
        return record
    file = WireFile(record.content, path, WAYMO, record.place)
    try:
        name = _id(file, record)
        if scenario_id not in (None, name):
            return None
        way = (f"record {record.number}",)
        scenario = KeyedValue(scenario_content(file), way, path, WAYMO, place=record.place)
        return scenario_recording(scenario, data_set("waymo"), name, "Waymo scenario")
    except RulecError as error:
        return error


def waymo_ids(path: Path) -> Iterator[str]:
    """The ids of the scenarios in a file, without broken records. Raises RulecError R0701."""
    for record in tfrecords(path, WAYMO):
        if isinstance(record, TfRecord):
            with suppress(RulecError):
                yield _id(WireFile(record.content, path, WAYMO, record.place), record)


def _id(file: WireFile, record: TfRecord) -> str:
    for item in file.fields(SCENARIO_ID):
        return str(item.value)
    raise file.wrong(f"record {record.number} has no `scenario_id`", 0)


def scenario_content(file: WireFile) -> dict[str, Any]:
    """The scenario in a record, as ScenarioNet's converter would write it.

    Raises RulecError R0610 for what cannot be written so: a broken message, and ids that are not
    unique.
    """
    times: list[float] = []
    tracks: dict[str, Any] = {}
    features: dict[str, Any] = {}
    shown: list[Fields] = []
    ego, states = None, 0
    for item in file.fields(SCENARIO):
        fields = fields_of([item])
        match item.field.name:
            case "timestamps_seconds":
                times += fields["timestamps_seconds"]
            case "sdc_track_index":
                ego = fields["sdc_track_index"]
            case "dynamic_map_states":
                shown += fields["dynamic_map_states"]
            case "tracks":
                (track,) = fields["tracks"]
                states += len(track.get("states", ()))
                if states > MOST_STATES:
                    raise file.wrong(f"there are more than {MOST_STATES:,} states", item.place)
                _enter(tracks, "track", track, _track(track), file)
            case "map_features":
                (feature,) = fields["map_features"]
                if (own := _feature(feature)) is not None:
                    _enter(features, "map feature", feature, own, file)
    if ego is not None and tracks and not 0 <= ego < len(tracks):
        raise file.wrong(f"`sdc_track_index` is {ego} of {len(tracks)} tracks", 0)
    return {
        "tracks": tracks,
        "map_features": features,
        "dynamic_map_states": _lights(shown, file),
        "metadata": {
            "ts": np.array(times),
            "sdc_id": "" if ego is None or not tracks else [*tracks][ego],
        },
    }


def _enter(
    known: dict[str, Any], kind: str, message: Fields, own: Mapping[str, Any], file: WireFile
) -> None:
    name = str(message.get("id", 0))
    if name in known:
        raise file.wrong(f"there is a second {kind} {name}", 0)
    known[name] = own


def _track(track: Fields) -> dict[str, Any]:
    states = track.get("states", ())

    def column(*names: str) -> NDArray[float64]:
        rows = [[state.get(name, nan) for name in names] for state in states]
        return np.array(rows, dtype=float).reshape(-1, len(names))

    return {
        "type": track.get("object_type", ""),
        "state": {
            "valid": np.array([state.get("valid", False) for state in states], dtype=bool),
            "position": column("center_x", "center_y"),
            "velocity": column("velocity_x", "velocity_y"),
            **{name: column(name) for name in ("heading", "length", "width")},
        },
    }


def _feature(feature: Fields) -> dict[str, Any] | None:
    """A map feature; None for those of kinds that are not used."""
    if (lane := feature.get("lane")) is not None:
        sides = [key for key in lane if key.startswith(("left_", "right_"))]
        parts = {key: [_INDICES | part for part in lane[key]] for key in sides}
        kind = f"LANE_{lane.get('type', '')}"
        return {**_NO_LINKS, **lane, **parts, "type": kind, "polyline": _points(lane, "polyline")}
    for line in (feature[name] for name in _LINES if name in feature):
        return {"type": "ROAD_LINE", "polyline": _points(line, "polyline")}
    if (sign := feature.get("stop_sign")) is not None:
        return {"type": "STOP_SIGN", "lane": sign.get("lane", [])}
    if (crosswalk := feature.get("crosswalk")) is not None:
        return {"type": "CROSSWALK", "polygon": _points(crosswalk, "polygon")}
    return None


_NO_LINKS: Mapping[str, Any] = {"entry_lanes": [], "exit_lanes": []}


def _points(message: Fields, name: str) -> NDArray[float64]:
    """The points in a field; without heights if one of them has none."""
    points = message.get(name, ())
    axes = "xyz" if all("z" in point for point in points) else "xy"
    rows = [[point.get(axis, nan) for axis in axes] for point in points]
    return np.array(rows, dtype=float).reshape(-1, len(axes))


def _lights(shown: list[Fields], file: WireFile) -> dict[str, Any]:
    """What the light of each lane shows at each of the times."""
    lights: dict[str, Any] = {}
    for number, moment in enumerate(shown):
        for state in moment.get("lane_states", ()):
            lane = state.get("lane", 0)
            if len(lights) * len(shown) > MOST_STATES:
                raise file.wrong(f"there are more than {MOST_STATES:,} states of lights", 0)
            new = {"lane": lane, "state": {"object_state": [None] * len(shown)}}
            light = lights.setdefault(str(lane), new)
            light["state"]["object_state"][number] = state.get("state")
    return lights
