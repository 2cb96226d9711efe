"""Argoverse 2's map of a log as lanelets.

See the data set's own API (`argoverse/av2-api`, `av2.map`): lane segments with bounds in the
direction of travel and the paint of each, neighbours that may have the opposite direction, and
pedestrian crossings as two edges along which people walk. Both data sets have the same file.
"""

from __future__ import annotations

from codecs import BOM_UTF8
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

import msgspec
import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import LARGEST, short
from rulec.recordings.lanes.lanes_along import with_sound_links
from rulec.recordings.polylines import ends_apart, line_length, paired, without_repeats
from rulec.recordings.recording import LONGEST_M, Lanelet, LaneMark, Points
from rulec.recordings.road_map import RoadMap, crosswalk

T = TypeVar("T")


def read_json(path: Path, form: FileFormat, kind: type[T]) -> T:
    """The content of a file as a value of a type, which bounds its depth.

    Raises RulecError R0610 for a file that is too large for the format, broken, or of other
    content, with the place as a path of keys or a byte; R0701 if it cannot be opened.
    """
    data = form.content(path)
    try:
        return msgspec.json.decode(data.removeprefix(BOM_UTF8), type=kind)
    except (msgspec.DecodeError, UnicodeDecodeError, ValueError) as reason:
        words = "".join(x if x.isprintable() else "?" for x in str(reason)[:200])
        raise form.refused(path, words) from None
    except RecursionError:
        raise form.refused(path, "its parts are too deep in each other") from None


MAP_ARCHIVE = FileFormat(
    "a map of Argoverse 2",
    "it is `log_map_archive_*.json`, as the data set has it beside its tracks",
    50_000_000,
)

_CLOSEST_M = 0.001

LANE_TYPES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"VEHICLE": (), "BIKE": ("bicycleLane",), "BUS": ("busLane",)}
)


class _Point(msgspec.Struct, frozen=True):
    x: float
    y: float


_Line = list[_Point]


class _LaneSegment(msgspec.Struct, frozen=True):
    id: int
    is_intersection: bool
    lane_type: str
    left_lane_boundary: _Line
    right_lane_boundary: _Line
    left_lane_mark_type: str
    right_lane_mark_type: str
    successors: list[int]
    predecessors: list[int] = []
    left_neighbor_id: int | None = None
    right_neighbor_id: int | None = None


class _Crossing(msgspec.Struct, frozen=True):
    id: int
    edge1: _Line
    edge2: _Line


class _MapArchive(msgspec.Struct, frozen=True):
    lane_segments: dict[str, _LaneSegment]
    pedestrian_crossings: dict[str, _Crossing] = {}


def read_map_archive(path: Path) -> RoadMap:
    """Read a map.

    Raises RulecError R0610 if the file is not a map, R0701 if it cannot be opened.
    """
    archive = read_json(path, MAP_ARCHIVE, _MapArchive)
    if not archive.lane_segments:
        raise MAP_ARCHIVE.refused(path, "there is no lane segment in it")
    lanes, crossings = list(_lanes(path, archive)), list(_crosswalks(path, archive))
    names = [lanelet.id for lanelet in (*lanes, *crossings)]
    if twice := [name for name, count in Counter(names).items() if count > 1]:
        raise MAP_ARCHIVE.refused(path, f"`{short(twice[0])}` is in it twice")
    lanelets = with_sound_links(lanes) | {crossing.id: crossing for crossing in crossings}
    return RoadMap(form="Argoverse 2 map", lanelets=lanelets, side="right", country="USA")


def _lanes(path: Path, archive: _MapArchive) -> Iterator[Lanelet]:
    for segment in archive.lane_segments.values():
        called = f"lane segment {segment.id}"
        bounds = _bounds(path, called, (segment.left_lane_boundary, segment.right_lane_boundary))
        if segment.lane_type not in LANE_TYPES:
            why = f"{called} is of type `{short(segment.lane_type)}`"
            raise MAP_ARCHIVE.refused(path, why, expected=f"expected {', '.join(LANE_TYPES)}")
        # At the edge of a map section, objects may have been cut to a point
        if bounds is None:
            continue
        left, right = paired(*bounds)
        kinds = (*LANE_TYPES[segment.lane_type], *["intersection"] * segment.is_intersection)
        beside = segment.left_neighbor_id, segment.right_neighbor_id
        left_of, right_of = (None if lane is None else str(lane) for lane in beside)
        yield Lanelet(
            id=str(segment.id),
            left=left,
            right=right,
            centre=(left + right) / 2,
            successors=tuple(map(str, segment.successors)),
            predecessors=tuple(map(str, segment.predecessors)),
            left_of=left_of,
            right_of=right_of,
            types=frozenset(kinds),
            left_mark=MARKS.get(segment.left_lane_mark_type),
            right_mark=MARKS.get(segment.right_lane_mark_type),
        )


MARKS: Mapping[str, LaneMark] = MappingProxyType(
    {
        **dict.fromkeys(("SOLID_WHITE", "SOLID_YELLOW"), "solid"),
        **dict.fromkeys(("SOLID_DASH_WHITE", "SOLID_DASH_YELLOW"), "solid"),
        **dict.fromkeys(("DOUBLE_SOLID_WHITE", "DOUBLE_SOLID_YELLOW"), "double_solid"),
        **dict.fromkeys(("DASHED_WHITE", "DASHED_YELLOW"), "broken"),
        **dict.fromkeys(("DASH_SOLID_WHITE", "DASH_SOLID_YELLOW"), "broken"),
        **dict.fromkeys(("DOUBLE_DASH_WHITE", "DOUBLE_DASH_YELLOW"), "broken"),
        "NONE": "none",
    }
)
"""Paint types -> marks.

Of two different lines the first in the name is the one on the lane's own side (`av2.rendering.map`
draws them so). The data set does not define blue lines.
"""


def _crosswalks(path: Path, archive: _MapArchive) -> Iterator[Lanelet]:
    for crossing in archive.pedestrian_crossings.values():
        called = f"pedestrian crossing {crossing.id}"
        edges = _bounds(path, called, (crossing.edge1, crossing.edge2))
        if edges is None:
            continue
        edge, other = edges
        if ends_apart(edge, other[::-1]) < ends_apart(edge, other):
            other = other[::-1]
        edge, other = paired(edge, other)
        along = (edge[-1] - edge[0]) + (other[-1] - other[0])
        across = (other - edge).mean(axis=0)
        towards_left = float(along[0] * across[1] - along[1] * across[0]) > 0
        left, right = (other, edge) if towards_left else (edge, other)
        yield crosswalk(str(crossing.id), left, right)


def _bounds(path: Path, called: str, lines: tuple[_Line, _Line]) -> tuple[Points, Points] | None:
    """The two bounds; None if one of them has no length."""
    bounds = []
    for line in lines:
        points: NDArray[float64] = np.array([(point.x, point.y) for point in line]).reshape(-1, 2)
        if len(points) < 2:
            raise MAP_ARCHIVE.refused(path, f"a bound of {called} has fewer than two points")
        if not (np.abs(points) < LARGEST).all():
            raise MAP_ARCHIVE.refused(path, f"a place of {called} is not on earth")
        if line_length(points) > LONGEST_M:
            raise MAP_ARCHIVE.refused(path, f"{called} is longer than {LONGEST_M / 1000:g} km")
        bounds.append(without_repeats(points, _CLOSEST_M))
    left, right = bounds
    return (left, right) if min(map(len, bounds)) > 1 else None
