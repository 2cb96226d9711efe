"""The INTERACTION data set: tracks of vehicles, and beside them those of people on foot or cycles.

Source: Zhan et al., *INTERACTION Dataset* (2019), section V, and the data set's own description:
10 Hz, x and y in metres of the map's projection with its origin at 0° N, 0° E, ``psi_rad`` counter-
clockwise from the x axis. ``agent_type`` is ``car`` for all vehicles, and ``pedestrian/bicycle``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy import int64

from rulec.recordings.commonroad.countries import country_in, side_in
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.table_columns import ColumnKind, NamedColumns, Texts, named_columns
from rulec.recordings.encodings.table_files import open_table
from rulec.recordings.recording import Recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.road_map import RoadMap
from rulec.recordings.tracks.even_times import framed_times
from rulec.recordings.tracks.roads_of_tracks import roads_of, track_recording
from rulec.recordings.tracks.track_rows import TrackRows

INTERACTION = FileFormat(
    "tracks of INTERACTION",
    "`vehicle_tracks_NNN.csv` has the columns `track_id`, `timestamp_ms`, `agent_type`, `x`, `y`, "
    "`vx`, `vy`, `psi_rad`, `length`, `width`",
    4_000_000_000,
)
_RATE = 10.0
_STEP_S = 1 / _RATE
_VEHICLES, _WALKERS = "vehicle_tracks_", "pedestrian_tracks_"
_CYCLING_MPS = 2.5
_EITHER = "pedestrian/bicycle"

_COLUMNS = (
    ColumnKind("case_id", {}, True),
    ColumnKind("track_id", {}, True, True),
    ColumnKind("timestamp_ms", {}, required=True),
    ColumnKind("agent_type", {}, True, True),
    *(ColumnKind(name, {}, required=True) for name in ("x", "y", "vx", "vy")),
    *(ColumnKind(name, {}) for name in ("psi_rad", "length", "width")),
)


def read_interaction(source: RecordingSource) -> Iterator[Recording]:
    """The recordings in a file: one, or as many as there are cases in its column ``case_id``.

    Raises RulecError R0610, R0614, R0615, R0701, else as reading the map.
    """
    path = source.path
    tables = [named_columns(open_table(file, INTERACTION), _COLUMNS) for file in _files(path)]
    scene = _scene(path)
    roads = roads_of(path, source.map_path, _STEP_S, _maps(path, scene))
    if "case_id" not in tables[0].texts:
        yield _recording(scene, tables, roads)
        return
    for case, chosen in tables[0].texts["case_id"].groups():
        name = f"{scene}_{case.removesuffix('.0')}"
        yield _recording(name, [tables[0].part(chosen)], roads)


def _files(path: Path) -> list[Path]:
    """The file and its companion, vehicles first."""
    for own, other in ((_VEHICLES, _WALKERS), (_WALKERS, _VEHICLES)):
        if path.name.startswith(own):
            companion = path.with_name(other + path.name.removeprefix(own))
            files = [path, companion] if companion.is_file() else [path]
            return sorted(files, key=lambda file: file.name.startswith(_WALKERS))
    return [path]


def _scene(path: Path) -> str:
    """The name of the site.

    It is the folder's for numbered files, else the file's without its part number.
    """
    stem = path.name.partition(".")[0]
    number = stem.rpartition("_")[2]
    if stem.startswith((_VEHICLES, _WALKERS)):
        return f"{path.absolute().parent.name}_{number}"
    return re.sub(r"_(train|val|test|obs)$", "", stem)


def _maps(path: Path, scene: str) -> list[Path]:
    """Where the map may be: in the data set's folder ``maps``, or alone beside the tracks."""
    place = path.absolute().parent
    names = {f"{place.name}.osm", f"{scene}.osm"}
    usual = [
        place.parents[up] / "maps" / name
        for up in (0, 1)
        for name in sorted(names)
        if up < len(place.parents)
    ]
    beside = sorted(place.glob("*.osm"))
    return [*usual, *(beside if len(beside) == 1 else [])]


def _recording(name: str, tables: Sequence[NamedColumns], roads: RoadMap) -> Recording:
    rows, remarks = [], []
    for table in tables:
        numbers = table.numbers
        types = table.texts["agent_type"]
        if types.having(_EITHER).any():
            types = _told_apart(table)
            remarks.append(
                f"who is `{_EITHER}` is taken to be on foot up to {_CYCLING_MPS:g} m/s in the mean"
            )
        frames = np.round(numbers["timestamp_ms"] / 1000 * _RATE, 6)
        rows.append(
            TrackRows(
                columns=table.columns,
                track=table.texts["track_id"],
                times=framed_times(frames, _RATE, table.columns),
                x=numbers["x"],
                y=numbers["y"],
                heading=numbers.get("psi_rad"),
                velocity=(numbers["vx"], numbers["vy"]),
                type=types,
                length=numbers.get("length"),
                width=numbers.get("width"),
            )
        )
    side = side_in(country_in(name.removeprefix("DR_")))
    with_side = roads if roads.side or side is None else replace(roads, side=side)
    return track_recording(name, rows, with_side, form="INTERACTION tracks", remarks=remarks)


def _told_apart(table: NamedColumns) -> Texts:
    """Types, with ``pedestrian/bicycle`` divided by speed."""
    track, types = table.texts["track_id"], table.texts["agent_type"]
    speeds = np.hypot(table.numbers["vx"], table.numbers["vy"])
    count = np.maximum(np.bincount(track.codes, minlength=len(track.names)), 1)
    mean = np.bincount(track.codes, weights=speeds, minlength=len(track.names)) / count
    names = (*types.names, "pedestrian", "bicycle")
    by_speed = np.where(mean[track.codes] > _CYCLING_MPS, len(names) - 1, len(names) - 2)
    codes = np.where(types.having(_EITHER), by_speed, types.codes).astype(int64)
    return Texts(codes, names)
