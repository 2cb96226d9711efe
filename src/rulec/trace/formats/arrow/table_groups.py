"""Arrow tables split by keys, and traces read from tables in memory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pyarrow import compute, types

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats.arrow.arrow_arrays import (
    array_of_truths,
    codes_in,
    flags_in,
    given_in,
    numbers_in,
    one_text,
    whole_array,
    with_plain_texts,
)
from rulec.trace.formats.arrow.arrow_blocks import cut
from rulec.trace.formats.arrow.parquet import check_types, is_valid
from rulec.trace.formats.table_reader import STEP, TRACE, Table, check_columns
from rulec.trace.trace_model import Trace

Key = tuple[str, ...]
"""The texts in a row's key columns."""


def groups(table: Any, keys: Sequence[str], order: Sequence[str]) -> Iterator[tuple[Key, Any]]:
    """The rows of each key, without the key columns, sorted by ``order``; keys are sorted.

    Sorting is stable; a missing text comes before all others.
    """
    table = _readable_by_row(table.combine_chunks())
    plain = {name: _plain(table.column(name)) for name in dict.fromkeys((*keys, *order))}
    plain |= {name: _as_text(plain[name]) for name in keys}
    plain = {name: _without_nulls(column) for name, column in plain.items()}
    names = [*keys, *order]
    rest = table.drop_columns([name for name in keys if name in table.column_names])
    if not len(table):
        return
    if names:
        sorting = pyarrow.table(list(plain.values()), names=list(plain))
        ways = [(name, "ascending") for name in names]
        places = compute.sort_indices(sorting, sort_keys=ways)
        rest = rest.take(places)
        plain = {name: plain[name].take(places) for name in keys}
    starts = _starts([plain[name] for name in keys], len(table))
    for start, stop in zip(starts, [*starts[1:], len(table)], strict=True):
        key = tuple(plain[name][start].as_py() for name in keys)
        yield key, rest.slice(start, stop - start)


def _readable_by_row(table: Any) -> Any:
    """The table without invalid dictionaries: text that is not UTF-8 then affects only its rows."""
    for place, (name, column) in enumerate(zip(table.column_names, table.columns, strict=True)):
        if types.is_dictionary(column.type) and not is_valid(column):
            table = table.set_column(place, name, _plain(column))
    return table


def _plain(column: Any) -> Any:
    """A column without dictionary encoding, by which not every version of Arrow can sort."""
    return column.cast(column.type.value_type) if types.is_dictionary(column.type) else column


def _as_text(column: Any) -> Any:
    return column if types.is_string(column.type) else column.cast(pyarrow.string())


def _without_nulls(column: Any) -> Any:
    is_text = types.is_string(column.type) or types.is_large_string(column.type)
    return compute.fill_null(column, one_text("")) if is_text and column.null_count else column


def _starts(columns: Sequence[Any], rows: int) -> list[int]:
    """The first row of each key, from sorted key columns."""
    changes: NDArray[np.bool_] = np.zeros(rows, dtype=bool)
    changes[0] = True
    for column in columns:
        differs = compute.not_equal(column.slice(1), column.slice(0, rows - 1))
        changes[1:] |= flags_in(differs)
    return [int(place) for place in np.flatnonzero(changes)]


def traces_of_table(table: Any, label: str) -> Iterator[Sequence[Trace | RulecError]]:
    """The traces of a table with rows as in a file, in chunks (docs/traces.md).

    ``label`` names the table in messages. A bad trace is replaced by the RulecError (R0509) that
    says why. Raises RulecError R0509 if something is wrong with the columns.
    """
    file = SourceLocation(label)
    check_columns(table.schema.names, file)
    check_types(table.schema, pyarrow, label)
    own = Table(tuple(table.schema.names), lambda value: value, lambda _: file)
    return cut(table.combine_chunks().to_batches(), own, 1, file)


class TraceOutline(NamedTuple):
    """A trace of a sorted table: its name, first row, number of rows and number of states.

    ``lacks`` says which step is missing; it is empty if none is.
    """

    name: str
    first: int
    rows: int
    states: int
    lacks: str


def trace_outlines(table: Any) -> list[TraceOutline]:
    """The traces of a table that is sorted by trace and step.

    If steps are not whole numbers, no step is reported missing: reading the rows reports that.
    """
    names = _without_nulls(_as_text(_plain(table.column(TRACE))))
    starts = _starts([names], len(table)) if len(table) else []
    try:
        array = whole_array(_plain(table.column(STEP)).cast(pyarrow.int64()))
        given = given_in(array)
        steps = np.where(given, numbers_in(array), -1)
    except (pyarrow.ArrowException, OverflowError):
        steps = None
    outlines = []
    for start, stop in zip(starts, [*starts[1:], len(table)], strict=True):
        lacks, states = "", 0
        if steps is not None:
            own = steps[start:stop]
            states = int(own[-1]) + 1
            if own[0] > 0 or (own[0] < 0 and given[start]):
                lacks = f"it begins with step {own[0]}"
            elif (gaps := np.diff(own) > 1).any():
                lacks = f"step {own[np.argmax(gaps)] + 1} is missing"
        outlines.append(TraceOutline(names[start].as_py(), start, stop - start, states, lacks))
    return outlines


def without_rows(table: Any, outlines: Sequence[TraceOutline]) -> Any:
    """The table without the rows of these traces."""
    if not outlines:
        return table
    kept: NDArray[np.bool_] = np.ones(len(table), dtype=bool)
    for outline in outlines:
        kept[outline.first : outline.first + outline.rows] = False
    return table.filter(array_of_truths(kept))


def extent(table: Any) -> tuple[object, ...]:
    """The number of rows, and each column's least and greatest value; independent of any order."""
    extents: list[object] = [len(table)]
    for name in sorted(table.column_names):
        column = _plain(table.column(name))
        if not types.is_nested(column.type):
            least, greatest = compute.min_max(column).values()
            extents.append((name, least.as_py(), greatest.as_py()))
    return tuple(extents)


def key_texts(table: Any, keys: Sequence[str], between: str) -> tuple[NDArray[np.int64], list[str]]:
    """For each row the index of its key's text, and these texts; one empty text without keys."""
    if not keys:
        return np.zeros(len(table), dtype=np.int64), [""]
    columns = [_without_nulls(_as_text(_plain(table.column(name)))) for name in keys]
    whole = (
        columns[0]
        if len(keys) == 1
        else compute.binary_join_element_wise(*columns, one_text(between))
    )
    if not len(whole):
        return np.zeros(0, dtype=np.int64), []
    codes, texts = codes_in(whole_array(whole))
    return codes, [*texts]


def not_utf8(table: Any, names: Sequence[str]) -> str:
    """A message that names a column with a text that is not UTF-8; empty if there is none."""
    bad = (name for name in names if not is_valid(_plain(table.column(name))))
    return f"the column `{name}` has a text that is not UTF-8" if (name := next(bad, "")) else ""


def rows_where(table: Any, codes: NDArray[np.int64], kept: NDArray[np.bool_]) -> Any:
    """The rows whose codes are marked in ``kept``."""
    return table if kept.all() else table.filter(array_of_truths(kept[codes]))


def table_of_batch(batch: Any) -> Any:
    """A record batch as a table, without string views."""
    return with_plain_texts(pyarrow.Table.from_batches([batch]))


def joined(tables: Sequence[Any]) -> Any:
    """The tables one after another; where one lacks a column, its values are missing."""
    return (
        tables[0]
        if len(tables) == 1
        else pyarrow.concat_tables(tables, promote_options="permissive")
    )
