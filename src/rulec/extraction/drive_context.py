"""One drive, state by state: ego, its road and the other participants."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, wraps
from typing import TypeVar, cast

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.source_tolerances import Tolerances
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_extents import RoadExtents, any_lane, part_of
from rulec.extraction.tracks.road_places import KMH as KMH
from rulec.extraction.tracks.road_places import RoadPlaces
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.extraction.tracks.tracks import Flags, Floats, Tracks
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.recording import Recording, Side
from rulec.trace.plain_arrays import distinct, median

_ENOUGH_TRACKS = 10
_ENOUGH_IN_LANE = 3
_LEAST_OFFSET_M = 0.15


@dataclass(frozen=True, eq=False, kw_only=True)
class DriveContext:
    """Arrays of one drive: a row per participant, a column per state.

    The rows are the participants that are ever relevant or in sight; ``ego`` and ``ego_extents``
    have one. ``relevant``: whether a participant counts for ego; ``in_sight``: is it on ego's
    lanes, so near that ego could reach it within ``catching_up_s``? ``there``: the lanes that exist
    where it is, a third axis, ``touched``: those of them that it reaches into; ``elsewhere``: does
    it drive on lanelets of another road? ``surroundings`` are the recording's. ``computed`` holds
    what functions have found ``once``.
    """

    recording: Recording
    thresholds: Thresholds
    side: Side
    road: DrivenRoad
    ego: Tracks
    ego_extents: RoadExtents
    tracks: Tracks
    extents: RoadExtents
    relevant: Flags
    in_sight: Flags
    there: Flags
    touched: Flags
    elsewhere: Flags
    surroundings: Surroundings
    computed: dict[Callable[..., object], object] = field(default_factory=dict)

    @cached_property
    def tolerances(self) -> Tolerances:
        """How well the source knows places and speeds."""
        return self.surroundings.tolerances

    @cached_property
    def states(self) -> int:
        """The number of states of the drive."""
        return int(self.ego_extents.s.shape[1])

    @cached_property
    def first_step(self) -> int:
        """The recording's time step of the first state."""
        return self.ego.first

    @cached_property
    def ego_lane(self) -> NDArray[intp]:
        """The lane of ego's middle by state, numbered from the right, or the nearest that is."""
        lane: NDArray[intp] = self.ego_extents.lane[0]
        lanes = np.arange(self.existing_lanes.shape[1])
        away = np.where(self.existing_lanes, abs(lanes - lane[:, None]), len(lanes))
        return np.where(self.existing_lanes.any(axis=1), away.argmin(axis=1), lane)

    @cached_property
    def limit_mps(self) -> Floats:
        """The limit of the lane of ego's middle by state, infinity if the map tells none there."""
        pieces = self.road.piece(self.ego_extents.s[0]).tolist()
        places = list(zip(pieces, self.ego_lane.tolist(), strict=True))
        turned = np.radians(self.thresholds.turned_deg)
        limits = {place: self.road.limit_mps(*place, turned) for place in set(places)}
        known = {place: np.inf if limit is None else limit for place, limit in limits.items()}
        return np.array([known[place] for place in places])

    @cached_property
    def existing_lanes(self) -> Flags:
        """Flags of the lanes (second axis) that exist beside ego, by state."""
        return self.road.lanes.existing_at(self.ego_extents.s[0])

    @cached_property
    def steady_lane(self) -> NDArray[intp]:
        """Ego's lane with hysteresis: it is left only ``changed_m`` beyond its mark."""
        if not np.diff(self.ego_lane).any():
            return self.ego_lane
        lane, left_of = self.ego_lane.tolist(), self.ego_extents.left_of[0].tolist()
        for state in range(1, len(lane)):
            before = lane[state - 1]
            beyond = max(-left_of[state][before], left_of[state][before + 1])
            if beyond < self.thresholds.changed_m and self.existing_lanes[state, before]:
                lane[state] = before
        return np.array(lane)

    @cached_property
    def going_along(self) -> Flags:
        """Flags of participants that are vehicles going ego's way on its lanes."""
        return self.relevant & self.driving_along

    @cached_property
    def driving_along(self) -> Flags:
        """The same of those in sight, however far away."""
        drives = self.tracks.of_type("vehicle")[:, None]
        turned = abs(self.extents.turned)
        return self.in_sight & drives & (turned < 1.0) & self.on_lanes

    @cached_property
    def on_lanes(self) -> Flags:
        """Flags of who reaches into a lane of the road."""
        return any_lane(self.touched)

    @cached_property
    def map_offset_m(self) -> Floats:
        """How far (m) left of their lanes' middles others drive, by state, if that is telling.

        The median of ``_ENOUGH_IN_LANE`` vehicles or more in ego's lane there, or else of
        ``_ENOUGH_TRACKS`` in all lanes, 0 up to ``_LEAST_OFFSET_M``. Drivers keep to the middle on
        the whole: by so much the map may be off the tracks.
        """
        rows = self.driving_along.any(axis=1).nonzero()[0]
        extents = self.extents.part(rows, slice(None))
        lane = extents.lane
        away = np.add(*extents.from_middle(lane)) / 2
        away = np.where(self.driving_along[rows], away, np.nan)
        by_state = np.zeros(self.states)
        for number in distinct(self.ego_lane).tolist():
            inside = np.where(lane == number, away, np.nan)
            inside = inside[~np.isnan(inside).all(axis=1)]
            enough = len(inside) >= _ENOUGH_IN_LANE
            by_state[self.ego_lane == number] = (
                _telling(inside, _ENOUGH_IN_LANE) if enough else _telling(away, _ENOUGH_TRACKS)
            )
        return by_state

    def zero_if_standing(self, speed_kmh: Floats) -> Floats:
        """Speeds (km/h), exactly 0 below the threshold of standing."""
        return speed_kmh * (abs(speed_kmh) >= self.thresholds.standing_kmh)


Found = TypeVar("Found")


def once(compute: Callable[[DriveContext], Found]) -> Callable[[DriveContext], Found]:
    """Let a function of a drive's context compute what it does once for each drive.

    What it finds is shared: nobody changes it.
    """

    @wraps(compute)
    def found(context: DriveContext) -> Found:
        if compute not in context.computed:
            context.computed[compute] = compute(context)
        return cast("Found", context.computed[compute])

    return found


def _telling(away: Floats, enough: int) -> float:
    """The median of rows' medians, 0 if there are too few or it is next to nothing."""
    if len(away) < enough:
        return 0.0
    offset = median(_medians(away))
    return offset if abs(offset) > _LEAST_OFFSET_M else 0.0


def _medians(rows: Floats) -> Floats:
    """The median of the numbers in each row, of which there is one at least, beside NaN."""
    ascending = np.sort(rows, axis=1)
    count, number = np.sum(~np.isnan(rows), axis=1), np.arange(len(rows))
    medians: Floats = (ascending[number, (count - 1) // 2] + ascending[number, count // 2]) / 2
    return medians


def drive_context(
    surroundings: Surroundings, places: RoadPlaces, side: Side, ego: int, columns: slice
) -> DriveContext:
    """The part of a recording that one drive is about: ``ego``'s row, in a range of columns."""
    relevant, in_sight = _near(ego, places, columns)
    rows = (relevant | in_sight).any(axis=1).nonzero()[0]
    own = np.array([ego])
    return DriveContext(
        recording=surroundings.recording,
        thresholds=places.thresholds,
        side=side,
        road=places.road,
        ego=places.tracks.part(own, columns),
        ego_extents=places.extents.part(own, columns),
        tracks=places.tracks.part(rows, columns),
        extents=places.extents.part(rows, columns),
        relevant=relevant[rows],
        in_sight=in_sight[rows],
        there=part_of(places.there, rows, columns),
        touched=part_of(places.touched, rows, columns),
        elsewhere=places.elsewhere[rows, columns],
        surroundings=surroundings,
    )


def _near(ego: int, places: RoadPlaces, columns: slice) -> tuple[Flags, Flags]:
    """Flags of participants (rows) that count for ego, and that are in its sight, by step."""
    limits, extents = places.thresholds, places.extents
    s_min, s_max, along = (x[:, columns] for x in (extents.s_min, extents.s_max, extents.along))
    gap = np.maximum(s_min - s_max[ego], s_min[ego] - s_max)
    # A little farther, since speeds are known to some tolerance
    reach = np.maximum(along[ego] - along + 1.0, 0.0) * limits.catching_up_s
    relevant = places.counts[:, columns] & (gap <= limits.near_m) & ~np.isnan(s_min[ego])
    in_sight = places.seen[:, columns] & (gap <= np.maximum(limits.near_m, reach))
    relevant[ego] = in_sight[ego] = False
    return relevant, in_sight
