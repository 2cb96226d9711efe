"""Maps of 123D as lanelets.

According to the map writer and the map layers of py123d 0.7, there is a row for each object, with
its layer, its id within that, its outline or line as well-known binary, and further attributes as
MessagePack, in which arrays are maps of type, shape and bytes. Bounds have the direction of travel.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.commonroad.countries import side_in
from rulec.recordings.d123 import log_files as files
from rulec.recordings.d123.log_files import OddPackError, unpacked
from rulec.recordings.d123.stop_zones import SIGNS, StopZone, with_signs
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable, Wanted, read_table
from rulec.recordings.encodings.arrow.nested_columns import Nested
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.lanes.lanes_along import with_sound_links
from rulec.recordings.polylines import line_length, paired, without_repeats
from rulec.recordings.recording import LONGEST_M, Lanelet, LaneMark, ObservedLight, Points
from rulec.recordings.road_map import RoadMap, crosswalk_with_outline

MAP = FileFormat(
    "a map of 123D", "it is `map.arrow`, or `DATASET_PLACE.arrow`, as py123d writes them"
)
_LANE, _LANE_GROUP, _CROSSWALK, _STOP_ZONE, _ROAD_LINE = 0, 1, 3, 7, 9
_LAYERS = frozenset({_LANE, _LANE_GROUP, _CROSSWALK, _STOP_ZONE, _ROAD_LINE})
_CLOSEST_M = 0.001
_ALONG_M = 0.2
"""A line of the map marks a bound if all of the bound is at most this far (m) from it."""

_TYPES: Mapping[int, tuple[str, ...]] = {
    0: (),
    1: ("highway",),
    2: (),
    3: ("bicycleLane",),
    4: ("busLane",),
}
"""Types of lanes by number; in most data sets undefined ones are streets."""

_MARKS: Mapping[int, LaneMark] = {
    0: "none",
    **dict.fromkeys((4, 5, 8, 9), "broken"),
    **dict.fromkeys((6, 7), "double_solid"),
    **dict.fromkeys((10, 11), "solid"),
}
"""Marks by line type. For two different lines side by side, their sides are unknown."""


@dataclass(frozen=True, slots=True)
class _Entry:
    """A row: its number, its id, its ``features`` and its geometry as bytes."""

    row: int
    id: int
    features: Mapping[Any, Any]
    shape: bytes


@dataclass(frozen=True, slots=True)
class _Layers:
    table: ArrowTable
    by_number: Mapping[int, list[_Entry]]

    def of(self, layer: int) -> list[_Entry]:
        return self.by_number.get(layer, [])

    def wrong(self, entry: _Entry, why: str) -> RulecError:
        return self.table.refused(entry.row, why)


def read_d123_map(path: Path) -> RoadMap:
    """Read a map. Raises RulecError R0610 if it is not one, R0701 if it cannot be opened, R0706."""
    layers = _layers(path)
    about = files.said_in(layers.table)
    data_set = files.word(about, "dataset")
    country = files.country_of(data_set, files.word(about, "location"))
    lanelets = with_sound_links(_lanes(layers))
    if not lanelets:
        raise MAP.refused(path, "there is no lane in it")
    is_waymo = data_set.startswith(files.WAYMO)
    signed, left_out = with_signs(lanelets, _stop_zones(layers), all_behind=is_waymo)
    signed |= {x.id: x for x in _crosswalks(layers)}
    why = f"stop zones whose lanes do not begin or end there are left out: {left_out:,}"
    return RoadMap(
        form="123D map",
        lanelets=signed,
        side=side_in(country),
        country=country,
        complete=frozenset({"STOP"} if is_waymo and not left_out else ()),
        remarks=(why,) * bool(left_out),
    )


def with_lights(
    lanelets: Mapping[str, Lanelet], lights: Mapping[str, Mapping[int, str]]
) -> Mapping[str, Lanelet]:
    """The lanelets with the observed lights, one for the way to each lane that has a light."""
    seen = {name: ObservedLight(colours) for name, colours in lights.items() if name in lanelets}
    lit = dict(lanelets)
    for name, lanelet in lanelets.items():
        if ways := {other: seen[other] for other in lanelet.successors if other in seen}:
            lit[name] = replace(lanelet, lights=tuple(ways.values()), lights_to=ways)
    return lit


def _layers(path: Path) -> _Layers:
    wanted = Wanted(
        whole=("object_id", "map_layer"),
        nested=tuple([Nested(name=name, kind="bytes") for name in ("features", "wkb")]),
    )
    table = read_table(path, MAP, wanted)
    by_layer: dict[int, list[_Entry]] = defaultdict(list)
    ids, layers = (table.whole[name].tolist() for name in ("object_id", "map_layer"))
    packed, shapes = (table.nested[name].values for name in ("features", "wkb"))
    for row, (key, layer) in enumerate(zip(ids, layers, strict=True)):
        if layer not in _LAYERS:
            continue
        try:
            features = unpacked(packed[row])
        except OddPackError:
            raise table.refused(row, "its `features` are damaged") from None
        if not isinstance(features, dict):
            raise table.refused(row, "its `features` are no table of names and values")
        by_layer[layer].append(_Entry(row, key, features, shapes[row]))
    return _Layers(table, by_layer)


def _lanes(layers: _Layers) -> Iterator[Lanelet]:
    entries = {}
    for entry in layers.of(_LANE):
        if entry.id in entries:
            raise layers.wrong(entry, f"there are two lanes {entry.id}")
        entries[entry.id] = entry
    inside = {
        group.id
        for group in layers.of(_LANE_GROUP)
        if group.features.get("intersection_id") is not None
    }
    paint = _Paint(layers)
    for name, entry in entries.items():
        bounds = [_line(layers, entry, f"{side}_boundary") for side in ("left", "right")]
        kind = entry.features.get("lane_type")
        if not isinstance(kind, int) or kind not in _TYPES:
            raise layers.wrong(entry, f"a lane is of the type {kind!s:.40}")
        # At the edge of a map section a lane may be cut to a point
        if min(map(len, bounds)) < 2:
            continue
        left, right = paired(bounds[0], bounds[1])
        crossing = ("intersection",) * (entry.features.get("lane_group_id") in inside)
        yield Lanelet(
            id=str(name),
            left=left,
            right=right,
            centre=(left + right) / 2,
            successors=_ids(layers, entry, "successor_ids"),
            predecessors=_ids(layers, entry, "predecessor_ids"),
            left_of=_id(entry, "left_lane_id"),
            right_of=_id(entry, "right_lane_id"),
            types=frozenset((*_TYPES[kind], *crossing)),
            limit_mps=_limit(layers, entry),
            left_mark=paint.along(bounds[0]),
            right_mark=paint.along(bounds[1]),
        )


def _ids(layers: _Layers, entry: _Entry, name: str) -> tuple[str, ...]:
    ids = entry.features.get(name)
    ids = [] if ids is None else ids
    if not isinstance(ids, list) or not all(isinstance(x, int) for x in ids):
        raise layers.wrong(entry, f"`{name}` is no list of ids")
    return tuple(dict.fromkeys(map(str, ids)))


def _id(entry: _Entry, name: str) -> str | None:
    number = entry.features.get(name)
    return str(number) if isinstance(number, int) else None


def _limit(layers: _Layers, lane: _Entry) -> float | None:
    limit = lane.features.get("speed_limit_mps")
    if limit is None:
        return None
    if not isinstance(limit, int | float) or not 0 < limit < LARGEST:
        raise layers.wrong(lane, "`speed_limit_mps` is no speed")
    return float(limit)


def _line(layers: _Layers, entry: _Entry, name: str) -> Points:
    """A line among an object's attributes, without heights."""
    points = _array(entry.features.get(name))
    if points is None or not len(points):
        raise layers.wrong(entry, f"`{name}` is no array of places")
    if not (np.abs(points[:, :2]) < LARGEST).all():
        raise layers.wrong(entry, f"a place of `{name}` is not on earth")
    flat = points[:, :2].astype(float)
    if line_length(flat) > LONGEST_M:
        raise layers.wrong(entry, f"`{name}` is longer than {LONGEST_M / 1000:g} km")
    return without_repeats(flat, _CLOSEST_M)


def _array(packed: object) -> NDArray[float64] | None:
    """The points of an array stored as NumPy bytes; None if it is not such an array."""
    if not isinstance(packed, dict):
        return None
    kind, shape, data = (packed.get(key) for key in (b"dtype", b"shape", b"data"))
    if kind not in ("<f8", "<f4") or not isinstance(shape, list) or not isinstance(data, bytes):
        return None
    if len(shape) != 2 or shape[1] not in (2, 3) or not isinstance(shape[0], int):
        return None
    size = 8 if kind == "<f8" else 4
    if shape[0] < 0 or shape[0] * shape[1] * size != len(data):
        return None
    return np.frombuffer(data, dtype=kind).reshape(shape[0], shape[1]).astype(float64)


class _Paint:
    """The painted lines of a map."""

    def __init__(self, layers: _Layers) -> None:
        entries = layers.of(_ROAD_LINE)
        self._lines = [_shape(layers, entry) for entry in entries]
        self._marks = [_mark(entry) for entry in entries]
        self._tree = shapely.STRtree(self._lines)

    def along(self, bound: Points) -> LaneMark | None:
        """The mark of the lines along a whole bound; None without lines, or if they differ.

        The map does not contain which of the two adjacent lanes a line belongs to.
        """
        line, places = shapely.LineString(bound), shapely.points(bound)
        # GEOS would divide by the tiny length of such lines
        with np.errstate(all="ignore"):
            near = self._tree.query(line, predicate="dwithin", distance=_ALONG_M).tolist()
            away = [shapely.distance(self._lines[k], places).max() for k in near]
        marks = {self._marks[k] for k, most in zip(near, away, strict=True) if most <= _ALONG_M}
        return marks.pop() if len(marks) == 1 else None


def _mark(line: _Entry) -> LaneMark | None:
    """A line's mark; None for an unknown type."""
    kind = line.features.get("road_line_type")
    return _MARKS.get(kind) if isinstance(kind, int) else None


def _shape(layers: _Layers, line: _Entry) -> shapely.LineString:
    """A line of the map without heights."""
    try:
        # Coordinates that are not numbers get an error instead of a warning
        with np.errstate(all="ignore"):
            shape = shapely.force_2d(shapely.from_wkb(line.shape))
    except shapely.errors.ShapelyError:
        raise layers.wrong(line, "its `wkb` is damaged") from None
    places = shapely.get_coordinates(shape)
    if not isinstance(shape, shapely.LineString) or not (np.abs(places) < LARGEST).all():
        raise layers.wrong(line, "its `wkb` is no line on earth")
    return shape


def _stop_zones(layers: _Layers) -> Iterator[StopZone]:
    """The zones that stand for signs."""
    for entry in layers.of(_STOP_ZONE):
        kind = entry.features.get("stop_zone_type")
        if isinstance(kind, int) and kind in SIGNS:
            lanes = _ids(layers, entry, "lane_ids")
            yield StopZone(SIGNS[kind], _line(layers, entry, "outline"), lanes)


def _crosswalks(layers: _Layers) -> Iterator[Lanelet]:
    for entry in layers.of(_CROSSWALK):
        outline = _line(layers, entry, "outline")
        if len(outline) > 3:
            yield crosswalk_with_outline(f"crosswalk {entry.id}", outline)
