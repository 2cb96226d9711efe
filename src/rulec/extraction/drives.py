"""The drives of a recording: for every vehicle the roads that it drove, and what it did there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from rulec.extraction.drive_context import Side, drive_context
from rulec.extraction.selection.relevance import relevant_participants
from rulec.extraction.selection.traffic_thresholds import USUAL, Thresholds
from rulec.extraction.to_trace import ALL_SIGNALS, Drive, TraceWriter, to_trace
from rulec.extraction.tracks.driven_road import DrivenRoad, driven_road
from rulec.extraction.tracks.driven_route import RouteStretch, driven_stretches
from rulec.extraction.tracks.junction_lanelets import junction_lanelets
from rulec.extraction.tracks.map_matching import MatchedLanelets, match_to_map
from rulec.extraction.tracks.road_extents import RoadExtents, road_extents
from rulec.extraction.tracks.tracks import Tracks, tracks_of
from rulec.extraction.tracks.vru_surface import on_crosswalks, on_lanes
from rulec.scenario.recorded.obstacle_types import OBSTACLE_TYPES
from rulec.scenario.recorded.recording import Recording

FEWEST_STATES = 2

MOST_PLACES = 1 << 17
"""Of longer recordings only those are placed along a road who are there while ego drives on it."""

_DRIVERS = ("vehicle", "light_rider")


@dataclass(frozen=True, slots=True)
class NoDrive:
    """Why there is nothing to say of what ``ego`` did."""

    ego: str
    why: str


class Drives:
    """The drives of a recording. Roads that several vehicles drive are worked out once."""

    def __init__(
        self,
        recording: Recording,
        side: Side,
        thresholds: Thresholds = USUAL,
        telling: TraceWriter = ALL_SIGNALS,
    ) -> None:
        self.recording = recording
        self._thresholds = thresholds
        self._telling = telling
        self._side: Side = side
        self._people = tracks_of(recording, thresholds)
        self._junctions = junction_lanelets(recording)
        self._ground = (
            on_lanes(recording, self._people),
            on_crosswalks(recording, self._people),
        )
        self._moments = match_to_map(recording, self._people)
        self._roads: dict[tuple[str, ...], tuple[DrivenRoad, RoadExtents | None] | str] = {}

    def egos(self) -> tuple[str, ...]:
        """Whoever moves and steers, in the order of the file."""
        return tuple(
            one.id
            for one in self._people.participants
            if not one.standing and set(OBSTACLE_TYPES.get(one.type, ())).intersection(_DRIVERS)
        )

    def kinds(self) -> dict[str, type]:
        """The words of all drives, and what their values are; empty if there is no drive."""
        drives = (one for ego in self.egos() for one in self.of(ego) if isinstance(one, Drive))
        first = next(drives, None)
        return {} if first is None else dict(first.kinds)

    def of(self, ego: str) -> Iterator[Drive | NoDrive]:
        """The drives of one vehicle: one, unless it leaves its road or the recording jumps."""
        row = next(k for k, one in enumerate(self._people.participants) if one.id == ego)
        found = [
            one
            for part in _unbroken(self._people, row, self._moments.get(row, {}))
            for one in driven_stretches(self.recording, part)
            if one.last - one.first + 1 >= FEWEST_STATES
        ]
        if not found:
            yield NoDrive(ego, "it is never on a lane that leads its way")
        for number, stretch in enumerate(found, 1):
            name = ego if number == 1 else f"{ego}#{number}"
            yield self._drive(row, name, stretch)

    def _drive(self, row: int, name: str, stretch: RouteStretch) -> Drive | NoDrive:
        ego = self._people.participants[row].id
        answer = self._road(stretch.way)
        if isinstance(answer, str):
            return NoDrive(ego, answer)
        road, everybody = answer
        people, ground, columns = self._people, self._ground, (stretch.first, stretch.last)
        if everybody is None:
            span = slice(stretch.first, stretch.last + 1)
            rows = people.there[:, span].any(axis=1).nonzero()[0]
            row = int(np.searchsorted(rows, row))
            people, columns = people.part(rows, span), (0, stretch.last - stretch.first)
            ground = ground[0][rows, span], ground[1][rows, span]
            everybody = road_extents(people, road)
        if np.isnan(everybody.w[row, columns[0] : columns[1] + 1]).any():
            return NoDrive(ego, "it is far from its road for a while")
        there = relevant_participants(row, people, everybody, road, self._thresholds)
        seen = drive_context(
            self.recording,
            self._thresholds,
            self._side,
            road,
            people,
            everybody,
            there,
            ground,
            row,
            columns,
        )
        return to_trace(seen, ego, name, self._telling)

    def _road(self, way: tuple[str, ...]) -> tuple[DrivenRoad, RoadExtents | None] | str:
        """A road, and everybody's place along it unless that were too much to remember."""
        if way not in self._roads:
            try:
                road = driven_road(self.recording, way, self._junctions)
                few = self._people.there.size <= MOST_PLACES
                self._roads[way] = road, road_extents(self._people, road) if few else None
            except ValueError as reason:
                self._roads[way] = f"its road makes no sense, {reason}"
        return self._roads[way]


def _unbroken(people: Tracks, row: int, moments: MatchedLanelets) -> Iterator[MatchedLanelets]:
    """The moments of somebody, parted where the recording does not have them for a while."""
    gone = np.cumsum(~people.there[row])
    for _, columns in groupby(moments, key=lambda column: int(gone[column])):
        yield {column: moments[column] for column in columns}
