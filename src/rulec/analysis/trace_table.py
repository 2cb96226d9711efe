"""A trace as a table: rows of rule inputs, columns of states."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

from rulec.logic.formula import Atom
from rulec.monitoring.state_view import value_in
from rulec.trace import Trace, Value
from rulec.vocabulary import Quantity, Vocabulary
from rulec.witnesses.state_synthesis import subjects_of


@dataclass(frozen=True, slots=True)
class SignalRow:
    """The values of one subject by column, with its title and unit.

    ``unit`` is empty if it has none.

    ``is_default``: the value is the default in all of them.
    """

    title: str
    unit: str
    values: tuple[Value | None, ...]
    is_default: bool = False


@dataclass(frozen=True, slots=True)
class TraceTable:
    """A table of a trace; equal neighbouring states share a column.

    Such a column has the numbers of its first and last state.
    """

    columns: tuple[tuple[int, int], ...]
    rows: tuple[SignalRow, ...]


def trace_table(trace: Trace, names: Set[str], vocabulary: Vocabulary) -> TraceTable:
    """The table of a trace's values for declarations and all its objects."""
    starts = [
        number
        for number, state in enumerate(trace.states)
        if number == 0 or state != trace.states[number - 1]
    ]
    ends = [*(start - 1 for start in starts[1:]), len(trace.states) - 1]
    rows = []
    for (name, items), declaration in subjects_of(vocabulary, trace.objects):
        if name in names and len(set(items)) == len(items):
            values = tuple(value_in(trace.states[n], name, items, declaration) for n in starts)
            unit = declaration.unit if isinstance(declaration, Quantity) else ""
            is_default = all(value == declaration.default for value in values)
            rows.append(SignalRow(str(Atom(name, items)), unit, values, is_default))
    return TraceTable(tuple(zip(starts, ends, strict=True)), tuple(rows))
