"""The road that ego drives along: Frenet coordinates, lanes, crossings, junctions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any, TypeAlias

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.tracks.matching.driven_route import pieces_of
from rulec.recordings.recording import LIMIT_SIGN, Lanelet, Points, Recording
from rulec.scenario.recorded.junction_lanelets import marks_junctions
from rulec.scenario.recorded.lane_coordinates import (
    Lanes,
    borders_along,
    crossings_along,
    lanes_along,
)
from rulec.scenario.recorded.reference_line import (
    ReferenceLine,
    pieces_at,
    reference_line,
    smoothed,
    turn,
)
from rulec.scenario.recorded.route import (
    lanes_beside,
    roads_beyond,
)

_BESIDE_M = 20.0
_AWAY_M = 30.0
"""A road meets itself if it is within ``_BESIDE_M`` of a piece over ``_AWAY_M`` away along it."""

Stretches: TypeAlias = Sequence[tuple[float, float]]
"""Intervals of a road (m)."""

_FEWEST_CORNERS = 20

_HAIR_M = 0.01

TURN_REACH_M = 10.0
"""Where a map marks no junctions, ways begin to turn this far (m) before crossing lanelets.

The crossing lanelets, which define junctions there, are often only the middle of a turn.
"""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class DrivenRoad:
    """The road of a drive, with ego's own lanelets end to end.

    Piece ``i`` extends from ``borders[i]`` to ``borders[i + 1]``. ``rows[i]`` are the lanelets
    beside each other there, one per lane from the right, None where the map has none;
    ``own_lanes[i]`` is the lane along which the road leads. ``crossings`` (pedestrian crossings)
    and ``junctions`` are intervals along the road. ``junctions_marked``: whether the map marks
    junctions. ``meets_itself``: whether a place may be beside several pieces, as on a ring.
    ``computed`` holds the results of functions wrapped in ``once_a_road``.
    """

    rows: tuple[tuple[Lanelet | None, ...], ...]
    own_lanes: tuple[int, ...]
    borders: Floats
    line: ReferenceLine
    lanes: Lanes
    crossings: tuple[tuple[float, float], ...]
    junctions: tuple[tuple[float, float], ...]
    junctions_marked: bool
    meets_itself: bool = False
    computed: dict[object, Any] = field(default_factory=dict)

    def lanelet(self, piece: int, lane: int) -> Lanelet:
        """The lanelet of a lane; ego's own lanelet where the map has none."""
        row = self.rows[piece]
        own = row[self.own_lanes[piece]]
        assert own is not None
        return row[lane] or own

    def ids_between(self, low: float, high: float) -> frozenset[str]:
        """The ids of the lanelets that begin between two places, or just before the first."""
        starts = self.borders[:-1].tolist()
        rows = [
            row for row, start in zip(self.rows, starts, strict=True) if low - 0.1 <= start < high
        ]
        return frozenset(lanelet.id for row in rows for lanelet in row if lanelet is not None)

    def limit_mps(self, piece: int, lane: int, most_turned: float) -> float | None:
        """The speed limit of a lane; None if the map has none there.

        In a junction without a limit, the one before it if the same holds behind it and the road
        turns by at most ``most_turned`` (rad): a sign stays valid for traffic going straight on.
        """
        own = self.lanelet(piece, lane).limit_mps
        middle = (self.borders[piece] + self.borders[piece + 1]) / 2
        for start, end in self.junctions:
            if own is None and start < middle < end:
                ends = np.array([start - _HAIR_M, end + _HAIR_M])
                before, after = (self.lanelet(k, lane).limit_mps for k in self.piece(ends).tolist())
                turned = abs(turn(*self.line.headings_at(ends).tolist()))
                return before if before == after and turned <= most_turned else None
        return own

    def limit_is_untold(self, piece: int, lane: int) -> bool:
        """Whether a sign may limit the speed there, and the map does not tell how.

        In a junction without a limit, a sign before or behind it may as well.
        """
        own = self.lanelet(piece, lane)
        middle = (self.borders[piece] + self.borders[piece + 1]) / 2
        places = [own]
        for start, end in self.junctions:
            if own.limit_mps is None and start < middle < end:
                ends = np.array([start - _HAIR_M, end + _HAIR_M])
                places += [self.lanelet(k, lane) for k in self.piece(ends).tolist()]
        return any(LIMIT_SIGN in lanelet.untold_signs for lanelet in places)

    def turned(self, start: float, end: float, aside_m: float = _HAIR_M) -> float:
        """The angle (rad) by which the road turns to the left between two places.

        Compares the directions ``aside_m`` outside the two places, or up to ``TURN_REACH_M``
        outside them where the map marks no junctions.
        """
        low, high = start - aside_m, end + aside_m
        if not self.junctions_marked:
            before, after = self.piece(np.array([low, high])).tolist()
            low = min(low, max(start - TURN_REACH_M, float(self.borders[before])))
            high = max(high, min(end + TURN_REACH_M, float(self.borders[after + 1])))
        return float(turn(*self.line.headings_at(np.array([low, high])).tolist()))

    def piece(self, s: Floats) -> NDArray[intp]:
        """The numbers of the pieces at places along the road."""
        return pieces_at(self.borders, s)


@dataclass(frozen=True, eq=False, slots=True)
class _Layout:
    """A road whose ``own_lanes`` are not known yet.

    ``pieces`` are the lanelets of each piece; ``numbers`` are how many lanes left of the first
    piece's lane each piece begins.
    """

    pieces: tuple[tuple[str, ...], ...]
    numbers: tuple[int, ...]
    borders: Floats
    line: ReferenceLine
    lanes: Lanes


class DrivenRoads(KeepsResults):
    """The roads of a recording's drives; roads along the same lanelets are laid out once.

    ``junctions`` are the ids of the lanelets that lie in a junction.
    """

    def __init__(self, recording: Recording, junctions: Set[str]) -> None:
        self._recording = recording
        self._junctions = junctions
        self._marks_junctions = marks_junctions(recording)

    def along(self, way: Sequence[str]) -> tuple[DrivenRoad, int]:
        """The road of a chain of lanelets and the number of the chain's first piece in it.

        Extended straight at both ends. Raises ValueError if its lanes cannot be laid out.
        """
        behind, ahead = roads_beyond(self._recording, way)
        driven = pieces_of(self._recording, way, self._beside)
        pieces = (*((number,) for number in behind), *driven, *((number,) for number in ahead))
        layout, first = self._layout(pieces), len(behind)
        # Lanes are identified in the middle of the driven pieces
        return self._road(layout, _own_lanes(layout, first, first + len(driven))), first

    @kept
    def _layout(self, pieces: tuple[tuple[str, ...], ...]) -> _Layout:
        recording, entries = self._recording, [piece[0] for piece in pieces]
        lanelets = [recording.lanelets[number] for number in entries]
        middles = [_middle(recording, piece) for piece in pieces]
        line = reference_line(smoothed(np.concatenate(middles)))
        borders = borders_along(lanelets, line)
        numbers = tuple(_lane_numbers(recording, pieces))
        middle_s = float(borders[0] + borders[-1]) / 2
        lanes = lanes_along(recording, entries, line, middle_s, numbers, borders=borders)
        return _Layout(pieces, numbers, borders, line, lanes)

    def _beside(self, start: str, end: str) -> bool:
        return any(end in lanes_beside(self._recording, start, left=left) for left in (True, False))

    @kept
    def _road(self, layout: _Layout, own_lanes: tuple[int, ...]) -> DrivenRoad:
        recording, borders = self._recording, layout.borders
        entries = [piece[0] for piece in layout.pieces]
        count = layout.lanes.there.shape[1]
        meets_itself = _meets_itself([recording.lanelets[number] for number in entries], borders)
        return DrivenRoad(
            rows=tuple(
                _row(recording, number, lane, count)
                for number, lane in zip(entries, own_lanes, strict=True)
            ),
            own_lanes=own_lanes,
            borders=borders,
            line=layout.line,
            lanes=layout.lanes,
            crossings=tuple(
                crossings_along(
                    recording,
                    layout.line,
                    layout.lanes,
                    0.0,
                    layout.line.length,
                    meets_itself=meets_itself,
                )
            ),
            junctions=tuple(runs_along(borders, [number in self._junctions for number in entries])),
            junctions_marked=self._marks_junctions,
            meets_itself=meets_itself,
        )


def _own_lanes(layout: _Layout, first: int, end: int) -> tuple[int, ...]:
    """The road's lane in each piece, found at the middle of pieces ``first`` to ``end``."""
    borders = layout.borders
    middle = float(borders[first] + borders[end]) / 2
    probed = _straight_piece(layout.pieces, int(pieces_at(borders, np.array(middle))))
    place = middle if borders[probed] <= middle <= borders[probed + 1] else borders[probed]
    left_of = layout.lanes.from_bounds(np.array([[place, 0.0]]))
    own = int((left_of > 0).sum()) - 1 - layout.numbers[probed]
    last = layout.lanes.there.shape[1] - 1
    return tuple(int(np.clip(own + number, 0, last)) for number in layout.numbers)


def _middle(recording: Recording, piece: Sequence[str]) -> Points:
    """The middle line of a piece; where it changes lanes, it leads across evenly."""
    first, last = (recording.lanelets[number].centre for number in (piece[0], piece[-1]))
    if len(piece) == 1:
        return first
    part = np.linspace(0.0, 1.0, max(len(first), len(last), _FEWEST_CORNERS))[:, None]
    starts, ends = (
        shapely.get_coordinates(
            shapely.line_interpolate_point(shapely.LineString(centre), part[:, 0], normalized=True)
        )
        for centre in (first, last)
    )
    middle: Points = starts * (1 - part) + ends * part
    return middle


def _lane_numbers(recording: Recording, pieces: Sequence[Sequence[str]]) -> list[int]:
    """The lane in which the road enters each piece: 0 in the first piece, ascending to the left."""
    numbers = [0]
    for piece in pieces:
        left = lanes_beside(recording, piece[0], left=True)
        right = lanes_beside(recording, piece[0], left=False)
        shift = 0
        if len(piece) > 1:
            shift = left.index(piece[-1]) + 1 if piece[-1] in left else -right.index(piece[-1]) - 1
        numbers.append(numbers[-1] + shift)
    return numbers[:-1]


def _straight_piece(pieces: Sequence[Sequence[str]], wanted: int) -> int:
    """The piece nearest to a wanted one in which the road does not change lanes."""
    straight = [k for k, piece in enumerate(pieces) if len(piece) == 1]
    return min(straight, key=lambda k: abs(k - wanted), default=0)


def _meets_itself(lanelets: Sequence[Lanelet], borders: Floats) -> bool:
    """Whether the road comes beside itself after having been away."""
    lines = [shapely.LineString(lanelet.centre) for lanelet in lanelets]
    pairs = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=_BESIDE_M)
    first, second = np.sort(pairs, axis=0)
    between = borders[second] - borders[np.minimum(first + 1, len(borders) - 1)]
    return bool((between > _AWAY_M).any())


def _row(recording: Recording, number: str, own: int, count: int) -> tuple[Lanelet | None, ...]:
    right = lanes_beside(recording, number, left=False)
    left = lanes_beside(recording, number, left=True)
    row = dict(enumerate((number, *left), own)) | dict(zip(range(own - 1, -1, -1), right))  # noqa: B905
    return tuple(recording.lanelets[row[k]] if k in row else None for k in range(count))


def reach_into(stretches: Stretches, low: Floats, high: Floats, before_m: float = 0.0) -> Flags:
    """Mask of bodies from ``low`` to ``high`` in a stretch of a road, or ``before_m`` before it."""
    found = np.zeros(low.shape, dtype=bool)
    for start, end in stretches:
        found |= (high >= start - before_m) & (low < end)
    return found


def next_along(stretches: Stretches, low: Floats) -> tuple[Floats, Floats]:
    """Where the first stretch of a road that does not end before ``low`` begins and ends.

    Infinity where there is none.
    """
    begin, end = np.full((2, *low.shape), np.inf)
    for start, stop in sorted(stretches, reverse=True):
        before = low < stop
        begin, end = np.where(before, start, begin), np.where(before, stop, end)
    return begin, end


def runs_along(borders: Floats, flags: Sequence[bool]) -> Iterator[tuple[float, float]]:
    """The extents along the road of runs of consecutive pieces that are flagged."""
    for flag, pieces in groupby(range(len(flags)), key=lambda piece: flags[piece]):
        if flag:
            run = list(pieces)
            yield float(borders[run[0]]), float(borders[run[-1] + 1])
