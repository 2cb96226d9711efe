"""The drives of a recording: its vehicles along the roads that they drove."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, TypeAlias

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.context_arrays import EgosOnRoad, drives_context
from rulec.extraction.recording_parts import egos_of
from rulec.extraction.traces.lost_drives import lost_drive, made_together
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.traces.to_trace import ALL_SIGNALS, TraceWriter, to_traces
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.laid_out_map import LaidOutMap
from rulec.extraction.tracks.matching.driven_route import RouteStretch, route_stretches
from rulec.extraction.tracks.matching.map_matching import MapMatching, MatchedStretch
from rulec.extraction.tracks.matching.wrong_way import wrong_way_stretches
from rulec.extraction.tracks.road_extents import (
    EgoPieces,
    RoadExtents,
    expected_places,
    road_extents,
)
from rulec.extraction.tracks.road_places import RoadPlaces, are_on_road, near_road, rows_in_reach
from rulec.extraction.tracks.surroundings import BACKS_MPS, Surroundings
from rulec.extraction.tracks.towed import towed_by
from rulec.extraction.tracks.tracks import Tracks, tracks_of
from rulec.extraction.traffic_thresholds import USUAL, Thresholds
from rulec.garbage_collection import no_garbage_collection
from rulec.recordings.recording import Lanelet, Recording, Side

FEWEST_STATES = 2

MOST_CELLS = 1 << 18
"""Most cells (participants × states) of several drives that are processed together."""

FEWEST_TOGETHER = 2
"""Fewer drives than this are processed one by one."""

MOST_PLACES = 1 << 17
"""Recordings with more cells (participants × steps) than this are processed in parts."""

MOST_OF_ALL = 0.75
"""If at least this share of all places is needed, all are computed: the outlines are known then."""

PART = 4
"""A part lasts this many times its first drive; drives that end within it share its places."""

MOST_KEPT = 1 << 22
"""Most cells (participants × steps) that are kept for all roads; each takes some 150 bytes."""

_Key: TypeAlias = tuple[int, int]
"""A drive: its participant's row and its first column."""

_LONGEST_M = 50.0
"""Upper bound (m) on the length of bodies whose ends count."""


@dataclass(frozen=True, eq=False, slots=True)
class _PlacesInPart:
    """Places on a road, kept for the drives that are still ``awaited``."""

    places: RoadPlaces
    awaited: set[_Key]


class Matching(Protocol):
    """The lanelets that participants drove, by row."""

    @property
    def lanelets(self) -> NDArray[intp]:
        """Their numbers in the file's order, by participant and column; -1 for none."""

    def of(self, row: int) -> tuple[MatchedStretch, ...]:
        """The matched stretches of a participant."""


class Drives(KeepsResults):
    """The drives of a recording, with a shared layout of each road.

    ``prepared`` are the map, the matched lanelets and the surroundings, if already known.
    ``expected`` are egos that will be asked for one after the other; those along one road are
    processed together.
    """

    def __init__(
        self,
        recording: Recording,
        side: Side,
        thresholds: Thresholds = USUAL,
        writer: TraceWriter = ALL_SIGNALS,
        *,
        prepared: tuple[LaidOutMap, Matching, Surroundings] | None = None,
        expected: Sequence[str] = (),
    ) -> None:
        self.recording = recording
        self._thresholds = thresholds
        self._writer = writer
        self._side: Side = side
        if prepared is None:
            tracks, map_ = tracks_of(recording, thresholds), LaidOutMap(recording)
            matching = MapMatching(recording, tracks, map_.graph)
            prepared = map_, matching, Surroundings(recording, tracks, thresholds)
        self._map, self._matching, self._surroundings = prepared
        self._tracks = self._surroundings.tracks
        self._first = self._tracks.present.argmax(axis=1)
        self._parts: dict[DrivenRoad, _PlacesInPart] = {}
        self._expected = expected
        self._ready: dict[_Key, Drive | NoDrive] = {}

    def egos(self) -> tuple[str, ...]:
        """The participants that move and steer, in the order of the file."""
        return egos_of(self.recording)

    def kinds(self) -> dict[str, type]:
        """The Python type of each signal, the same for all drives; empty if there is no drive."""
        drives = (x for ego in self.egos() for x in self.of(ego) if isinstance(x, Drive))
        return next((dict(drive.kinds) for drive in drives), {})

    def of(self, ego: str) -> Iterator[Drive | NoDrive]:
        """The drives of one vehicle: several if it leaves its road or the recording jumps."""
        try:
            yield from self._of(ego)
        except Exception as problem:
            yield lost_drive(ego, problem)

    def _of(self, ego: str) -> Iterator[Drive | NoDrive]:
        row = next(k for k, body in enumerate(self._tracks.participants) if body.id == ego)
        body = self._tracks.participants[row]
        if 2 * len(body.states) < len(body.outlines):
            yield NoDrive(ego, "it has no track: only sets of places where it may be")
            return
        # The vehicle that the file names as ego drives itself, however close to another one
        is_ego = ego == self.recording.ego
        towing = None if is_ego else towed_by(self._tracks, row, self.recording.step_s)
        if towing is not None:
            yield NoDrive(ego, f"`{towing}` tows it")
            return
        stretches = self._planned[row] if row in self._planned else self.stretches(row)
        yield from self.along(row, stretches)

    def stretches(self, row: int) -> list[RouteStretch]:
        """The stretches of road that a participant drove, along it or against it."""
        along = [
            stretch
            for matched in self._matching.of(row)
            for stretch in self._routes_of(matched)
            if stretch.last - stretch.first + 1 >= FEWEST_STATES
        ]
        return sorted((*along, *self._against.get(row, ())), key=lambda stretch: stretch.first)

    @kept
    def _routes_of(self, matched: MatchedStretch) -> tuple[RouteStretch, ...]:
        # Many candidates of one vehicle drive along the same lanelets at the same times
        return tuple(route_stretches(self.recording, matched, self._map.graph))

    @cached_property
    def _against(self) -> dict[int, list[RouteStretch]]:
        """The stretches that participants drove the wrong way, by row."""

        def is_one_way(lanelet: Lanelet) -> bool:
            return self._surroundings.is_surely_one_way(lanelet, self._side)

        may_back = self._surroundings.head_as_they_move[:, None] & ~(
            self._tracks.speed >= BACKS_MPS
        )
        return wrong_way_stretches(
            self.recording, self._tracks, self._matching.lanelets, is_one_way, may_back
        )

    def along(self, row: int, stretches: Sequence[RouteStretch]) -> Iterator[Drive | NoDrive]:
        """The drives of a participant along stretches of road."""
        ego = self._tracks.participants[row].id
        if not stretches:
            is_brief = len(self._tracks.participants[row].states) < FEWEST_STATES
            why = "recorded at one moment only" if is_brief else "never on a lane in its direction"
            yield NoDrive(ego, f"it is {why}")
        for number, stretch in enumerate(stretches, 1):
            name = ego if number == 1 else f"{ego}#{number}"
            try:
                yield self.drive(row, name, stretch)
            except Exception as problem:
                yield lost_drive(name, problem)

    @no_garbage_collection()
    def drive(self, row: int, name: str, stretch: RouteStretch) -> Drive | NoDrive:
        """The drive of a participant along a stretch of road."""
        ego = self._tracks.participants[row].id
        laid_out = self._map.road(stretch.route)
        if isinstance(laid_out, str):
            return NoDrive(ego, laid_out)
        road, first_piece = laid_out
        columns = slice(stretch.first, stretch.last + 1)
        if stretch.against or road.meets_itself:
            places = self._places_of_one(road, first_piece, row, stretch)
        elif (row, stretch.first) not in self._ready:
            places = self._places_along(road, row, columns)
            self._look_ahead(road, places, (row, stretch.first))
        if not stretch.against and (row, stretch.first) in self._ready:
            return self._ready.pop((row, stretch.first))
        found = self._there(places, row, columns)
        if found is None:
            return NoDrive(ego, "it is far from its road for a while")
        return self._made(places, [(name, *found)], against=stretch.against)[0]

    def _made(
        self, places: RoadPlaces, egos: Sequence[tuple[str, int, slice]], *, against: bool = False
    ) -> list[Drive]:
        """Drives along one road, from names, rows and columns."""
        names, rows, columns = zip(*egos, strict=True)
        on_road = EgosOnRoad(places, rows, columns, own=self._surroundings)
        context = drives_context(self._surroundings, places, self._side, on_road)
        ids = [places.tracks.participants[row].id for row in rows]
        return to_traces(replace(context, wrong_way=against), ids, names, self._writer)

    @cached_property
    def _planned(self) -> dict[int, list[RouteStretch]]:
        """The stretches of the expected egos by row, in their order."""
        rows, planned = {body.id: k for k, body in enumerate(self._tracks.participants)}, {}
        for ego in self._expected:
            with suppress(Exception):  # a fault is found again when this ego is asked for
                planned[rows[ego]] = self.stretches(rows[ego])
        return planned

    @cached_property
    def _plans(self) -> dict[DrivenRoad, list[tuple[int, str, slice]]]:
        """The drives of the expected egos by road: row, name and columns of each."""
        plans: dict[DrivenRoad, list[tuple[int, str, slice]]] = defaultdict(list)
        for row, stretches in self._planned.items():
            ego = self._tracks.participants[row].id
            for number, stretch in enumerate(stretches, 1):
                road = self._map.road(stretch.route)
                if not stretch.against and not isinstance(road, str):
                    name = ego if number == 1 else f"{ego}#{number}"
                    plans[road[0]].append((row, name, slice(stretch.first, stretch.last + 1)))
        return plans

    def _look_ahead(self, road: DrivenRoad, places: RoadPlaces, asked: _Key) -> None:
        """Make the drive ``asked`` and others awaiting these places, up to ``MOST_CELLS``."""
        part = self._parts.get(road)
        awaited = {asked} if part is None else part.awaited | {asked}
        members: dict[_Key, tuple[str, int, slice]] = {}
        cells = 0
        for row, name, columns in self._plans.get(road, []):
            found = (row, columns.start) in awaited and self._there(places, row, columns)
            if found and cells < MOST_CELLS:
                n_there = np.count_nonzero(places.tracks.present[:, found[1]].any(axis=1))
                own = int(n_there) * (columns.stop - columns.start)
                if not members or cells + own <= MOST_CELLS:
                    members[row, columns.start] = (name, *found)
                    cells += own
        if asked in members and len(members) >= FEWEST_TOGETHER:
            self._ready |= self._made_together(places, members)
        if part is not None:
            part.awaited.difference_update(self._ready, [asked])
            if not part.awaited:
                del self._parts[road]

    def _made_together(
        self, places: RoadPlaces, members: Mapping[_Key, tuple[str, int, slice]]
    ) -> dict[_Key, Drive | NoDrive]:
        """Drives along one road, from names, rows and columns; empty if their signals differ."""
        egos = [*members.values()]
        drives = made_together(
            [name for name, *_ in egos],
            lambda: self._made(places, egos),
            lambda k: self._made(places, [egos[k]])[0],
        )
        return dict(zip(members, drives, strict=True)) if drives else {}

    def _there(self, places: RoadPlaces, row: int, columns: slice) -> tuple[int, slice] | None:
        """A drive's row and columns in ``places``; None if they lack it or it leaves the road."""
        rows, before = places.tracks.rows, places.tracks.first - self._tracks.first
        own = slice(columns.start - before, columns.stop - before)
        at = int(rows.searchsorted(row))
        is_there = own.start >= 0 and own.stop <= places.tracks.present.shape[1]
        if not is_there or at == len(rows) or rows[at] != row:
            return None
        return None if np.isnan(places.extents.s[at, own]).any() else (at, own)

    def places_of(self, road: DrivenRoad, rows: NDArray[intp]) -> RoadPlaces:
        """The places of some participants on a road, at all times."""
        columns = slice(0, self._tracks.present.shape[1])
        is_all = len(rows) == len(self._tracks.participants)
        tracks = self._tracks if is_all else self._tracks.part(rows, columns)
        elsewhere = self._elsewhere(road, rows, columns)
        return self._road_places(road, tracks, road_extents(tracks, road), elsewhere)

    def _present(self, columns: slice) -> NDArray[intp]:
        """The rows of the participants that are present in some of the columns."""
        return self._tracks.present[:, columns].any(axis=1).nonzero()[0]

    def _places_along(self, road: DrivenRoad, row: int, columns: slice) -> RoadPlaces:
        """The places on a road during a drive and the expected drives on it that follow soon."""
        known = self._parts.get(road)
        if known is not None and (row, columns.start) in known.awaited:
            return known.places
        begin, end = columns.start, columns.start + PART * (columns.stop - columns.start)
        if self._tracks.present.size <= MOST_PLACES:
            begin, end = 0, self._tracks.present.shape[1]
        soon = [
            (ego, own)
            for ego, _, own in self._plans.get(road, [])
            if begin <= own.start and own.stop <= end and (ego, own) != (row, columns)
        ]
        places = self._places_during(road, [(row, columns), *soon])
        self._parts.pop(road, None)
        if soon:
            awaited = {(ego, own.start) for ego, own in soon}
            self._parts[road] = _PlacesInPart(places, awaited)
        # Drop the newest: drives alternate between their roads, so the road that was used longest
        # ago is the one that is needed next.
        n_kept = sum(part.places.tracks.present.size for part in self._parts.values())
        if len(self._parts) > 1 and n_kept > MOST_KEPT:
            self._parts.pop(road, None)
        return places

    def _places_during(self, road: DrivenRoad, egos: Sequence[tuple[int, slice]]) -> RoadPlaces:
        """The places on a road, during drives along it, of all that may count for them."""
        begin, end = min(own.start for _, own in egos), max(own.stop for _, own in egos)
        columns = slice(begin, end)
        tracks, limits, step_s = self._tracks, self._thresholds, self.recording.step_s
        rows = rows_in_reach(tracks, road, egos, limits).nonzero()[0]
        near = near_road(tracks, road, (rows, columns), limits, step_s)
        near[rows.searchsorted([row for row, _ in egos])] = True
        n_near = np.count_nonzero(near & tracks.present[rows, columns])
        if n_near >= MOST_OF_ALL * np.count_nonzero(tracks.present):
            return self.places_of(road, np.arange(len(tracks.participants)))
        is_near = near.any(axis=1)
        rows, near = rows[is_near], near[is_near]
        own_rows = rows.searchsorted([row for row, _ in egos])
        extents = road_extents(tracks.part(rows, columns).where(near), road)
        if not are_on_road(extents, road, own_rows, limits):
            rows = self._present(columns)
            extents = road_extents(tracks.part(rows, columns), road)
        # Without the arrays that the extents were computed from, which are many times as large
        part = tracks.part(rows, columns)
        return self._road_places(road, part, extents, self._elsewhere(road, rows, columns))

    def _places_of_one(
        self, road: DrivenRoad, first_piece: int, row: int, stretch: RouteStretch
    ) -> RoadPlaces:
        """The places of all during one drive against a road, or on a road that meets itself.

        ``first_piece`` is the piece of the road in which the drive begins.
        """
        columns = slice(stretch.first, stretch.last + 1)
        near = rows_in_reach(self._tracks, road, [(row, columns)], self._thresholds)
        for rows in (near.nonzero()[0], self._present(columns)):
            tracks = self._tracks.part(rows, columns)
            lanelets = self._matching.lanelets[rows, columns]
            own = [column - stretch.first for column in stretch.columns]
            pieces = [first_piece + piece for piece in stretch.pieces]
            own_row = rows.searchsorted([row])
            ego = EgoPieces(int(own_row[0]), own, pieces, self._map.numbers)
            reach_m = self._thresholds.near_m + _LONGEST_M
            expected = expected_places(tracks, road, ego, lanelets, reach_m)
            extents = road_extents(tracks, road, expected)
            if are_on_road(extents, road, own_row, self._thresholds):
                break
        elsewhere = self._elsewhere(road, rows, columns)
        return self._road_places(road, self._tracks.part(rows, columns), extents, elsewhere)

    def _road_places(
        self, road: DrivenRoad, tracks: Tracks, extents: RoadExtents, elsewhere: Flags
    ) -> RoadPlaces:
        moving = self._surroundings.in_traffic[tracks.rows]
        limits = self._thresholds
        return RoadPlaces(road, tracks, extents, limits, elsewhere=elsewhere, in_traffic=moving)

    def _elsewhere(self, road: DrivenRoad, rows: NDArray[intp], columns: slice) -> Flags:
        """Mask of the participants in ``rows`` on lanelets outside the road, in some columns."""
        first = int(self._first[rows].min(initial=columns.start))
        lanelets = self._matching.lanelets[rows, first : columns.stop]
        own = np.zeros(len(self._map.numbers) + 1, dtype=bool)
        own[self._numbers_along(road)] = True
        # A participant that turns off counts as ahead until it has left; one coming from elsewhere
        # does not
        flags = (lanelets >= 0) & ~np.logical_or.accumulate(own[lanelets], axis=1)
        return flags[:, columns.start - first :]

    def _numbers_along(self, road: DrivenRoad) -> list[int]:
        lanelets = [lanelet for row in road.rows for lanelet in row if lanelet is not None]
        return [self._map.numbers[lanelet.id] for lanelet in lanelets]
