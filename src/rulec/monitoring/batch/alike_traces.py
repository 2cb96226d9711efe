"""Traces of one shape as columns, whatever source they were read from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.monitoring.batch.columns.block_columns import (
    BlockGroup,
    columnize_block,
    encode_column,
)
from rulec.monitoring.batch.columns.column_states import trace_at
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.trace_groups import Names
from rulec.monitoring.implied_values import words_meant
from rulec.trace import Trace
from rulec.trace.formats.alike_lines import AlikeLines, LineBlock
from rulec.trace.trace_columns import Array, Key, Layout, TraceColumns, layout_of
from rulec.trace.trace_model import Ending
from rulec.vocabulary import Enumeration, Vocabulary


@dataclass(frozen=True, slots=True, eq=False)
class AlikeTraces:
    """Traces of one shape as columns, with the object names of the first trace.

    ``places`` are the positions of the traces among all that were read, in the order of the
    columns. For the trace at a number in this order, ``ids`` gives its id, ``names`` its object
    names, ``says`` whether a state of it has a name, and ``traces`` the trace itself.
    """

    places: Sequence[int]
    columns: TraceColumns
    ids: Callable[[int], str]
    names: Callable[[int], Names]
    says: Callable[[int, str], bool]
    traces: Callable[[int], Trace]
    ends: Ending

    @property
    def is_whole(self) -> bool:
        """Whether nothing is unknown: before, after and in the traces."""
        known = not self.columns.unknown and not self.columns.upper
        return known and self.ends == "complete"


def traces_of_group(group: BlockGroup, vocabulary: Vocabulary) -> AlikeTraces:
    """The traces of one shape in a block. Raises UnencodableError."""
    columns = columnize_block(group, vocabulary)
    check_nothing_derived(columns, vocabulary)
    block, presence, places = group.block, group.presence, group.traces.tolist()

    def says(number: int, name: str) -> bool:
        start, stop = block.starts[places[number] : places[number] + 2].tolist()
        column = block.columns.get(name) if name in block.table.names else None
        return column is not None and bool(column.given_at(slice(start, stop)).any())

    return AlikeTraces(
        places=places,
        columns=columns,
        ids=lambda number: presence.names[places[number]],
        names=lambda number: presence.objects_of(places[number]),
        says=says,
        traces=lambda number: _trace(block[places[number]]),
        ends=presence.ends[places[0]],
    )


def traces_of_lines(block: LineBlock, lines: AlikeLines, vocabulary: Vocabulary) -> AlikeTraces:
    """The traces of some lines of a block. Raises UnencodableError."""
    order, columns = _columnized(lines, vocabulary)
    check_nothing_derived(columns, vocabulary)
    headings = [lines.headings[place] for place in order.tolist()]
    places = lines.lines[order].tolist()
    return AlikeTraces(
        places=places,
        columns=columns,
        ids=lambda number: headings[number].id,
        names=lambda number: tuple(headings[number].objects),
        says=lambda _, name: name in lines.names,
        traces=lambda number: _trace(block[places[number]]),
        ends=headings[0].ends,
    )


def traces_of_columns(columns: TraceColumns, vocabulary: Vocabulary) -> AlikeTraces:
    """Traces that a caller gives as columns, with their numbers as ids.

    Raises ValueError for an array that fits no name of the vocabulary, or not the layout.
    """
    for key in columns.values:
        _check_array(columns, key, vocabulary)
    said = {name for name, _ in columns.values}
    return AlikeTraces(
        places=range(columns.layout.n_traces),
        columns=columns,
        ids=str,
        names=lambda _: tuple(columns.objects),
        says=lambda _, name: name in said,
        traces=lambda number: trace_at(columns, number, vocabulary),
        ends="complete",
    )


def _check_array(columns: TraceColumns, key: Key, vocabulary: Vocabulary) -> None:
    (name, items), values, n_states = key, columns.values[key], columns.layout.n_states
    what = f"the array for `{name}`{' of `' + ', '.join(items) + '`' if items else ''}"
    declaration = vocabulary.declarations.get(name)
    if declaration is None:
        raise ValueError(f"{what} is of no name that `{vocabulary.name}` has")
    if len(items) != len(declaration.parameters):
        raise ValueError(f"{what} is about {len(items)} objects, not {len(declaration.parameters)}")
    for column in (values, columns.unknown.get(key, values), columns.upper.get(key, values)):
        if len(column) != n_states:
            raise ValueError(f"{what} has {len(column)} entries, for {n_states} states")
    if isinstance(declaration, Enumeration):
        wrong = values[(values < 0) | (values >= len(declaration.values))]
        if len(wrong):
            most = len(declaration.values)
            raise ValueError(f"{what} has place {wrong[0]}, of {most} values, which count from 0")


def _trace(item: Trace | RulecError) -> Trace:
    assert isinstance(item, Trace), "it has been read"
    return item


def check_nothing_derived(columns: TraceColumns, vocabulary: Vocabulary) -> None:
    """Raise UnencodableError if axioms imply more than the columns of a file contain."""
    for (name, _), values in columns.values.items():
        if name in vocabulary.constants and _changes(values, columns.layout):
            raise UnencodableError
    if words_meant(vocabulary, None):
        raise UnencodableError
    for cause, effects in vocabulary.implied.items():
        if any(_lacks(columns, cause, effect) for effect in effects):
            raise UnencodableError


def _changes(values: Array, layout: Layout) -> bool:
    """Whether the values of a column change within a trace."""
    first = values[: layout.n_traces]
    return any(
        bool(
            (
                values[layout.starts[step] : layout.starts[step + 1]]
                != first[: layout.active(step)]
            ).any()
        )
        for step in range(1, layout.n_steps)
    )


def _lacks(columns: TraceColumns, cause: str, effect: str) -> bool:
    """Whether some state has a true signal but lacks another signal that it implies."""
    values = columns.values
    return any(
        bool(truths.any())
        and ((effect, items) not in values or bool((~values[effect, items] & truths).any()))
        for (name, items), truths in values.items()
        if name == cause
    )


def _columnized(
    lines: AlikeLines, vocabulary: Vocabulary
) -> tuple[NDArray[np.int64], TraceColumns]:
    """The traces as columns, with the first one's objects, and which trace is at each position.

    Raises UnencodableError.
    """
    order = (-lines.lengths).argsort(kind="stable")
    layout = layout_of(lines.lengths[order])
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    # Reorder from trace by trace to step by step.
    step = np.arange(layout.n_states) - (lines.lengths.cumsum() - lines.lengths).repeat(
        lines.lengths
    )
    rows = np.empty(layout.n_states, dtype=np.int64)
    rows[layout.starts[step] + rank.repeat(lines.lengths)] = np.arange(layout.n_states)
    example = lines.headings[order[0]]
    objects = tuple(example.objects.items())
    columns: dict[Key, Array] = {}
    for (name, places), column in lines.columns.items():
        declaration = vocabulary.declarations.get(name)
        if declaration is None or len(places) != len(declaration.parameters):
            raise UnencodableError
        items = [objects[place] for place in places]
        for (_, kind), wanted in zip(items, declaration.parameters, strict=True):
            if not vocabulary.is_subtype(kind, wanted):
                raise UnencodableError
        values = encode_column(column, rows, declaration)
        columns[name, tuple([item for item, _ in items])] = values
    return order, TraceColumns(layout, columns, example.objects, {}, example.step_s)
