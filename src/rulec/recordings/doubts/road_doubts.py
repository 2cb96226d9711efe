"""Tracks and roads that do not belong together: another place, another frame, other axes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.diagnostics import SourceLocation
from rulec.recordings.doubts.long_ways import LongWays
from rulec.recordings.encodings.file_values import short
from rulec.recordings.polylines import arc_lengths, places_in
from rulec.recordings.recording import Lanelet, Participant, Points, Recording, is_lane
from rulec.recordings.recording_messages import OTHER_NET
from rulec.recordings.track import TrackStates

NEAR_M = 50.0
"""The largest plausible distance of participants from the roads."""

_MOST_PLACES = 40
"""The most positions evaluated for each body, at even distances along its track."""

_FEW, _HALF, _MOST = 1 / 3, 0.5, 0.8
"""Shares of positions that are on lanes, or along them, from which on maps are doubted.

On the maps of published recordings at least 0.61 of the positions of moving bodies are on lanes,
and as many along them; with other axes at most 0.43, on maps of other places a third or less.
"""

_ASTRAY = np.pi / 3
"""The largest angle to its lane of a vehicle that turns off or changes lanes."""

_FEWEST_BODIES = 3

_APART_M = 1.0
"""The largest gap between a lane and its successor.

On the maps of published recordings it is 0.6 m.
"""


def check_near(recording: Recording, path: Path | None) -> None:
    """Raise RulecError R0615 if all tracks are far from the roads of their map."""
    where = None if path is None else SourceLocation(str(path))
    if not recording.lanelets:
        raise OTHER_NET.error(where, "the map has no lanes", help="give another map with --map")
    places = [
        some for participant in recording.participants if len(some := _some_places(participant))
    ]
    lines = [shapely.LineString(lanelet.centre) for lanelet in recording.lanelets.values()]
    tree = shapely.STRtree(lines)
    for own in places:
        near = tree.query(shapely.points(own), predicate="dwithin", distance=NEAR_M)
        if near.size:
            return
    if not places:
        return
    low, high = box_of(places)
    least, most = box_of([lanelet.centre for lanelet in recording.lanelets.values()])
    raise OTHER_NET.error(
        where,
        f"nobody is near the roads: tracks are at x {low[0]:.1f} to {high[0]:.1f}, "
        f"y {low[1]:.1f} to {high[1]:.1f}, the map at x {least[0]:.1f} to {most[0]:.1f}, "
        f"y {least[1]:.1f} to {most[1]:.1f}",
        help="tracks and map are in one frame, in metres: move the tracks, or give their map",
    )


def road_doubts(lanelets: Mapping[str, Lanelet], tracks: Sequence[LongWays]) -> Iterator[str]:
    """Remarks on roads; ``tracks`` are those of moving vehicles."""
    lanes = [lanelet for lanelet in lanelets.values() if is_lane(lanelet)]
    if not lanes or not tracks:
        return
    yield from _gaps(lanes)
    roads = _Roads(lanes)
    moves = [_moves(moved) for moved in tracks]
    on, along = roads.shares(moves)
    if along < _HALF and len(tracks) >= _FEWEST_BODIES:
        for fault, change in _AXES.items():
            better = roads.shares([change(move) for move in moves])[1]
            if better > _MOST:
                yield (
                    f"{fault}: then {better:.0%} of the places of vehicles that move would be on "
                    f"lanes that lead their way, and {along:.0%} are as they are"
                )
                return
        backwards = roads.shares([_turned(move) for move in moves])[1]
        if backwards > _MOST:
            yield (
                f"{backwards:.0%} of the places of vehicles that move are on lanes that lead "
                "against their way: lanes seem to be drawn backwards; each goes from its start to "
                "its end, its left border at its left"
            )
            return
    if on < _FEW:
        yield (
            f"only {on:.0%} of the places of vehicles that move are on lanes: the map may be that "
            "of another place, or in another frame"
        )
    elif along < _FEW and len(tracks) >= _FEWEST_BODIES:
        yield (
            f"only {along:.0%} of the places of vehicles that move are on lanes that lead their "
            "way: the map may be that of another place, or y point down"
        )


def _gaps(lanes: Sequence[Lanelet]) -> Iterator[str]:
    """Remarks on lanes that end elsewhere than their successors begin."""
    known = {lanelet.id: lanelet for lanelet in lanes}
    pairs = [
        (lanelet, known[name]) for lanelet in lanes for name in lanelet.successors if name in known
    ]
    if not pairs:
        return
    ends, begins = (
        shapely.linestrings([(lane.left[at], lane.right[at]) for lane in own])
        for at, own in zip((-1, 0), zip(*pairs, strict=True), strict=True)
    )
    gaps = shapely.distance(ends, begins)
    count, widest = int((gaps > _APART_M).sum()), int(gaps.argmax())
    if count:
        before, behind = (f"`{short(lanelet.id)}`" for lanelet in pairs[widest])
        yield (
            f"at {count:,} of {len(pairs):,} places where a lane leads to the next, that one "
            f"begins more than {_APART_M:g} m from its end, {behind} {gaps[widest]:.1f} m from "
            f"that of {before}: what is said of lanes may be wrong near there"
        )


Moves = NDArray[float64]
"""Positions with the displacement from there: x, y, dx, dy."""


def _exchanged(moves: Moves) -> Moves:
    there: Moves = moves[:, [1, 0, 3, 2]]
    return there


def _downward(moves: Moves) -> Moves:
    there: Moves = moves * np.array([1.0, -1.0, 1.0, -1.0])
    return there


def _turned(moves: Moves) -> Moves:
    there: Moves = moves * np.array([1.0, 1.0, -1.0, -1.0])
    return there


_AXES = {
    "x and y seem to be exchanged": _exchanged,
    "y seems to point down, and wants another sign": _downward,
}


class _Roads:
    """The lanes of a map, with queries for who is on them."""

    def __init__(self, lanes: Sequence[Lanelet]) -> None:
        outlines = [np.vstack((lanelet.left, lanelet.right[::-1])) for lanelet in lanes]
        self._areas = [shapely.Polygon(line).buffer(0) for line in outlines]
        self._middles = [lanelet.centre for lanelet in lanes]

    def shares(self, bodies: Sequence[Moves]) -> tuple[float, float]:
        """The mean shares of each body's positions on a lane, and on a lane along it."""
        moves = np.concatenate(bodies)
        rows, lanes = places_in(self._areas, *moves[:, :2].T)
        on, along = np.zeros((2, len(moves)), dtype=bool)
        on[rows] = True
        for lane in np.unique(lanes).tolist():
            there = rows[lanes == lane]
            along[there] |= _leads(self._middles[lane], moves[there])
        begins = np.cumsum([0, *map(len, bodies[:-1])])
        sizes = np.array([*map(len, bodies)])
        on_share, along_share = (
            float((np.add.reduceat(flags, begins, dtype=np.intp) / sizes).mean())
            for flags in (on, along)
        )
        return on_share, along_share


def _leads(middle: Points, moves: Moves) -> NDArray[np.bool_]:
    """Mask of moves along the direction of a lane where it is nearest."""
    ways = np.diff(middle, axis=0)
    x, y = (middle[:-1] + ways / 2).T
    away = np.hypot(x - moves[:, :1], y - moves[:, 1:2])
    way_x, way_y = ways[away.argmin(axis=1)].T
    cross, dot = (
        way_x * moves[:, 3] - way_y * moves[:, 2],
        way_x * moves[:, 2] + way_y * moves[:, 3],
    )
    leads: NDArray[np.bool_] = np.abs(np.arctan2(cross, dot)) < _ASTRAY
    return leads


def _moves(moved: LongWays) -> Moves:
    """Some positions of a track, with the displacements from there."""
    places = moved.track.rows[moved.rows, :2]
    driven = arc_lengths(places)
    rows = np.searchsorted(driven, np.linspace(0.0, driven[-1], _MOST_PLACES))
    some = places[np.unique(rows)]
    return np.column_stack((some[:-1], np.diff(some, axis=0)))


def _some_places(body: Participant) -> Points:
    """Some positions of a body."""
    if isinstance(body.states, TrackStates):
        rows = body.states.track.rows
        places: Points = rows[:: max(1, len(rows) // _MOST_PLACES), :2]
        return places
    steps = list(body.states)
    some = [body.states[step] for step in steps[:: max(1, len(steps) // _MOST_PLACES)]]
    return np.array([(state.x, state.y) for state in some]).reshape(-1, 2)


def box_of(lines: Sequence[Points]) -> tuple[Points, Points]:
    """The least and the greatest x and y of lines (m)."""
    whole = np.concatenate(lines)
    return whole.min(axis=0), whole.max(axis=0)
