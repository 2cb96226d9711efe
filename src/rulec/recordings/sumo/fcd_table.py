"""Reads SUMO's floating-car data from tables: .csv and .parquet from SUMO, or from xml2csv.py.

A table has no head that names the net. SUMO writes pedestrians into the same columns as vehicles:
rows with an edge and no lane are pedestrians.
"""

from __future__ import annotations

from array import array
from pathlib import Path

import numpy as np
from numpy import int64, intp
from numpy.typing import NDArray

from rulec.recordings.encodings.file_values import LARGEST, short
from rulec.recordings.encodings.table_columns import Columns
from rulec.recordings.encodings.table_files import open_table
from rulec.recordings.sumo.fcd_content import (
    BODIES,
    FCD,
    LONGEST_ID,
    MICROSECONDS,
    NOWHERE,
    PLACE,
    SPEED,
    FcdTrack,
    FloatingCarData,
)

_TIME = "timestep_time"
_MORE = (SPEED, "acceleration", "signals")
_TEXTS = ("id", "type", "lane", "edge", "vehicle")


def read_fcd_table(path: Path) -> FloatingCarData:
    """The content of a table. Raises RulecError R0610 for another kind of file, R0701, R0706."""
    table = open_table(path, FCD)
    kinds = [kind for kind in sorted(BODIES) if f"{kind}_id" in table.names]
    needed = [f"{kind}_{name}" for kind in kinds for name in PLACE]
    for name in (_TIME, *needed):
        if name not in table.names:
            raise table.refused(f"it has no column `{name}`")
    optional = [f"{kind}_{name}" for kind in kinds for name in _MORE]
    texts = [f"{kind}_{name}" for kind in kinds for name in _TEXTS]
    columns = table.read(
        [_TIME, *needed, *(name for name in optional if name in table.names)],
        [name for name in texts if name in table.names],
    )
    times = columns.numbers[_TIME]
    if np.isnan(times).any():
        raise columns.wrong(int(np.argmax(np.isnan(times))), f"its column `{_TIME}` is empty here")
    moments, at = np.unique(np.round(times * MICROSECONDS).astype(int64), return_inverse=True)
    data = FloatingCarData(moments=moments.tolist())
    tracks = [
        (rows[0], kind, key, rows)
        for kind in kinds
        for key, rows in columns.texts[f"{kind}_id"].groups()
        if key
    ]
    for _, kind, key, rows in sorted(tracks, key=lambda entry: int(entry[0])):
        _add(data, columns, (kind, key), rows[np.argsort(at[rows], kind="stable")], at)
    return data


def _add(
    data: FloatingCarData,
    columns: Columns,
    element_and_key: tuple[str, str],
    rows: NDArray[intp],
    at: NDArray[int64],
) -> None:
    kind, key = element_and_key
    if len(key) > LONGEST_ID:
        raise columns.wrong(int(rows[0]), f"an id is longer than {LONGEST_ID} characters")
    carrier = columns.texts.get(f"{kind}_vehicle")
    if carrier is not None:
        # Passengers count as part of their vehicle
        rows = rows[~np.array([bool(carrier.names[code]) for code in carrier.codes[rows]])]
    unknown = np.full(len(columns.rows), np.nan)
    numbers = [columns.numbers.get(f"{kind}_{name}", unknown)[rows] for name in (*PLACE, SPEED)]
    place = np.stack(numbers, axis=-1)
    is_there = ~(place[:, :2] == NOWHERE).all(axis=1)
    rows, place = rows[is_there], place[is_there]
    bad = ~(np.abs(place) < LARGEST)
    bad[:, -1] &= ~np.isnan(place[:, -1])
    odd = np.argwhere(bad)
    if odd.size:
        row, at = odd[0].tolist()
        name = (*PLACE, SPEED)[at]
        raise columns.wrong(int(rows[row]), f"its column `{kind}_{name}` holds no number")
    twice = np.flatnonzero(np.diff(at[rows]) == 0)
    if twice.size:
        why = f"`{short(key)}` is twice in one time step"
        raise columns.wrong(int(rows[twice[0] + 1]), why)
    if not rows.size:
        return
    lane, edge = (columns.texts.get(f"{kind}_{name}") for name in ("lane", "edge"))
    walks = bool(lane and edge and not lane.of(rows[0]) and edge.of(rows[0]))
    element = "person" if kind == "vehicle" and walks else kind
    types = columns.texts.get(f"{kind}_type")
    track = FcdTrack(
        element,
        types.of(rows[0]) if types else "",
        array("q", at[rows].tolist()),
        array("d", place.ravel().tolist()),
    )
    faster = columns.numbers.get(f"{kind}_acceleration")
    track.accelerations.extend([np.nan] * len(rows) if faster is None else faster[rows].tolist())
    signals = columns.numbers.get(f"{kind}_signals")
    if signals is not None:
        known = rows[np.isfinite(signals[rows])]
        track.lamps.update(
            zip(at[known].tolist(), signals[known].astype(int).tolist(), strict=True)
        )
    data.tracks[key if key not in data.tracks else f"{element} {key}"] = track
    for network_part, named in (("lane", lane), ("edge", edge)):
        for code in np.unique(named.codes[rows]).tolist() if named else ():
            if named and named.names[code]:
                row = int(rows[np.argmax(named.codes[rows] == code)])
                data.on.setdefault(named.names[code], (network_part, int(columns.rows[row])))
