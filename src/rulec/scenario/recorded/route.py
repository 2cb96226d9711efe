"""The lanelets along ego's road, behind and ahead of its own."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from math import atan2, radians

import numpy as np
import shapely
from numpy.typing import NDArray

from rulec.recordings.polylines import line_length
from rulec.recordings.recording import Lanelet, Points, Recording, TrackState, id_order, is_lane
from rulec.scenario.recorded.reference_line import pieces_at, turn

REACH_M = 300.0
"""How far (m) ego's road is followed ahead and behind, as far as the file contains it."""

_NEAR_M = 3.0
_SHORTEST_M = 1.0
_LOOK_M = 30.0
_TURNS_BACK = radians(135)


def lanelet_area(lanelet: Lanelet) -> shapely.Polygon:
    """The polygon between a lanelet's bounds."""
    return shapely.make_valid(shapely.Polygon(np.concatenate((lanelet.right, lanelet.left[::-1]))))


def directions_beside(lanelet: Lanelet, points: NDArray[np.object_]) -> NDArray[np.float64]:
    """The direction (rad) of a lanelet's centre line at the place nearest to each point."""
    return directions_at(
        lanelet, shapely.line_locate_point(shapely.LineString(lanelet.centre), points)
    )


def directions_at(lanelet: Lanelet, along: NDArray[np.float64]) -> NDArray[np.float64]:
    """The direction (rad) of a lanelet's centre line at places along it (m)."""
    steps = lanelet.centre[1:] - lanelet.centre[:-1]
    reached = np.concatenate(([0.0], np.hypot(*steps.T).cumsum()))
    piece = pieces_at(reached, along)
    directions: NDArray[np.float64] = np.arctan2(steps[piece, 1], steps[piece, 0])
    return directions


def lanelet_of(recording: Recording, state: TrackState) -> str | None:
    """The lanelet under a vehicle that is best aligned with it, else the nearest within 3 m."""
    place = shapely.Point(state.x, state.y)
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    far = {lanelet.id: float(shapely.distance(lanelet_area(lanelet), place)) for lanelet in lanes}
    near = [lanelet for lanelet in lanes if far[lanelet.id] <= _NEAR_M]
    inside = [lanelet for lanelet in near if far[lanelet.id] == 0.0]

    def rank(lanelet: Lanelet) -> tuple[float, float, tuple[int, str]]:
        error = abs(turn(float(directions_beside(lanelet, np.array([place]))[0]), state.heading))
        return (0.0 if inside else far[lanelet.id], round(error, 6), id_order(lanelet.id))

    return min(inside or near, key=rank).id if near else None


def lanelets_at(recording: Recording, places: Points) -> frozenset[str]:
    """The lanes at any of the places, and the lanes beside these in the same direction."""
    points = shapely.points(places)
    holding = {
        lanelet.id
        for lanelet in recording.lanelets.values()
        if is_lane(lanelet) and bool(shapely.intersects(lanelet_area(lanelet), points).any())
    }
    return frozenset(
        own
        for number in holding
        for own in (
            number,
            *lanes_beside(recording, number, left=True),
            *lanes_beside(recording, number, left=False),
        )
    )


def lanes_beside(recording: Recording, start: str, *, left: bool) -> tuple[str, ...]:
    """The lanes left or right of a lanelet in the same direction, nearest first."""
    lanes: list[str] = []
    lanelet = recording.lanelets[start]
    while True:
        number = lanelet.left_of if left else lanelet.right_of
        if number is None or number in (start, *lanes) or number not in recording.lanelets:
            return tuple(lanes)
        lanelet = recording.lanelets[number]
        if not is_lane(lanelet):
            return tuple(lanes)
        lanes.append(number)


def route(recording: Recording, start: str, targets: frozenset[str]) -> tuple[str, ...]:
    """The lanelets along ego's road, each followed by one of its successors.

    Where the road branches, the route leads towards a target if one can be reached, else as
    straight as possible. A closed road is cut at its half.
    """
    lanelets = recording.lanelets
    way = _way_to(lanelets, start, targets)
    ahead = _straight_on(lanelets, way)
    behind = _straight_on(lanelets, [start], backwards=True, taken=ahead)
    if start in lanelets[ahead[-1]].successors:
        own = [lanelet_length(lanelets[number]) for number in ahead]
        while len(ahead) > len(way) and sum(own[len(ahead) - 1 :]) < sum(own[: len(ahead) - 1]):
            behind.append(ahead.pop())
    return (*behind[:0:-1], *ahead)


def roads_beyond(
    recording: Recording, way: Sequence[str]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The lanelets before and after a route, as straight as possible where the road branches.

    They may lead back to the route, as on a ring.
    """
    lanelets = recording.lanelets
    ahead = _straight_on(lanelets, [way[-1]], again=True)
    behind = _straight_on(lanelets, [way[0]], backwards=True, again=True)
    return tuple(behind[:0:-1]), tuple(ahead[1:])


def _way_to(lanelets: Mapping[str, Lanelet], start: str, targets: frozenset[str]) -> list[str]:
    came_from: dict[str, str | None] = {start: None}
    waiting = deque([start])
    while waiting:
        here = waiting.popleft()
        if here in targets:
            way = [here]
            while (previous := came_from[way[-1]]) is not None:
                way.append(previous)
            return way[::-1]
        for number in lanelets[here].successors:
            if number in lanelets and number not in came_from:
                came_from[number] = here
                waiting.append(number)
    return [start]


def _straight_on(
    lanelets: Mapping[str, Lanelet],
    start: Sequence[str],
    *,
    backwards: bool = False,
    taken: Iterable[str] = (),
    again: bool = False,
) -> list[str]:
    """A route extended as straight as possible, without the lanelets ``taken``.

    ``again``: whether a lanelet may occur twice.
    """
    way = list(start)
    seen = {*way, *taken}
    reach = sum(lanelet_length(lanelets[number]) for number in way[1:])
    while reach < REACH_M:
        here = lanelets[way[-1]]
        leaving = _end_heading(here, backwards)
        onward = ways_on(lanelets, here, backwards=backwards)
        options = [lanelet for lanelet in onward if again or lanelet.id not in seen]
        if not options:
            break
        turns = {x.id: abs(turn(leaving, _heading_ahead(x, backwards))) for x in options}
        chosen = min(options, key=lambda option: (turns[option.id], id_order(option.id)))
        way.append(chosen.id)
        seen.add(chosen.id)
        reach += max(lanelet_length(chosen), _SHORTEST_M)
    return way


def ways_on(
    lanelets: Mapping[str, Lanelet], here: Lanelet, *, backwards: bool = False
) -> list[Lanelet]:
    """The lanes into which a lanelet leads, except back beside it.

    A road does not turn back on itself, though vehicles may turn around at its end. ``backwards``:
    the lanes that lead into it.
    """
    return [
        lanelets[number]
        for number in (here.predecessors if backwards else here.successors)
        if number in lanelets
        and is_lane(lanelets[number])
        and not turns_back(here, lanelets[number], backwards=backwards)
    ]


def turns_back(before: Lanelet, lanelet: Lanelet, *, backwards: bool = False) -> bool:
    """Whether a lanelet leads back beside the one before it, as where vehicles turn around.

    ``backwards``: whether both are followed from their end to their start.
    """
    angle = turn(_end_heading(before, backwards), _end_heading(lanelet, backwards))
    return abs(angle) >= _TURNS_BACK


def lanelet_length(lanelet: Lanelet) -> float:
    """The length (m) of a lanelet's centre line."""
    return line_length(lanelet.centre)


def _end_heading(lanelet: Lanelet, backwards: bool) -> float:
    """The direction (rad) in which the route leaves a lanelet at its end."""
    centre = lanelet.centre[::-1] if backwards else lanelet.centre
    return _direction(centre[-2], centre[-1])


def _heading_ahead(lanelet: Lanelet, backwards: bool) -> float:
    """The direction (rad) of the route some 30 m into a lanelet."""
    centre = lanelet.centre[::-1] if backwards else lanelet.centre
    line = shapely.LineString(centre)
    end = min(line.length, _LOOK_M)
    before, after = (line.interpolate(s) for s in (max(end - 1.0, 0.0), end))
    return _direction((before.x, before.y), (after.x, after.y))


def _direction(start: Iterable[float], end: Iterable[float]) -> float:
    (x0, y0), (x1, y1) = start, end
    return atan2(y1 - y0, x1 - x0)
