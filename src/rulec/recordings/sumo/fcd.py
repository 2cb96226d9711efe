"""Reads SUMO's floating-car data (positions over time), and finds the files beside them.

A vehicle's ``x`` and ``y`` are the middle of its front bumper; its ``angle`` is in degrees
clockwise from the y axis, as on a compass. Passengers count as part of their vehicle and are left
out.

Tables are .csv and .parquet from SUMO, or from xml2csv.py. A table has no head that names the net.
SUMO writes pedestrians into the same columns as vehicles: rows with an edge and no lane are
pedestrians.
"""

from __future__ import annotations

from array import array
from operator import itemgetter
from pathlib import Path, PurePosixPath

import numpy as np
from numpy import int64, intp
from numpy.typing import NDArray

from rulec.diagnostics import RulecError, SourceLocation, named
from rulec.recordings.encodings.file_values import LARGEST, numbers_in, short
from rulec.recordings.encodings.safe_xml import scan
from rulec.recordings.encodings.table_columns import Columns
from rulec.recordings.encodings.table_files import open_table
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.recording_format import Glance
from rulec.recordings.recording_messages import NET_MISSING
from rulec.recordings.sumo.fcd_content import (
    BODIES,
    FCD,
    LONGEST_ID,
    MICROSECONDS,
    NOWHERE,
    PLACE,
    SPEED,
    FcdHead,
    FcdTrack,
    FloatingCarData,
    fcd_head,
)
from rulec.recordings.table_heads import head_of, is_fcd_head

_place_of = itemgetter("id", *PLACE)
_TIME = "timestep_time"
_MORE = (SPEED, "acceleration", "signals")
_TEXTS = ("id", "type", "lane", "edge", "vehicle")


def read_fcd(path: Path) -> FloatingCarData:
    """The content of XML or a table.

    Raises RulecError R0610 for another kind of file, R0701 if it is unreadable, R0706.
    """
    return _in_table(path) if is_fcd_head(head_of(Glance(path))) else _in_xml(path)


def _in_xml(path: Path) -> FloatingCarData:
    data = FloatingCarData()
    carriers = 0

    def comment(text: str) -> None:
        if not data.moments and "<" in text:
            data.head = fcd_head(text)

    def begin(element: Tree) -> None:
        nonlocal carriers
        if element.name in BODIES:
            carriers += 1
            if not data.moments:
                raise element.wrong(f"a `{element.name}` is in no `timestep`")
            if carriers == 1 and not element.attributes.get("vehicle"):
                _add_element(data, element)
        elif element.name == "timestep":
            moment = round(element.number("time") * MICROSECONDS)
            if data.moments and moment <= data.moments[-1]:
                raise element.wrong("its time steps are not in ascending order")
            data.moments.append(moment)

    def end(name: str) -> None:
        nonlocal carriers
        carriers -= name in BODIES

    scan(path, FCD, begin, end=end, comment=comment)
    return data


def _add_element(data: FloatingCarData, element: Tree) -> None:
    name, attributes = element.name, element.attributes
    try:
        key, *place = _place_of(attributes)
        motion = attributes.get(SPEED, "0"), attributes.get("acceleration", "nan")
        x, y, angle, speed, acceleration = numbers_in((*place, *motion))
    except (KeyError, ValueError):
        raise _wrong(element) from None
    if x == y == NOWHERE:
        return
    # Comparisons with NaN are false
    if not (
        -LARGEST < x < LARGEST
        and -LARGEST < y < LARGEST
        and -LARGEST < angle < LARGEST
        and -LARGEST < speed < LARGEST
    ):
        raise _wrong(element)
    track = data.tracks.get(key)
    if track is not None and track.element != name:
        # SUMO lets a person and a vehicle have the same id; here ids are unique
        key = f"{name} {key}"
        track = data.tracks.get(key)
    moment = len(data.moments) - 1
    if track is None:
        if not 0 < len(key) <= LONGEST_ID:
            raise element.wrong(f"the id of a `{name}` is empty, or longer than {LONGEST_ID}")
        track = data.tracks[key] = FcdTrack(name, attributes.get("type", ""))
    elif track.moments[-1] == moment:
        raise element.wrong(f"`{short(key)}` is twice in one time step")
    track.moments.append(moment)
    track.rows.extend((x, y, angle, speed if SPEED in attributes else float("nan")))
    track.accelerations.append(acceleration if abs(acceleration) < LARGEST else float("nan"))
    if "signals" in attributes:
        track.lamps[moment] = int(element.number("signals"))
    on = attributes.get("lane") or attributes.get("edge")
    if on and on not in data.on:
        kind = "lane" if attributes.get("lane") else "edge"
        data.on[on] = kind, element.place


def _wrong(element: Tree) -> RulecError:
    element.filled("id")
    for key in PLACE:
        element.number(key)
    for key in (SPEED, "acceleration"):
        element.number(key, 0.0)
    raise AssertionError("one of these is not a number")


def _in_table(path: Path) -> FloatingCarData:
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
        _add_rows(data, columns, (kind, key), rows[np.argsort(at[rows], kind="stable")], at)
    return data


def _add_rows(
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
    for network_part, names in (("lane", lane), ("edge", edge)):
        for code in np.unique(names.codes[rows]).tolist() if names else ():
            if names and names.names[code]:
                row = int(rows[np.argmax(names.codes[rows] == code)])
                data.on.setdefault(names.names[code], (network_part, int(columns.rows[row])))


def net_beside(path: Path, head: FcdHead) -> Path:
    """The net of floating-car data. Raises RulecError R0614 if it is missing or unclear."""
    written = named_beside(path, head.net) if head.net else None
    if written is not None:
        return written
    nets = [*path.parent.glob("*.net.xml"), *path.parent.glob("*.net.xml.gz")]
    if len(nets) == 1:
        return nets[0]
    if nets:
        why = f"there are several nets beside it: {named(sorted(net.name for net in nets))}"
    elif head.net:
        why = f"`{_name(head.net)}`, which it was made with, is not beside it"
    else:
        why = "there is no net beside it"
    raise NET_MISSING.error(
        SourceLocation(str(path)),
        f"SUMO's floating-car data do not say where the roads are, and {why}",
        help="name SUMO's net with --map FILE",
    )


def demand_beside(path: Path, head: FcdHead) -> tuple[Path, ...]:
    """The files beside floating-car data that may describe the types of vehicles."""
    written = [file for name in head.demand if (file := named_beside(path, name)) is not None]
    if written:
        return tuple(written)
    only = [*path.parent.glob("*.rou.xml"), *path.parent.glob("*.rou.xml.gz")]
    return tuple(only) if len(only) == 1 else ()


def named_beside(path: Path, written: str) -> Path | None:
    """The file beside floating-car data that has the name in ``written``; None if it is missing."""
    # Only the file's name is used, so that no other folder can be read
    candidate = path.parent / _name(written)
    return candidate if candidate.is_file() else None


def _name(written: str) -> str:
    return PurePosixPath(written.replace("\\", "/").replace("\0", "")).name
