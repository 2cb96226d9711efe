"""Tables of each name's values: rows are objects, columns are states."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.batch.columns.columnize import UnencodableError, columnize
from rulec.monitoring.batch.trace_groups import group_traces
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.state_view import value_in, with_values
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.untold_names import untold_names, with_untold
from rulec.trace import Trace
from rulec.trace.trace_columns import Array, TraceColumns
from rulec.vocabulary import Declaration, Enumeration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue
from rulec.vocabulary.vocabulary_model import least_value
from rulec.vocabulary.written_numbers import WrittenNumber


@dataclass(frozen=True, slots=True, eq=False)
class ValueRows:
    """The values of a name (rows x states): Booleans, numbers, or places among those declared.

    A number lies between ``values`` and ``upper``; where a value is ``unknown`` its entry is
    meaningless.
    """

    values: Array
    upper: Array
    unknown: Flags

    def at(
        self, *, rows: NDArray[np.intp] | None = None, states: NDArray[np.intp] | None = None
    ) -> ValueRows:
        """Some of the rows and some of the columns; the columns may differ by row."""
        chosen: Any = slice(None) if rows is None else rows
        if states is not None:
            numbers = np.arange(len(self.values)) if rows is None else rows
            chosen = numbers[:, None], states
        values = self.values[chosen]
        upper = values if self.upper is self.values else self.upper[chosen]
        return ValueRows(values, upper, self.unknown[chosen])


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
        last: NDArray[np.intp],
        vocabulary: Vocabulary,
    ) -> None:
        untold = untold_names(vocabulary, told)
        self.vocabulary = with_untold(vocabulary, untold) if untold else vocabulary
        self.objects = tuple(objects)
        self.types = tuple(objects.values())
        self.last = last
        self.n_states = int(last.max()) + 1
        self._known: dict[str, ValueRows] = {}

    @property
    def n_traces(self) -> int:
        """The number of traces."""
        return len(self.last)

    @property
    @abstractmethod
    def spans(self) -> NDArray[np.intp]:
        """The first and last state of each object."""

    def world(self, name: str) -> ValueRows:
        """The rows of a name that is about no object, one for each trace."""
        if name not in self._known:
            self._known[name] = self._world(name)
        return self._known[name]

    def about(self, name: str) -> ValueRows:
        """The rows of a name that is about one object, one for each object of the traces."""
        if name not in self._known:
            self._known[name] = self._about(name)
        return self._known[name]

    @abstractmethod
    def about_several(self, name: str, rows: NDArray[np.intp]) -> ValueRows:
        """The rows of a name for these objects (rows x parameters), given by their numbers."""

    @abstractmethod
    def _world(self, name: str) -> ValueRows:
        """The rows of a name about no object."""

    @abstractmethod
    def _about(self, name: str) -> ValueRows:
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
    def spans(self) -> NDArray[np.intp]:
        """The first and last state of each object."""
        spans = np.zeros((self.n_traces, len(self.objects), 2), dtype=np.intp)
        spans[:, :, 1] = self.last[:, None]
        for place, item in enumerate(self.objects):
            if item in self._columns.present:
                spans[:, place] = self._columns.present[item]
        return spans.reshape(-1, 2)

    def about_several(self, name: str, rows: NDArray[np.intp]) -> ValueRows:
        """The rows of a name for these objects (rows x parameters), given by their numbers."""
        n_objects = len(self.objects)
        trace, places = rows[:, 0] // n_objects, rows % n_objects
        codes = places @ n_objects ** np.arange(rows.shape[1])
        _, first, which = np.unique(codes, return_index=True, return_inverse=True)
        chosen = [tuple([self.objects[place] for place in row]) for row in places[first].tolist()]
        stacked = self._stacked(name, chosen)
        return stacked.at(rows=trace * len(chosen) + which)

    def _world(self, name: str) -> ValueRows:
        return self._stacked(name, [()])

    def _about(self, name: str) -> ValueRows:
        return self._stacked(name, [(item,) for item in self.objects])

    def _stacked(self, name: str, about: Sequence[tuple[str, ...]]) -> ValueRows:
        """The rows of a name for these objects of the first trace, then of the second, etc."""
        columns, cells = self._columns, self._cells
        default, is_known = default_of(self.vocabulary.declarations[name])
        shape = (self.n_traces, len(about), self.n_states)
        values = np.empty(shape, dtype=type(default))
        upper: Array | None = None
        unknown = np.zeros(shape, dtype=bool)
        for row, items in enumerate(about):
            key = name, items
            column = columns.values.get(key)
            if column is None:
                values[:, row], unknown[:, row] = default, not is_known
                continue
            values[:, row] = column[cells]
            if key in columns.unknown:
                unknown[:, row] = columns.unknown[key][cells]
            if key in columns.upper:
                if upper is None:
                    upper = values.copy()
                upper[:, row] = columns.upper[key][cells]
            elif upper is not None:
                upper[:, row] = values[:, row]
        flat = (-1, self.n_states)
        lowest = values.reshape(flat)
        highest = lowest if upper is None else np.maximum(upper, values).reshape(flat)
        return ValueRows(lowest, highest, unknown.reshape(flat))


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
