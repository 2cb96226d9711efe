"""Crossroads and priority at the junctions of an OpenDRIVE map.

The standard has a junction wherever roads split or merge, also where ramps leave a motorway. For
traffic law, only junctions of three or more roads with traffic from different directions count.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import pi

import numpy as np

from rulec.recordings.opendrive.content.elements import OpenDrive, RoadJunction
from rulec.recordings.opendrive.lane_links import LaneLinks
from rulec.recordings.opendrive.pieces import LaneKey
from rulec.recordings.opendrive.plan_view import place_on
from rulec.recordings.polylines import wrapped

_ARMS = 3
_LIKE = np.radians(30.0)
"""Ways that enter a junction at smaller angles to each other merge, as where a ramp joins."""


@dataclass(frozen=True, slots=True)
class Crossroads:
    """Road -> the crossroads that it leads through; road -> roads with priority over it there."""

    junction_of: dict[str, str] = field(default_factory=dict)
    yields_to: dict[str, frozenset[str]] = field(default_factory=dict)


def crossroads(content: OpenDrive, links: LaneLinks) -> Crossroads:
    """The crossroads of a file."""
    within: dict[str, list[str]] = defaultdict(list)
    for road in content.roads.values():
        if road.junction:
            within[road.junction].append(road.id)
    entering: dict[str, list[LaneKey]] = defaultdict(list)
    arms: dict[str, set[str]] = defaultdict(set)
    for start, ends in links.after.items():
        for end in ends:
            before, after = start.piece.road.junction, end.piece.road.junction
            if before != after:
                if after:
                    entering[after].append(end)
                    arms[after].add(start.piece.road.id)
                if before:
                    arms[before].add(end.piece.road.id)
    found = Crossroads()
    for name, roads in within.items():
        headings = [_heading(key) for key in entering[name]]
        if len(arms[name]) >= _ARMS and _differ(headings):
            found.junction_of.update(dict.fromkeys(roads, name))
            junction = content.junctions.get(name)
            if junction is not None and junction.priorities:
                found.yields_to.update(_rights(junction, roads))
    return found


def _heading(key: LaneKey) -> float:
    *_, heading = place_on(key.piece.road.geometries, key.start)
    return heading if key.forward else heading + pi


def _differ(headings: Sequence[float]) -> bool:
    """Whether two of the headings (rad) differ by more than merging ways do."""
    if not headings:
        return False
    turned = wrapped(np.array(headings) - headings[0])
    return bool(np.ptp(turned) > _LIKE)


def _rights(junction: RoadJunction, roads: Sequence[str]) -> Iterator[tuple[str, frozenset[str]]]:
    """The roads through a junction that its priorities name, and the roads with priority over each.

    A road that leads to the junction stands for all ways that begin at it.
    """
    starting: dict[str, set[str]] = defaultdict(set)
    for connection in junction.connections:
        starting[connection.incoming].add(connection.road)
    first: dict[str, set[str]] = defaultdict(set)
    for high, low in junction.priorities:
        before = {high} if high in roads else starting.get(high, set())
        for road in {low} if low in roads else starting.get(low, set()):
            first[road] |= before - {road}
        for road in before:
            first.setdefault(road, set())
    yield from ((road, frozenset(others)) for road, others in first.items())
