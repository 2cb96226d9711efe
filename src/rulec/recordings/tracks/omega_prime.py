"""Tracks in the columns of OMEGA-PRIME, which are those of ASAM OSI's moving objects.

Source: the specification of omega-prime (ika-rwth-aachen/omega-prime): one row an object and
moment, ``total_nanos``, ``idx``, the middle of the body, velocities, ``yaw``, and OSI's numbers of
``type``, ``role`` and ``subtype`` (``osi_object.proto``).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy import int64

from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.table_columns import ColumnKind, NamedColumns, Texts, named_columns
from rulec.recordings.encodings.table_files import open_table
from rulec.recordings.mending.derived_motion import along
from rulec.recordings.osi.moving_objects import kind_of
from rulec.recordings.osi.osi_tables import OBJECTS, ROLES, VEHICLES
from rulec.recordings.recording import Recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.tracks.even_times import even_times
from rulec.recordings.tracks.roads_of_tracks import lanes_beside, roads_of, track_recording
from rulec.recordings.tracks.track_rows import TrackRows

OMEGA_PRIME = FileFormat(
    "tracks in OMEGA-PRIME's columns", "see the specification of omega-prime", 4_000_000_000
)
_MOST = 100
"""More than any number of a type, role or subtype."""

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
    """Our types, by OSI's numbers: those that a trace with the same numbers has."""
    kind = named.numbers["type"]
    more = [named.numbers.get(name, np.full(len(kind), -1.0)) for name in ("subtype", "role")]
    # An empty cell is as good as -1, which says that there is none
    columns = [np.nan_to_num(column, nan=-1.0) for column in (kind, *more)]
    numbers = [np.clip(column, -1, _MOST - 2).astype(int64) + 1 for column in columns]
    together = (numbers[0] * _MOST + numbers[1]) * _MOST + numbers[2]
    distinct, codes = np.unique(together, return_inverse=True)
    return Texts(codes.astype(int64), tuple([_type(number) for number in distinct.tolist()]))


def _type(together: int) -> str:
    rest, role = divmod(together, _MOST)
    kind, vehicle = divmod(rest, _MOST)
    words = [
        words.by_number.get(number - 1, words.other) if number else None
        for words, number in ((OBJECTS, kind), (VEHICLES, vehicle), (ROLES, role))
    ]
    return kind_of(words[0] or "unknown", *words[1:])
