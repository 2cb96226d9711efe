"""All participants beside one road: what is the same for every ego that drives along it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.lane_sets import LaneSets, lane_sets, lanes_touched
from rulec.extraction.tracks.road_extents import RoadExtents, and_row
from rulec.extraction.tracks.tracks import Tracks
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.cells import Cells

_ACROSS = np.pi / 4
"""Traffic from another road drives across if its angle to the road is larger than this."""

_PIECES_M = 20.0
"""Allowance (m), since feet are searched on whole pieces of a line, of at most 5 m."""

_SOME_TIMES = 32
"""Only one state in this many is examined first."""

_SOON_S = 2.0
"""Participants count this long (s), in addition to ``away_s``, before they come near a road."""

_NEXT_TO_M = 2.0
"""Bodies on tracks, or in a bus bay, next to a lane are nearer to it than this (m)."""

_ALONG_COSINE = 0.9

_INDICATORS = frozenset({"left_indicator", "right_indicator"})

_ONCOMING_COSINE = -0.7
"""Cosine of the angle to the road beyond which a vehicle counts as oncoming."""


@dataclass(frozen=True, eq=False)
class RoadPlaces(KeepsResults):
    """The places of participants on a road, a row each, by step.

    ``elsewhere``: whether a participant drives on lanelets outside the road. ``in_traffic``:
    whether it moves in the whole recording, or stands there as nobody does that parks.
    """

    road: DrivenRoad
    tracks: Tracks
    extents: RoadExtents
    thresholds: Thresholds
    elsewhere: Flags
    in_traffic: Flags

    def and_one(self, other: RoadPlaces, row: int, tracks: Tracks) -> RoadPlaces:
        """These places, followed by one row of ``other``; ``tracks`` are the joined ones."""
        joined = replace(
            self,
            tracks=tracks,
            extents=self.extents.and_one(other.extents, row),
            elsewhere=and_row(self.elsewhere, other.elsewhere, row),
            in_traffic=and_row(self.in_traffic, other.in_traffic, row),
        )
        # Values already derived for each row need not be derived again
        for name in ("lanes_there", "touched", "on_lanes", "crosses", "counts", "seen"):
            joined.__dict__[name] = and_row(getattr(self, name), getattr(other, name), row)
        for name in ("s", "lane", "lane_steps"):
            values = getattr(self.extents, name), getattr(other.extents, name)
            joined.extents.__dict__[name] = and_row(*values, row)
        return joined

    @cached_property
    def there(self) -> Flags:
        """Mask of the lanes (last axis) that exist where participants are."""
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

    @kept
    def lanes_within(self, place_m: float) -> tuple[LaneSets, ...]:
        """The sets of lanes reached into: as measured, and by ``place_m`` less far and farther.

        Each side of a body counts by itself at a lane's bounds.
        """
        reach = self.thresholds.touching_m
        least = reach + place_m, reach - place_m
        return self.touched, *lanes_touched(self.extents, self.lanes_there, least)

    @cached_property
    def on_lanes(self) -> Flags:
        """Mask of participants that reach into at least one lane."""
        flags: Flags = self.touched != 0
        return flags

    @cached_property
    def counts(self) -> Flags:
        """Mask of participants that count for an ego that is near.

        On the lanes everybody does; beside them only vulnerable road users, oncoming vehicles that
        are not parked, trams that run along the road on tracks next to the lanes, and buses that
        signal to come in from a bay there.
        """
        beside = self.thresholds.beside_road_m
        close = (self.extents.left_of_max[..., 0] > -beside) & (
            self.extents.left_of_min[..., -1] < beside
        )
        flags: Flags = close & self.tracks.of_type("vulnerable_user")[:, None]
        others = Cells.at(close & self.in_traffic[:, None] & ~flags & ~self.on_lanes)
        np.put(flags, others.places, np.cos(others.of(self.extents.turned)) < _ONCOMING_COSINE)
        rails = self.tracks.of_type("rail_vehicle").nonzero()[0]
        if len(rails):
            flags[rails] |= self._next_to_lanes(rails)
        buses = self.tracks.of_type("bus").nonzero()[0]
        if len(buses):
            flags[buses] |= self._next_to_lanes(buses) & self._signal_to_come_in(buses)
        flags |= self.on_lanes
        flags &= ~self.crosses
        return flags

    def _next_to_lanes(self, rows: NDArray[intp]) -> Flags:
        """Mask of participants in ``rows`` that head along the road, on its lanes or next to them.

        Who is on the lanes is next to them, too.
        """
        right = self.extents.left_of_max[rows, :, 0] > -_NEXT_TO_M
        left = self.extents.left_of_min[rows, :, -1] < _NEXT_TO_M
        along = np.cos(self.extents.turned[rows]) > _ALONG_COSINE
        next_to: Flags = right & left & along
        return next_to

    def _signal_to_come_in(self, rows: NDArray[intp]) -> Flags:
        """Mask of vehicles in ``rows`` that stand and have signalled towards the lanes since then.

        From the first flash on: an indicator is dark in between.
        """
        tracks = self.tracks
        columns = np.arange(tracks.present.shape[1])
        stands = tracks.speed[rows] * KMH_PER_MPS < self.thresholds.standing_kmh
        lit = np.zeros_like(stands)
        at_right = self.extents.left_of_max[rows, :, 0] < 0
        for number, row in enumerate(rows.tolist()):
            lamps = tracks.participants[row].lamps
            for column in stands[number].nonzero()[0].tolist() if lamps else ():
                shown = lamps.get(tracks.first + column, frozenset()) & _INDICATORS
                inwards = "left_indicator" if at_right[number, column] else "right_indicator"
                lit[number, column] = shown == {inwards}
        signalled = np.maximum.accumulate(np.where(lit, columns, -1), axis=1)
        moved = np.maximum.accumulate(np.where(stands, -1, columns), axis=1)
        flags: Flags = signalled > moved
        return flags

    @cached_property
    def crosses(self) -> Flags:
        """Mask of cross traffic: vehicles that drive on another road, across this one."""
        cells = Cells.at(self.elsewhere & self.tracks.of_type("vehicle")[:, None])
        turned = np.abs(cells.of(self.extents.turned))
        return cells.laid((turned > _ACROSS) & (turned < np.pi - _ACROSS))

    @cached_property
    def seen(self) -> Flags:
        """Mask of participants that are in sight of an ego that is near enough."""
        return self.on_lanes & ~self.crosses


def rows_in_reach(
    tracks: Tracks, road: DrivenRoad, egos: Sequence[tuple[int, slice]], limits: Thresholds
) -> Flags:
    """Mask of the tracks that may count for one of the egos on a road, or be in its sight.

    They come near enough to the ego, given as row and columns, in some column, in a straight line
    and at their greatest speeds. The feet of a body's corners on the road are no farther apart than
    its outline is large, and egos are no farther off the road than ``are_on_road`` allows.
    """
    flags = np.zeros(len(tracks.present), dtype=bool)
    flags[[ego for ego, _ in egos]] = True
    off = 2 * _farthest_off(road, limits) + _PIECES_M
    # Most of those that come near enough already are so at one of a few times
    for step in (_SOME_TIMES, 1):
        for ego, columns in egos:
            rows, times = (~flags).nonzero()[0], slice(columns.start, columns.stop, step)
            if not len(rows):
                return flags
            # Like the gap that counts, measured along the road, but with all directions unknown
            fastest = tracks.fastest[rows] + tracks.fastest[ego]
            along = np.maximum(limits.near_m, (fastest + 1.0) * limits.catching_up_s)
            squares = (along + off + tracks.reaches[rows] + tracks.reaches[ego]) ** 2
            away = tracks.x[rows, times] - tracks.x[ego, times]
            aside = tracks.y[rows, times] - tracks.y[ego, times]
            away *= away
            aside *= aside
            away += aside
            flags[rows] = (away <= squares[:, None]).any(axis=1)
    return flags


def near_road(
    tracks: Tracks,
    road: DrivenRoad,
    at: tuple[NDArray[intp], slice],
    limits: Thresholds,
    step_s: float,
) -> Flags:
    """Mask of where participants, in some rows and columns, are near enough to a road to count.

    Includes shortly before and after: nobody that counts is absent in between.
    """
    reach = float(tracks.reaches.max(initial=0.0)) + _PIECES_M
    fastest = float(tracks.fastest.max(initial=0.0))
    beyond = max(limits.near_m, (2 * fastest + 1.0) * limits.catching_up_s) + reach
    around = road.line.surroundings(_farthest_off(road, limits) + reach, beyond)
    near: Flags = shapely.contains_xy(around, tracks.x[at], tracks.y[at])
    if np.array_equal(near, tracks.present[at]):
        return near
    soon = int((limits.away_s + _SOON_S) / step_s) + 1
    counts = np.pad(near, ((0, 0), (soon + 1, soon))).cumsum(axis=1, dtype=np.int32)
    flags: Flags = counts[:, 2 * soon + 1 :] > counts[:, : -2 * soon - 1]
    return flags


def are_on_road(
    extents: RoadExtents, road: DrivenRoad, egos: NDArray[intp], limits: Thresholds
) -> bool:
    """Whether the egos are never farther off a road than participants that count may be."""
    ends = extents.d_min[egos], extents.d_max[egos]
    return not any((np.abs(end) > _farthest_off(road, limits)).any() for end in ends)


def _farthest_off(road: DrivenRoad, limits: Thresholds) -> float:
    """Upper bound (m) on how far from the road's line a part of a body that counts may be."""
    return float(np.abs(road.lanes.bounds).max()) + limits.beside_road_m
