"""Traces of one shape as columns, whatever source they were read from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

from rulec.diagnostics import RulecError
from rulec.monitoring.batch.columns.block_columns import BlockGroup, columnize_block, groups_of
from rulec.monitoring.batch.columns.columnize import UnencodableError, columnize
from rulec.monitoring.batch.columns.line_columns import columnize_lines
from rulec.monitoring.batch.trace_groups import Names, Shape, group_traces, shape_of
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.untold_names import untold_names, with_untold
from rulec.trace import Trace
from rulec.trace.formats.alike_lines import AlikeLines, LineBlock
from rulec.trace.formats.table_blocks import Block
from rulec.trace.trace_columns import Array, Layout, TraceColumns
from rulec.trace.trace_model import Ending
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True, eq=False)
class AlikeTraces:
    """Traces of one shape as columns, with the object names of the first trace.

    ``places`` are the positions of the traces among all that were read, in the order of the
    columns; ``names`` maps such a position to the object names of that trace.
    """

    places: Sequence[int]
    columns: TraceColumns
    names: Callable[[int], Names]
    ends: Ending = "complete"
    told: frozenset[str] | None = None


def alike_traces(
    items: Sequence[Trace | RulecError], wanted: Sequence[int], vocabulary: Vocabulary
) -> Iterator[AlikeTraces]:
    """The ``wanted`` items, already judged, as far as they can be given as columns.

    The groups may contain further traces of the same shape.
    """
    makers: list[Callable[[], AlikeTraces]] = []
    if isinstance(items, Block) and items.outline is not None:
        groups = groups_of(items, items.outline)
        makers += [partial(traces_of_group, group, vocabulary) for group in groups]
        wanted = [place for place in wanted if place in items.partial]
    elif isinstance(items, LineBlock):
        makers += [partial(traces_of_lines, lines, vocabulary) for lines in items.alike]
        wanted = [place for place in wanted if items.items[place] is not None]
    shapes: dict[Shape, list[tuple[int, Trace]]] = {}
    for place in wanted:
        trace = items[place]
        assert isinstance(trace, Trace), "it has been judged"
        if vocabulary.constants or vocabulary.implied:
            trace = with_derived_values(spelled_out(trace, vocabulary), vocabulary)
        shapes.setdefault((*shape_of(trace), trace.ends, trace.told), []).append((place, trace))
    makers += [partial(_of_traces, placed, vocabulary) for placed in shapes.values()]
    for made in makers:
        with suppress(UnencodableError):
            yield made()


def traces_of_group(group: BlockGroup, vocabulary: Vocabulary) -> AlikeTraces:
    """The traces of one shape in a block. Raises UnencodableError."""
    columns = columnize_block(group, vocabulary)
    _check_nothing_derived(columns, vocabulary)
    traces = group.traces.tolist()
    return AlikeTraces(traces, columns, lambda number: group.presence.objects_of(traces[number]))


def traces_of_lines(lines: AlikeLines, vocabulary: Vocabulary) -> AlikeTraces:
    """The traces of some lines; ``places`` are those of the lines. Raises UnencodableError."""
    order, columns = columnize_lines(lines, vocabulary)
    _check_nothing_derived(columns, vocabulary)
    headings = [lines.headings[place] for place in order.tolist()]
    return AlikeTraces(
        lines.lines[order].tolist(), columns, lambda number: tuple(headings[number].objects)
    )


def _of_traces(placed: Sequence[tuple[int, Trace]], vocabulary: Vocabulary) -> AlikeTraces:
    example = placed[0][1]
    group = group_traces([trace for _, trace in placed])
    untold = untold_names(vocabulary, example.told)
    if untold:
        vocabulary = with_untold(vocabulary, untold)
    columns = columnize(group.cells, vocabulary, group.names)
    ordered = [placed[place] for place in group.order]
    return AlikeTraces(
        [place for place, _ in ordered],
        columns,
        lambda number: tuple(ordered[number][1].objects),
        example.ends,
        example.told,
    )


def _check_nothing_derived(columns: TraceColumns, vocabulary: Vocabulary) -> None:
    """Raise UnencodableError if axioms imply more than the columns of a file contain."""
    for (name, _), values in columns.values.items():
        if name in vocabulary.constants and _changes(values, columns.layout):
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
