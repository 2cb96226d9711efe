"""Columns of values from JSON lines that share one layout."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.batch.columns.block_columns import encode_column
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.trace.formats.alike_lines import AlikeLines
from rulec.trace.trace_columns import Array, Key, TraceColumns, layout_of
from rulec.vocabulary import Vocabulary


def columnize_lines(
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
