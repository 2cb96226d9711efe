"""Others on the road of a scene, as extraction has them, and the scene's coordinates there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray

from rulec.cell_words.ego_boxes import Floats
from rulec.cell_words.probe_drives import ProbeDrives
from rulec.extraction.drive_context import KMH
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_places import RoadPlaces
from rulec.extraction.traffic_thresholds import USUAL

_FAR_M = 300.0
_HAIR_M = 0.05
_BENDS = np.radians(USUAL.turned_deg - 15.0)
"""Whose way in a junction differs by less from its direction before goes straight on."""

Flags: TypeAlias = NDArray[bool_]


@dataclass(frozen=True, slots=True, eq=False)
class OthersNow:
    """Where others are at a time, a row each; NaN for who is not beside the road.

    ``s`` and ``d`` (m) are the ends of their bodies in the scene's coordinates, ``lanes`` those
    that they reach into for sure, ``perhaps`` those that they may. ``along`` are speeds along the
    road, wrong as they may be (m/s). ``counts``: is it one who counts for ego, if it is near?
    ``is_there``: is it, or was it and will it be, so soon that it was there all the time?
    ``loose_s`` (m) says how far distances along the road may be wrong.
    ``goes_along`` are vehicles that go ego's way for sure, ``may_go_along`` those that may,
    ``may_ride_along`` cycles that may.
    ``some_come``: does somebody move against ego's direction then, or later?
    ``ever_come``: who does, whenever that is?
    """

    s: tuple[Floats, Floats]
    d: tuple[Floats, Floats]
    lanes: Flags
    perhaps: Flags
    along: tuple[Floats, Floats]
    counts: Flags
    is_there: Flags
    goes_along: Flags
    may_go_along: Flags
    may_ride_along: Flags
    some_come: bool
    ever_come: Flags
    loose_s: float


class RoadFrame:
    """A scene's road, with everybody on it as extraction has them.

    ``apart_s`` (m) says how far coordinates along it may differ from those along another road on
    the same lanes, ``apart_d`` how far those across it, ``loose_s`` and ``loose_d`` how far
    distances may be wrong for that and since places are known to ``place_m`` only. ``has_rails``:
    is there a level crossing on it? ``one_way``: does nobody come the other way on it, surely?
    ``goes_straight``: does it turn in none of its junctions?
    Raises ValueError: no drive has such a road, or it meets itself.
    """

    def __init__(self, probes: ProbeDrives) -> None:
        origin, among = probes.origin, probes.among
        found = among.map.road(origin.way)
        if isinstance(found, str):
            raise ValueError(found)
        road, _ = found
        if road.meets_itself:
            raise ValueError("places beside a road that meets itself are not of one stretch of it")
        self.probes, self._origin = probes, origin
        self._straight = origin.lanes.straight
        self.places: RoadPlaces = among.places(replace(road, line=origin.line, lanes=origin.lanes))
        self.crossings = self._in_scene(road, road.crossings)
        self.junctions = self._in_scene(road, road.junctions)
        lanelets = [lanelet for row in road.rows for lanelet in row if lanelet is not None]
        self.has_rails = any("level_crossing" in lanelet.types for lanelet in lanelets)
        self.one_way = all(among.surroundings.directions(one)[0] for one in lanelets)
        turns = [road.turned(start, end, aside_m=1.0) for start, end in road.junctions]
        self.goes_straight = all(abs(one) < _BENDS for one in turns)
        at = np.abs(origin.lanes.s - origin.ego_s) <= _FAR_M
        widths = np.diff(origin.lanes.bounds[at], axis=1)
        self.stretched = np.abs(widths - np.diff(self._straight)).sum(axis=1).max(initial=0.0)
        self.place_m = among.surroundings.tolerances.place_m
        differs = np.abs(widths - np.diff(self._straight)).max(initial=0.0)
        self.apart_d = _HAIR_M + min(float(differs), 1.0) / 2
        self.loose_d = self.place_m + self.apart_d
        # On bends lines beside each other are not equally long
        headings = np.unwrap(origin.line.headings_at(origin.lanes.s[at]))
        across = float(self._straight[-1] - self._straight[0])
        turned = float(np.abs(np.diff(headings)).sum())
        self.apart_s = _HAIR_M + min(turned * across / 2, across)
        self.loose_s = self.place_m + self.apart_s

    @cached_property
    def _come(self) -> Flags:
        """Flags of who counts and moves against ego's direction."""
        slowest = self.places.extents.along - self.places.tracks.speed_error
        come: Flags = self.places.counts & (slowest * KMH < -USUAL.standing_kmh)
        return come

    def _in_scene(
        self, road: DrivenRoad, stretches: Sequence[tuple[float, float]]
    ) -> list[tuple[float, float]]:
        """Stretches of a road, in the scene's coordinates along its own."""
        line, found = road.line, []
        for ends in stretches:
            s = np.array(ends)
            piece = np.clip(np.searchsorted(line.arc, s, "right") - 1, 0, len(line.arc) - 1)
            places = line.start[piece] + line.ahead[piece] * (s - line.arc[piece])[:, None]
            first, last = (
                self._origin.line.coordinates(places)[:, 0] - self._origin.ego_s
            ).tolist()
            found.append((first, last))
        return found

    def at(self, seconds: float) -> OthersNow | None:
        """The others at a time of the scene; None before or after the recording."""
        column = self.probes.column(seconds)
        columns = np.unique([int(np.floor(column + 1e-6)), int(np.ceil(column - 1e-6))])
        n_columns = self.places.extents.s_min.shape[1]
        if columns[0] < 0 or columns[-1] >= n_columns:
            return None
        return self._in(columns)

    def _in(self, columns: NDArray[intp]) -> OthersNow:
        places, ends, tracks = self.places, self.places.extents, self.places.tracks

        def hull(low: Floats, high: Floats) -> tuple[Floats, Floats]:
            return low[:, columns].min(axis=1), high[:, columns].max(axis=1)

        s0, s1 = hull(ends.s_min, ends.s_max)
        d0 = self._straightened(ends.left_of_min[:, columns]).min(axis=1)
        d1 = self._straightened(ends.left_of_max[:, columns]).max(axis=1)
        touching = places.thresholds.touching_m
        inside, breadth = ends.inside[:, columns], ends.breadth[:, columns]
        there = places.there[:, columns]
        least = np.minimum(touching, breadth / 2)
        error = tracks.speed_error[:, columns]
        along = ends.along[:, columns]
        away = round(places.thresholds.away_s / self.probes.recording.step_s)
        before = slice(max(int(columns[0]) - away, 0), int(columns[-1]) + 1)
        behind = slice(int(columns[0]), int(columns[-1]) + away + 1)
        vehicles = tracks.of_type("vehicle")
        goes = places.on_lanes & (np.abs(ends.turned) < 1.0) & ~places.crosses
        was, will = (
            np.any(places.counts[:, part], axis=1, keepdims=True) for part in (before, behind)
        )
        return OthersNow(
            s=(s0 - self._origin.ego_s, s1 - self._origin.ego_s),
            d=(d0, d1),
            lanes=np.all((inside > least + _HAIR_M) & there, axis=1),
            perhaps=np.any((inside > least - _HAIR_M) & there, axis=1),
            along=((along - error).min(axis=1), (along + error).max(axis=1)),
            counts=np.all(places.counts[:, columns], axis=1),
            is_there=(was & will)[:, 0],
            goes_along=vehicles & np.all(goes[:, columns], axis=1),
            may_go_along=vehicles & np.any(goes[:, columns], axis=1),
            may_ride_along=tracks.of_type("light_rider") & np.any(goes[:, columns], axis=1),
            some_come=bool(self._come[:, int(columns[0]) :].any()),
            ever_come=np.any(self._come, axis=1),
            loose_s=self.loose_s,
        )

    def _straightened(self, left_of: Floats) -> Floats:
        """The scene's coordinate across the road, from how far left of each bound places are."""
        straight = self._straight
        lane = np.clip((left_of >= 0).sum(axis=-1) - 1, 0, len(straight) - 2)
        low = np.take_along_axis(left_of, lane[..., None], -1)[..., 0]
        high = np.take_along_axis(left_of, lane[..., None] + 1, -1)[..., 0]
        wide = straight[lane + 1] - straight[lane]
        inside = straight[lane] + low * wide / np.maximum(low - high, 1e-6)
        beyond = np.where(low < 0, straight[lane] + low, straight[lane + 1] + high)
        found: Floats = np.where((low >= 0) & (high <= 0), inside, beyond)
        return found
