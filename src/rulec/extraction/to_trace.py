"""A drive told state by state, in rulebooks' words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.drive_projection import project_columns
from rulec.extraction.signals.crossing_signals import crossing_signals
from rulec.extraction.signals.ego_signals import ego_signals
from rulec.extraction.signals.flow_signals import flow_signals
from rulec.extraction.signals.junction_signals import junction_signals
from rulec.extraction.signals.lane_change_signals import lane_change_signals
from rulec.extraction.signals.lane_mark_signals import lane_mark_signals
from rulec.extraction.signals.map_signals import map_signals
from rulec.extraction.signals.other_signals import other_signals
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.presence import Presence, presences
from rulec.scenario.recorded.obstacle_types import OBSTACLE_TYPES
from rulec.trace import State, Trace, Value
from rulec.trace.vocabulary_projection import known_types
from rulec.vocabulary import Vocabulary

_KINDS: Mapping[str, type] = {"b": bool, "f": float, "i": float}


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
class TraceWriter:
    """In which words: those of a vocabulary, if there is one, and of these only some ``names``.

    ``assumed`` is what holds in every state, whatever the recording says.
    """

    vocabulary: Vocabulary | None = None
    names: frozenset[str] | None = None
    assumed: Mapping[str, Value] = field(default_factory=dict)


ALL_SIGNALS = TraceWriter()


def to_trace(seen: DriveContext, ego: str, name: str, telling: TraceWriter) -> Drive:
    """What ``ego`` did, as a trace of that name."""
    words = ego_signals(seen) | other_signals(seen) | map_signals(seen) | junction_signals(seen)
    words |= (
        crossing_signals(seen)
        | flow_signals(seen)
        | lane_change_signals(seen)
        | lane_mark_signals(seen)
    )
    types = [
        OBSTACLE_TYPES.get(one.type, OBSTACLE_TYPES["unknown"]) for one in seen.people.participants
    ]
    if telling.vocabulary is not None:
        words = project_columns(words, types, telling.vocabulary, telling.names)
    words |= SignalColumns(
        {name: np.full(seen.states, value) for name, value in telling.assumed.items()}
    )
    there = list(presences(seen))
    own_types = {one.name: types[one.row] for one in there}
    if telling.vocabulary is None:
        objects = {object_name: own[0] for object_name, own in own_types.items()}
    else:
        objects = known_types(own_types, telling.vocabulary)
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


def _kinds(words: SignalColumns) -> dict[str, type]:
    columns = {**words.world, **words.about}
    return {name: _KINDS.get(column.dtype.kind, str) for name, column in columns.items()}


def _states(words: SignalColumns, there: Sequence[Presence], count: int) -> tuple[State, ...]:
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
