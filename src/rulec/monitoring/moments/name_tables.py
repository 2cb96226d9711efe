"""What a trace says of names: for each of them a row for each object, a column for each state."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.thresholds import EXACT_IN_FLOATS
from rulec.monitoring.batch.columns.columnize import UnencodableError, columnize, one_value
from rulec.monitoring.batch.trace_groups import group_traces
from rulec.monitoring.implied_values import with_all_said
from rulec.monitoring.state_view import value_in, with_values
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.untold_names import untold_names, with_untold
from rulec.trace import Trace
from rulec.trace.trace_columns import Array, Key, TraceColumns
from rulec.vocabulary import Declaration, Enumeration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue
from rulec.vocabulary.written_numbers import WrittenNumber

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class ValueRows:
    """Values of a name (rows x states): Booleans, numbers, or places among those declared.

    A number lies between ``values`` and ``upper``; where a value is ``unknown`` its entry means
    nothing.
    """

    values: Array
    upper: Array
    unknown: Flags

    def at(
        self, *, rows: NDArray[np.intp] | None = None, states: NDArray[np.intp] | None = None
    ) -> ValueRows:
        """Some of the rows, and some of the columns."""
        chosen = (slice(None) if rows is None else rows, slice(None) if states is None else states)
        values = self.values[chosen]
        upper = values if self.upper is self.values else self.upper[chosen]
        return ValueRows(values, upper, self.unknown[chosen])


class NameTables(ABC):
    """Tables of a checked trace, each made when it is first asked for.

    ``objects`` are those of the trace, in its order, with their types, ``spans`` (objects x 2) the
    first and the last state in which each is there. ``vocabulary`` has unknown defaults for what
    the source cannot tell.
    """

    def __init__(
        self,
        told: frozenset[str] | None,
        objects: Mapping[str, str],
        n_states: int,
        vocabulary: Vocabulary,
    ) -> None:
        untold = untold_names(vocabulary, told)
        self.vocabulary = with_untold(vocabulary, untold) if untold else vocabulary
        self.objects = tuple(objects)
        self.types = tuple(objects.values())
        self.n_states = n_states
        self._known: dict[str, ValueRows] = {}

    @property
    @abstractmethod
    def spans(self) -> NDArray[np.intp]:
        """The first and the last state of each object."""

    def world(self, name: str) -> ValueRows:
        """The one row of a name that is about no object."""
        if name not in self._known:
            self._known[name] = self._world(name)
        return self._known[name]

    def about(self, name: str) -> ValueRows:
        """The rows of a name that is about one object, one for each of the trace's."""
        if name not in self._known:
            self._known[name] = self._about(name)
        return self._known[name]

    @abstractmethod
    def about_several(self, name: str, rows: Sequence[tuple[int, ...]]) -> ValueRows:
        """The rows of a name for these objects, which are given by their numbers."""

    @abstractmethod
    def _world(self, name: str) -> ValueRows:
        """The row of a name."""

    @abstractmethod
    def _about(self, name: str) -> ValueRows:
        """The rows of a name."""


class StateTables(NameTables):
    """Tables of a trace with states."""

    def __init__(self, trace: Trace, vocabulary: Vocabulary) -> None:
        super().__init__(trace.told, trace.objects, len(trace.states), vocabulary)
        if vocabulary.constants or vocabulary.implied:
            trace = with_all_said(spelled_out(trace, vocabulary), vocabulary)
        self._present = trace.present
        self._columns = _columns_of(trace, self.vocabulary)

    @property
    def spans(self) -> NDArray[np.intp]:
        """The first and the last state of each object."""
        whole = (0, self.n_states - 1)
        spans = [self._present.get(item, whole) for item in self.objects]
        return np.array(spans, dtype=np.intp).reshape(-1, 2)

    def _world(self, name: str) -> ValueRows:
        return self._stacked([(name, ())])

    def _about(self, name: str) -> ValueRows:
        return self._stacked([(name, (item,)) for item in self.objects])

    def about_several(self, name: str, rows: Sequence[tuple[int, ...]]) -> ValueRows:
        """The rows of a name for these objects, which are given by their numbers."""
        chosen = [(name, tuple([self.objects[place] for place in row])) for row in rows]
        return self._stacked(chosen)

    def _stacked(self, keys: Sequence[Key]) -> ValueRows:
        declaration = self.vocabulary.declarations[keys[0][0]] if keys else None
        columns = self._columns
        default, is_known = default_of(declaration)
        kind = type(default)
        values = np.empty((len(keys), self.n_states), dtype=kind)
        upper: Array | None = None
        unknown = np.zeros((len(keys), self.n_states), dtype=bool)
        for row, key in enumerate(keys):
            column = columns.values.get(key)
            if column is None:
                values[row], unknown[row] = default, not is_known
                continue
            values[row] = column
            if key in columns.unknown:
                unknown[row] = columns.unknown[key]
            if key in columns.upper:
                if upper is None:
                    upper = values.copy()
                upper[row] = columns.upper[key]
            elif upper is not None:
                upper[row] = column
        return ValueRows(values, _filled(upper, values), unknown)


def _filled(upper: Array | None, values: Array) -> Array:
    return values if upper is None else np.maximum(upper, values)


def default_of(declaration: Declaration | None) -> tuple[bool | float | int, bool]:
    """A name's default as a column has it, and whether there is one; any value if not."""
    if declaration is None:
        return False, False
    default: Any = declaration.default
    is_known = default is not None and default is not UNKNOWN
    value = default if is_known else one_value(declaration)
    if isinstance(declaration, Enumeration):
        return declaration.values.index(str(value)), is_known
    return value if isinstance(value, bool) else float(value), is_known


def _columns_of(trace: Trace, vocabulary: Vocabulary) -> TraceColumns:
    cells = group_traces([trace]).cells
    try:
        return columnize(cells, vocabulary)
    except UnencodableError:
        # Something is said of some states only: of others it is unknown. Or numbers are no floats.
        plain = replace(trace, states=tuple([_spelled(s, trace, vocabulary) for s in trace.states]))
        return columnize(group_traces([plain]).cells, vocabulary)


def _between_floats(value: Any) -> PartialValue:
    """A number that no float stands for, as what lies between two of them."""
    if type(value) is int and abs(value) > EXACT_IN_FLOATS:
        value = WrittenNumber(Fraction(value))
    said: PartialValue = value
    return Interval(*value.neighbours) if isinstance(value, WrittenNumber) else said


def _spelled(state: Mapping[str, Any], trace: Trace, vocabulary: Vocabulary) -> dict[str, Any]:
    """A state that says something of all that some state speaks of, if only that it is unknown."""
    said: dict[tuple[str, tuple[str, ...]], Any] = {}
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
            said[name, row] = UNKNOWN if value is None else _between_floats(value)
    return dict(with_values({}, said))
