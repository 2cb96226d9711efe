"""The ways from lanelet to lanelet: successors, and lanes beside that lead the same way.

Lanes whose borders coincide for a while, as where a ramp joins, are beside each other there even if
the map does not name them neighbours; changing to such a lane counts as two changes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import shapely

from rulec.extraction.computed_once import KeepsResults, kept
from rulec.recordings.adjacency import bordering
from rulec.recordings.recording import Lanelet, Recording, is_lane
from rulec.scenario.recorded.route import lanelet_area, lanelet_length, lanes_beside

MOST_HOPS = 4
"""The most lanelets that a vehicle passes between two of its states."""

_LANE_M = 4.0
_SHORTEST_M = 5.0
_UNNAMED_CHANGES = 2


@dataclass(frozen=True, slots=True)
class Way:
    """A way from a lanelet's start to another's: its lanelets except the first, its length (m).

    ``changes`` is the number of lane changes, ``sideways`` roughly how far they lead (m).
    """

    lanelets: tuple[str, ...]
    length: float
    changes: int

    @property
    def sideways(self) -> float:
        """Roughly how far the way leads sideways (m)."""
        return self.changes * _LANE_M


class LaneletGraph(KeepsResults):
    """The lanes of a map and the ways between them, each computed once."""

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        self._bordering: dict[str, list[str]] = defaultdict(list)
        for pair in bordering(recording.lanelets.values()):
            if pair.length >= _SHORTEST_M:
                self._bordering[pair.right.id].append(pair.left.id)
                self._bordering[pair.left.id].append(pair.right.id)

    @cached_property
    def lanes(self) -> tuple[Lanelet, ...]:
        """The lanes, in the order of the file."""
        return tuple([x for x in self._recording.lanelets.values() if is_lane(x)])

    @cached_property
    def areas(self) -> tuple[shapely.Polygon, ...]:
        """The areas of the lanes."""
        return tuple([lanelet_area(lanelet) for lanelet in self.lanes])

    @kept
    def length(self, start: str) -> float:
        """The length (m) of a lane's middle line."""
        return lanelet_length(self._recording.lanelets[start])

    def beside(self, start: str, end: str) -> bool:
        """Whether a lane is beside another one, in its row or along a part of its border."""
        return end in self.row(start) or end in self._bordering[start]

    @kept
    def row(self, start: str) -> tuple[str, ...]:
        """The lanes beside each other at a lanelet, from the right."""
        right, left = (lanes_beside(self._recording, start, left=left) for left in (False, True))
        return (*right[::-1], start, *left)

    def successors(self, start: str) -> Iterator[Lanelet]:
        """The lanes that a lane leads to."""
        lanelets = self._recording.lanelets
        for number in lanelets[start].successors:
            if number in lanelets and is_lane(lanelets[number]):
                yield lanelets[number]

    @kept
    def ways(self, start: str) -> Mapping[str, Way]:
        """The short ways to other lanes, each with the fewest changes, then lanelets."""
        ways = {start: Way((), 0.0, 0)}
        ring = [start]
        for hop in range(MOST_HOPS + 1):
            ring = [*ring, *self._sideways(ring, ways)]
            if hop < MOST_HOPS:
                ring = self._forwards(ring, ways)
        return ways

    def _sideways(self, ring: list[str], found: dict[str, Way]) -> list[str]:
        added = []
        for here in ring:
            row, way = self.row(here), found[here]
            own = row.index(here)
            changes_to = {other: abs(place - own) for place, other in enumerate(row)}
            for other in self._bordering[here]:
                changes_to.setdefault(other, _UNNAMED_CHANGES)
            for other, more in changes_to.items():
                changes = way.changes + more
                if other not in found or changes < found[other].changes:
                    added.append(other)
                    found[other] = Way((*way.lanelets, other), way.length, changes)
        return added

    def _forwards(self, ring: list[str], found: dict[str, Way]) -> list[str]:
        added = []
        for here in ring:
            way = found[here]
            length = way.length + self.length(here)
            for lanelet in self.successors(here):
                known = found.get(lanelet.id)
                if known is None or way.changes < known.changes:
                    found[lanelet.id] = Way((*way.lanelets, lanelet.id), length, way.changes)
                    added.append(lanelet.id)
        return added
