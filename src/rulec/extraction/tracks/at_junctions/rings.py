"""Roundabouts of a map: rings of lanelets that no other lane crosses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import shapely

from rulec.array_types import Floats
from rulec.recordings.polylines import line_length
from rulec.recordings.recording import Lanelet, Recording, Side, is_lane
from rulec.scenario.recorded.reference_line import turn

LONGEST_M = 300.0
"""Greatest length (m) of a ring."""

MOST_LANELETS = 24

_FULL_TURN = 2 * np.pi
_UNEVEN = 0.5

_EVERY_M = 2.0
_INSIDE_M = 1.0
"""A lane that leads through a ring is farther inside it than this."""

_STEP_M, _BACK = 2.0, np.pi / 2
"""Steps of lines that turn by more than ``_BACK`` (rad) lead back, by less than ``_STEP_M``."""

_STRAIGHT_M, _LEAST_TURN = 30.0, 0.2
"""A roundabout turns by more than ``_LEAST_TURN`` (rad) on each stretch of ``_STRAIGHT_M``."""


def ring_lanelets(recording: Recording, side: Side) -> frozenset[str]:
    """The lanelets of roundabouts: those that the map marks, or else rings of its lanelets.

    A ring leads round once, away from ``side``, is nowhere straight for long, unlike the streets
    around a block, can be entered and left, and no lane crosses it.
    """
    known = recording.lanelets
    marked = frozenset(name for name, lanelet in known.items() if "roundabout" in lanelet.types)
    if marked or "roundabout" in recording.complete:
        return marked | _between(known, marked)
    lanes = {name: lanelet for name, lanelet in known.items() if is_lane(lanelet)}
    turned = {name: _turned(lanelet) for name, lanelet in lanes.items()}
    towards = 1.0 if side == "right" else -1.0
    bent = {name for name, angle in turned.items() if angle * towards > 0.1}
    found: set[str] = set()
    for start in bent:
        if start not in found:
            for ring in _rings(lanes, turned, start, towards):
                if _is_round(ring, lanes) and not _crossed(ring, lanes) and _is_joined(ring, lanes):
                    found.update(ring)
                    break
    return frozenset(found)


def _between(lanelets: Mapping[str, Lanelet], marked: frozenset[str]) -> frozenset[str]:
    """The lanelets within junctions that lead from one lanelet of a ring to another."""
    return frozenset(
        name
        for name, lanelet in lanelets.items()
        if marked & set(lanelet.predecessors) and marked & set(lanelet.successors)
    )


def _turned(lanelet: Lanelet) -> float:
    turns = _turns(np.diff(lanelet.centre, axis=0))
    if np.abs(turns).max(initial=0.0) > _BACK:
        turns = _turns(np.diff(_without_steps_back(lanelet.centre), axis=0))
    return float(turns.sum())


def _turns(steps: Floats) -> Floats:
    """The angles (rad) between successive steps."""
    headings = np.arctan2(steps[:, 1], steps[:, 0])
    turns: Floats = turn(headings[:-1], headings[1:])
    return turns


def _without_steps_back(line: Floats) -> Floats:
    """A line's first and last point and, in between, those ``_STEP_M`` apart.

    Where two pieces of a map's line meet, the second one may begin a little before the first ends.
    """
    kept = [line[0]]
    for point in line[1:]:
        if np.hypot(*(point - kept[-1])) >= _STEP_M:
            kept.append(point)
    return np.array([kept[0], *kept[1:-1], line[-1]])


def _rings(
    lanes: Mapping[str, Lanelet], turned: Mapping[str, float], start: str, towards: float
) -> Iterator[tuple[str, ...]]:
    """The chains of lanelets that lead from ``start`` back to itself in one full turn."""
    chains: tuple[str, ...] = (start,)
    waiting = [(chains, turned[start] * towards, line_length(lanes[start].centre))]
    while waiting:
        chain, angle, length = waiting.pop()
        for number in lanes[chain[-1]].successors:
            if number not in lanes:
                continue
            corner = _corner(lanes[chain[-1]], lanes[number]) * towards
            if number == start:
                if abs(angle + corner - _FULL_TURN) < _UNEVEN:
                    yield chain
            elif number not in chain and len(chain) < MOST_LANELETS:
                further = angle + corner + turned[number] * towards
                longer = length + line_length(lanes[number].centre)
                if angle - _UNEVEN <= further <= _FULL_TURN + _UNEVEN and longer <= LONGEST_M:
                    waiting.append(((*chain, number), further, longer))


def _corner(before: Lanelet, after: Lanelet) -> float:
    """The angle (rad) between the end of a lanelet and the beginning of the next one."""
    angle = _angle(before.centre, after.centre)
    if abs(angle) > _BACK:
        angle = _angle(_without_steps_back(before.centre), _without_steps_back(after.centre))
    return angle


def _angle(before: Floats, after: Floats) -> float:
    """The angle (rad) between the last step of a line and the first one of the next."""
    (angle,) = _turns(np.array((before[-1] - before[-2], after[1] - after[0])))
    return float(angle)


def _is_round(ring: tuple[str, ...], lanes: Mapping[str, Lanelet]) -> bool:
    """Whether a ring turns at least a little on every stretch of ``_STRAIGHT_M``."""
    line = shapely.LinearRing(np.concatenate([lanes[name].centre for name in ring]))
    count = max(int(line.length / _EVERY_M), 8)
    places = shapely.get_coordinates(
        shapely.line_interpolate_point(line, np.arange(count) / count, normalized=True)
    )
    headings = np.arctan2(*np.diff(places, axis=0, append=places[:1]).T[::-1])
    apart = min(round(_STRAIGHT_M / (line.length / count)), count - 1)
    turned = np.abs(np.angle(np.exp(1j * (np.roll(headings, -apart) - headings))))
    return bool(turned.min() > _LEAST_TURN)


def _crossed(ring: tuple[str, ...], lanes: Mapping[str, Lanelet]) -> bool:
    """Whether a lane outside the ring leads through it from side to side.

    One that joins it may touch it more than once as it gets onto it, but does not go inside.
    """
    line = shapely.LinearRing(np.concatenate([lanes[name].centre for name in ring]))
    others = [shapely.LineString(x.centre) for name, x in lanes.items() if name not in ring]
    met = shapely.intersection(line, others)
    inside = shapely.intersects(shapely.Polygon(line).buffer(-_INSIDE_M), others)
    often = ~shapely.is_empty(met) & (shapely.get_num_geometries(met) > 1)
    return bool((often & inside).any())


def _is_joined(ring: tuple[str, ...], lanes: Mapping[str, Lanelet]) -> bool:
    outside = [
        number
        for name in ring
        for number in (*lanes[name].predecessors, *lanes[name].successors)
        if number not in ring
    ]
    return len(outside) >= 2
