"""Tables of each name's values: rows are objects, columns are states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError, encode_partly_known
from rulec.monitoring.batch.joined.joined_states import joined_states
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.implied_values import with_defined_words, with_derived_values
from rulec.monitoring.state_view import value_in
from rulec.monitoring.told_names import untold_names, with_untold, words_meant
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.trace import Trace
from rulec.trace.partly_known.column_values import partly_known
from rulec.trace.partly_known.partly_known_values import (
    NameValues,
    Number,
)
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from rulec.vocabulary.written_numbers import WrittenNumber


def at_places(rows: NameValues, chosen: Indices | None, states: Indices | None) -> NameValues:
    """Some of the rows (None for all) and columns, which may differ by row."""

    def part(half: Array) -> Array:
        if states is None:
            return half if chosen is None else half[chosen]
        return half[(np.arange(len(half)) if chosen is None else chosen)[:, None], states]

    return rows.each(part)


class NameTables:
    """Tables of checked traces of one shape, each built on demand.

    ``objects`` are those of the first trace with their ``types``, in its order; all traces have
    equally many, of the same types. The rows are the objects of the first trace, then those of the
    second, and so on; the columns of a trace shorter than ``n_states`` end in arbitrary values.
    ``last`` is the last state of each trace, ``spans`` (objects x 2) the first and last state in
    which each object is present. ``vocabulary`` has unknown defaults for names that the source
    cannot provide.
    """

    def __init__(self, traces: JoinedTraces, vocabulary: Vocabulary) -> None:
        untold = untold_names(vocabulary, traces.kind.told)
        self.vocabulary = with_untold(vocabulary, untold) if untold else vocabulary
        declared = self.vocabulary.declarations.items()
        dark = {name: UNKNOWN for name, item in declared if item.default is None}
        meant = words_meant(self.vocabulary, traces.kind.told)
        self._traces, self._stack = traces, Stack(traces, self.vocabulary, meant, dark)
        self._n_objects = traces.n_objects[0]
        self.objects = tuple(traces.names[: self._n_objects])
        self.types = tuple(traces.types[: self._n_objects])
        self.n_traces = len(traces.lengths)
        self.last: Indices = traces.lengths - 1
        self.spans = traces.spans
        self.n_states = int(traces.lengths.max())
        self._states = np.arange(self.n_states)
        self._known: dict[str, NameValues] = {}

    def world(self, name: str) -> NameValues:
        """The rows of a name that is about no object, one for each trace."""
        if name not in self._known:
            spans = np.stack([np.zeros_like(self.last), self.last], axis=1)
            self._known[name] = self._rows(name, self._stack.begins[:-1], spans)
        return self._known[name]

    def about(self, name: str) -> NameValues:
        """The rows of a name that is about one object, one for each object of the traces."""
        if name not in self._known:
            self._known[name] = self._rows(name, self._stack.starts[:-1], self.spans)
        return self._known[name]

    def about_several(self, name: str, rows: Indices) -> NameValues:
        """The rows of a name for these objects (rows x parameters), given by their numbers."""
        if rows.shape[1] > 2:
            return self._by_states(name, rows)
        stack = self._stack
        since, until = stack.firsts[rows].max(axis=1), stack.lasts[rows].min(axis=1)
        states = stack.begins[stack.trace_of[rows[:, 0]]][:, None] + self._states
        states = np.minimum(np.maximum(states, since[:, None]), until[:, None])
        first, second = (own.repeat(self.n_states) for own in rows.T)
        places = stack.pairs.places(first, second, states.ravel())
        return self._stack.named(name, places.reshape(states.shape))

    def _rows(self, name: str, begins: Indices, spans: Indices) -> NameValues:
        """Rows of values that begin at these places, for states from the first to the last."""
        first, last = spans[:, :1], spans[:, 1:]
        within = np.minimum(np.maximum(self._states, first), last)
        rows = self._stack.named(name, begins[:, None] + within - first)
        if not self.vocabulary.declarations[name].constant:
            return rows
        return _constant(rows, within == self._states)

    def _by_states(self, name: str, rows: Indices) -> NameValues:
        """The rows of a name about more than two objects."""
        declaration, values = self.vocabulary.declarations[name], list[Any]()
        for row in rows.tolist():
            items = [self._traces.names[item] for item in row]
            trace = self._traces.trace(row[0] // self._n_objects)
            states = with_defined_words(trace, self.vocabulary).states
            own = [value_in(state, name, items, declaration) for state in states]
            values += [*own, *own[-1:] * (self.n_states - len(own))]
        shape = len(rows), self.n_states
        column = encode_partly_known([UNKNOWN if x is None else x for x in values], declaration)
        column = column.at(np.arange(len(values)).reshape(shape))
        upper = column.values if column.upper is None else column.upper
        return partly_known(declaration, column.values, upper, column.unknown)


def tables_of(trace: Trace | TraceArrays, vocabulary: Vocabulary) -> NameTables:
    """The name tables of a checked trace."""
    if isinstance(trace, TraceArrays):
        return NameTables(JoinedTraces.of_arrays([trace], vocabulary), vocabulary)
    if vocabulary.constants or vocabulary.implied:
        trace = with_derived_values(spelled_out(trace, vocabulary), vocabulary)
    try:
        joined = joined_states([trace], vocabulary)
    except UnencodableError:
        states = tuple([_plain(state, trace, vocabulary) for state in trace.states])
        plain = replace(trace, states=states)
        joined = replace(joined_states([plain], vocabulary), trace=[trace].__getitem__)
    return NameTables(joined, vocabulary)


def _plain(state: Mapping[str, Any], trace: Trace, vocabulary: Vocabulary) -> dict[str, Any]:
    """A state with names about at most two of the objects, and with numbers that are floats."""
    objects, is_subtype = trace.objects, vocabulary.is_subtype

    def plain(value: Any, kinds: Sequence[str]) -> Any:
        if kinds and isinstance(value, Mapping):
            own = {x: inner for x, inner in value.items() if x in objects}
            own = {x: inner for x, inner in own.items() if is_subtype(objects[x], kinds[0])}
            return {item: plain(inner, kinds[1:]) for item, inner in own.items()}
        if type(value) is int and abs(value) > EXACT_IN_FLOATS:
            value = WrittenNumber(Fraction(value))
        # What no float represents exactly lies between two of them.
        return Interval(*value.neighbours) if isinstance(value, WrittenNumber) else value

    about = {name: own.parameters for name, own in vocabulary.declarations.items()}
    few = (name for name in state if name in about and len(about[name]) <= 2)
    return {name: plain(state[name], about[name]) for name in few}


def _constant(rows: NameValues, there: Flags) -> NameValues:
    """Rows of a constant, whose value in some state holds in all."""
    is_stated = there & ~rows.unknown
    any_stated = is_stated.any(axis=1, keepdims=True)
    if isinstance(rows, Number) and (is_stated & (rows.low != rows.high)).any():
        # The intersection of several intervals.
        low = np.where(is_stated, rows.low, -np.inf).max(axis=1, keepdims=True)
        high = np.where(is_stated, rows.high, np.inf).min(axis=1, keepdims=True)
        return Number(np.where(any_stated, low, rows.low), np.where(any_stated, high, rows.high))
    first = is_stated.argmax(axis=1)[:, None]
    return rows.each(lambda half: np.where(any_stated, np.take_along_axis(half, first, 1), half))
