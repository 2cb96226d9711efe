"""Drives of many candidates that do not coexist: what one vehicle may do among the same others."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.context_arrays import EgosOnRoad, drives_context
from rulec.extraction.drives import Drives
from rulec.extraction.traces.lost_drives import made_together
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.traces.to_trace import TraceWriter, to_traces
from rulec.extraction.tracks.at_junctions.junction_passages import junction_passages
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.laid_out_map import LaidOutMap
from rulec.extraction.tracks.matching.driven_route import RouteStretch
from rulec.extraction.tracks.matching.map_matching import MapMatching, MatchedStretch
from rulec.extraction.tracks.road_places import RoadPlaces
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.extraction.tracks.tracks import ObjectTypes, tracks_of
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.recording import Participant, Recording, Side

MOST_CELLS = 1 << 18
"""Drives are laid end to end up to this many cells; fewer take more calls, more need more
memory."""

Block: TypeAlias = list[tuple[int, tuple[Drive | NoDrive, ...]]]
"""Pairs of a candidate's number and its drives."""


@dataclass(frozen=True, slots=True, eq=False)
class _Matched:
    """The matched lanelets of the other participants and, as the last row, of one candidate."""

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
    """The drives of one candidate among the others, whose places on roads are already known."""

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

    def _places_along(self, road: DrivenRoad, _row: int, _columns: slice) -> RoadPlaces:
        own, row = self._batch.places(road, self._row)
        return self._among.places(road).and_one(own, row, self._tracks)


@dataclass(frozen=True, slots=True, eq=False)
class _Stretch:
    """Stretch ``number`` of the candidate in ``row``, with the name and columns of its drive."""

    row: int
    number: int
    name: str
    columns: slice


class _Batch(KeepsResults):
    """Candidates that are processed together."""

    def __init__(
        self, among: CandidateDrives, candidates: Sequence[Participant], writer: TraceWriter
    ) -> None:
        recording, surroundings = among.recording, among.surroundings
        known = surroundings.tolerances
        tracks = tracks_of(recording, among.thresholds, candidates, among.span, known)
        self._among = among
        self.writer = writer
        self.matching = MapMatching(recording, tracks, among.map.graph)
        self.surroundings = Surroundings(
            recording, tracks, among.thresholds, of_map=surroundings.of_map
        )
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
        self._roads = [[self._road(stretch) for stretch in own] for own in self.stretches]
        self._rows: dict[DrivenRoad, dict[int, int]] = defaultdict(dict)
        for row, roads in enumerate(self._roads):
            for road in dict.fromkeys(roads):
                if road is not None:
                    own = self._rows[road]
                    own[row] = len(own)

    def _road(self, stretch: RouteStretch) -> DrivenRoad | None:
        found = self._among.map.road(stretch.route)
        return None if isinstance(found, str) else found[0]

    def places(self, road: DrivenRoad, row: int) -> tuple[RoadPlaces, int]:
        """The places on a road of all candidates that drive there, and a candidate's row there."""
        return self._places(road), self._rows[road][row]

    @kept
    def _places(self, road: DrivenRoad) -> RoadPlaces:
        rows = self._rows[road]
        return self._drives.places_of(road, np.fromiter(rows, dtype=intp, count=len(rows)))

    def drives(self, *, bare: bool) -> Iterator[Block]:
        """The drives of each candidate, ordered by road, in blocks.

        With ``bare`` the drives are bare, unless one block holds all candidates.
        """
        known: dict[DrivenRoad | None, int] = {}
        roads = [known.setdefault(own[0] if own else None, len(known)) for own in self._roads]
        order = sorted(range(len(roads)), key=roads.__getitem__)
        n_others = max(len(self._among.surroundings.tracks.participants), 1)
        rows: list[int] = []
        states = 0
        for row in order:
            rows.append(row)
            states += sum(stretch.last - stretch.first + 1 for stretch in self.stretches[row])
            if states * n_others >= MOST_CELLS:
                yield self._block(rows, bare=bare and len(rows) < len(order))
                rows, states = [], 0
        if rows:
            yield self._block(rows, bare=bare and len(rows) < len(order))

    def _block(self, rows: Sequence[int], *, bare: bool) -> Block:
        """The drives of the candidates in ``rows``."""
        writer = replace(self.writer, bare=bare)
        together: dict[DrivenRoad, list[_Stretch]] = defaultdict(list)
        apart = set()
        for row in rows:
            stretches = self.stretches[row]
            own = [self._together(row, number, stretch) for number, stretch in enumerate(stretches)]
            ready = [trace for trace in own if trace is not None]
            if not own or len(ready) < len(own):
                apart.add(row)
                continue
            for road, stretch in ready:
                together[road].append(stretch)
        drives: dict[tuple[int, int], Drive | NoDrive] = {}
        for road, waiting in together.items():
            drives |= self._end_to_end(road, waiting, writer)
        found: Block = []
        for row in rows:
            own_drives = [drives.get((row, k)) for k in range(len(self.stretches[row]))]
            whole = tuple([drive for drive in own_drives if drive is not None])
            is_whole = row not in apart and len(whole) == len(own_drives)
            found.append((row, whole if is_whole else self._by_itself(row)))
        return found

    def _together(
        self, row: int, number: int, stretch: RouteStretch
    ) -> tuple[DrivenRoad, _Stretch] | None:
        """The road of a stretch that can be processed with others, and the stretch; or None."""
        road = self._roads[row][number]
        if road is None or road.meets_itself or stretch.against:
            return None
        columns = slice(stretch.first, stretch.last + 1)
        places, own = self.places(road, row)
        if np.isnan(places.extents.s[own, columns]).any():
            return None
        ego = self.surroundings.tracks.participants[row].id
        name = ego if number == 0 else f"{ego}#{number + 1}"
        return road, _Stretch(row, number, name, columns)

    def _by_itself(self, row: int) -> tuple[Drive | NoDrive, ...]:
        """The drives of a candidate that is processed by itself."""
        drives_of_one = _DrivesOfOne(self._among, self, row)
        return tuple(
            drives_of_one.along(
                len(self._among.surroundings.tracks.participants), self.stretches[row]
            )
        )

    def _end_to_end(
        self, road: DrivenRoad, stretches: Sequence[_Stretch], writer: TraceWriter
    ) -> dict[tuple[int, int], Drive | NoDrive]:
        """Drives along one road by candidate and number; empty if their traces' names differ."""
        among = self._among
        egos = EgosOnRoad(
            self.places(road, stretches[0].row)[0],
            [self.places(road, stretch.row)[1] for stretch in stretches],
            [stretch.columns for stretch in stretches],
            own=self.surroundings,
            alone=lambda number: self._surroundings_of(stretches[number].row),
        )
        context = drives_context(among.surroundings, among.places(road), among.side, egos)
        ids = [self.surroundings.tracks.participants[stretch.row].id for stretch in stretches]
        names = [stretch.name for stretch in stretches]
        drives = made_together(
            names,
            lambda: to_traces(context, ids, names, writer),
            lambda number: self._alone(stretches[number]),
        )
        keys = [(stretch.row, stretch.number) for stretch in stretches]
        return dict(zip(keys, drives, strict=True)) if drives else {}

    def _alone(self, stretch: _Stretch) -> Drive | NoDrive:
        n_others = len(self._among.surroundings.tracks.participants)
        own = self.stretches[stretch.row][stretch.number]
        return _DrivesOfOne(self._among, self, stretch.row).drive(n_others, stretch.name, own)

    def _surroundings_of(self, row: int) -> tuple[Surroundings, int]:
        """The surroundings with a candidate as last participant, and its row in them."""
        among = self._among
        joined = among.surroundings.and_one(self.surroundings, row, among.types)
        return joined, len(among.surroundings.tracks.participants)


class CandidateDrives(KeepsResults):
    """The drives of candidates for one vehicle, the last participant of a ``recording``.

    The others do not see the candidates, nor do candidates see each other: each drive is the one of
    the recording with the candidate in that vehicle's place. All arrays cover the steps of
    ``span``, from the first to the last step of any moving participant.
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
        self.surroundings = Surroundings(recording, tracks, thresholds)
        self.types = ObjectTypes((*tracks.participants, recording.participants[-1]))
        prepared = self.map, self.matching, self.surroundings
        self._drives = Drives(recording, side, thresholds, prepared=prepared)
        self._everybody = np.arange(len(tracks.participants))

    @kept
    def places(self, road: DrivenRoad) -> RoadPlaces:
        """The places of the others on a road."""
        return self._drives.places_of(road, self._everybody)

    def of(
        self, candidates: Sequence[Participant], writer: TraceWriter
    ) -> list[tuple[Drive | NoDrive, ...]]:
        """The drives of each candidate."""
        blocks = _Batch(self, candidates, writer).drives(bare=False)
        found = dict(own for block in blocks for own in block)
        return [found[row] for row in range(len(candidates))]

    def in_blocks(self, candidates: Sequence[Participant], writer: TraceWriter) -> Iterator[Block]:
        """The drives of candidates, block by block; the first block contains the first candidate.

        Drives are bare if there are several blocks.
        """
        yield from _Batch(self, candidates, writer).drives(bare=True)
