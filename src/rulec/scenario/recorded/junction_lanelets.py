"""Which lanelets lie in junctions: those that a map marks, or else those that its ways show."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from math import inf, radians
from typing import TypeAlias

from rulec.recordings.polylines import crossings
from rulec.recordings.recording import GIVE_WAY_SIGNS, Lanelet, Recording, is_lane
from rulec.scenario.recorded.route import lanelet_length, lanes_beside

_WAY_M = 30.0
"""Longest way through a junction that only joins others; roads that lead there are longer."""

_CROSSING_ANGLE = radians(30.0)


def marks_junctions(recording: Recording) -> bool:
    """Whether a recording's map marks junctions, or states that all are marked."""
    lanes = filter(is_lane, recording.lanelets.values())
    return "junctions" in recording.complete or any("intersection" in x.types for x in lanes)


def junction_lanelets(recording: Recording) -> frozenset[str]:
    """The ids of the lanelets in junctions: marked by the map, or on ways that cross or join there.

    Ways join there behind a sign, or beside crossing ones. Where the map marks any junction, or
    states that all are marked, only marked ones count.
    """
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    if not lanes or marks_junctions(recording):
        return frozenset(lanelet.id for lanelet in lanes if "intersection" in lanelet.types)
    pairs = [pair for pair in _crossing_pairs(lanes) if not any(map(_is_level_crossing, pair))]
    inside = {lanelet.id for pair in (*pairs, *_signed_joins(lanes)) for lanelet in pair}
    return frozenset(inside | _beside_crossing(recording, lanes, inside))


def _beside_crossing(
    recording: Recording, lanes: Sequence[Lanelet], crossing: Set[str]
) -> frozenset[str]:
    """The lanelets on ways through a junction that cross no other, as most turns to the near side.

    Such a way parts from a lane that leads to ``crossing`` lanelets, or from one beside it, and
    joins one that leads away from such. On maps that mark junctions, crossing lanelets are six of
    ten that are marked, and these two more; nine of ten of these are marked.
    """
    length_m = {lanelet.id: lanelet_length(lanelet) for lanelet in lanes}
    earlier, later = _links(lanes)
    others = length_m.keys() - crossing
    before = _away_m(others, length_m, crossing, earlier)
    behind = _away_m(others, length_m, crossing, later)
    free = others - before.keys() - behind.keys()
    entries, exits = (_with_lanes_beside(recording, own) for own in (before, behind))
    since = _away_m(free, length_m, entries, later)
    until = _away_m(free, length_m, exits, earlier)
    return frozenset(
        number
        for number in since.keys() & until
        if since[number] + length_m[number] + until[number] <= _WAY_M
    )


_Links: TypeAlias = Mapping[str, Set[str]]
"""Lanelet -> the lanelets right before it, or right behind it."""


def _links(lanes: Iterable[Lanelet]) -> tuple[_Links, _Links]:
    """The lanelets before and behind each one; some maps tell only one of the two of it."""
    pairs = [(lanelet.id, after) for lanelet in lanes for after in lanelet.successors]
    pairs += [(before, lanelet.id) for lanelet in lanes for before in lanelet.predecessors]
    earlier, later = defaultdict(set), defaultdict(set)
    for first, second in pairs:
        later[first].add(second)
        earlier[second].add(first)
    return earlier, later


def _away_m(
    among: Set[str], length_m: Mapping[str, float], starts: Iterable[str], onward: _Links
) -> dict[str, float]:
    """How far (m) beyond the ``starts`` the lanelets begin that do so at most ``_WAY_M`` away."""
    least: dict[str, float] = {}
    waiting = [(0.0, number) for start in starts for number in onward.get(start, ())]
    while waiting:
        away, number = waiting.pop()
        if number in among and away <= _WAY_M and away < least.get(number, inf):
            least[number] = away
            waiting += [(away + length_m[number], after) for after in onward.get(number, ())]
    return least


def _with_lanes_beside(recording: Recording, lanelets: Iterable[str]) -> frozenset[str]:
    beside = (
        number
        for own in lanelets
        for left in (True, False)
        for number in lanes_beside(recording, own, left=left)
    )
    return frozenset((*lanelets, *beside))


def _signed_joins(lanes: Sequence[Lanelet]) -> Iterator[tuple[Lanelet, ...]]:
    """Short lanelets that join, as onto a ring, where a sign makes one of them give way.

    Includes short ones that part from them: traffic that leaves there is in nobody's way.
    """
    short = {x.id: x for x in lanes if x.successors and lanelet_length(x) <= _WAY_M}
    known, joining = {lanelet.id: lanelet for lanelet in lanes}, defaultdict(list)
    for lanelet in short.values():
        for after in lanelet.successors:
            joining[after].append(lanelet)
    for ways in joining.values():
        before = [known[x] for way in ways for x in way.predecessors if x in known]
        if len(ways) > 1 and any(GIVE_WAY_SIGNS & x.signs for x in (*ways, *before)):
            parting = {x for one in before for x in one.successors if x in short}
            yield (*ways, *(short[x] for x in sorted(parting)))


def level_crossing_lanelets(recording: Recording) -> frozenset[str]:
    """The ids of the lanelets that cross at level crossings, where no junctions are marked.

    A level crossing is not a junction: a different rule says what cars must not block there.
    """
    lanes = [lanelet for lanelet in recording.lanelets.values() if is_lane(lanelet)]
    if marks_junctions(recording) or not any(map(_is_level_crossing, lanes)):
        return frozenset()
    pairs = [pair for pair in _crossing_pairs(lanes) if any(map(_is_level_crossing, pair))]
    return frozenset(lanelet.id for pair in pairs for lanelet in pair)


def _is_level_crossing(lanelet: Lanelet) -> bool:
    return "level_crossing" in lanelet.types


def _crossing_pairs(lanes: Sequence[Lanelet]) -> Iterator[tuple[Lanelet, Lanelet]]:
    """The pairs of lanelets whose middle lines cross."""
    for pair in crossings([lanelet.centre for lanelet in lanes], _CROSSING_ANGLE):
        yield lanes[pair.first], lanes[pair.second]
