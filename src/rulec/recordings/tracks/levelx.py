"""The data sets of levelXdata: highD, inD, rounD, exiD and uniD, as drones saw traffic in Germany.

Sources: the pages on the format of each data set (levelxdata.com), and Krajewski et al., *The
highD dataset* (ITSC 2018). Each recording has three files: ``NN_tracks.csv``,
``NN_tracksMeta.csv`` and ``NN_recordingMeta.csv``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
from numpy import int64

from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import number_in, short
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.encodings.table_columns import ColumnKind, NamedColumns, Texts, named_columns
from rulec.recordings.encodings.table_files import open_table
from rulec.recordings.lanes.lanes_along import lanelet_along
from rulec.recordings.mending.derived_motion import along
from rulec.recordings.recording import LONGEST_M, Lanelet, Recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.road_map import RoadMap
from rulec.recordings.tracks.even_times import EvenTimes, framed_times
from rulec.recordings.tracks.roads_of_tracks import roads_of, shifted_to_roads, track_recording
from rulec.recordings.tracks.track_rows import TrackRows

_BEYOND_M = 20.0
_EVERY_M = 20.0
_WIDEST_M = 20.0
_ROUNDED_KMH = 0.1


def highd_roads(about: NamedColumns, reach: tuple[float, float]) -> RoadMap:
    """The roads described by a table about a recording, over all x that vehicles reach.

    Lanes are numbered from the right, as in ``upper_1``. Raises RulecError for invalid marks.
    """
    limit = float(about.numbers["speedLimit"][0])
    kmh = limit * KMH_PER_MPS
    limit_mps = None if limit <= 0 else limit
    if limit_mps is not None and abs(kmh - round(kmh)) < _ROUNDED_KMH:
        limit_mps = round(kmh) / KMH_PER_MPS
    low, high = reach[0] - _BEYOND_M, reach[1] + _BEYOND_M
    if high - low > LONGEST_M:
        raise about.columns.refused(f"tracks reach from x = {low:g} to {high:g}")
    x = np.linspace(low, high, max(2, round((high - low) / _EVERY_M)))
    lanelets: dict[str, Lanelet] = {}
    for side, way in (("upper", -1), ("lower", 1)):
        marks = _marks(about, f"{side}LaneMarkings")
        # The rightmost mark is the one of the smallest y on the upper carriageway, else the largest
        marks = marks if way < 0 else marks[::-1]
        count = len(marks) - 1
        for number in range(1, count + 1):
            right, left = marks[number - 1], marks[number]
            y = np.full(len(x), -(left + right) / 2)
            name = f"{side}_{number}"
            lanelets[name] = lanelet_along(
                name,
                np.column_stack((x[::way], y)),
                abs(left - right),
                left_of=f"{side}_{number + 1}" if number < count else None,
                right_of=f"{side}_{number - 1}" if number > 1 else None,
                types=frozenset({"highway"}),
                limit_mps=limit_mps,
                left_mark="broken" if number < count else "solid",
                right_mark="broken" if number > 1 else "solid",
            )
    return RoadMap(form="highD marks", lanelets=lanelets, side="right", country="DEU")


def _marks(about: NamedColumns, name: str) -> list[float]:
    """The positions of a carriageway's marks by ascending y (m), as in the file."""
    text = about.texts[name].names[int(about.texts[name].codes[0])]
    try:
        marks = sorted(number_in(part) for part in text.split(";") if part.strip())
    except ValueError:
        marks = []
    gaps = np.diff(marks)
    if len(marks) < 2 or not ((gaps > 0) & (gaps < _WIDEST_M)).all():
        why = f"its `{name}` are `{short(text)}`"
        raise about.columns.wrong(0, why, "expected the y of two marks or more, such as `8.5;12.6`")
    return marks


LEVELX = FileFormat(
    "tracks of levelXdata",
    "give `NN_tracks.csv`, with `NN_tracksMeta.csv` and `NN_recordingMeta.csv` beside it",
    4_000_000_000,
)
_TRACKS = "tracks.csv"
_META, _ABOUT = "tracksMeta.csv", "recordingMeta.csv"
_COUNTRY = "DEU"
_SLOW_MPS = 5.0
"""Slower vehicles on a motorway are turned along it: their boxes have no heading."""


def _numbers(names: str, *, required: bool = True) -> tuple[ColumnKind, ...]:
    return tuple(
        ColumnKind(name, {name.casefold(): 1.0}, required=required) for name in names.split()
    )


def _texts(names: str) -> tuple[ColumnKind, ...]:
    return tuple(ColumnKind(name, {name.casefold(): 1.0}, True, True) for name in names.split())


_HIGHD = (
    *_texts("id"),
    *_numbers("frame x y width height xVelocity yVelocity xAcceleration yAcceleration"),
)
_HIGHD_META = (*_texts("id class"), *_numbers("drivingDirection"))
_HIGHD_ABOUT = (*_numbers("frameRate speedLimit"), *_texts("upperLaneMarkings lowerLaneMarkings"))
_OTHERS = (
    *_texts("trackId"),
    *_numbers("frame xCenter yCenter heading width length xVelocity yVelocity"),
    *_numbers("lonAcceleration", required=False),
)
_OTHERS_META = _texts("trackId class")
_OTHERS_ABOUT = (
    *_numbers("frameRate"),
    *_numbers("xUtmOrigin yUtmOrigin", required=False),
)


def read_highd(source: RecordingSource) -> Iterator[Recording]:
    """A recording of highD's, with its roads. Raises RulecError R0610, R0701."""
    path = source.path
    tracks, meta, about = _tables(path, (_HIGHD, _HIGHD_META, _HIGHD_ABOUT))
    numbers = tracks.numbers
    ids = tracks.texts["id"]
    place = _places_in(meta.texts["id"], ids, tracks)
    leftward = meta.numbers["drivingDirection"][place] == 1
    vx, vy = numbers["xVelocity"], -numbers["yVelocity"]
    along_road = np.where(leftward, pi, 0.0)
    heading = np.where(np.hypot(vx, vy) < _SLOW_MPS, along_road, np.arctan2(vy, vx))
    acceleration = np.column_stack((numbers["xAcceleration"], -numbers["yAcceleration"]))
    rows = TrackRows(
        columns=tracks.columns,
        track=ids,
        times=_times(tracks, about),
        x=numbers["x"] + numbers["width"] / 2,
        y=-(numbers["y"] + numbers["height"] / 2),
        heading=heading,
        speed=along(np.column_stack((vx, vy)), heading),
        acceleration=along(acceleration, heading),
        type=_classes(meta, place),
        length=numbers["width"],
        width=numbers["height"],
    )
    roads = highd_roads(about, (float(rows.x.min()), float(rows.x.max())))
    name = f"highD_{path.name.partition('_')[0]}"
    yield replace(track_recording(name, [rows], roads, form="highD tracks"), country=_COUNTRY)


def read_levelx(source: RecordingSource) -> Iterator[Recording]:
    """A recording of inD's, rounD's, exiD's or uniD's on its map.

    Raises RulecError R0610, R0614, R0615, R0701, else as reading the map.
    """
    path = source.path
    tracks, meta, about = _tables(path, (_OTHERS, _OTHERS_META, _OTHERS_ABOUT))
    numbers = tracks.numbers
    ids = tracks.texts["trackId"]
    place = _places_in(meta.texts["trackId"], ids, tracks)
    rows = TrackRows(
        columns=tracks.columns,
        track=ids,
        times=_times(tracks, about),
        x=numbers["xCenter"],
        y=numbers["yCenter"],
        heading=np.radians(numbers["heading"]),
        velocity=(numbers["xVelocity"], numbers["yVelocity"]),
        acceleration=numbers.get("lonAcceleration"),
        type=_classes(meta, place),
        length=numbers["length"],
        width=numbers["width"],
    )
    roads = roads_of(path, source.map_path, rows.times.step_s, ())
    x, y = (about.numbers.get(name, np.zeros(1))[0] for name in ("xUtmOrigin", "yUtmOrigin"))
    rows = shifted_to_roads(rows, roads, (float(x), float(y)))
    name = f"levelX_{path.name.partition('_')[0]}"
    recording = track_recording(name, [rows], roads, form="levelX tracks")
    yield replace(recording, country=_COUNTRY, side=roads.side or "right")


def _tables(
    path: Path, kinds: tuple[Sequence[ColumnKind], Sequence[ColumnKind], Sequence[ColumnKind]]
) -> tuple[NamedColumns, NamedColumns, NamedColumns]:
    """The tables of tracks, of what they are, and of the recording."""
    if not path.name.endswith(_TRACKS):
        raise LEVELX.refused(path, "it is about the tracks of a recording, and has none")
    stem = path.name.removesuffix(_TRACKS)
    files = [path, *(path.with_name(stem + end) for end in (_META, _ABOUT))]
    for file in files:
        if not file.is_file():
            raise LEVELX.refused(path, f"there is no `{short(file.name)}` beside it")
    tracks, meta, about = (
        named_columns(open_table(file, LEVELX), own) for file, own in zip(files, kinds, strict=True)
    )
    return tracks, meta, about


def _times(tracks: NamedColumns, about: NamedColumns) -> EvenTimes:
    rate = float(about.numbers["frameRate"][0])
    if not 1 <= rate <= 1000:
        why = f"its frame rate is {rate:g}"
        raise about.columns.wrong(0, why, "expected 1 to 1000 frames a second")
    return framed_times(tracks.numbers["frame"], rate, tracks.columns)


def _places_in(
    known: Texts, ids: Texts, tracks: NamedColumns
) -> np.ndarray[tuple[int], np.dtype[int64]]:
    """For each row of tracks the row of its id in the table about them."""
    rows = {known.names[code]: row for row, code in enumerate(known.codes.tolist())}
    places = np.array([rows.get(name, -1) for name in ids.names], dtype=int64)[ids.codes]
    if (places < 0).any():
        row = int(np.argmax(places < 0))
        name = short(ids.names[int(ids.codes[row])])
        raise tracks.columns.wrong(row, f"track `{name}` is not in the table about tracks")
    return places


def _classes(meta: NamedColumns, places: np.ndarray[tuple[int], np.dtype[int64]]) -> Texts:
    classes = meta.texts["class"]
    return Texts(classes.codes[places], classes.names)
