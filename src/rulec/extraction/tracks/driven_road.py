"""The road that ego drives along: Frenet coordinates, lanes, crossings, junctions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from itertools import groupby
from math import radians

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.tracks import Floats
from rulec.scenario.recorded.lane_coordinates import (
    Lanes,
    borders_along,
    crossings_along,
    lanes_along,
)
from rulec.scenario.recorded.recording import Lanelet, Recording
from rulec.scenario.recorded.reference_line import ReferenceLine, pieces_at, reference_line
from rulec.scenario.recorded.route import directions_beside, extended_route, is_lane, lanes_beside

_CROSSING_ANGLE = radians(30.0)
"""Ways that meet at a smaller angle run into each other, as where lanes join or part."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class DrivenRoad:
    """The road of a drive, with ego's own lanelets end to end.

    Lanelet ``i`` lies from ``borders[i]`` to ``borders[i + 1]``; ``rows[i]`` are those beside each
    other there, a lane each, from the right, None where the map has none. ``crossings`` are
    pedestrian crossings and ``junctions`` junctions, from where to where along the road.
    """

    rows: tuple[tuple[Lanelet | None, ...], ...]
    own_lane: int
    borders: Floats
    line: ReferenceLine
    lanes: Lanes
    crossings: tuple[tuple[float, float], ...]
    junctions: tuple[tuple[float, float], ...]

    def lanelet(self, piece: int, lane: int) -> Lanelet:
        """The lanelet of a lane; where the map has none, ego's own."""
        row = self.rows[piece]
        own = row[self.own_lane]
        assert own is not None
        return row[lane] or own

    def piece(self, s: Floats) -> NDArray[intp]:
        """The numbers of the lanelets at places."""
        return pieces_at(self.borders, s)

    def lane_of(self, d: Floats) -> NDArray[intp]:
        """The lanes at straightened offsets, the nearest beside the road."""
        return pieces_at(self.lanes.straight, d)


def driven_road(recording: Recording, way: Sequence[str], junctions: Set[str]) -> DrivenRoad:
    """The road of a chain of lanelets, extended straight at both ends.

    ``junctions`` are the lanelets that lie in one. Raises ValueError: its lanes cannot be laid out
    along a line.
    """
    whole = extended_route(recording, way)
    lanelets = tuple(recording.lanelets[number] for number in whole)
    line = reference_line(np.concatenate([part.centre for part in lanelets]))
    borders = borders_along(lanelets, line)
    first = whole.index(way[0])
    middle = float(borders[first] + borders[first + len(way)]) / 2
    lanes = lanes_along(recording, whole, line, middle)
    ((_, own_d),) = lanes.straightened(np.array([[middle, 0.0]])).tolist()
    own = int(np.clip(np.searchsorted(lanes.straight, own_d) - 1, 0, len(lanes.straight) - 2))
    return DrivenRoad(
        rows=tuple(_row(recording, number, own, len(lanes.straight) - 1) for number in whole),
        own_lane=own,
        borders=borders,
        line=line,
        lanes=lanes,
        crossings=tuple(crossings_along(recording, line, lanes, 0.0, line.length)),
        junctions=tuple(_runs(borders, [number in junctions for number in whole])),
    )


def _row(recording: Recording, number: str, own: int, count: int) -> tuple[Lanelet | None, ...]:
    right = lanes_beside(recording, number, left=False)
    left = lanes_beside(recording, number, left=True)
    row = dict(enumerate((number, *left), own)) | dict(zip(range(own - 1, -1, -1), right))  # noqa: B905
    return tuple(recording.lanelets[row[k]] if k in row else None for k in range(count))


def _runs(borders: Floats, flags: Sequence[bool]) -> Iterator[tuple[float, float]]:
    """The extents along the road of consecutive pieces that have a flag."""
    for flag, pieces in groupby(range(len(flags)), key=lambda piece: flags[piece]):
        if flag:
            run = list(pieces)
            yield float(borders[run[0]]), float(borders[run[-1] + 1])


def junction_lanelets(recording: Recording) -> frozenset[str]:
    """The ids of the lanelets in junctions, by the map or by crossing ways.

    Where a map marks any, only those count: whoever drew it has thought of junctions.
    """
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    marked = {lanelet.id for lanelet in lanes if "intersection" in lanelet.types}
    if marked or not lanes:
        return frozenset(marked)
    lines = [shapely.LineString(lanelet.centre) for lanelet in lanes]
    firsts, seconds = shapely.STRtree(lines).query(lines, predicate="crosses")
    crossing: set[str] = set()
    for first, second in zip(firsts.tolist(), seconds.tolist(), strict=True):
        meeting = shapely.intersection(lines[first], lines[second])
        if first < second and _angle(lanes[first], lanes[second], meeting) > _CROSSING_ANGLE:
            crossing.update((lanes[first].id, lanes[second].id))
    return frozenset(crossing)


def _angle(first: Lanelet, second: Lanelet, meeting: shapely.Geometry) -> float:
    """The angle (rad) between two lanelets where they meet, at most a right angle."""
    place = np.array([shapely.point_on_surface(meeting)])
    turn = directions_beside(first, place)[0] - directions_beside(second, place)[0]
    return float(abs(np.arctan(np.tan(turn))))
