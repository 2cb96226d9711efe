"""Everybody beside one road: what is the same for all who drive along it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.lane_sets import LaneSets, lane_sets, lanes_touched
from rulec.extraction.tracks.road_extents import RoadExtents, and_row
from rulec.extraction.tracks.tracks import Flags, Floats, Tracks
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.trace.cells import Cells

KMH = 3.6
"""km/h in one m/s."""

_ACROSS = np.pi / 4
"""The angle to the road from which on who comes from another one drives across."""

_PIECES_M = 20.0
"""Feet are looked for on whole pieces of a line, of 5 m at most."""

_SOME_TIMES = 32
"""One of so many times is looked at first."""

_SOON_S = 2.0
"""So long before it comes near to a road one is looked at, longer than somebody may be away."""

_ONCOMING_COSINE = -0.7
"""The cosine of the angle to the road from which on a vehicle counts as coming towards ego."""


@dataclass(frozen=True, eq=False)
class RoadPlaces:
    """The places of participants on a road, a row each, by step.

    ``elsewhere``: who drives on lanelets that are not of the road. ``fastest`` is each one's
    greatest speed (m/s) in all of the recording.
    """

    road: DrivenRoad
    tracks: Tracks
    extents: RoadExtents
    thresholds: Thresholds
    elsewhere: Flags
    fastest: Floats

    def and_one(self, other: RoadPlaces, row: int, tracks: Tracks) -> RoadPlaces:
        """These, and behind them a row of others on the road; ``tracks`` has all of them."""
        joined = replace(
            self,
            tracks=tracks,
            extents=self.extents.and_one(other.extents, row),
            elsewhere=and_row(self.elsewhere, other.elsewhere, row),
            fastest=and_row(self.fastest, other.fastest, row),
        )
        # What is known of each need not be derived again
        for name in ("lanes_there", "touched", "on_lanes", "crosses", "counts", "seen"):
            joined.__dict__[name] = and_row(getattr(self, name), getattr(other, name), row)
        for place_m, own in self._lanes_within.items():
            both = zip(own, other.lanes_within(place_m), strict=True)
            joined._lanes_within[place_m] = tuple(and_row(*sets, row) for sets in both)
        for name in ("s", "lane", "lane_steps"):
            values = getattr(self.extents, name), getattr(other.extents, name)
            joined.extents.__dict__[name] = and_row(*values, row)
        return joined

    @cached_property
    def there(self) -> Flags:
        """Flags of the lanes (last axis) that exist where participants are."""
        return self.road.lanes.existing_at(self.extents.s)

    @cached_property
    def lanes_there(self) -> LaneSets:
        """The sets of the lanes that exist where participants are."""
        lanes = self.road.lanes
        return lane_sets(lanes.there)[lanes.pieces_at(self.extents.s)]

    @cached_property
    def touched(self) -> LaneSets:
        """The sets of the lanes that participants reach into."""
        (sets,) = lanes_touched(self.extents, self.lanes_there, (self.thresholds.touching_m,))
        return sets

    def lanes_within(self, place_m: float) -> tuple[LaneSets, ...]:
        """The sets of those lanes, and of those with all so much (m) less far and farther in them.

        Across a lane's bounds each of a body's sides counts by itself.
        """
        if place_m not in self._lanes_within:
            reach = self.thresholds.touching_m
            least = reach + place_m, reach - place_m
            others = lanes_touched(self.extents, self.lanes_there, least)
            self._lanes_within[place_m] = self.touched, *others
        return self._lanes_within[place_m]

    @cached_property
    def _lanes_within(self) -> dict[float, tuple[LaneSets, ...]]:
        return {}

    @cached_property
    def on_lanes(self) -> Flags:
        """Flags of who reaches into any."""
        flags: Flags = self.touched != 0
        return flags

    @cached_property
    def counts(self) -> Flags:
        """Flags of who counts for one that is near.

        On the lanes everybody does; beside them only vulnerable road users, and oncoming vehicles
        that move at some time.
        """
        beside = self.thresholds.beside_road_m
        close = (self.extents.left_of_max[..., 0] > -beside) & (
            self.extents.left_of_min[..., -1] < beside
        )
        flags: Flags = close & self.tracks.of_type("vulnerable_user")[:, None]
        moves = self.fastest * KMH >= self.thresholds.standing_kmh
        others = Cells.at(close & moves[:, None] & ~flags & ~self.on_lanes)
        flags.ravel()[others.places] = np.cos(others.of(self.extents.turned)) < _ONCOMING_COSINE
        flags |= self.on_lanes
        flags &= ~self.crosses
        return flags

    @cached_property
    def crosses(self) -> Flags:
        """Flags of cross traffic: vehicles that drive on another road, and across this one."""
        cells = Cells.at(self.elsewhere & self.tracks.of_type("vehicle")[:, None])
        turned = np.abs(cells.of(self.extents.turned))
        return cells.laid((turned > _ACROSS) & (turned < np.pi - _ACROSS))

    @cached_property
    def seen(self) -> Flags:
        """Flags of who is in sight of one that is near enough."""
        return self.on_lanes & ~self.crosses


def rows_in_reach(
    tracks: Tracks, road: DrivenRoad, ego: int, columns: slice, limits: Thresholds
) -> Flags:
    """Flags of those of all tracks that may count for, or be in sight of, ego on a road.

    They are so near some time in a range of columns, as the crow flies, were they as fast as they
    ever are: somebody's feet on the road are no farther apart than its outline is large, and ego's
    no farther off than `are_on_road`.
    """
    # As the gap between them that counts, measured along the road, where nobody is known to turn
    along = np.maximum(
        limits.near_m, (tracks.fastest + tracks.fastest[ego] + 1.0) * limits.catching_up_s
    )
    off = 2 * _farthest_off(road, limits) + _PIECES_M + tracks.reaches + tracks.reaches[ego]
    squares = (along + off) ** 2
    flags = np.zeros(len(squares), dtype=bool)
    flags[ego] = True
    # Most of those who are so near some time are so at one of a few times already
    for step in (_SOME_TIMES, 1):
        rows, times = (~flags).nonzero()[0], slice(columns.start, columns.stop, step)
        away = tracks.x[rows, times] - tracks.x[ego, times]
        aside = tracks.y[rows, times] - tracks.y[ego, times]
        away *= away
        aside *= aside
        away += aside
        flags[rows] = (away <= squares[rows, None]).any(axis=1)
    return flags


def near_road(
    tracks: Tracks,
    road: DrivenRoad,
    at: tuple[NDArray[intp], slice],
    limits: Thresholds,
    step_s: float,
) -> Flags:
    """Flags of where participants, some rows and columns, are so near a road that they may count.

    Or will so soon, or did shortly before: nobody who counts is absent in between.
    """
    reach = float(tracks.reaches.max(initial=0.0)) + _PIECES_M
    fastest = float(tracks.fastest.max(initial=0.0))
    beyond = max(limits.near_m, (2 * fastest + 1.0) * limits.catching_up_s) + reach
    around = road.line.surroundings(_farthest_off(road, limits) + reach, beyond)
    near = around.holds(tracks.x[at], tracks.y[at])
    if np.array_equal(near, tracks.present[at]):
        return near
    soon = int((limits.away_s + _SOON_S) / step_s) + 1
    counts = np.pad(near, ((0, 0), (soon + 1, soon))).cumsum(axis=1, dtype=np.int32)
    flags: Flags = counts[:, 2 * soon + 1 :] > counts[:, : -2 * soon - 1]
    return flags


def are_on_road(
    extents: RoadExtents, road: DrivenRoad, egos: NDArray[intp], limits: Thresholds
) -> bool:
    """Whether rows are never farther off a road than who counts on it, wherever they are known."""
    ends = extents.d_min[egos], extents.d_max[egos]
    return not any((np.abs(end) > _farthest_off(road, limits)).any() for end in ends)


def _farthest_off(road: DrivenRoad, limits: Thresholds) -> float:
    """How far (m) from the road's line a part of a body may be that counts, and more."""
    return float(np.abs(road.lanes.bounds).max()) + limits.beside_road_m
