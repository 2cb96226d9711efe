"""Every recorded drive as a trace: what a vehicle did, state by state, in rulebooks' words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

import numpy as np

from rulec.drives.company import Presence, presences
from rulec.drives.crossing_words import crossing_words
from rulec.drives.ego_words import ego_words
from rulec.drives.everyone import Everyone, everyone
from rulec.drives.fitting import fitted, named_types
from rulec.drives.flow import flow_words
from rulec.drives.ground import on_crosswalks, on_lanes
from rulec.drives.junction_words import junction_words
from rulec.drives.junctions import in_junctions
from rulec.drives.lane_change_words import lane_change_words
from rulec.drives.map_words import map_words
from rulec.drives.mark_words import mark_words
from rulec.drives.nearness import near
from rulec.drives.other_words import other_words
from rulec.drives.placed import Placed, placed
from rulec.drives.road import Road, road_along
from rulec.drives.thresholds import USUAL, Thresholds
from rulec.drives.view import Side, View, view
from rulec.drives.ways import Stretch, stretches
from rulec.drives.whereabouts import Moments, whereabouts
from rulec.drives.words import Words
from rulec.scenario.recorded.kinds import WORDS
from rulec.scenario.recorded.recording import Recording
from rulec.trace import State, Trace, Value
from rulec.vocabulary import Vocabulary

FEWEST_STATES = 2

MOST_PLACES = 1 << 19
"""Of longer recordings only those are placed along a road who are there while ego drives on it."""

_KINDS: Mapping[str, type] = {"b": bool, "f": float, "i": float}
_DRIVERS = ("vehicle", "light_rider")


@dataclass(frozen=True, slots=True)
class Drive:
    """What ``ego`` did from ``start_s`` (s of the recording) on.

    ``kinds`` are the words that the recording supplies, whether or not there is anybody to say them
    of, and what their values are.
    """

    ego: str
    start_s: float
    trace: Trace
    kinds: Mapping[str, type]

    @property
    def words(self) -> frozenset[str]:
        """The words that the recording supplies."""
        return frozenset(self.kinds)

    def time_s(self, state: int | None) -> float:
        """When a state was (s of the recording); None is the last one."""
        number = len(self.trace.states) - 1 if state is None else state
        return round(self.start_s + number * self.trace.step_s, 9)


@dataclass(frozen=True, slots=True)
class NoDrive:
    """Why there is nothing to say of what ``ego`` did."""

    ego: str
    why: str


@dataclass(frozen=True, slots=True)
class Telling:
    """In which words: those of a vocabulary, if there is one, and of these only some ``names``.

    ``assumed`` is what holds in every state, whatever the recording says.
    """

    vocabulary: Vocabulary | None = None
    names: frozenset[str] | None = None
    assumed: Mapping[str, Value] = field(default_factory=dict)


EVERYTHING = Telling()


class Drives:
    """The drives of a recording. Roads that several vehicles drive are worked out once."""

    def __init__(
        self,
        recording: Recording,
        side: Side,
        thresholds: Thresholds = USUAL,
        telling: Telling = EVERYTHING,
    ) -> None:
        self.recording = recording
        self._thresholds = thresholds
        self._telling = telling
        self._side: Side = side
        self._people = everyone(recording, thresholds)
        self._junctions = in_junctions(recording)
        self._ground = (
            on_lanes(recording, self._people),
            on_crosswalks(recording, self._people),
        )
        self._moments = whereabouts(recording, self._people)
        self._roads: dict[tuple[str, ...], tuple[Road, Placed | None] | str] = {}

    def egos(self) -> tuple[str, ...]:
        """Whoever moves and steers, in the order of the file."""
        return tuple(
            one.id
            for one in self._people.participants
            if not one.standing and set(WORDS.get(one.type, ())).intersection(_DRIVERS)
        )

    def kinds(self) -> dict[str, type]:
        """The words of all drives, and what their values are; empty if there is no drive."""
        drives = (one for ego in self.egos() for one in self.of(ego) if isinstance(one, Drive))
        first = next(drives, None)
        return {} if first is None else dict(first.kinds)

    def of(self, ego: str) -> Iterator[Drive | NoDrive]:
        """The drives of one vehicle: one, unless it leaves its road or the recording jumps."""
        row = next(k for k, one in enumerate(self._people.participants) if one.id == ego)
        found = [
            one
            for part in _unbroken(self._people, row, self._moments.get(row, {}))
            for one in stretches(self.recording, part)
            if one.last - one.first + 1 >= FEWEST_STATES
        ]
        if not found:
            yield NoDrive(ego, "it is never on a lane that leads its way")
        for number, stretch in enumerate(found, 1):
            name = ego if number == 1 else f"{ego}#{number}"
            yield self._drive(row, name, stretch)

    def _drive(self, row: int, name: str, stretch: Stretch) -> Drive | NoDrive:
        ego = self._people.participants[row].id
        answer = self._road(stretch.way)
        if isinstance(answer, str):
            return NoDrive(ego, answer)
        road, everybody = answer
        people, ground, columns = self._people, self._ground, (stretch.first, stretch.last)
        if everybody is None:
            span = slice(stretch.first, stretch.last + 1)
            rows = people.there[:, span].any(axis=1).nonzero()[0]
            row = int(np.searchsorted(rows, row))
            people, columns = people.part(rows, span), (0, stretch.last - stretch.first)
            ground = ground[0][rows, span], ground[1][rows, span]
            everybody = placed(people, road)
        if np.isnan(everybody.w[row, columns[0] : columns[1] + 1]).any():
            return NoDrive(ego, "it is far from its road for a while")
        there = near(row, people, everybody, road, self._thresholds)
        seen = view(
            self.recording,
            self._thresholds,
            self._side,
            road,
            people,
            everybody,
            there,
            ground,
            row,
            columns,
        )
        return _told(seen, ego, name, self._telling)

    def _road(self, way: tuple[str, ...]) -> tuple[Road, Placed | None] | str:
        """A road, and everybody's place along it unless that were too much to remember."""
        if way not in self._roads:
            try:
                road = road_along(self.recording, way, self._junctions)
                few = self._people.there.size <= MOST_PLACES
                self._roads[way] = road, placed(self._people, road) if few else None
            except ValueError as reason:
                self._roads[way] = f"its road makes no sense, {reason}"
        return self._roads[way]


def _unbroken(people: Everyone, row: int, moments: Moments) -> Iterator[Moments]:
    """The moments of somebody, parted where the recording does not have them for a while."""
    gone = np.cumsum(~people.there[row])
    for _, columns in groupby(moments, key=lambda column: int(gone[column])):
        yield {column: moments[column] for column in columns}


def _told(seen: View, ego: str, name: str, telling: Telling) -> Drive:
    words = ego_words(seen) | other_words(seen) | map_words(seen) | junction_words(seen)
    words |= crossing_words(seen) | flow_words(seen) | lane_change_words(seen) | mark_words(seen)
    types = [WORDS.get(one.type, WORDS["unknown"]) for one in seen.people.participants]
    if telling.vocabulary is not None:
        words = fitted(words, types, telling.vocabulary, telling.names)
    words |= Words({name: np.full(seen.states, value) for name, value in telling.assumed.items()})
    there = list(presences(seen))
    objects = named_types({one.name: types[one.row] for one in there}, telling.vocabulary)
    there = [one for one in there if one.name in objects]
    last = seen.states - 1
    trace = Trace(
        name,
        seen.recording.step_s,
        objects,
        _states(words, there, seen.states),
        {one.name: (one.first, one.last) for one in there if (one.first, one.last) != (0, last)},
    )
    start_s = round(seen.first_step * seen.recording.step_s, 9)
    return Drive(ego, start_s, trace, _kinds(words))


def _kinds(words: Words) -> dict[str, type]:
    columns = {**words.world, **words.about}
    return {name: _KINDS.get(column.dtype.kind, str) for name, column in columns.items()}


def _states(words: Words, there: Sequence[Presence], count: int) -> tuple[State, ...]:
    states: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, column in words.world.items():
        unknown = words.unknown.get(name)
        for state, value in enumerate(column.tolist()):
            if unknown is None or not unknown[state]:
                states[state][name] = value
    for name, rows in words.about.items():
        only = words.only.get(name)
        said: list[dict[str, Any]] = [{} for _ in range(count)]
        for one in there:
            if only is None or only[one.row]:
                span = range(one.first, one.last + 1)
                for state, value in zip(span, rows[one.row, span].tolist(), strict=True):
                    said[state][one.name] = value
        for state, values in enumerate(said):
            if values:
                states[state][name] = values
    return tuple(states)
