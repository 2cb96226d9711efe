"""Tracks in the columns of OMEGA-PRIME, which are those of ASAM OSI's moving objects.

Source: the specification of omega-prime (ika-rwth-aachen/omega-prime): one row an object and
moment, ``total_nanos``, ``idx``, the middle of the body, velocities, ``yaw``, and OSI's numbers of
``type``, ``role`` and ``subtype`` (``osi_object.proto``).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
from numpy import int64

from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.table_columns import ColumnKind, NamedColumns, Texts, named_columns
from rulec.recordings.encodings.table_files import open_table
from rulec.recordings.recording import Recording
from rulec.recordings.tracks.derived_motion import along
from rulec.recordings.tracks.even_times import even_times
from rulec.recordings.tracks.roads_of_tracks import lanes_beside, roads_of, track_recording
from rulec.recordings.tracks.track_rows import TrackRows

if TYPE_CHECKING:
    from rulec.recordings.recording_format import RecordingSource

OMEGA_PRIME = FileFormat(
    "tracks in OMEGA-PRIME's columns", "see the specification of omega-prime", 4_000_000_000
)
_VEHICLE, _PEDESTRIAN = 2, 3
_SUBTYPES = {
    **dict.fromkeys((2, 3, 4, 5, 6), "car"),
    **dict.fromkeys((7, 16), "truck"),
    10: "motorcycle",
    11: "bicycle",
    12: "bus",
    **dict.fromkeys((13, 14), "train"),
    15: "pedestrian",
    17: "bicycle",
}
_RESCUE_ROLES = (3, 4, 5)
_KINDS: tuple[str, ...] = (
    *("unknown", "car", "truck", "motorcycle", "bicycle", "bus", "train", "pedestrian"),
    "priorityVehicle",
)

_COLUMNS = (
    ColumnKind("idx", {}, True, True),
    ColumnKind("total_nanos", {"total_nanos": 1e-9}, required=True),
    *(
        ColumnKind(name, {}, required=True)
        for name in ("x", "y", "vel_x", "vel_y", "length", "width", "yaw", "type")
    ),
    *(ColumnKind(name, {}) for name in ("acc_x", "acc_y", "role", "subtype")),
)


def read_omega_prime(source: RecordingSource) -> Iterator[Recording]:
    """The recording in a table. Raises RulecError R0610, R0614, R0615, R0701, R0706."""
    path = source.path
    named = named_columns(open_table(path, OMEGA_PRIME), _COLUMNS)
    numbers = named.numbers
    heading = numbers["yaw"]
    acceleration = None
    if "acc_x" in numbers and "acc_y" in numbers:
        acceleration = along(np.column_stack((numbers["acc_x"], numbers["acc_y"])), heading)
    rows = TrackRows(
        columns=named.columns,
        track=named.texts["idx"],
        times=even_times(numbers["total_nanos"], named.columns),
        x=numbers["x"],
        y=numbers["y"],
        heading=heading,
        velocity=(numbers["vel_x"], numbers["vel_y"]),
        acceleration=acceleration,
        type=_types(named),
        length=numbers["length"],
        width=numbers["width"],
    )
    roads = roads_of(path, source.map_path, rows.times.step_s, lanes_beside(path))
    name = path.name.split(".")[0] or path.name
    yield track_recording(name, [rows], roads, form="OMEGA-PRIME tracks")


def _types(named: NamedColumns) -> Texts:
    """Our types, by OSI's numbers; trailers and others are unknown."""
    nothing = np.full(len(named.numbers["type"]), -1.0)
    kind = named.numbers["type"]
    subtype, role = (named.numbers.get(name, nothing) for name in ("subtype", "role"))
    codes = np.zeros(len(kind), dtype=int64)
    codes[kind == _PEDESTRIAN] = _KINDS.index("pedestrian")
    for number, own in _SUBTYPES.items():
        codes[(kind == _VEHICLE) & (subtype == number)] = _KINDS.index(own)
    rescue = (kind == _VEHICLE) & np.isin(role, _RESCUE_ROLES)
    codes[rescue] = _KINDS.index("priorityVehicle")
    return Texts(codes, _KINDS)
