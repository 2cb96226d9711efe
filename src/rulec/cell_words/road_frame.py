"""Others on the road of a scene, as extraction has them, and the scene's coordinates there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, pairwise

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.cell_words.lane_roads import lane_roads, linked_with
from rulec.cell_words.probe_drives import ProbeDrives
from rulec.extraction.signals.ego_lanelets import CYCLE_LANE, SHOULDER, lanes_of_type
from rulec.extraction.signals.map.line_signals import lights_of
from rulec.extraction.signals.settling import fewest_states
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_places import RoadPlaces
from rulec.extraction.traffic_thresholds import LEAST_S, USUAL
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import Lanelet, Light, ObservedLight

_FAR_M = 300.0
_HAIR_M = 0.05
_PARTS = 4
"""Half of a body is examined in this many parts."""

_BENDS = np.radians(USUAL.turned_deg - 15.0)
"""A way in a junction that turns by less than this goes straight on."""


@dataclass(frozen=True, slots=True, eq=False)
class OthersNow:
    """Where others are at a time, a row each; NaN for those that are not beside the road.

    ``s`` and ``d`` (m) are the ends of their bodies in the scene's coordinates. ``right`` and
    ``left`` are the least and the greatest place of either side across the road, over as long
    before and after as the least duration of a side of ego. Over the same time, ``lanes`` are those
    that they surely reach into, ``perhaps`` those that they may. ``along`` are the bounds of speeds
    along the road (m/s). ``counts``: whether a participant counts for ego if it is near.
    ``is_there``: whether it is there, or was and will be within so short a time that it counts as
    there throughout. ``loose_s`` (m) is the possible error of distances along the road.
    ``goes_along`` are vehicles that surely go ego's way, ``may_go_along`` those that may,
    ``may_ride_along`` cycles that may. ``some_come``: whether any participant moves against ego's
    direction then or later; ``ever_come``: which ones do at any time.
    """

    s: tuple[Floats, Floats]
    d: tuple[Floats, Floats]
    right: tuple[Floats, Floats]
    left: tuple[Floats, Floats]
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


@dataclass(frozen=True, slots=True, eq=False)
class LaneLight:
    """The lights at the end of a piece of a lane, ``end`` m along the scene's road.

    ``drawn``: whether the map has their line. ``goes_dark``: whether they show nothing at times.
    """

    lane: int
    end: float
    lights: tuple[Light | ObservedLight, ...]
    drawn: bool

    @property
    def goes_dark(self) -> bool:
        """Whether the lights may show nothing at times."""
        return any(
            isinstance(light, ObservedLight) or "inactive" in dict(light.phases)
            for light in self.lights
        )


class RoadFrame:
    """A scene's road, with all participants on it as extraction has them.

    ``apart_s`` (m) is how far coordinates along it may differ from those along another road on the
    same lanes, ``apart_d`` the same across it; ``loose_s`` and ``loose_d`` are the possible errors
    of distances, from that and from the error ``place_m`` of places. ``has_rails``: whether it has
    a level crossing. ``one_way``: whether surely nobody comes the other way. ``goes_straight``:
    whether it turns in none of its junctions. ``crossings`` and ``junctions`` are those of any road
    along its lanes. On ``other_lanes`` these roads do not all have the same lanes. ``lights`` are
    those of its lanes; ``leaving`` is the mask of those to another road, or from one.

    Ego extends at most ``half_m`` from its middle to its corners, starts ``ego_d`` m left of the
    line, and reaches some ``lanes``, or all.

    Raises ValueError if no drive has such a road, or it meets itself.
    """

    def __init__(
        self,
        probes: ProbeDrives,
        half_m: float,
        ego_d: float = 0.0,
        lanes: Sequence[int] | None = None,
    ) -> None:
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
        self._roads = lane_roads(probes, road, ego_d, lanes)
        roads = self._roads.roads
        crossings = [self._roads.in_scene(own, own.crossings) for own in roads]
        junctions = [self._roads.in_scene(own, own.junctions) for own in roads]
        self.crossings, self.junctions = (
            list(dict.fromkeys(chain(*own))) for own in (crossings, junctions)
        )
        lanelets = [lanelet for row in road.rows for lanelet in row if lanelet is not None]
        self.lights = tuple(self._lane_lights(road))
        self._partings = self._roads.partings()
        self.has_rails = any("level_crossing" in lanelet.types for lanelet in lanelets)
        self.one_way = all(among.surroundings.directions(lanelet.id)[0] for lanelet in lanelets)
        turns = [own.turned(*ends, aside_m=1.0) for own in roads for ends in own.junctions]
        self.goes_straight = all(abs(turn) < _BENDS for turn in turns)
        at = np.abs(origin.lanes.s - origin.ego_s) <= _FAR_M
        widths = np.diff(origin.lanes.bounds[at], axis=1)
        self.stretched = np.abs(widths - np.diff(self._straight)).sum(axis=1).max(initial=0.0)
        self.place_m = among.surroundings.tolerances.place_m
        differs = np.abs(widths - np.diff(self._straight)).max(initial=0.0)
        self.apart_d = _HAIR_M + min(float(differs), 1.0) / 2
        self.loose_d = self.place_m + self.apart_d
        # In bends, lines beside each other differ in length
        headings = np.unwrap(origin.line.headings_at(origin.lanes.s[at]))
        across = float(self._straight[-1] - self._straight[0])
        turned = float(np.abs(np.diff(headings)).sum())
        self.apart_s = _HAIR_M + min(turned * across / 2, across)
        self.loose_s = self.place_m + self.apart_s
        self._line_s = origin.lanes.s[at] - origin.ego_s
        self._line_d, self._bounds_d = self._roads.apart(self._line_s)
        self.other_lanes = list(self._roads.other_lanes(self._line_s))
        self._bent_d = _bent(self._line_s, headings, half_m)
        self._lasting = _lasting_lanes(road)
        self.leaving = _leaving(road.rows, 1) | _leaving(road.rows[::-1], -1)

    def _lane_lights(self, road: DrivenRoad) -> Iterator[LaneLight]:
        recording, ends = self.probes.recording, road.borders[1:].tolist()
        places = self._roads.in_scene(road, [(end, end) for end in ends])
        for piece, (row, (end, _)) in enumerate(zip(road.rows, places, strict=True)):
            for lane, lanelet in enumerate(row):
                if lanelet is not None and lanelet.lights:
                    lights = lights_of(recording, road, piece, lane)
                    drawn = lanelet.stop_line is not None
                    yield LaneLight(lane, end, lights or lanelet.lights, drawn)

    def gap_to_oncoming_lanes(
        self, places: tuple[Floats, Floats], sides: tuple[Floats, Floats]
    ) -> Floats:
        """How far (m) rectangles stay from where lanes of the other direction may lie.

        They extend between the places along the road, and from side to side. Beyond the end of a
        lane, lanes of the other direction may lie beside the lane that goes on.
        """
        lanes, first = self._origin.lanes, self._origin.ego_s
        straight, there = self._straight, lanes.there
        if self.probes.among.side == "right":
            last = there.shape[1] - there[:, ::-1].argmax(axis=1)
            edges = np.where(there.any(axis=1), straight[last], np.inf)
        else:
            edges = -np.where(there.any(axis=1), straight[there.argmax(axis=1)], -np.inf)
        begins, ends = (lanes.pieces_at(place + first).tolist() for place in places)
        nearest = [edges[k : end + 1].min() for k, end in zip(begins, ends, strict=True)]
        reach = sides[1] if self.probes.among.side == "right" else -sides[0]
        gap: Floats = np.array(nearest, dtype=np.float64) - reach
        return gap

    def line_apart(self, s: tuple[Floats, Floats]) -> Floats:
        """The greatest distance (m) between the two lines, for each pair of places."""
        return self._most(self._line_d, s)

    def bounds_apart(self, s: tuple[Floats, Floats]) -> Floats:
        """The greatest distance (m) between lane bounds, for each pair of places."""
        return self._most(self._bounds_d, s)

    def bent(self, s: tuple[Floats, Floats]) -> Floats:
        """How far (m) the middle of ego's body is beside ego's place, at most, where roads bend.

        To extraction the middle is halfway between the body's ends across the road.
        """
        return self._most(self._bent_d, s)

    def travel_lanes(self, s: tuple[Floats, Floats]) -> tuple[Flags, Flags]:
        """Masks of lanes (second axis) that are surely, and perhaps, there to travel on.

        Wherever ego is between two places, one row per pair.
        """
        lanes, first = self._origin.lanes, self._origin.ego_s
        begins, ends = (
            lanes.pieces_at(place + first + aside).tolist()
            for place, aside in zip(s, (-self.apart_s, self.apart_s), strict=True)
        )
        there = [lanes.there[k : end + 1] for k, end in zip(begins, ends, strict=True)]
        surely = np.array([part.all(axis=0) for part in there]) & self._lasting
        return surely, np.array([part.any(axis=0) for part in there])

    def _most(self, values: Floats, s: tuple[Floats, Floats]) -> Floats:
        begins = np.searchsorted(self._line_s, s[0] - self.apart_s, "right") - 1
        ends = np.searchsorted(self._line_s, s[1] + self.apart_s, "left") + 1
        rows = zip(np.maximum(begins, 0).tolist(), ends.tolist(), strict=True)
        return np.array([values[begin:end].max(initial=0.0) for begin, end in rows])

    @cached_property
    def _come(self) -> Flags:
        """Mask of participants that count and move against ego's direction."""
        slowest = self.places.extents.along - self.places.tracks.speed_error
        come: Flags = self.places.counts & (slowest * KMH_PER_MPS < -USUAL.standing_kmh)
        return come

    def _with_partings(self, now: OthersNow, ego_s: float) -> OthersNow:
        """The others, with those beyond a parting in each lane that they may be in to a drive.

        ``ego_s`` (m) is ego's farthest place; from there, others before a parting are beyond it.
        """
        lanes, perhaps = now.lanes.copy(), now.perhaps.copy()
        sides = [side.copy() for side in (*now.d, *now.right, *now.left)]
        widest, (s0, s1) = float(np.diff(self._straight).max()), now.s
        anywhere, unknown = (-lanes.shape[1], lanes.shape[1]), np.zeros(len(lanes), dtype=bool)
        for place, way, shifts in self._beyond(ego_s):
            rows = np.flatnonzero(s1 > place if way > 0 else s0 < place)
            for number, side in enumerate(sides):
                side[rows] += (shifts or anywhere)[-(number % 2)] * widest
            lanes[rows] = np.all([_shifted(lanes[rows], by) for by in shifts], axis=0)
            perhaps[rows] = np.any([_shifted(perhaps[rows], by) for by in shifts], axis=0)
            unknown[rows] |= not shifts
        lanes[unknown], perhaps[unknown] = False, True
        d, right, left = zip(sides[::2], sides[1::2], strict=True)
        return replace(
            now,
            lanes=lanes,
            perhaps=perhaps,
            d=d,
            right=right,
            left=left,
            counts=now.counts & ~unknown,
            goes_along=now.goes_along & ~unknown,
        )

    def _beyond(self, ego_s: float) -> Iterator[tuple[float, int, Sequence[int]]]:
        """Places of partings, the way beyond each, and shifts of others to the left, in lanes."""
        for parting in self._partings:
            yield parting.place, parting.way, parting.shifts
            if parting.way > 0 and parting.place < ego_s:
                yield parting.place, -1, tuple(-by for by in reversed(parting.shifts))

    def at(self, seconds: float, ego_s: float = 0.0) -> OthersNow | None:
        """The others at a time of the scene; None before or after the recording.

        ``ego_s`` (m) is the farthest place that ego has reached by then.
        """
        column = self.probes.column(seconds)
        columns = np.unique([int(np.floor(column + 1e-6)), int(np.ceil(column - 1e-6))])
        n_columns = self.places.extents.s_min.shape[1]
        if columns[0] < 0 or columns[-1] >= n_columns:
            return None
        now = self._in(columns)
        return self._with_partings(now, ego_s) if self._partings else now

    def _in(self, columns: NDArray[intp]) -> OthersNow:
        places, ends, tracks = self.places, self.places.extents, self.places.tracks

        def hull(low: Floats, high: Floats) -> tuple[Floats, Floats]:
            return low[:, columns].min(axis=1), high[:, columns].max(axis=1)

        s0, s1 = hull(ends.s_min, ends.s_max)
        touching = places.thresholds.touching_m
        # A side that lasts for less is replaced by the one before and after
        brief = fewest_states(LEAST_S["lateral"], self.probes.recording.step_s) - 1
        first, end = max(int(columns[0]) - brief, 0), int(columns[-1]) + brief + 1
        around = slice(first, end)
        low = self._straightened(ends.left_of_min[:, around])
        high = self._straightened(ends.left_of_max[:, around])
        now = columns - first
        inside, breadth = ends.inside[:, around], ends.breadth[:, around]
        there, absent = places.there[:, around], np.isnan(ends.s_min[:, around])
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
        s = s0 - self._origin.ego_s, s1 - self._origin.ego_s
        # There, too, drives have bounds of their own
        apart = self.bounds_apart(s)
        loose = (_HAIR_M + apart)[:, None, None]
        lanes = np.all(((inside > least + loose) & there) | absent[..., None], axis=1)
        perhaps = np.any((inside > least - loose) & there, axis=1)
        return OthersNow(
            s=s,
            d=(low[:, now].min(axis=1), high[:, now].max(axis=1)),
            right=(np.fmin.reduce(low, axis=1) - apart, np.fmax.reduce(low, axis=1) + apart),
            left=(np.fmin.reduce(high, axis=1) - apart, np.fmax.reduce(high, axis=1) + apart),
            lanes=lanes,
            perhaps=perhaps,
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
        """The scene's coordinate across the road, from how far left of lane bounds places are."""
        straight = self._straight
        lane = np.clip((left_of >= 0).sum(axis=-1) - 1, 0, len(straight) - 2)
        low = np.take_along_axis(left_of, lane[..., None], -1)[..., 0]
        high = np.take_along_axis(left_of, lane[..., None] + 1, -1)[..., 0]
        wide = straight[lane + 1] - straight[lane]
        inside = straight[lane] + low * wide / np.maximum(low - high, 1e-6)
        beyond = np.where(low < 0, straight[lane] + low, straight[lane + 1] + high)
        found: Floats = np.where((low >= 0) & (high <= 0), inside, beyond)
        return found


def _bent(s: Floats, headings: Floats, half_m: float) -> Floats:
    """How far (m) a line bends aside within ``half_m`` of each of its places, at most."""
    found: Floats = np.zeros(len(s))
    part = half_m / _PARTS
    for way in (1, -1):
        turned = (
            np.abs(np.interp(s + way * number * part, s, headings) - headings)
            for number in range(1, _PARTS + 1)
        )
        found = np.maximum(found, part * sum(turned))
    return found


def _leaving(rows: Sequence[Sequence[Lanelet | None]], way: int) -> Flags:
    """Mask of a road's lanes that somewhere go on, but not on this road."""
    found: Flags = np.zeros(len(rows[0]), dtype=bool)
    for row, onward in pairwise(rows):
        there = {lanelet.id for lanelet in onward if lanelet is not None}
        linked = [() if lanelet is None else linked_with(lanelet, way) for lanelet in row]
        found |= [bool(ids) and there.isdisjoint(ids) for ids in linked]
    return found


def _lasting_lanes(road: DrivenRoad) -> Flags:
    """Mask of lanes that are never cycle lanes or shoulders; none if shoulders may divide them."""
    shoulders, cycles = (
        np.logical_or.reduce(lanes_of_type(road, kind)) for kind in (SHOULDER, CYCLE_LANE)
    )
    lasting: Flags = ~shoulders & ~cycles & ~np.any(shoulders[1:-1])
    return lasting


def _shifted(flags: Flags, by: int) -> Flags:
    """A mask of lanes (second axis), shifted left by ``by`` lanes."""
    found = np.zeros_like(flags)
    count = flags.shape[1]
    found[:, max(by, 0) : count + min(by, 0)] = flags[:, max(-by, 0) : count - max(by, 0)]
    return found
