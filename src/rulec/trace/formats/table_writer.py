"""Traces laid out as rows, to be written. ``rows`` reads them back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from rulec.trace.formats.table_reader import OWN
from rulec.trace.trace_model import State, Trace, Value

Kinds = Mapping[str, type]
"""For each name that states speak of what its values are: ``bool``, ``float`` or ``str``."""


def kinds_in(states: Iterable[State]) -> dict[str, type]:
    """Kinds of all names that states speak of, in order."""
    kinds: dict[str, type] = {}
    for state in states:
        for name, value in state.items():
            for leave in _leaves(value):
                kinds.setdefault(name, float if type(leave) is int else type(leave))
    return kinds


def _leaves(value: Any) -> Iterator[Value]:
    if isinstance(value, Mapping):
        for inner in value.values():
            yield from _leaves(inner)
    else:
        yield value


def columns_for(kinds: Kinds) -> list[str]:
    """Columns of a table for these names.

    ValueError if two columns have one name.
    """
    taken = [name for name in kinds if name in OWN]
    if taken:
        raise ValueError(f"`{taken[0]}` is a column of its own and cannot be a name")
    return [*OWN, *kinds]


def rows_of(trace: Trace, names: Sequence[str]) -> Iterator[list[Any]]:
    """Rows of a trace: of states, of their objects, of pairs.

    What is said of objects that are not there is left out; no rule reads it.
    """
    for step, state in enumerate(trace.states):
        start = [trace.id, step, trace.step_s]
        yield [*start, None, None, None, *(_about(state, name, ()) for name in names)]
        there = [item for item in trace.objects if _is_there(item, step, trace)]
        for item in there:
            values = [_about(state, name, (item,)) for name in names]
            yield [*start, item, trace.objects[item], None, *values]
        for item in there:
            for other in there:
                values = [_about(state, name, (item, other)) for name in names]
                if any(value is not None for value in values):
                    yield [*start, item, trace.objects[item], other, *values]


def _is_there(item: str, step: int, trace: Trace) -> bool:
    first, last = trace.present.get(item, (0, len(trace.states) - 1))
    return first <= step <= last


def _about(state: State, name: str, items: Sequence[str]) -> Value | None:
    """Value of a name for just these objects in a state."""
    value: Any = state.get(name)
    for item in items:
        value = value.get(item) if isinstance(value, Mapping) else None
    return None if isinstance(value, Mapping) else value
