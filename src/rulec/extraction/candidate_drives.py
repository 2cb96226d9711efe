"""Drives of many vehicles that are not there together: what one might do among the same others."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drives import Drives, LaidOutMap, NoDrive
from rulec.extraction.to_trace import Drive, TraceWriter
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.driven_route import RouteStretch
from rulec.extraction.tracks.junction_passages import junction_passages
from rulec.extraction.tracks.map_matching import MapMatching, MatchedStretch
from rulec.extraction.tracks.road_places import RoadPlaces
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.extraction.tracks.tracks import ObjectTypes, tracks_of
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.recording import Participant, Recording, Side


@dataclass(frozen=True, slots=True, eq=False)
class _Matched:
    """The lanelets of others, and behind them of one more."""

    others: MapMatching
    candidates: MapMatching
    row: int

    @property
    def lanelets(self) -> NDArray[intp]:
        own = self.candidates.lanelets[self.row : self.row + 1]
        return np.concatenate((self.others.lanelets, own))

    def of(self, row: int) -> tuple[MatchedStretch, ...]:
        is_own = row == len(self.others.lanelets)
        return self.candidates.of(self.row) if is_own else self.others.of(row)


class _DrivesOfOne(Drives):
    """The drives of a candidate among others, whose places on roads are known."""

    def __init__(self, among: CandidateDrives, batch: _Batch, row: int) -> None:
        super().__init__(
            among.recording,
            among.side,
            among.thresholds,
            batch.writer,
            prepared=(
                among.map,
                _Matched(among.matching, batch.matching, row),
                among.surroundings.and_one(batch.surroundings, row, among.types),
            ),
        )
        self._among, self._batch, self._row = among, batch, row

    def _is_shared(self, road: DrivenRoad, _: int) -> bool:
        return not road.meets_itself

    def _places_on(self, road: DrivenRoad) -> RoadPlaces:
        own, row = self._batch.places(road, self._row)
        return self._among.places(road).and_one(own, row, self._tracks)


class _Batch:
    """Candidates that are looked at together."""

    def __init__(
        self, among: CandidateDrives, candidates: Sequence[Participant], writer: TraceWriter
    ) -> None:
        recording, surroundings = among.recording, among.surroundings
        tracks = tracks_of(recording, among.thresholds, candidates, among.span)
        self.writer = writer
        self.matching = MapMatching(recording, tracks, among.map.graph)
        self.surroundings = Surroundings(recording, tracks, of_map=surroundings.of_map)
        self.surroundings.__dict__["passages"] = junction_passages(
            recording, tracks, surroundings.passages.junctions
        )
        self._drives = Drives(
            recording,
            among.side,
            among.thresholds,
            prepared=(among.map, self.matching, self.surroundings),
        )
        self.stretches = [self._drives.stretches(row) for row in range(len(candidates))]
        self._rows: dict[DrivenRoad, list[int]] = defaultdict(list)
        for row, stretches in enumerate(self.stretches):
            for road in {self._road(among, stretch) for stretch in stretches}:
                if road is not None:
                    self._rows[road].append(row)
        self._places: dict[DrivenRoad, RoadPlaces] = {}

    @staticmethod
    def _road(among: CandidateDrives, stretch: RouteStretch) -> DrivenRoad | None:
        found = among.map.road(stretch.route)
        return None if isinstance(found, str) else found[0]

    def places(self, road: DrivenRoad, row: int) -> tuple[RoadPlaces, int]:
        """The places on a road of all that drive there, and a candidate's row among them."""
        rows = self._rows[road]
        if road not in self._places:
            self._places[road] = self._drives.places_of(road, np.array(rows, dtype=intp))
        return self._places[road], int(np.searchsorted(rows, row))


class CandidateDrives:
    """The drives of candidates for one vehicle, the last participant of a ``recording``.

    Others do not see the candidates, nor do these see each other: each drive is the one of the
    recording in which the candidate is in that vehicle's place. All arrays are of the steps of a
    ``span``, from the first to the last one of anybody who moves.
    """

    def __init__(
        self, recording: Recording, side: Side, thresholds: Thresholds, span: tuple[int, int]
    ) -> None:
        self.recording = recording
        self.side: Side = side
        self.thresholds = thresholds
        self.span = span
        others = recording.participants[:-1]
        tracks = tracks_of(recording, thresholds, others, span)
        self.map = LaidOutMap(recording)
        self.matching = MapMatching(recording, tracks, self.map.graph)
        self.surroundings = Surroundings(recording, tracks)
        self.types = ObjectTypes((*tracks.participants, recording.participants[-1]))
        prepared = self.map, self.matching, self.surroundings
        self._drives = Drives(recording, side, thresholds, prepared=prepared)
        self._everybody = np.arange(len(tracks.participants))
        self._places: dict[DrivenRoad, RoadPlaces] = {}

    def places(self, road: DrivenRoad) -> RoadPlaces:
        """The places of the others on a road."""
        if road not in self._places:
            self._places[road] = self._drives.places_of(road, self._everybody)
        return self._places[road]

    def of(
        self, candidates: Sequence[Participant], writer: TraceWriter
    ) -> Iterator[tuple[Drive | NoDrive, ...]]:
        """The drives of each candidate."""
        batch = _Batch(self, candidates, writer)
        last = len(self._everybody)
        for row, stretches in enumerate(batch.stretches):
            yield tuple(_DrivesOfOne(self, batch, row).along(last, stretches))
