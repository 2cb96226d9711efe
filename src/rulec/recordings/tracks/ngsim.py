"""NGSIM's trajectories: vehicles on four roads of the USA, tracked in video from high buildings.

Source: Federal Highway Administration, *Next Generation Simulation: US101 Dataset*, and the like
for I-80, Lankershim Boulevard and Peachtree Street (metadata documentation). Lengths are in feet,
speeds in feet a second; ``Local_X``, ``Local_Y`` is the middle of the front, across and along the
road. Files in text have no head, 18 columns on motorways, and 24 on streets.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy import int64

from rulec.recordings.encodings.csv_head import is_number
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.table_columns import ColumnKind, NamedColumns, Texts, named_columns
from rulec.recordings.encodings.table_files import open_table
from rulec.recordings.recording import Recording
from rulec.recordings.recording_format import Glance, RecordingSource
from rulec.recordings.table_heads import head_of
from rulec.recordings.tracks.even_times import even_times
from rulec.recordings.tracks.roads_of_tracks import lanes_beside, roads_of, track_recording
from rulec.recordings.tracks.track_rows import TrackRows

NGSIM_TRACKS = FileFormat(
    "trajectories of NGSIM",
    "give `trajectories-0750am-0805am.txt` or the like, or a table with the names of its columns",
    4_000_000_000,
)
_FOOT_M = 0.3048
_FRONT = (
    *("Vehicle_ID", "Frame_ID", "Total_Frames", "Global_Time", "Local_X", "Local_Y", "Global_X"),
    *("Global_Y", "v_Length", "v_Width", "v_Class", "v_Vel", "v_Acc", "Lane_ID"),
)
_BEHIND = ("Preceding", "Following", "Space_Headway", "Time_Headway")
_STREETS = ("O_Zone", "D_Zone", "Int_ID", "Section_ID", "Direction", "Movement")
HEADLESS = {18: (*_FRONT, *_BEHIND), 24: (*_FRONT, *_STREETS, *_BEHIND)}
"""Columns of files without a head, by how many there are."""

_TYPES = {1: "motorcycle", 2: "car", 3: "truck"}

_COLUMNS = (
    ColumnKind("Vehicle_ID", {"vehicle_id": 1}, True, True),
    ColumnKind("Global_Time", {"global_time": 1e-3}, required=True),
    ColumnKind("Local_X", {"local_x": _FOOT_M}, required=True),
    ColumnKind("Local_Y", {"local_y": _FOOT_M}, required=True),
    ColumnKind("v_Length", {"v_length": _FOOT_M}, required=True),
    ColumnKind("v_Width", {"v_width": _FOOT_M}, required=True),
    ColumnKind("v_Class", {"v_class": 1}, required=True),
    ColumnKind("v_Vel", {"v_vel": _FOOT_M}, required=True),
    ColumnKind("v_Acc", {"v_acc": _FOOT_M}, required=True),
    ColumnKind("Location", {"location": 1}, True),
)


def read_ngsim(source: RecordingSource) -> Iterator[Recording]:
    """The recordings in a file: one, or one for each place in its column ``Location``.

    Raises RulecError R0610, R0614, R0615, R0701, else as reading the map.
    """
    path = source.path
    first = head_of(Glance(path))
    headless = len(first) in HEADLESS and all(map(is_number, first))
    table = open_table(path, NGSIM_TRACKS, HEADLESS[len(first)] if headless else ())
    named = named_columns(table, _COLUMNS)
    name = path.name.split(".")[0]
    places = named.texts.get("Location")
    parts = (
        [(name, named)]
        if places is None
        else [(place or name, named.part(chosen)) for place, chosen in places.groups()]
    )
    for own, part in parts:
        rows = _rows(part)
        roads = roads_of(path, source.map_path, rows.times.step_s, lanes_beside(path))
        recording = track_recording(own, [rows], roads, form="NGSIM tracks")
        yield replace(recording, country="USA", side=roads.side or "right")


def _rows(part: NamedColumns) -> TrackRows:
    numbers = part.numbers
    classes = numbers["v_Class"].astype(int64)
    unknown = ~np.isin(classes, list(_TYPES))
    if unknown.any():
        row = int(np.argmax(unknown))
        why = f"its `v_Class` is {numbers['v_Class'][row]:g}"
        raise part.columns.wrong(row, why, "expected 1 (motorcycle), 2 (car) or 3 (truck)")
    return TrackRows(
        columns=part.columns,
        track=part.texts["Vehicle_ID"],
        times=even_times(numbers["Global_Time"], part.columns),
        x=numbers["Local_X"],
        y=numbers["Local_Y"],
        speed=numbers["v_Vel"],
        acceleration=numbers["v_Acc"],
        type=Texts(classes, ("", *_TYPES.values())),
        length=numbers["v_Length"],
        width=numbers["v_Width"],
        front=True,
    )
