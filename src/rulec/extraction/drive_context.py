"""One drive, state by state: ego, its road and the other participants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_extents import RoadExtents, lanes_touched
from rulec.extraction.tracks.tracks import Flags, Floats, Tracks
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.scenario.recorded.recording import Recording, Side

KMH = 3.6
"""km/h in one m/s."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class DriveContext:
    """Arrays of one drive: a row per participant, a column per state.

    The rows are the participants that are ever relevant.

    ``extents`` and ``tracks`` have these rows; ``ego`` and ``ego_extents`` have one. ``relevant``:
    whether a participant counts for ego; ``touched``: the lanes that it reaches into, a third axis;
    ``on_lane`` and ``on_crosswalk``: whether a vulnerable road user is on one of the map.
    """

    recording: Recording
    thresholds: Thresholds
    side: Side
    road: DrivenRoad
    first_step: int
    ego: Tracks
    ego_extents: RoadExtents
    tracks: Tracks
    extents: RoadExtents
    relevant: Flags
    touched: Flags
    on_lane: Flags
    on_crosswalk: Flags

    @property
    def states(self) -> int:
        """The number of states of the drive."""
        return int(self.ego_extents.s.shape[1])

    @property
    def ego_lane(self) -> NDArray[intp]:
        """The lane of ego's middle by state, numbered from the right."""
        lane: NDArray[intp] = self.road.lane_of(self.ego_extents.w)[0]
        return lane

    @property
    def going_along(self) -> Flags:
        """Flags of participants that are vehicles going ego's way on its lanes."""
        drives = self.tracks.of_type("vehicle")[:, None]
        turned = abs(self.extents.turned)
        return self.relevant & drives & (turned < 1.0) & self.touched.any(axis=-1)

    def speeds(self) -> Floats:
        """The participants' speeds along the road (km/h), 0 for those that stand."""
        return zero_if_standing(self.extents.along * KMH, self.thresholds)


def zero_if_standing(speed_kmh: Floats, thresholds: Thresholds) -> Floats:
    """Speeds (km/h), exactly 0 below the threshold of standing."""
    standing = abs(speed_kmh) < thresholds.standing_kmh
    speeds: Floats = speed_kmh * ~standing
    return speeds


def drive_context(
    *,
    recording: Recording,
    thresholds: Thresholds,
    side: Side,
    road: DrivenRoad,
    tracks: Tracks,
    extents: RoadExtents,
    relevant: Flags,
    on_lane: Flags,
    on_crosswalk: Flags,
    ego: int,
    columns: tuple[int, int],
) -> DriveContext:
    """The part of a recording that one drive is about.

    ``ego`` is a row of the arrays; ``columns`` are the first and the last one of the drive.
    """
    span = slice(columns[0], columns[1] + 1)
    rows = relevant[:, span].any(axis=1).nonzero()[0]
    own_extents = extents.part(rows, span)
    return DriveContext(
        recording=recording,
        thresholds=thresholds,
        side=side,
        road=road,
        first_step=tracks.first + columns[0],
        ego=tracks.part(np.array([ego]), span),
        ego_extents=extents.part(np.array([ego]), span),
        tracks=tracks.part(rows, span),
        extents=own_extents,
        relevant=relevant[rows, span],
        touched=lanes_touched(own_extents, road, thresholds),
        on_lane=on_lane[rows, span],
        on_crosswalk=on_crosswalk[rows, span],
    )
