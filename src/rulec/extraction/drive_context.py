"""One drive, or several along one road, by state: ego, its road and the other participants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import kept
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.lane_sets import LaneSets, edges, is_in
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.extraction.tracks.source_tolerances import Tolerances
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.extraction.tracks.tracks import Tracks
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import Recording, Side
from rulec.scenario.recorded.route import ways_on
from rulec.trace.cells import Cells
from rulec.trace.end_to_end import EndToEnd
from rulec.trace.plain_arrays import medians

_ENOUGH_TRACKS = 10
_ENOUGH_IN_LANE = 3
_LEAST_OFFSET_M = 0.15

_OF_STATES = ("relevant", "in_sight", "lanes_there", "elsewhere")


@dataclass(frozen=True, eq=False, kw_only=True)
class DriveContext:
    """Arrays of one drive, or of several end to end: a row per participant, a column per state.

    ``spans`` are the columns of each drive, ``steps`` the recording's time step of each column. The
    rows are the participants that are ever relevant or in sight, NaN in drives in which they never
    are. ``ego`` and ``ego_extents`` have one row; ``ego`` has one participant per drive, and its
    ``rows`` refer to the ``own`` surroundings, which contain its whole track.

    ``relevant``: whether a participant counts for ego. ``in_sight``: whether it is on ego's lanes
    and so near that ego could reach it within ``catching_up_s``. ``lanes_there``: the set of lanes
    that exist at its place. ``lanes_within``: the sets of those lanes that it reaches into, as
    measured, and moved farther out and farther in by the tolerance of places. ``elsewhere``:
    whether it drives on lanelets of another road. ``surroundings`` are the recording's; if each
    drive has its own, ``alone`` returns them by the drive's number, with ego's row in them.
    ``wrong_way``: whether ego drives against the road. ``computed`` holds the results of functions
    wrapped in ``once``.
    """

    recording: Recording
    thresholds: Thresholds
    side: Side
    road: DrivenRoad
    spans: EndToEnd
    steps: NDArray[intp]
    own: Surroundings
    ego: Tracks
    ego_extents: RoadExtents
    tracks: Tracks
    extents: RoadExtents
    relevant: Flags
    in_sight: Flags
    lanes_there: LaneSets
    lanes_within: tuple[LaneSets, ...]
    elsewhere: Flags
    surroundings: Surroundings
    alone: Callable[[int], tuple[Surroundings, int]] | None = None
    wrong_way: bool = False
    computed: dict[Callable[..., object], Any] = field(default_factory=dict)

    @cached_property
    def tolerances(self) -> Tolerances:
        """The errors of places and speeds in this source."""
        return self.surroundings.tolerances

    @cached_property
    def ids(self) -> tuple[str, ...]:
        """The participants' ids, by row."""
        return tuple(body.id for body in self.tracks.participants)

    @cached_property
    def states(self) -> int:
        """The number of states."""
        return self.spans.n_states

    @cached_property
    def columns(self) -> NDArray[intp]:
        """The states' columns in arrays of the whole recording."""
        return self.steps - self.surroundings.tracks.first

    def steps_in(self, seconds: float) -> int:
        """The number of time steps in some time (s)."""
        return round(seconds / self.recording.step_s)

    @cached_property
    def ego_moves(self) -> Flags:
        """Mask of states in which ego moves."""
        drives: Flags = self.ego.speed[0] * KMH_PER_MPS >= self.thresholds.standing_kmh
        return drives

    @cached_property
    def moving(self) -> Flags:
        """Mask of participants that move."""
        moves: Flags = self.tracks.speed * KMH_PER_MPS >= self.thresholds.standing_kmh
        return moves

    @cached_property
    def standing(self) -> Flags:
        """Mask of participants that stand."""
        stand: Flags = self.tracks.speed * KMH_PER_MPS < self.thresholds.standing_kmh
        return stand

    @property
    def first_column(self) -> int:
        """The column of the first state."""
        return int(self.columns[0])

    @property
    def is_one(self) -> bool:
        """Whether this is a single drive whose ``surroundings`` contain all that concerns it."""
        return self.spans.n_drives == 1 and self.alone is None

    def one(self, number: int) -> DriveContext:
        """One of the drives by itself, with the same rows."""
        return self if self.is_one else self._one(number)

    @kept
    def _one(self, number: int) -> DriveContext:
        columns, rows = self.spans.slices[number], np.arange(len(self.relevant))
        surroundings, row = self.surroundings, int(self.ego.rows[number])
        if self.alone is not None:
            surroundings, row = self.alone(number)
        own = self.ego.part(np.zeros(1, dtype=intp), columns)
        return replace(
            self,
            spans=EndToEnd.of_one(columns.stop - columns.start),
            steps=self.steps[columns],
            own=surroundings,
            ego=own.seen_as(
                self.ego.participants[number : number + 1],
                surroundings.tracks.types,
                np.array([row]),
            ),
            ego_extents=self.ego_extents.part(np.zeros(1, dtype=intp), columns),
            tracks=self.tracks.part(rows, columns),
            extents=self.extents.part(rows, columns),
            lanes_within=tuple(sets[:, columns] for sets in self.lanes_within),
            surroundings=surroundings,
            alone=None,
            computed={},
            **{name: getattr(self, name)[:, columns] for name in _OF_STATES},
        )

    def ego_is(self, kind: str) -> Flags:
        """Mask of the states in which ego has an object type or one of its subtypes."""
        flags: Flags = self.spans.spread(self.ego.of_type(kind))
        return flags

    @cached_property
    def ego_lane(self) -> NDArray[intp]:
        """The lane of ego's middle by state, from the right; the nearest if it does not exist."""
        lane: NDArray[intp] = self.ego_extents.lane[0]
        lanes = np.arange(self.existing_lanes.shape[1])
        away = np.where(self.existing_lanes, abs(lanes - lane[:, None]), len(lanes))
        return np.where(self.existing_lanes.any(axis=1), away.argmin(axis=1), lane)

    @cached_property
    def limit_mps(self) -> Floats:
        """The speed limit in the lane of ego's middle by state; infinity where the map has none.

        Where the limit at ego's front is higher, that one: past a sign, drivers speed up by then.
        """
        front = self.places_at(self.ego_extents.s_max[0], self.ego_lane)
        own, ahead = (self._limits_at(*places) for places in (self.ego_places, front))
        return np.where(np.isfinite(ahead), np.maximum(own, ahead), own)

    @cached_property
    def limit_untold(self) -> Flags:
        """Mask of states in which a sign may limit ego's speed, and the map does not tell how."""
        front = self.places_at(self.ego_extents.s_max[0], self.ego_lane)
        untold = [
            np.array([self.road.limit_is_untold(*place) for place in places], dtype=bool)[number]
            for places, number in (self.ego_places, front)
        ]
        either: Flags = untold[0] | untold[1]
        return either

    def _limits_at(self, places: tuple[tuple[int, int], ...], number: NDArray[intp]) -> Floats:
        turned = np.radians(self.thresholds.turned_deg)
        limits = [self.road.limit_mps(*place, turned) for place in places]
        return np.array([np.inf if limit is None else limit for limit in limits])[number]

    @cached_property
    def ego_places(self) -> tuple[tuple[tuple[int, int], ...], NDArray[intp]]:
        """The distinct (piece, lane) pairs of ego's middle, and by state the pair's index."""
        return self.places_at(self.ego_extents.s[0], self.ego_lane)

    def places_at(
        self, middle: Floats, lanes: NDArray[intp]
    ) -> tuple[tuple[tuple[int, int], ...], NDArray[intp]]:
        """The distinct (piece, lane) pairs at places along the road; by state the pair's index."""
        width = self.existing_lanes.shape[1]
        codes = self.road.piece(middle) * width + lanes
        different = np.unique(codes)
        places = tuple([divmod(code, width) for code in different.tolist()])
        return places, different.searchsorted(codes)

    @cached_property
    def route_known_until(self) -> Floats:
        """Up to where (m) along the road ego's route is known, by state of its drive.

        To the first fork of ego's lane that its drive does not reach; infinity without one.
        """
        last = self.spans.begins + self.spans.lengths - 1
        middle, lanes = self.ego_extents.s[0, last], self.ego_lane[last]
        places, number = self.places_at(middle, lanes)
        ends = np.array([self._next_fork(*place) for place in places])[number]
        return self.spans.spread(ends)

    def _next_fork(self, piece: int, lane: int) -> float:
        if not self.wrong_way:
            for own in range(piece, len(self.road.rows)):
                here = self.road.lanelet(own, lane)
                if len(ways_on(self.recording.lanelets, here)) > 1:
                    return float(self.road.borders[own + 1])
        return np.inf

    @cached_property
    def existing_lanes(self) -> Flags:
        """Mask of the lanes (second axis) that exist beside ego, by state."""
        return self.road.lanes.existing_at(self.ego_extents.s[0])

    @cached_property
    def lane_edges(self) -> tuple[NDArray[intp], NDArray[intp]]:
        """The numbers of the first and the last lane bound beside ego, by state."""
        return edges(self.existing_lanes)

    @cached_property
    def steady_lane(self) -> NDArray[intp]:
        """Ego's lane with hysteresis: ego leaves a lane only ``changed_m`` beyond its mark."""
        changes = self.spans.changes(self.ego_lane)
        if not changes.any():
            return self.ego_lane
        steady: NDArray[intp] = self.ego_lane.copy()
        for _, columns in self.spans.those(self.spans.any(changes)):
            self._keep_lanes(steady, columns, int(steady[columns.start]))
        return steady

    @cached_property
    def steady_lane_from_beside(self) -> NDArray[intp]:
        """``steady_lane``, assuming that ego, if near a mark at first, had just crossed it."""
        begins = self.spans.begins
        near = self._stays[begins]
        near[np.arange(len(begins)), self.ego_lane[begins]] = False
        if not near.any():
            return self.steady_lane
        steady: NDArray[intp] = self.steady_lane.copy()
        for number in near.any(axis=1).nonzero()[0].tolist():
            self._keep_lanes(steady, self.spans.slices[number], int(near[number].argmax()))
        return steady

    @cached_property
    def _stays(self) -> Flags:
        """Mask of the lanes (second axis) that ego, if it came from there, has not left yet."""
        left_of = self.ego_extents.left_of[0]
        beyond = np.maximum(-left_of[:, :-1], left_of[:, 1:])
        stays: Flags = (beyond < self.thresholds.changed_m) & self.existing_lanes
        return stays

    @cached_property
    def _leaves(self) -> NDArray[intp]:
        """For each lane and state the first state from there on in which ego has left the lane."""
        others = self.ego_lane[:, None] != np.arange(self.existing_lanes.shape[1])
        leaves: NDArray[intp] = self.spans.next_state((others & ~self._stays).T)
        return leaves

    def _keep_lanes(self, steady: NDArray[intp], columns: slice, own: int) -> None:
        """Write the lanes that ego keeps in a drive that begins in lane ``own``."""
        state, last = columns.start, columns.stop - 1
        while state <= last:
            end = int(self._leaves[own, state + 1]) if state < last else columns.stop
            steady[state:end], state = own, end
            own = int(self.ego_lane[min(end, last)])

    @cached_property
    def going_along(self) -> Flags:
        """Mask of participants that are vehicles driving ego's way on its lanes."""
        return self.relevant & self.driving_along

    @cached_property
    def driving_along(self) -> Flags:
        """``going_along`` for all vehicles in sight, however far away."""
        drives = self.tracks.of_type("vehicle")[:, None]
        turned = abs(self.extents.turned)
        return self.in_sight & drives & (turned < 1.0) & self.on_lanes

    @cached_property
    def there(self) -> Flags:
        """Mask of the lanes (last axis) that exist where participants are."""
        lanes = range(self.existing_lanes.shape[1])
        return np.moveaxis(np.stack([is_in(self.lanes_there, lane) for lane in lanes]), 0, -1)

    @cached_property
    def on_lanes(self) -> Flags:
        """Mask of participants that reach into some lane of the road."""
        flags: Flags = self.lanes_within[0] != 0
        return flags

    @cached_property
    def in_ego_lane(self) -> Flags:
        """Mask of participants that reach into ego's lane."""
        return self.in_lane(self.ego_lane)

    def in_lane(self, lane: NDArray[intp] | int) -> Flags:
        """Mask of participants that reach into a lane, given by state or for all states."""
        return is_in(self.lanes_within[0], lane)

    @cached_property
    def map_offset_m(self) -> Floats:
        """How far (m) left of the middle of their lanes others drive, by state, if enough do so.

        The median over at least ``_ENOUGH_IN_LANE`` vehicles in ego's lane there, or else over at
        least ``_ENOUGH_TRACKS`` in all lanes; 0 if not above ``_LEAST_OFFSET_M``. Drivers on the
        whole keep to the middle, so the map may be displaced from the tracks by this much.
        """
        by_state = np.zeros(self.states)
        cells = Cells.at(self.driving_along)
        rows, columns = cells.rows, cells.columns
        lane, drive = cells.of(self.extents.lane), self.spans.number[columns]
        away = cells.of(self.extents.off_middle)
        of_all: Floats | None = None
        for number in np.unique(self.ego_lane).tolist():
            inside = (lane == number).nonzero()[0]
            offset, count = self._offsets(rows[inside], drive[inside], away[inside])
            if (count < _ENOUGH_IN_LANE).any() and of_all is None:
                offset_of_all, tracks = self._offsets(rows, drive, away)
                of_all = np.where(tracks >= _ENOUGH_TRACKS, offset_of_all, 0.0)
            if of_all is not None:
                offset = np.where(count >= _ENOUGH_IN_LANE, offset, of_all)
            here = self.ego_lane == number
            by_state[here] = offset[self.spans.number[here]]
        return np.where(np.abs(by_state) > _LEAST_OFFSET_M, by_state, 0.0)

    def _offsets(
        self, rows: NDArray[intp], drive: NDArray[intp], away: Floats
    ) -> tuple[Floats, NDArray[intp]]:
        """For each drive the median of the participants' medians, and how many these are."""
        n_drives = self.spans.n_drives
        own, count = medians(rows * n_drives + drive, away, len(self.relevant) * n_drives)
        of_drive = np.arange(len(own)) % n_drives
        there = count > 0
        return medians(of_drive[there], own[there], n_drives)

    @cached_property
    def stays(self) -> Flags:
        """Mask of participants that stand for as long as they are recorded, by row."""
        return self.surroundings.stays[self.tracks.rows]
