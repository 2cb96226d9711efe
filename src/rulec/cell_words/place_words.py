"""Words that depend only on place or time, or that nothing on the road gives a reason for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, TypeAlias, get_args

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.cell_words.ego_boxes import EgoBoxes
from rulec.cell_words.probe_drives import EVERY_M, LaneProbe, ProbeDrives
from rulec.extraction.tracks.at_junctions.rings import ring_lanelets
from rulec.recordings.recording import Side
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf

Words: TypeAlias = dict[str, Any]
"""Name -> its value; for a word about objects, object -> value."""

OF_SCENE = frozenset({"ego_on_call", "ego_type", "ego_length", "told_to_stop", "told_to_go"})
OF_SCENE |= {"wet", "icy", "visibility", "raining", "night"}
"""Words that are the same at all places and times."""

OF_OTHERS = frozenset(
    {
        "two_wheeled",
        "parked",
        "stopped",
        "oncoming",
        "goes_across",
        "in_the_road",
        "boarding",
        "leaving_stop",
        "warning_lights",
        "hazard_lights",
        "on_call",
        "turning_far",
        "about_to_overtake",
        "on_shoulder",
        "leads_elsewhere",
    }
)
"""Words about others that depend on time only, wherever ego is."""

OF_PLACE = frozenset(
    {
        "limit",
        "minimum_limit",
        "built_up",
        "road_class",
        "one_way",
        "divided",
        "lane_kind",
        "tunnel",
        "tracks_at_kerb",
        "lanes",
        "lane",
        "lane_number",
        "apart_from_far_lane",
        "marked_lanes",
        "surface",
        "driving_side",
        "junction_zone",
        "crossing_zone",
        "crossing_kind",
        "level_crossing_zone",
        "past_level_crossing_sign",
        "guarded",
        "no_overtaking_sign",
        "narrowing",
        "merged",
        "turn",
    }
)
"""Words that depend on where ego is along the road, and in which lane."""

OF_LANES = frozenset({"lanes", "lane", "lane_number", "apart_from_far_lane", "marked_lanes"})
"""Those of them that depend on which other lanes exist there."""

AT_LINE = frozenset(
    {"light", "give_way_sign", "stop_sign", "turn_on_red_sign", "no_turn_on_red_sign"}
)
"""Also decided by place, and valid even in the state in which ego crosses their line."""

DISTANCES = frozenset({"distance_to_crossing", "distance_to_junction"})

NEEDS_JUNCTION = frozenset(
    {
        "enters_junction",
        "all_way_stop",
        "unregulated_junction",
        "own_road_ends",
        "other_road_ends",
        "conflict_from_left",
        "conflict_from_right",
        "conflict_with_rail",
        "conflict_with_rail_from_side",
        "in_way_of_oncoming",
        "turns_in_way_of",
        "enters_roundabout",
        "roundabout_signed",
        "compulsory_roundabout",
        "conflict_on_roundabout",
        "crosses_side_road",
        "came_up_beside",
        "crosses_light_line",
        "crosses_stop_line",
        "enters_level_crossing",
        "exit_clear",
    }
)
"""Words that are the same everywhere on a road without junctions, crossings and level crossings."""

NEEDS_CROSSING = frozenset({"crossing_use", "stopped_for_pedestrian", "nearest_to_crossing"})
"""Words that are the same everywhere on a road without pedestrian crossings."""

_NEEDS_TYPE = {
    "emergency_vehicle_near": "emergency_vehicle",
    "conflict_with_rail": "rail_vehicle",
    "conflict_with_rail_from_side": "rail_vehicle",
}
"""Word -> the type of participant without which it is False."""

_AT_ZONE: Mapping[str, Any] = {"enters_junction": False, "turn": "straight_on"}
"""The values of words where ego is not at a junction."""

LOOSE_M = 2.0
"""Coordinates of the same place along two roads differ by at most this (m)."""

_NEXT_LANE_M = 0.5
"""Farthest beyond its mark (m) that a lane is left, including the tolerance of marks."""


def hull(values: Iterable[Any]) -> Any:
    """The hull of some values: the most that is known if the value is any of them."""
    found = list(dict.fromkeys(values))
    if len(found) == 1:
        return found[0]
    if found and all(isinstance(value, str | OneOf) for value in found):
        return OneOf(frozenset().union(*map(_among, found)))
    if found and all(type(value) in (float, int, Interval) for value in found):
        ends = [_ends(value) for value in found]
        return Interval(min(low for low, _ in ends), max(high for _, high in ends))
    return UNKNOWN


def _among(value: str | OneOf) -> frozenset[str]:
    return value.values if isinstance(value, OneOf) else frozenset({value})


def _ends(value: float | Interval) -> tuple[float, float]:
    return (value.low, value.high) if isinstance(value, Interval) else (value, value)


@dataclass(frozen=True, slots=True, eq=False)
class _Lane:
    """The words along a lane, in runs of places with the same words.

    ``s`` are the places, ``run`` is the number of each place's run, ``said`` has each run's words.
    """

    probe: LaneProbe
    s: Floats
    run: NDArray[intp]
    said: tuple[Words, ...]


class PlaceWords:
    """The words of cells that depend neither on ego's motion nor on others beside it."""

    def __init__(self, probes: ProbeDrives, names: frozenset[str]) -> None:
        self._probes = probes
        self._names = names & (OF_PLACE | AT_LINE)
        self._distances = names & DISTANCES
        self._straight = probes.origin.lanes.straight
        self._lanes = [_runs(probe, self._names) for probe in probes.lanes]
        self._known: dict[object, Words] = {}

    @property
    def differ(self) -> bool:
        """Whether words differ between places along a lane."""
        return any(len(lane.said) > 1 for lane in self._lanes)

    def of_cells(self, boxes: EgoBoxes, behind: Floats | float = 0.0) -> list[Words]:
        """The words of each cell of a layer, and ``behind`` (m) it; equal ones are shared."""
        low = boxes.s[0] - LOOSE_M - behind
        high = boxes.s[1] + LOOSE_M
        first, last = lanes_of(boxes, self._straight)
        rows = zip(low.tolist(), high.tolist(), first.tolist(), last.tolist(), strict=True)
        return [self._between(*row) for row in rows]

    def _between(self, low: float, high: float, first: int, last: int) -> Words:
        """The words for all places between two, in a range of lanes."""
        spans = []
        there = [
            (lane, max(begin, low) + EVERY_M, min(end, high) - EVERY_M)
            for lane, begin, end in self._probes.stretches
            if first <= lane <= last and begin <= high and end >= low
        ]
        untold = set(there)
        for number, lane in enumerate(self._lanes):
            if first <= lane.probe.lane <= last and lane.s[0] <= high and lane.s[-1] >= low:
                begin = max(int(np.searchsorted(lane.s, low, "right")) - 1, 0)
                end = min(int(np.searchsorted(lane.s, high, "left")), len(lane.s) - 1)
                untold -= {
                    state
                    for state in there
                    if state[0] == lane.probe.lane
                    and lane.s[0] <= state[1]
                    and lane.s[-1] >= state[2]
                }
                spans.append((number, int(lane.run[begin]), int(lane.run[end])))
        key = tuple(spans), not untold
        if key not in self._known:
            self._known[key] = self._said_in(*key)
        found = self._known[key]
        if self._distances:
            found = {**found, **self._ways(low, high)}
        return found

    def _said_in(self, spans: tuple[tuple[int, int, int], ...], whole: bool) -> Words:
        said = [
            self._lanes[number].said[run]
            for number, first, last in spans
            for run in range(first, last + 1)
        ]
        if not whole or not said:
            return dict.fromkeys(self._names, UNKNOWN)
        return {name: hull(one[name] for one in said) for name in self._names}

    def _ways(self, low: float, high: float) -> Words:
        return {name: hull(self._distances_to(name, low, high)) for name in self._distances}

    def _distances_to(self, name: str, low: float, high: float) -> Iterator[Any]:
        """The possible distances to something, from the places between two.

        In all lanes: ego's way is that of the lane to which it may change later.
        """
        for lane in self._lanes:
            begin = int(np.searchsorted(lane.s, low - EVERY_M, "left"))
            end = int(np.searchsorted(lane.s, high + EVERY_M, "right"))
            values = [state.get(name, UNKNOWN) for state in lane.probe.states[begin:end]]
            yield from values
            for before, after in pairwise(values):
                if UNKNOWN not in (before, after) and _ends(after)[1] > _ends(before)[1]:
                    # The nearest one is reached between the two places, and the next one counts
                    # from there on
                    nearest = max(_ends(before)[0] - EVERY_M, 0.0)
                    yield Interval(nearest, _ends(after)[1] + EVERY_M)


def lanes_of(boxes: EgoBoxes, straight: Floats) -> tuple[NDArray[intp], NDArray[intp]]:
    """The first and the last lane that ego may be in, by cell."""
    first = np.searchsorted(straight, boxes.d[0] - _NEXT_LANE_M, "right") - 1
    last = np.searchsorted(straight, boxes.d[1] + _NEXT_LANE_M, "left") - 1
    top = len(straight) - 2
    return np.clip(first, 0, top), np.clip(last, 0, top)


def _runs(probe: LaneProbe, names: frozenset[str]) -> _Lane:
    profiles = [
        tuple((name, state.get(name, UNKNOWN)) for name in sorted(names)) for state in probe.states
    ]
    new = [True, *(one != other for one, other in pairwise(profiles))]
    run = np.cumsum(new) - 1
    said = tuple(dict(profile) for profile, begins in zip(profiles, new, strict=True) if begins)
    return _Lane(probe, probe.s, run, said)


@dataclass(frozen=True, eq=False)
class SceneWords:
    """The words of a whole scene, and those of a time.

    ``no_junction``: whether the road has no junction, crossing or level crossing as far as ego may
    get, and beyond; ``no_crossing``: the same for pedestrian crossings alone. ``straight``: whether
    the road turns in none of its junctions.
    """

    probes: ProbeDrives
    names: frozenset[str]
    no_junction: bool
    no_crossing: bool
    straight: bool

    @cached_property
    def everywhere(self) -> Words:
        """Words about the world that are the same in all cells."""
        words: Words = {}
        for name in self.names & OF_SCENE:
            words[name] = hull(self._values(name))
        for name in self._guarded:
            values = list(self._values(name))
            if values and not any(isinstance(value, Mapping) for value in values):
                words[name] = hull(values)
        for name, type_ in _NEEDS_TYPE.items():
            if name in self.names:
                others = self.probes.recording.participants
                words[name] = UNKNOWN if any(type_ in o.object_types for o in others) else False
        if self.straight:
            words |= dict.fromkeys(self.names & {"in_way_of_oncoming"}, False)
        return words

    @cached_property
    def about_all(self) -> Words:
        """Words about others that are the same for all of them in all cells: name -> value."""
        of_all = {
            name: hull(
                inner
                for value in self._values(name)
                if isinstance(value, Mapping)
                for inner in value.values()
            )
            for name in self._guarded
            if any(isinstance(value, Mapping) for value in self._values(name))
        }
        if self.straight and not self._has_rings:
            of_all |= dict.fromkeys(self.names & {"turns_in_way_of"}, False)
        return of_all

    @cached_property
    def _has_rings(self) -> bool:
        return any(ring_lanelets(self.probes.recording, side) for side in get_args(Side))

    @cached_property
    def _guarded(self) -> frozenset[str]:
        names = frozenset[str]()
        if self.no_junction:
            # Where a road leaves a ring there may be none
            names |= NEEDS_JUNCTION - ({"turns_in_way_of"} if self._has_rings else set())
        if self.no_crossing:
            names |= NEEDS_CROSSING
        return names & self.names

    def _values(self, name: str) -> Iterable[Any]:
        probes = [*(own.states for own in self.probes.lanes)]
        probes += [own.states for own in self.probes.timed]
        return (state[name] for states in probes for state in states if name in state)

    def constants(self, names: frozenset[str]) -> dict[str, dict[str, Any]]:
        """Those of ``names`` about others whose values never change: name -> object -> value."""
        found: dict[str, dict[str, Any]] = {}
        for state in (state for probe in self.probes.timed for state in probe.states):
            for name in names & OF_OTHERS & state.keys():
                known = {item: value for item, value in state[name].items() if value is not UNKNOWN}
                found.setdefault(name, {}).update(known)
        return found

    def of_others(self, states: Sequence[int]) -> dict[str, dict[str, Any]]:
        """Words about others in some states of the scene's time, as the hull over all drives."""
        found: dict[str, dict[str, list[Any]]] = {}
        for said in self._timed(states):
            for name in self.names & OF_OTHERS & said.keys():
                for item, value in said[name].items():
                    found.setdefault(name, {}).setdefault(item, []).append(value)
        return {
            name: {item: hull(values) for item, values in own.items()}
            for name, own in found.items()
        }

    def present(self, states: Sequence[int]) -> list[str]:
        """The objects that have words in some states of the scene's time."""
        about = (value for said in self._timed(states) for value in said.values())
        return list(dict.fromkeys(x for own in about if isinstance(own, Mapping) for x in own))

    def _timed(self, states: Sequence[int]) -> Iterator[Mapping[str, Any]]:
        begin = self.probes.origin.start.step
        for probe in self.probes.timed:
            for place in (number + begin - probe.first for number in states):
                if 0 <= place < len(probe.states):
                    yield probe.states[place]


def settled_by_place(words: Words, names: frozenset[str]) -> Words:
    """The values of other words that follow from those of a place."""
    found: Words = {}
    if words.get("junction_zone") is False:
        found |= {name: value for name, value in _AT_ZONE.items() if name in names}
    if words.get("level_crossing_zone") is False and "enters_level_crossing" in names:
        found["enters_level_crossing"] = False
    return found
