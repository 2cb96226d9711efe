"""One drive, state by state: ego, its road and the other participants."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.source_tolerances import Tolerances, tolerances_of
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_extents import RoadExtents, lanes_touched
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.extraction.tracks.tracks import Flags, Floats, Tracks
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.recording import Recording, Side

KMH = 3.6
"""km/h in one m/s."""

_ACROSS = np.pi / 4
"""The angle to the road from which on who comes from another one drives across."""

_ENOUGH_TRACKS = 10
_ENOUGH_IN_LANE = 3
_LEAST_OFFSET_M = 0.15

_ONCOMING_COSINE = -0.7
"""The cosine of the angle to the road from which on a vehicle counts as coming towards ego."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DriveContext:
    """Arrays of one drive: a row per participant, a column per state.

    The rows are the participants that are ever relevant or in sight; ``ego`` and ``ego_extents``
    have one. ``relevant``: whether a participant counts for ego; ``in_sight``: is it on ego's
    lanes, so near that ego could reach it within ``catching_up_s``? ``touched``: the lanes that it
    reaches into, a third axis; ``elsewhere``: does it drive on lanelets of another road?
    ``surroundings`` are the recording's.
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
    touched: Flags
    elsewhere: Flags
    surroundings: Surroundings

    @cached_property
    def tolerances(self) -> Tolerances:
        """How well the source knows places and speeds."""
        return tolerances_of(self.recording)

    @property
    def states(self) -> int:
        """The number of states of the drive."""
        return int(self.ego_extents.s.shape[1])

    @property
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
        at = zip(pieces, self.ego_lane.tolist(), strict=True)
        turned = np.radians(self.thresholds.turned_deg)
        limits = [self.road.limit_mps(piece, lane, turned) for piece, lane in at]
        return np.array([np.inf if limit is None else limit for limit in limits])

    @cached_property
    def existing_lanes(self) -> Flags:
        """Flags of the lanes (second axis) that exist beside ego, by state."""
        return self.road.lanes.existing_at(self.ego_extents.s[0])

    @cached_property
    def steady_lane(self) -> NDArray[intp]:
        """Ego's lane with hysteresis: it is left only ``changed_m`` beyond its mark."""
        lane, left_of = np.array(self.ego_lane), self.ego_extents.left_of[0]
        for state in range(1, len(lane)):
            before = lane[state - 1]
            beyond = max(-left_of[state, before], left_of[state, before + 1])
            if beyond < self.thresholds.changed_m and self.existing_lanes[state, before]:
                lane[state] = before
        return lane

    @cached_property
    def going_along(self) -> Flags:
        """Flags of participants that are vehicles going ego's way on its lanes."""
        return self.relevant & self.driving_along

    @cached_property
    def driving_along(self) -> Flags:
        """The same of those in sight, however far away."""
        drives = self.tracks.of_type("vehicle")[:, None]
        turned = abs(self.extents.turned)
        return self.in_sight & drives & (turned < 1.0) & self.touched.any(axis=-1)

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
        offsets = np.full(self.road.lanes.there.shape[1], _telling(away, _ENOUGH_TRACKS))
        for number in range(len(offsets)):
            inside = np.where(lane == number, away, np.nan)
            inside = inside[~np.isnan(inside).all(axis=1)]
            if len(inside) >= _ENOUGH_IN_LANE:
                offsets[number] = _telling(inside, _ENOUGH_IN_LANE)
        by_state: Floats = offsets[self.ego_lane]
        return by_state

    def zero_if_standing(self, speed_kmh: Floats) -> Floats:
        """Speeds (km/h), exactly 0 below the threshold of standing."""
        return speed_kmh * (abs(speed_kmh) >= self.thresholds.standing_kmh)


def _telling(away: Floats, enough: int) -> float:
    """The median of rows' medians, 0 if there are too few or it is next to nothing."""
    if len(away) < enough:
        return 0.0
    offset = float(np.median(np.nanmedian(away, axis=1)))
    return offset if abs(offset) > _LEAST_OFFSET_M else 0.0


def drive_context(
    recording: Recording,
    road: DrivenRoad,
    side: Side,
    thresholds: Thresholds,
    *,
    tracks: Tracks,
    extents: RoadExtents,
    surroundings: Surroundings,
    ego: int,
    columns: slice,
    elsewhere: Flags | None = None,
) -> DriveContext:
    """The part of a recording that one drive is about: ``ego``'s row, in a range of columns.

    ``elsewhere``: who drives on lanelets that are not of the road, if anybody is matched to any.
    """
    near = _near(ego, tracks, extents, road, thresholds)
    if elsewhere is None:
        elsewhere = np.zeros(tracks.present.shape, dtype=bool)
    near = {name: flags & ~_crosses(tracks, extents, elsewhere) for name, flags in near.items()}
    near = {name: flags[:, columns] for name, flags in near.items()}
    rows = np.any([flags.any(axis=1) for flags in near.values()], axis=0).nonzero()[0]
    own, others = np.array([ego]), extents.part(rows, columns)
    return DriveContext(
        recording=recording,
        thresholds=thresholds,
        side=side,
        road=road,
        ego=tracks.part(own, columns),
        ego_extents=extents.part(own, columns),
        tracks=tracks.part(rows, columns),
        extents=others,
        relevant=near["relevant"][rows],
        in_sight=near["in_sight"][rows],
        touched=lanes_touched(others, road, thresholds.touching_m),
        elsewhere=elsewhere[rows, columns],
        surroundings=surroundings,
    )


def _crosses(tracks: Tracks, extents: RoadExtents, elsewhere: Flags) -> Flags:
    """Flags of cross traffic: vehicles that drive on another road, and across ego's."""
    turned = np.abs(np.nan_to_num(extents.turned))
    across = (turned > _ACROSS) & (turned < np.pi - _ACROSS)
    crosses: Flags = elsewhere & across & tracks.of_type("vehicle")[:, None]
    return crosses


def _near(
    ego: int, tracks: Tracks, extents: RoadExtents, road: DrivenRoad, thresholds: Thresholds
) -> dict[str, Flags]:
    """Flags of participants (rows) that count for ego, and that are in its sight, by step.

    On ego's lanes everything counts that is near; beside them only vulnerable road users, and
    oncoming vehicles that move at some time.
    """
    own = extents.of(ego)
    gap = np.maximum(extents.s_min - own.s_max, own.s_min - extents.s_max)
    on_lanes = lanes_touched(extents, road, thresholds.touching_m).any(axis=-1)
    beside = thresholds.beside_road_m
    close = (extents.left_of_max[..., 0] > -beside) & (extents.left_of_min[..., -1] < beside)
    vulnerable = tracks.of_type("vulnerable_user")
    fastest = np.nan_to_num(tracks.speed).max(axis=1, initial=0.0)
    moves = fastest * KMH >= thresholds.standing_kmh
    oncoming = (np.cos(extents.turned) < _ONCOMING_COSINE) & moves[:, None]
    counts = (gap <= thresholds.near_m) & (on_lanes | (close & (vulnerable[:, None] | oncoming)))
    # A little farther, since speeds are known to some tolerance
    reach = np.maximum(own.along - extents.along + 1.0, 0.0) * thresholds.catching_up_s
    near = {
        "relevant": counts & ~np.isnan(own.s_min),
        "in_sight": on_lanes & (gap <= np.maximum(thresholds.near_m, reach)),
    }
    for flags in near.values():
        flags[ego] = False
    return near
