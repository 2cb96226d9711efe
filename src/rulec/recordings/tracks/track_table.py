"""Tracks as a table with user-defined columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np

from rulec.diagnostics import nearest_name
from rulec.recordings.doubts.motion_doubts import with_doubts
from rulec.recordings.doubts.road_doubts import check_near
from rulec.recordings.encodings.csv_head import is_number
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.speed_units import MPS_PER_KMH, MPS_PER_MPH
from rulec.recordings.encodings.table_columns import (
    ColumnKind,
    ColumnTable,
    NamedColumns,
    named_columns,
    unread_remark,
)
from rulec.recordings.encodings.table_files import open_table, table_of
from rulec.recordings.lanes.lane_table import lane_map
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import Lamp, Recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.road_map import RoadMap
from rulec.recordings.table_heads import SAME_NAME
from rulec.recordings.tracks.even_times import EvenTimes, even_times, framed_times
from rulec.recordings.tracks.roads_of_tracks import lanes_beside, roads_of, track_recording
from rulec.recordings.tracks.track_rows import TrackRows

TRACKS = FileFormat(
    "a table of tracks",
    "it has a row for each time of each track, with the columns `track`, `t`, `x`, `y`",
    4_000_000_000,
)

_RECORDING = "recording"
"""The column of fleets' tables that names a row's recording."""

_SPARSE_S = 5.0
_CREEPING_MPS = 0.5
_MANY_NAMES = 5
_ALMOST_EVEN = 2.5
_DEG = pi / 180
_LAMPS = cast("tuple[Lamp, ...]", get_args(Lamp))

TRACK_COLUMNS = (
    ColumnKind(
        "track",
        dict.fromkeys(("track_id", "trackid", "id", "object_id", "vehicle_id"), 1.0),
        is_text=True,
        required=True,
    ),
    ColumnKind(
        "t",
        {"t_s": 1, "time": 1, "time_s": 1, "t_ms": 1e-3, "time_ms": 1e-3, "timestamp_ms": 1e-3}
        | {"t_us": 1e-6, "time_us": 1e-6, "timestamp_us": 1e-6}
        | {"t_ns": 1e-9, "time_ns": 1e-9, "timestamp_ns": 1e-9},
        required=True,
    ),
    ColumnKind("x", {"x_m": 1, "front_x": 1}, required=True),
    ColumnKind("y", {"y_m": 1, "front_y": 1}, required=True),
    ColumnKind("type", dict.fromkeys(("class", "agent_type", "object_type"), 1.0), is_text=True),
    ColumnKind(
        "heading",
        {"heading_rad": 1, "yaw": 1, "yaw_rad": 1, "psi_rad": 1}
        | {"heading_deg": _DEG, "yaw_deg": _DEG},
    ),
    ColumnKind(
        "speed", {"speed_mps": 1, "v": 1, "speed_kmh": MPS_PER_KMH, "speed_mph": MPS_PER_MPH}
    ),
    ColumnKind("vx", {"vel_x": 1, "vx_mps": 1}),
    ColumnKind("vy", {"vel_y": 1, "vy_mps": 1}),
    ColumnKind("acceleration", {"acc": 1, "acceleration_mps2": 1}),
    ColumnKind("length", {"length_m": 1}),
    ColumnKind("width", {"width_m": 1}),
    ColumnKind("standing", {}),
    ColumnKind("ego", {"is_ego": 1}),
    *(ColumnKind(lamp, {}) for lamp in _LAMPS),
)

_OPTIONAL = ("heading", "speed", "acceleration", "length", "width", "standing", "ego")
_FRAMES = frozenset({"frame", "frame_id", "frameid", "frame_nr", "frame_number"})
_FRAME = ColumnKind("t", dict.fromkeys(sorted(_FRAMES), 1.0), required=True)
_TIMES = frozenset(
    alias for kind in TRACK_COLUMNS if kind.name == "t" for alias in ("t", *kind.also)
)
_OF_FRAMES = (
    "say how many frames a second has, as in `--frame-rate 25`; or name a column `t`, in seconds"
)


def read_track_table(source: RecordingSource) -> Iterator[Recording]:
    """The recording in a file. Raises RulecError R0610, R0614, R0615, R0701, R0706."""
    path = source.path
    rows, remark = track_rows_of(open_table(path, TRACKS), source.frame_rate)
    roads = roads_of(path, source.map_path, rows.times.step_s, lanes_beside(path))
    name = path.name.split(".")[0] or path.name
    yield track_recording(name, [rows], roads, form="tracks as a table", remarks=[remark])


def recording_from_columns(
    tracks: Mapping[str, Any],
    lanes: Mapping[str, Any] | RoadMap | str | Path,
    *,
    name: str = "tracks",
    frame_rate: float | None = None,
) -> Recording:
    """A recording from columns: a dict of sequences or arrays, or a data frame.

    ``tracks`` has the columns of [tracks as a table](formats.md#tracks-as-a-table), such as
    ``track``, ``t``, ``x`` and ``y``; ``lanes`` has those of lanes as a table, or is a ``RoadMap``
    or the path of a map. ``frame_rate`` (Hz) is needed where ``frame`` is in the place of ``t``,
    and confirms times that speeds contradict. Raises RulecError R0610 for invalid values, with row
    (counted from 0) and column, R0615 if nobody is near the roads, else as reading that map. Odd
    but readable values are reported in ``remarks``.
    """
    rows, remark = track_rows_of(table_of(tracks, "tracks"), frame_rate)
    if isinstance(lanes, RoadMap):
        roads = lanes
    elif isinstance(lanes, str | Path):
        roads = read_map(Path(lanes), rows.times.step_s)
    else:
        roads = lane_map(lanes)
    recording = track_recording(name, [rows], roads, form="tracks as a table", remarks=[remark])
    check_near(recording, None)
    return with_doubts(recording, rows.columns.refused, sure=frame_rate is not None)


def track_rows_of(table: ColumnTable, frame_rate: float | None = None) -> tuple[TrackRows, str]:
    """The rows of a table of tracks, and a remark about column names that are almost known.

    A ``frame_rate`` (Hz) says what a second is, whatever the times are; frames need it.
    """
    _check_one_recording(table)
    heads = {name.strip().casefold() for name in table.names}
    kinds = TRACK_COLUMNS
    if framed := not _TIMES & heads and bool(_FRAMES & heads):
        if frame_rate is None:
            why = "it has frames in the place of times `t`, and no frame rate"
            raise table.refused(why, help_text=_OF_FRAMES)
        kinds = tuple(_FRAME if kind.name == "t" else kind for kind in kinds)
    named = named_columns(table, kinds)
    numbers = named.numbers
    if ("vx" in numbers) != ("vy" in numbers):
        has, lacks = ("vx", "vy") if "vx" in numbers else ("vy", "vx")
        raise table.refused(f"it has a column `{has}`, but none `{lacks}`")
    front = "front_x" in heads
    if front != ("front_y" in heads):
        raise table.refused("only one of the columns `front_x` and `front_y` is there")
    velocity = (numbers["vx"], numbers["vy"]) if "vx" in numbers else None
    if velocity is not None and any(np.isnan(part).any() for part in velocity):
        # Who has no velocity somewhere has none: places tell it as well
        velocity = None
    _check_exchanged(named)
    if framed and frame_rate is not None:
        times = framed_times(numbers["t"], frame_rate, named.columns)
    else:
        times = even_times(numbers["t"], named.columns, named.texts["track"].codes)
    if frame_rate is not None:
        start = times.start_s / times.step_s / frame_rate
        times = EvenTimes(1 / frame_rate, times.steps, start)
    rows = TrackRows(
        columns=named.columns,
        track=named.texts["track"],
        times=times,
        x=numbers["x"],
        y=numbers["y"],
        velocity=velocity,
        type=named.texts.get("type"),
        front=front,
        **{name: numbers.get(name) for name in _OPTIONAL},
        lamps={lamp: numbers[lamp] for lamp in _LAMPS if lamp in numbers},
    )
    if frame_rate is None:
        _check_seconds(rows, heads)
    return rows, unread_remark(named.unread, TRACK_COLUMNS)


def _check_one_recording(table: ColumnTable) -> None:
    """Refuse tracks of several recordings, which would share one road."""
    for name in table.names:
        if not nearest_name(name.strip(), [_RECORDING], SAME_NAME):
            continue
        names = table.read([], [name]).texts[name].names
        if len(names) > 1:
            shown = [f"`{short(text)}`" for text in names[:3]] + ["…"] * (len(names) > 3)
            raise table.refused(
                f"it has the tracks of {len(names):,} recordings, by its column `{short(name)}`: "
                f"{', '.join(shown)}; they would be taken to share one road",
                help_text="write each recording to a file of its own; or all of them to a table in "
                "Parquet with the column `recording`, which `rulec fleet` reads",
            )


def _check_seconds(rows: TrackRows, heads: set[str]) -> None:
    """Refuse unitless times that cannot be seconds: rows far apart although nobody moves.

    If milliseconds were taken for seconds, a car seen ten times a second would move a metre in 100
    s. Tracks with rare observations, for instance by satellite, move much farther from row to row.
    """
    column = next((name for name in ("t", "time") if name in heads), None)
    step_s = rows.times.step_s
    if column is None or step_s < _SPARSE_S or len(rows.x) < 2:
        return
    order = np.lexsort((rows.times.steps, rows.track.codes))
    same = np.diff(rows.track.codes[order]) == 0
    moved = np.hypot(np.diff(rows.x[order]), np.diff(rows.y[order]))
    took = np.maximum(np.diff(rows.times.steps[order]), 1) * step_s
    fastest = float(np.max(moved[same] / took[same], initial=0.0))
    if fastest > _CREEPING_MPS:
        return
    unit = "milliseconds" if step_s < 1000 * _SPARSE_S else "microseconds or nanoseconds"
    names = "`t_ms`" if step_s < 1000 * _SPARSE_S else "`t_us` or `t_ns`"
    why = (
        f"its times are {step_s:g} s apart, in which nobody moves faster than {fastest:.2g} m/s: "
        f"`{column}` seems to hold {unit}, not seconds"
    )
    way_out = f"call the column {names}; or `t_s`, if these are seconds"
    raise rows.columns.refused(why, help_text=way_out)


def _check_exchanged(named: NamedColumns) -> None:
    """Refuse tables in which the columns of tracks and times are exchanged.

    Otherwise each moment would become a track that is everywhere.
    """
    names, times = named.texts["track"].names, named.numbers["t"]
    if len(names) < _MANY_NAMES or not all(map(is_number, names)):
        return
    moments = np.unique([float(name) for name in names])
    between = np.diff(moments)
    is_grid = len(moments) == len(names) and between.max() < _ALMOST_EVEN * between.min()
    are_whole = (moments == np.round(moments)).all()
    if is_grid and not are_whole and (times == np.round(times)).all():
        why = (
            f"its tracks are called `{short(names[0])}` to `{short(names[-1])}`, and its times are "
            "whole numbers: `track` and `t` seem to be exchanged"
        )
        raise named.columns.refused(why, help_text="exchange the names of these two columns")
