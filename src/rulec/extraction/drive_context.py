"""One drive, from where words are found: ego, its road, and everybody on it, over its states."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.selection.traffic_thresholds import Thresholds
from rulec.extraction.signals.relations import lanes_touched
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.extraction.tracks.tracks import Flags, Floats, Tracks
from rulec.scenario.recorded.recording import Recording

Side = Literal["left", "right"]

KMH = 3.6


@dataclass(frozen=True, eq=False, slots=True)
class DriveContext:
    """Columns are the states of the drive; ``rows`` are those of everybody who is ever there.

    ``others`` and ``people`` have a row for each of them, ``near`` says when they are there for
    ego, ``touched`` in which of its lanes, ``in_the_road`` when they are on any lane and
    ``on_crosswalk`` on a pedestrian crossing.
    """

    recording: Recording
    thresholds: Thresholds
    side: Side
    road: DrivenRoad
    first_step: int
    ego: Tracks
    own: RoadExtents
    people: Tracks
    others: RoadExtents
    near: Flags
    touched: Flags
    in_the_road: Flags
    on_crosswalk: Flags

    @property
    def states(self) -> int:
        """How many states the drive has."""
        return int(self.own.s.shape[1])

    @property
    def lane(self) -> NDArray[intp]:
        """The number of ego's lane, from the right, by ego's middle."""
        lane: NDArray[intp] = self.road.lane_of(self.own.w)[0]
        return lane

    @property
    def with_ego(self) -> Flags:
        """Which vehicles go ego's way on its lanes?"""
        drives = self.people.of_kind("vehicle")[:, None]
        return self.near & drives & (abs(self.others.turned) < 1.0) & self.touched.any(axis=-1)

    def speeds(self) -> Floats:
        """Everybody's speed along the road (km/h), 0 of those who stand."""
        return zero_if_standing(self.others.along * KMH, self.thresholds)


def zero_if_standing(speed_kmh: Floats, thresholds: Thresholds) -> Floats:
    """Speeds, those of who stands made exactly 0."""
    still = abs(speed_kmh) < thresholds.standing_kmh
    rest: Floats = speed_kmh * ~still
    return rest


def drive_context(
    recording: Recording,
    thresholds: Thresholds,
    side: Side,
    road: DrivenRoad,
    everyone: Tracks,
    all_placed: RoadExtents,
    near: Flags,
    ground: tuple[Flags, Flags],
    ego: int,
    columns: tuple[int, int],
) -> DriveContext:
    """The part of a recording that one drive is about."""
    span = slice(columns[0], columns[1] + 1)
    rows = near[:, span].any(axis=1).nonzero()[0]
    others = _cut(all_placed, rows, span)
    return DriveContext(
        recording,
        thresholds,
        side,
        road,
        everyone.first + columns[0],
        everyone.part(np.array([ego]), span),
        _cut(all_placed, [ego], span),
        everyone.part(rows, span),
        others,
        near[rows, span],
        lanes_touched(others, road, thresholds),
        ground[0][rows, span],
        ground[1][rows, span],
    )


def _cut(all_placed: RoadExtents, rows: NDArray[intp] | list[int], span: slice) -> RoadExtents:
    return RoadExtents(
        *(getattr(all_placed, one.name)[rows][:, span] for one in fields(all_placed))
    )
