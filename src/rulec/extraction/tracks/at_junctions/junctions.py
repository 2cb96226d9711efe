"""The junctions of a map: the ways through them, and where ways cross or join."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise, takewhile

import numpy as np
import shapely
from numpy.typing import NDArray

from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.tracks.driven_road import TURN_REACH_M
from rulec.recordings.polylines import arc_lengths, line_length
from rulec.recordings.recording import (
    ALL_STOP,
    REGULATING,
    Lanelet,
    Light,
    ObservedLight,
    Points,
    Recording,
    is_there,
)
from rulec.scenario.recorded.junction_lanelets import (
    junction_lanelets,
    level_crossing_lanelets,
    marks_junctions,
)
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import lanelet_area

MOST_LANELETS = 8
"""The most lanelets end to end on one way through a junction."""

_SIDE_M = 0.4
"""Bodies keep this far (m) inside their lanes, so that ways side by side do not conflict."""

_SHORT_M = 30.0

_NO_WAY_M = 1e-9
"""Corners of a line that are nearer to each other than this (m) give it no direction."""

_TURNED = np.radians(45.0)

Interval = tuple[float, float]


@dataclass(frozen=True, eq=False)
class JunctionWay:
    """A way through a junction: its lanelets end to end, from the junction's entry to its exit.

    ``entries`` and ``exits`` are the lanelets before and after it; ``before``: the former, as far
    as the map has them, and ``approaches``: these and, where they are short, those before them.
    ``road_headings``: the directions (rad) in which the road arrives and leaves, if not those of
    the way's ends.
    """

    lanelets: tuple[Lanelet, ...]
    entries: frozenset[str]
    exits: frozenset[str]
    before: tuple[Lanelet, ...] = ()
    approaches: tuple[Lanelet, ...] = ()
    road_headings: tuple[float, float] | None = None

    @cached_property
    def line(self) -> shapely.LineString:
        """The middle line of the way."""
        return shapely.LineString(np.concatenate([lanelet.centre for lanelet in self.lanelets]))

    @cached_property
    def area(self) -> shapely.Geometry:
        """The area of the way's lanelets, without their edges."""
        whole = shapely.union_all([lanelet_area(lanelet) for lanelet in self.lanelets])
        return shapely.buffer(whole, -_SIDE_M)

    @cached_property
    def headings(self) -> tuple[float, float]:
        """The directions (rad) in which the way begins and ends."""
        first, last = self.lanelets[0].centre, self.lanelets[-1].centre
        return _heading(first[:2]), _heading(last[-2:])

    @cached_property
    def turned(self) -> float:
        """The angle (rad) by which the way turns to the left."""
        return float(turn(*(self.road_headings or self.headings)))

    @cached_property
    def names(self) -> frozenset[str]:
        """The ids of the way's lanelets."""
        return frozenset(lanelet.id for lanelet in self.lanelets)

    @cached_property
    def on_rails(self) -> bool:
        """Whether only rail vehicles use the way."""
        return all("rail" in lanelet.types for lanelet in self.lanelets)


def _heading(points: Points) -> float:
    (x0, y0), (x1, y1) = points
    return float(np.arctan2(y1 - y0, x1 - x0))


@dataclass(frozen=True, eq=False)
class Junction(KeepsResults):
    """A junction with its ways.

    ``regulated``: whether signs or lights determine priority; None if the map does not say.
    """

    id: str
    ways: tuple[JunctionWay, ...]
    regulated: bool | None

    @cached_property
    def names(self) -> frozenset[str]:
        """The ids of the lanelets of all ways."""
        return frozenset().union(*(way.names for way in self.ways))

    @cached_property
    def area(self) -> shapely.Geometry:
        """The area of all of the junction's lanelets."""
        return shapely.union_all([lanelet_area(x) for way in self.ways for x in way.lanelets])

    @kept
    def meeting(self, way: int, other: int) -> tuple[Interval, Interval] | None:
        """The intervals (m) of two ways in which they cross or join, one along each, or None.

        Ways from the same lanelet do not cross; ways that share lanelets join before them.
        """
        return _meeting(self.ways[way], self.ways[other])

    @cached_property
    def ending_roads(self) -> tuple[tuple[bool, bool], ...]:
        """For each way, whether its road ends here, and whether the one that it meets here does.

        A road ends if no way goes straight on from it. It meets one that goes on if a way does
        across.
        """
        wheels = np.array([not way.on_rails for way in self.ways], dtype=bool)
        begins = np.array([way.headings[0] for way in self.ways])
        away = np.abs(turn(begins[:, None], begins[wheels]))
        is_straight = np.array([abs(way.turned) < _TURNED for way in self.ways], dtype=bool)
        straight = ((away < _TURNED) & is_straight[wheels]).any(axis=1)
        is_met = (away > np.pi / 4) & (away < 3 * np.pi / 4)
        goes_on = (is_met & straight[wheels]).any(axis=1)
        ends = straight & is_met.any(axis=1) & ~goes_on
        return tuple(zip((~straight & goes_on).tolist(), ends.tolist(), strict=True))

    @cached_property
    def all_have_to_stop(self) -> bool | None:
        """Whether every road to the junction has a stop sign; None if unknown.

        The signs of roads that begin at the map's edge are unknown.
        """
        ways = [way for way in self.ways if not way.on_rails]
        signs = [{sign for entry in way.approaches for sign in entry.signs} for way in ways]
        if any(ALL_STOP in sign for sign in signs):
            return True
        lacks = [way.entries and "STOP" not in sign for sign, way in zip(signs, ways, strict=True)]
        untold = [any("STOP" in entry.untold_signs for entry in way.approaches) for way in ways]
        if any(missing and not may for missing, may in zip(lacks, untold, strict=True)):
            return False
        return None if any(lacks) or not all(way.entries for way in ways) else True


def before_joining(way: JunctionWay, other: JunctionWay) -> tuple[Lanelet, ...]:
    """The lanelets of a way before the first shared one, in the order of the other way."""
    shared = next((x.id for x in other.lanelets if x.id in way.names), "")
    return tuple(takewhile(lambda lanelet: lanelet.id != shared, way.lanelets))


def _meeting(way: JunctionWay, other: JunctionWay) -> tuple[Interval, Interval] | None:
    if way.entries & other.entries:
        return None
    foes = way.lanelets[0].foes
    if foes is not None and not foes & other.names:
        return None
    for one in (way, other) if way.names & other.names else ():
        # After joining, vehicles follow each other: the ways meet before that, or where they leave
        shared = next(x.id for x in one.lanelets if x.id in way.names & other.names)
        parts = [_until(x, shared) for x in (way, other)]
        if all(part.lanelets for part in parts) and (met := _overlap(*parts)):
            return met
    return None if way.names & other.names else _overlap(way, other)


def _until(way: JunctionWay, lanelet: str) -> JunctionWay:
    """The part of a way before a lanelet."""
    part = tuple(takewhile(lambda x: x.id != lanelet, way.lanelets))
    return JunctionWay(part, frozenset(), frozenset())


def _overlap(way: JunctionWay, other: JunctionWay) -> tuple[Interval, Interval] | None:
    both = shapely.intersection(way.area, other.area)
    if both.is_empty:
        return None
    points = shapely.points(shapely.get_coordinates(both))
    first, second = (
        (float(at.min()), float(at.max()))
        for at in (shapely.line_locate_point(x.line, points) for x in (way, other))
    )
    return first, second


def junctions_of(recording: Recording) -> tuple[Junction, ...]:
    """The junctions of a recording's map, in the order of their first lanelets."""
    members: dict[str, list[Lanelet]] = defaultdict(list)
    for number, junction in _junction_ids(recording).items():
        members[junction].append(recording.lanelets[number])
    # A map without any such sign is more likely one in which nobody has drawn signs
    told = bool(recording.complete & REGULATING) or any(
        lanelet.signs & REGULATING for lanelet in recording.lanelets.values()
    )
    junctions, marked = [], marks_junctions(recording)
    for name, lanelets in members.items():
        ways = tuple(_ways({lanelet.id: lanelet for lanelet in lanelets}, recording.lanelets))
        if not marked:
            ways = tuple(
                [replace(way, road_headings=_road_headings(recording, way)) for way in ways]
            )
        regulated = _regulated(lanelets, ways)
        if regulated is None and told and not _may_be_regulated(ways):
            regulated = False
        junctions.append(Junction(name, ways, regulated))
    return tuple(junctions)


def _junction_ids(recording: Recording) -> dict[str, str]:
    """Lanelet -> junction: the map's own, or else one per group of overlapping lanelets."""
    lanelets = recording.lanelets
    # Computed once: on maps without marked junctions it goes through all lanelets
    crossing = junction_lanelets(recording)
    inside = [number for number in lanelets if number in crossing]
    with_rails = [
        x.id
        for x in lanelets.values()
        if x.junction and x.id not in inside and {"rail", "level_crossing"} & x.types
    ]
    with_rails += sorted(level_crossing_lanelets(recording) - {*inside, *with_rails})
    named = {number: lanelets[number].junction for number in (*inside, *with_rails)}
    unnamed = [number for number, name in named.items() if not name]
    if unnamed:
        areas = [lanelet_area(lanelets[number]) for number in unnamed]
        parts = shapely.get_parts(shapely.union_all(areas))
        at, part = shapely.STRtree(parts).query(areas, predicate="intersects")
        for index, piece in zip(at.tolist(), part.tolist(), strict=True):
            named[unnamed[index]] = f"junction {piece + 1}"
    return named


def _ways(members: Mapping[str, Lanelet], known: Mapping[str, Lanelet]) -> Iterator[JunctionWay]:
    def onward(chain: tuple[Lanelet, ...]) -> Iterator[tuple[Lanelet, ...]]:
        inside = [members[x] for x in chain[-1].successors if x in members]
        inside = [x for x in inside if x not in chain]
        if not inside or len(chain) == MOST_LANELETS:
            yield chain
        for lanelet in inside:
            yield from onward((*chain, lanelet))

    for lanelet in members.values():
        entries = [x for x in lanelet.predecessors if x not in members]
        if entries or not lanelet.predecessors:
            names = frozenset(entries)
            before = tuple([known[x] for x in names if x in known])
            short = [x for x in before if line_length(x.centre) < _SHORT_M]
            further = [known[x] for entry in short for x in entry.predecessors if x in known]
            for chain in onward((lanelet,)):
                exits = frozenset(x for x in chain[-1].successors if x not in members)
                if _is_no_corner(chain):
                    yield JunctionWay(chain, names, exits, before, (*before, *further))


def _road_headings(recording: Recording, way: JunctionWay) -> tuple[float, float]:
    """The road's directions (rad) ``TURN_REACH_M`` before and behind a way, or at its ends."""
    first, last, known = way.lanelets[0], way.lanelets[-1], recording.lanelets
    begins, ends = way.headings
    for entry in [known[x].centre for x in first.predecessors if x in known][:1]:
        begins = _heading_from(entry[::-1]) + np.pi
    for exit_ in [known[x].centre for x in last.successors if x in known][:1]:
        ends = _heading_from(exit_)
    return begins, ends


def _heading_from(line: Points) -> float:
    """A line's direction (rad) ``TURN_REACH_M`` from its beginning, or at its end if shorter."""
    far = arc_lengths(line)[1:]
    piece = min(int(far.searchsorted(TURN_REACH_M)), len(far) - 1)
    return _heading(line[piece : piece + 2])


def _is_no_corner(chain: tuple[Lanelet, ...]) -> bool:
    """Whether lanelets follow each other without a gap, as those of one way do."""
    return all(np.hypot(*(b.centre[0] - a.centre[-1])) < 1.0 for a, b in pairwise(chain))


def _regulated(lanelets: list[Lanelet], ways: tuple[JunctionWay, ...]) -> bool | None:
    """True if signs or lights determine priority, False if the map says that nothing does."""
    if any("unregulated" in lanelet.types for lanelet in lanelets):
        return False
    if any(lanelet.first is not None for lanelet in lanelets):
        return True
    entries = [entry for way in ways for entry in way.approaches]
    signed = any(
        entry.signs & REGULATING or any(map(is_there, entry.lights))
        for entry in (*entries, *lanelets)
    )
    return True if signed else None


def _may_be_regulated(ways: tuple[JunctionWay, ...]) -> bool:
    """Whether a junction may have unobserved lights, or signs whose place is unknown."""
    entries = [entry for way in ways for entry in way.approaches]
    return any(
        entry.untold_signs & REGULATING or not all(map(is_there, entry.lights)) for entry in entries
    )


def entry_lights(
    way: JunctionWay,
) -> Iterator[tuple[Lanelet, tuple[Light | ObservedLight, ...]]]:
    """Each lanelet right before a way, with its light for the way, or all of its lights."""
    for entry in way.before:
        own = entry.lights_to.get(way.lanelets[0].id)
        yield entry, (own,) if own else entry.lights


def places_along(line: shapely.LineString, places: NDArray[np.object_]) -> NDArray[np.float64]:
    """Arc lengths (m) along a line beside places: below 0 before its start, beyond its end above.

    A junction covers all of its ways, and some begin within it.
    """
    points, corners = shapely.get_coordinates(places), shapely.get_coordinates(line)
    along: NDArray[np.float64] = shapely.line_locate_point(line, places)
    for end, before, beyond in ((0, 1, -1), (-1, -2, 1)):
        ahead = corners[end] - corners[before]
        away = (points - corners[end]) @ (ahead / max(float(np.hypot(*ahead)), _NO_WAY_M))
        at_end = along <= 0 if beyond < 0 else along >= line.length
        along = np.where(at_end, along + beyond * np.maximum(away, 0.0), along)
    return along


def extended(line: shapely.LineString, places: NDArray[np.object_]) -> shapely.LineString:
    """A line, with straight pieces at both ends for places before and beyond it.

    A junction covers all of its ways: who drives on along one that is shorter does not leave it.
    """
    along, corners = places_along(line, places), shapely.get_coordinates(line)
    ends = []
    for end, before, more in (
        (0, 1, -float(along.min())),
        (-1, -2, float(along.max()) - line.length),
    ):
        ahead = corners[end] - corners[before]
        length = max(float(np.hypot(*ahead)), _NO_WAY_M)
        ends.append(corners[end] + ahead / length * max(more, 0.0))
    return shapely.LineString(np.vstack((ends[0], corners, ends[1])))
