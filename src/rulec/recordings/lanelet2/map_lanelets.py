"""The lanelets of a file: bounds in the direction of travel, and the meaning of their tags."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.lanelet2 import lane_tags
from rulec.recordings.lanelet2.osm_file import OsmFile, OsmRelation, OsmWay
from rulec.recordings.polylines import paired
from rulec.recordings.recording import LONGEST_M, Lanelet, Points, is_lane

MOST_POINTS = 5_000_000
"""The most points of all bounds together, counting lines once for each lanelet that uses them."""

_CLOSEST_M = 1e-6
_FEWEST_POINTS = 2

REVERSED = "_reversed"
"""The ending of the id of the opposite lanelet, where a lanelet may be used in both directions."""


class MapBound(NamedTuple):
    """A way of the file as a bound; ``turned``: the direction of travel is not that of the file."""

    way: OsmWay
    turned: bool

    @property
    def key(self) -> tuple[str, bool]:
        """What identifies the bound."""
        return self.way.id, self.turned

    @property
    def ends(self) -> tuple[int, int]:
        """The nodes at which it begins and ends, in the direction of travel."""
        first, last = self.way.nodes[0], self.way.nodes[-1]
        return (last, first) if self.turned else (first, last)

    def reversed(self) -> MapBound:
        """The bound of a lanelet in the opposite direction."""
        return MapBound(self.way, not self.turned)


class MapLanelet(NamedTuple):
    """A lanelet without its surroundings, and its bounds in the file."""

    lanelet: Lanelet
    left: MapBound
    right: MapBound


def map_lanelets(file: OsmFile, points: Points, left_out: list[str]) -> dict[str, MapLanelet]:
    """The lanelets of a file by id; ids of those without two bounds are added to ``left_out``.

    A lane used by vehicles in both directions becomes two lanelets. Raises RulecError R0610 for a
    bound that is too long, or too many points.
    """
    entries: dict[str, MapLanelet] = {}
    count = 0
    for relation in file.relations.values():
        if relation.tags.get("type") != "lanelet":
            continue
        ways = [list(relation.refs(side, "way")) for side in ("left", "right")]
        left, right = (file.ways.get(refs[0]) if len(refs) == 1 else None for refs in ways)
        entry = None
        if left is not None and right is not None:
            count += len(left.nodes) + len(right.nodes)
            if count > MOST_POINTS:
                why = f"the bounds of its lanelets have more than {MOST_POINTS:,} points"
                raise file.refused(why, relation.place)
            entry = _entry(file, points, relation, left, right)
        if entry is None:
            left_out.append(relation.id)
            continue
        entries[relation.id] = entry
        if is_lane(entry.lanelet) and lane_tags.leads_both_ways(relation.tags):
            against = _reversed(entry)
            entries[against.lanelet.id] = against
    return entries


def _entry(
    file: OsmFile, points: Points, relation: OsmRelation, left: OsmWay, right: OsmWay
) -> MapLanelet | None:
    left_line, right_line = (_distinct(points[list(way.nodes)]) for way in (left, right))
    if left_line is None or right_line is None:
        return None
    for line, way in ((left_line, left), (right_line, right)):
        if np.ptp(line, axis=0).max() > LONGEST_M:
            why = f"a lanelet's bound is longer than {LONGEST_M / 1000:g} km"
            raise file.refused(why, way.place)
    turned = _aligned(left_line, right_line)
    left_line, right_line = (
        line[::-1] if turns else line
        for line, turns in zip((left_line, right_line), turned, strict=True)
    )
    tags = relation.tags
    lanelet = Lanelet(
        id=relation.id,
        types=lane_tags.lane_types(tags),
        left=left_line,
        right=right_line,
        centre=_middle_line(left_line, right_line),
        left_mark=lane_tags.mark(left.tags, turned=turned[0], on_left=False),
        right_mark=lane_tags.mark(right.tags, turned=turned[1], on_left=True),
    )
    if is_lane(lanelet):
        junction = tags.get("intersection_area", "")
        lanelet = replace(lanelet, limit_mps=lane_tags.speed_limit(tags), junction=junction)
    return MapLanelet(lanelet, MapBound(left, turned[0]), MapBound(right, turned[1]))


def _reversed(entry: MapLanelet) -> MapLanelet:
    """The lanelet in the opposite direction on the same ground."""
    own = entry.lanelet
    lanelet = replace(
        own,
        id=own.id + REVERSED,
        left=own.right[::-1],
        right=own.left[::-1],
        centre=own.centre[::-1],
        left_mark=own.right_mark,
        right_mark=own.left_mark,
    )
    return MapLanelet(lanelet, entry.right.reversed(), entry.left.reversed())


def _aligned(left: Points, right: Points) -> tuple[bool, bool]:
    """Whether two lines are to be turned as bounds of a lanelet, by Lanelet2's ``geometry::align``.

    The left bound gets the direction in which the middle of the right one lies to its right; then
    the right bound gets the direction in which the middle of the left one lies to its left.
    """
    left_turned = bool(_left_of(left, _middle(right)) >= 0)
    left = left[::-1] if left_turned else left
    return left_turned, bool(_left_of(right, _middle(left)) <= 0)


def _middle(line: Points) -> NDArray[float64]:
    middle: NDArray[float64] = line[len(line) // 2]
    return middle if len(line) > _FEWEST_POINTS else line[[0, -1]].mean(axis=0)


def _left_of(line: Points, place: NDArray[float64]) -> float:
    """The signed distance of a place from a line, positive on its left.

    Where a corner is nearest, both segments at the corner count equally.
    """
    steps = np.diff(line, axis=0)
    squared = np.maximum((steps**2).sum(axis=1), _CLOSEST_M**2)
    part = np.clip(((place - line[:-1]) * steps).sum(axis=1) / squared, 0.0, 1.0)
    to = place - (line[:-1] + part[:, None] * steps)
    distance = np.hypot(*to.T)
    nearest = int(distance.argmin())
    ahead = steps[nearest] / np.sqrt(squared[nearest])
    if part[nearest] == 1.0 and nearest + 1 < len(steps):
        ahead = ahead + steps[nearest + 1] / np.sqrt(squared[nearest + 1])
    elif part[nearest] == 0.0 and nearest > 0:
        ahead = ahead + steps[nearest - 1] / np.sqrt(squared[nearest - 1])
    return float(ahead[0] * to[nearest, 1] - ahead[1] * to[nearest, 0])


def _distinct(line: Points) -> Points | None:
    """A line without repeated points; None if fewer than two points remain."""
    if len(line) < _FEWEST_POINTS:
        return None
    kept = line[np.append(True, np.hypot(*np.diff(line, axis=0).T) > _CLOSEST_M)]
    return kept if len(kept) >= _FEWEST_POINTS else None


def _middle_line(left: Points, right: Points) -> Points:
    """The line halfway between two bounds.

    It has a point at each fraction of the length at which either bound has one.
    """
    both = paired(left, right)
    line = _distinct((both[0] + both[1]) / 2)
    # Bounds in opposite directions with the same ends have no centre line
    return left if line is None else line
