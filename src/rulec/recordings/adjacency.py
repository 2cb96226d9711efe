"""Finds lanelets side by side by their borders, whether or not the file names them.

Also finds the side of traffic, which lanes show if no country is known.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import cos, radians
from typing import Any

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.diagnostics import first_of
from rulec.recordings.recording import Lanelet, Points, Recording, Side, is_lane
from rulec.trace.plain_arrays import ranges

BORDER_M = 0.5
"""Borders no farther apart than this coincide."""

WHOLE = 0.9
"""Lanelets are neighbours if their borders coincide for this share of either."""

LONG_M = 30.0
"""Shorter lanelets side by side, as where turning lanes begin, may lead different ways."""

_RESERVED = frozenset({"busLane", "bicycleLane", "rail"})
"""Lanes reserved for others may lead against the road's traffic on its far side."""

_LEAST_M = 10.0
"""Shorter stretches of common border belong to paths that meet in a junction."""

_CLEARLY = 4.0
"""The least ratio of lengths on both sides for the side of traffic to be clear."""

_EVERY_M = 2.0
_LIKE = cos(radians(30))
_NAMED = 3


@dataclass(frozen=True, slots=True)
class Bordering:
    """A lanelet right of another one, with the share and length of their common border."""

    right: Lanelet
    left: Lanelet
    part: float
    length: float


def bordering(lanelets: Iterable[Lanelet], *, alone: bool = False) -> Iterator[Bordering]:
    """The pairs of lanes of the same direction with a common stretch of border.

    Pairs that the map names are left out; with ``alone``, also lanes that have another neighbour
    there.
    """
    lanes = [lanelet for lanelet in lanelets if is_lane(lanelet)]
    right = [lane for lane in lanes if not alone or lane.left_of is None]
    left = [lane for lane in lanes if not alone or lane.right_of is None]
    if not right or not left:
        return
    lefts, rights = _lines([x.left for x in right]), _lines([x.right for x in left])
    owns, others = shapely.STRtree(rights).query(lefts, predicate="dwithin", distance=BORDER_M)
    named = [(right[own], left[other]) for own, other in zip(owns, others, strict=True)]
    unsaid = [lane is not beside and lane.left_of != beside.id for lane, beside in named]
    owns, others = owns[unsaid], others[unsaid]
    if not len(owns):
        return
    shares = _near(lefts[owns], rights[others]), _near(rights[others], lefts[owns])
    parts, lengths = np.minimum(*shares), shares[0] * shapely.length(lefts[owns])
    pairs = zip(owns.tolist(), others.tolist(), parts.tolist(), lengths.tolist(), strict=True)
    for own, other, part, length in pairs:
        yield Bordering(right[own], left[other], part, length)


def _oncoming_length(borders: Sequence[Points]) -> float:
    """The total length (m) of borders shared with lanes of the opposite direction.

    Only stretches of at least ``_LEAST_M`` count.
    """
    if not borders:
        return 0.0
    lines = _lines(borders)
    owns, others = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=BORDER_M)
    apart = owns != others
    owns, others = owns[apart], others[apart]
    if not len(owns):
        return 0.0
    lengths = _near(lines[owns], lines[others], sense=-1) * shapely.length(lines[owns])
    return float(lengths[lengths >= _LEAST_M].sum())


def _lines(borders: Sequence[Points]) -> NDArray[Any]:
    return np.array([shapely.LineString(border) for border in borders], dtype=object)


def _points(lines: NDArray[Any], at: NDArray[float64]) -> Points:
    """The points at places (m) along lines; beyond an end, that end."""
    inside = np.clip(at, 0.0, shapely.length(lines))
    points: Points = shapely.get_coordinates(shapely.line_interpolate_point(lines, inside))
    return points


def _directions(lines: NDArray[Any], at: NDArray[float64]) -> Points:
    """The directions there, from a metre before to a metre after."""
    steps = _points(lines, at + 1) - _points(lines, at - 1)
    directions: Points = steps / np.maximum(np.hypot(*steps.T), 1e-9)[:, None]
    return directions


def _near(lines: NDArray[Any], others: NDArray[Any], *, sense: int = 1) -> NDArray[float64]:
    """The share of each line along which the other line coincides and leads the same way.

    With ``sense`` -1, the opposite way.
    """
    lengths = shapely.length(lines)
    counts = np.maximum(2, np.round(lengths / _EVERY_M)).astype(int) + 1
    numbers, starts = ranges(np.zeros(len(counts), dtype=int), counts)
    at = numbers * (lengths / (counts - 1)).repeat(counts)
    own, other = lines.repeat(counts), others.repeat(counts)
    points = shapely.points(_points(own, at))
    shapely.prepare(others)
    like = shapely.dwithin(other, points, BORDER_M)
    own, other, points, place = own[like], other[like], points[like], at[like]
    along = shapely.line_locate_point(other, points)
    cosines = (_directions(own, place) * _directions(other, along)).sum(axis=1)
    like[like] = sense * cosines >= _LIKE
    shares: NDArray[float64] = np.add.reduceat(like, starts, dtype=float) / counts
    return shares


def _crossed(lanelets: Iterable[Lanelet]) -> set[str]:
    """The lanes whose centre lines cross another one's."""
    lanes = [lanelet for lanelet in lanelets if is_lane(lanelet)]
    middles = [shapely.LineString(lanelet.centre) for lanelet in lanes]
    if not lanes:
        return set()
    pairs = shapely.STRtree(middles).query(middles, predicate="crosses")
    return {lanes[number].id for number in pairs.ravel().tolist()}


def with_untold_neighbours(recording: Recording) -> Recording:
    """The recording, with neighbours added if its map or format names none at all."""
    named = any(lanelet.left_of or lanelet.right_of for lanelet in recording.lanelets.values())
    return recording if named else with_neighbours(recording)


def with_neighbours(recording: Recording) -> Recording:
    """The recording, with neighbours added that its map does not name, and a remark about it.

    Lanes that others cross are left out: side by side in a junction, they lead different ways.
    """
    lanelets = dict(recording.lanelets)
    pairs = [
        pair
        for pair in bordering(lanelets.values(), alone=True)
        if pair.part >= WHOLE and pair.length >= LONG_M
    ]
    crossed = _crossed(lanelets.values()) if pairs else set()
    joined = []
    for pair in sorted(pairs, key=lambda pair: -pair.part):
        right, left = lanelets[pair.right.id], lanelets[pair.left.id]
        if crossed.intersection((right.id, left.id)):
            continue
        if right.left_of is not None or left.right_of is not None:
            continue
        lanelets[right.id] = replace(right, left_of=left.id)
        lanelets[left.id] = replace(left, right_of=right.id)
        joined.append(f"{right.id} and {left.id}")
    if not joined:
        return recording
    remark = (
        "lanelets side by side are taken to be neighbours, although the file does not say so: "
        + first_of(joined, _NAMED)
    )
    return replace(recording, lanelets=lanelets, remarks=(*recording.remarks, remark))


def with_side(recording: Recording) -> Recording:
    """The recording, with the side of traffic that its lanes show, if it is not known otherwise."""
    if recording.side is not None:
        return recording
    return replace(recording, side=side_by_lanes(recording.lanelets.values()))


def side_by_lanes(lanelets: Iterable[Lanelet]) -> Side | None:
    """The side to which most lanes keep that border on lanes of the opposite direction.

    Such lanes share their left borders if traffic keeps right, their right borders if it keeps
    left. None if there are no such lanes, or both kinds.
    """
    lanes = [lanelet for lanelet in lanelets if is_lane(lanelet) and not lanelet.types & _RESERVED]
    keeps_right, keeps_left = (
        _oncoming_length([getattr(lanelet, border) for lanelet in lanes])
        for border in ("left", "right")
    )
    if keeps_right > _CLEARLY * keeps_left:
        return "right"
    return "left" if keeps_left > _CLEARLY * keeps_right else None
