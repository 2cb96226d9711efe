"""The drives of a recording: vehicles along the roads they drove."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from rulec.extraction.drive_context import drive_context
from rulec.extraction.to_trace import ALL_SIGNALS, Drive, TraceWriter, to_trace
from rulec.extraction.tracks.driven_road import DrivenRoad, driven_road, junction_lanelets
from rulec.extraction.tracks.map_matching import (
    MatchedLanelets,
    RouteStretch,
    driven_stretches,
    match_to_map,
)
from rulec.extraction.tracks.road_extents import RoadExtents, road_extents
from rulec.extraction.tracks.tracks import Tracks, tracks_of
from rulec.extraction.traffic_thresholds import USUAL, Thresholds
from rulec.scenario.recorded.recording import Recording, Side

FEWEST_STATES = 2

MOST_PLACES = 1 << 17
"""Extents of recordings with more participants times steps are computed drive by drive."""

_DRIVERS = frozenset({"vehicle", "light_rider"})


@dataclass(frozen=True, slots=True)
class NoDrive:
    """A vehicle ``ego`` without a drive, and the reason."""

    ego: str
    why: str


class Drives:
    """The drives of a recording, with a shared layout of each road."""

    def __init__(
        self,
        recording: Recording,
        side: Side,
        thresholds: Thresholds = USUAL,
        writer: TraceWriter = ALL_SIGNALS,
    ) -> None:
        self.recording = recording
        self._thresholds = thresholds
        self._writer = writer
        self._side: Side = side
        self._tracks = tracks_of(recording, thresholds)
        self._junctions = junction_lanelets(recording)
        self._matches = match_to_map(recording, self._tracks)
        self._roads: dict[tuple[str, ...], tuple[DrivenRoad, RoadExtents | None] | str] = {}

    def egos(self) -> tuple[str, ...]:
        """The participants that move and steer, in the order of the file."""
        return tuple(
            body.id
            for body in self._tracks.participants
            if not body.standing and _DRIVERS.intersection(body.object_types)
        )

    def kinds(self) -> dict[str, type]:
        """The Python type of each signal of all drives, empty if there is no drive."""
        drives = (x for ego in self.egos() for x in self.of(ego) if isinstance(x, Drive))
        first = next(drives, None)
        return {} if first is None else dict(first.kinds)

    def of(self, ego: str) -> Iterator[Drive | NoDrive]:
        """The drives of one vehicle: several if it leaves its road or the recording jumps."""
        row = next(k for k, body in enumerate(self._tracks.participants) if body.id == ego)
        stretches = [
            stretch
            for part in _unbroken(self._tracks, row, self._matches.get(row, {}))
            for stretch in driven_stretches(self.recording, part)
            if stretch.last - stretch.first + 1 >= FEWEST_STATES
        ]
        if not stretches:
            yield NoDrive(ego, "it is never on a lane that leads its way")
        for number, stretch in enumerate(stretches, 1):
            name = ego if number == 1 else f"{ego}#{number}"
            yield self._drive(row, name, stretch)

    def _drive(self, row: int, name: str, stretch: RouteStretch) -> Drive | NoDrive:
        ego = self._tracks.participants[row].id
        laid_out = self._road(stretch.route)
        if isinstance(laid_out, str):
            return NoDrive(ego, laid_out)
        road, extents = laid_out
        tracks, columns = self._tracks, slice(stretch.first, stretch.last + 1)
        if extents is None:
            rows = tracks.present[:, columns].any(axis=1).nonzero()[0]
            row = int(np.searchsorted(rows, row))
            tracks, columns = tracks.part(rows, columns), slice(0, None)
            extents = road_extents(tracks, road)
        if np.isnan(extents.w[row, columns]).any():
            return NoDrive(ego, "it is far from its road for a while")
        context = drive_context(
            self.recording,
            road,
            self._side,
            self._thresholds,
            tracks=tracks,
            extents=extents,
            ego=row,
            columns=columns,
        )
        return to_trace(context, ego, name, self._writer)

    def _road(self, route: tuple[str, ...]) -> tuple[DrivenRoad, RoadExtents | None] | str:
        if route not in self._roads:
            try:
                road = driven_road(self.recording, route, self._junctions)
                few = self._tracks.present.size <= MOST_PLACES
                self._roads[route] = road, road_extents(self._tracks, road) if few else None
            except ValueError as reason:
                self._roads[route] = f"its road makes no sense, {reason}"
        return self._roads[route]


def _unbroken(tracks: Tracks, row: int, matches: MatchedLanelets) -> Iterator[MatchedLanelets]:
    """The matches of a participant, parted at gaps in its recording."""
    absent = np.cumsum(~tracks.present[row])
    for _, columns in groupby(matches, key=lambda column: int(absent[column])):
        yield {column: matches[column] for column in columns}
