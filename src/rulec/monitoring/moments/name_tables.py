"""Tables of each name's values: rows are objects, columns are states."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.batch.columns.columnize import UnencodableError, columnize
from rulec.monitoring.batch.trace_groups import group_traces
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.state_view import value_in, with_values
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.untold_names import untold_names, with_untold
from rulec.trace import Trace
from rulec.trace.partly_known.partly_known_values import (
    EnumeratedChoice,
    NameValues,
    Number,
    Truth,
)
from rulec.trace.trace_columns import Array, TraceColumns
from rulec.vocabulary import Declaration, Enumeration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue
from rulec.vocabulary.vocabulary_model import least_value
from rulec.vocabulary.written_numbers import WrittenNumber


def at_places(rows: NameValues, chosen: Indices | None, states: Indices | None) -> NameValues:
    """Some of the rows (None for all) and columns, which may differ by row."""

    def part(half: Array) -> Array:
        if states is None:
            return half if chosen is None else half[chosen]
        return half[(np.arange(len(half)) if chosen is None else chosen)[:, None], states]

    return rows.each(part)


def partly_known(
    declaration: Declaration | None, values: Array, upper: Array, unknown: Flags | None
) -> NameValues:
    """The values of a name: Booleans, numbers up to ``upper``, or places among those declared.

    Where they are ``unknown`` their entries are meaningless.
    """
    if unknown is not None and not unknown.any():
        unknown = None
    if isinstance(declaration, Enumeration):
        n_values = len(declaration.values)
        kind = np.min_scalar_type(1 << n_values)
        bits = np.array([1 << place for place in range(n_values)], dtype=kind)
        if unknown is None:
            return EnumeratedChoice(bits[values])
        return EnumeratedChoice(np.where(unknown, bits.sum(dtype=kind), bits[values]))
    if isinstance(declaration, Quantity):
        if unknown is None:
            return Number(values, upper)
        return Number(np.where(unknown, -np.inf, values), np.where(unknown, np.inf, upper))
    truth = Truth.known(values)
    return truth if unknown is None else truth.unknown_at(unknown)


class NameTables(ABC):
    """Tables of checked traces of one shape, each built on demand.

    ``objects`` are those of the first trace with their types, in its order; all traces have equally
    many, of the same types. The rows are the objects of the first trace, then those of the second,
    and so on; the columns of a trace shorter than ``n_states`` end in arbitrary values. ``last`` is
    the last state of each trace, ``spans`` (objects x 2) the first and last state in which each
    object is present. ``vocabulary`` has unknown defaults for names that the source cannot provide.
    """

    def __init__(
        self,
        told: frozenset[str] | None,
        objects: Mapping[str, str],
        last: Indices,
        vocabulary: Vocabulary,
    ) -> None:
        untold = untold_names(vocabulary, told)
        self.vocabulary = with_untold(vocabulary, untold) if untold else vocabulary
        self.objects = tuple(objects)
        self.types = tuple(objects.values())
        self.last = last
        self.n_states = int(last.max()) + 1
        self._known: dict[str, NameValues] = {}

    @property
    def n_traces(self) -> int:
        """The number of traces."""
        return len(self.last)

    @property
    @abstractmethod
    def spans(self) -> Indices:
        """The first and last state of each object."""

    def world(self, name: str) -> NameValues:
        """The rows of a name that is about no object, one for each trace."""
        if name not in self._known:
            self._known[name] = self._world(name)
        return self._known[name]

    def about(self, name: str) -> NameValues:
        """The rows of a name that is about one object, one for each object of the traces."""
        if name not in self._known:
            self._known[name] = self._about(name)
        return self._known[name]

    @abstractmethod
    def about_several(self, name: str, rows: Indices) -> NameValues:
        """The rows of a name for these objects (rows x parameters), given by their numbers."""

    @abstractmethod
    def _world(self, name: str) -> NameValues:
        """The rows of a name about no object."""

    @abstractmethod
    def _about(self, name: str) -> NameValues:
        """The rows of a name about one object."""


class ColumnTables(NameTables):
    """Tables of traces that are given as columns, which contain everything that axioms imply."""

    def __init__(
        self, columns: TraceColumns, vocabulary: Vocabulary, told: frozenset[str] | None = None
    ) -> None:
        layout = columns.layout
        last = (layout.lengths - 1).astype(np.intp)
        super().__init__(told, columns.objects, last, vocabulary)
        self._columns = columns
        step = np.minimum(np.arange(layout.n_steps), last[:, None])
        self._cells = layout.starts[step] + np.arange(layout.n_traces)[:, None]

    @property
    def spans(self) -> Indices:
        """The first and last state of each object."""
        spans = np.zeros((self.n_traces, len(self.objects), 2), dtype=np.intp)
        spans[:, :, 1] = self.last[:, None]
        for place, item in enumerate(self.objects):
            if item in self._columns.present:
                spans[:, place] = self._columns.present[item]
        return spans.reshape(-1, 2)

    def about_several(self, name: str, rows: Indices) -> NameValues:
        """The rows of a name for these objects (rows x parameters), given by their numbers."""
        n_objects = len(self.objects)
        trace, places = rows[:, 0] // n_objects, rows % n_objects
        codes = places @ n_objects ** np.arange(rows.shape[1])
        _, first, which = np.unique(codes, return_index=True, return_inverse=True)
        chosen = [tuple([self.objects[place] for place in row]) for row in places[first].tolist()]
        stacked = self._stacked(name, chosen)
        return at_places(stacked, trace * len(chosen) + which, None)

    def _world(self, name: str) -> NameValues:
        return self._stacked(name, [()])

    def _about(self, name: str) -> NameValues:
        return self._stacked(name, [(item,) for item in self.objects])

    def _stacked(self, name: str, about: Sequence[tuple[str, ...]]) -> NameValues:
        """The rows of a name for these objects of the first trace, then of the second, etc."""
        columns, cells = self._columns, self._cells
        declaration = self.vocabulary.declarations[name]
        default, is_known = default_of(declaration)
        shape = (self.n_traces, len(about), self.n_states)
        values = np.empty(shape, dtype=type(default))
        unknown, upper = np.zeros(shape, dtype=bool), values
        if any((name, items) in columns.upper for items in about):
            upper = np.empty(shape, dtype=type(default))
        for row, items in enumerate(about):
            key = name, items
            column = columns.values.get(key)
            if column is None:
                values[:, row] = upper[:, row] = default
                unknown[:, row] = not is_known
                continue
            values[:, row] = column[cells]
            if upper is not values:
                upper[:, row] = np.maximum(columns.upper.get(key, column), column)[cells]
            if key in columns.unknown:
                unknown[:, row] = columns.unknown[key][cells]
        # One array for both ends says that they are equal
        flat = values.reshape(-1, self.n_states)
        highest = flat if upper is values else upper.reshape(flat.shape)
        return partly_known(declaration, flat, highest, unknown.reshape(flat.shape))


def tables_of_trace(trace: Trace, vocabulary: Vocabulary) -> NameTables:
    """Tables of a trace with states."""
    if vocabulary.constants or vocabulary.implied:
        trace = with_derived_values(spelled_out(trace, vocabulary), vocabulary)
    untold = untold_names(vocabulary, trace.told)
    columns = _columns_of(trace, with_untold(vocabulary, untold) if untold else vocabulary)
    return ColumnTables(columns, vocabulary, trace.told)


def default_of(declaration: Declaration | None) -> tuple[bool | float | int, bool]:
    """A name's default, encoded as in columns, and whether it has one.

    If not, an arbitrary value.
    """
    if declaration is None:
        return False, False
    default: Any = declaration.default
    is_known = default is not None and default is not UNKNOWN
    value = default if is_known else least_value(declaration)
    if isinstance(declaration, Enumeration):
        return declaration.values.index(str(value)), is_known
    return value if isinstance(value, bool) else float(value), is_known


def _columns_of(trace: Trace, vocabulary: Vocabulary) -> TraceColumns:
    cells = group_traces([trace]).cells
    try:
        return columnize(cells, vocabulary)
    except UnencodableError:
        # Some states lack a value, which is unknown there, or numbers are no floats.
        plain = replace(trace, states=tuple([_spelled(s, trace, vocabulary) for s in trace.states]))
        return columnize(group_traces([plain]).cells, vocabulary)


def _between_floats(value: Any) -> PartialValue:
    """A number that no float represents exactly, as the interval between two floats."""
    if type(value) is int and abs(value) > EXACT_IN_FLOATS:
        value = WrittenNumber(Fraction(value))
    plain: PartialValue = value
    return Interval(*value.neighbours) if isinstance(value, WrittenNumber) else plain


def _spelled(state: Mapping[str, Any], trace: Trace, vocabulary: Vocabulary) -> dict[str, Any]:
    """A state that mentions everything that some state mentions, if only as unknown."""
    values: dict[tuple[str, tuple[str, ...]], Any] = {}
    names = set().union(*trace.states) & vocabulary.declarations.keys()
    for name in names:
        declaration = vocabulary.declarations[name]
        rows: list[tuple[str, ...]] = [()]
        for kind in declaration.parameters:
            own = [
                item for item, type_ in trace.objects.items() if vocabulary.is_subtype(type_, kind)
            ]
            rows = [(*row, item) for row in rows for item in own]
        for row in rows:
            value = value_in(state, name, row, declaration)
            values[name, row] = UNKNOWN if value is None else _between_floats(value)
    return dict(with_values({}, values))
