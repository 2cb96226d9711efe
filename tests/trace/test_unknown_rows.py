"""Traces of Parquet of which not all is known: made from columns, as they are read row by row."""

import io
from dataclasses import replace

import pyarrow
import pytest
from pyarrow import parquet

from rulec.diagnostics import RulecError
from rulec.trace.formats.table_blocks import outlined
from rulec.trace.formats.trace_files import read_chunks
from rulec.vocabulary.partial_values import UNKNOWN

TEXTS = pyarrow.list_(pyarrow.string())
NOBODY = {"step": [0, 1], "object": [None, None], "type": [None, None], "speed": [1.0, 2.0]}
ROWS = {
    "known": {**NOBODY, "unknown": [None, None]},
    "empty lists": {**NOBODY, "unknown": [[], None]},
    "a name without a value": {**NOBODY, "unknown": [["wet"], ["wet", "gap"]]},
    "of an object": {
        "step": [0, 0, 1],
        "object": [None, "v", "v"],
        "type": [None, "car", None],
        "speed": [1.0, None, None],
        "unknown": [["wet"], ["gap"], []],
    },
    "said, too": {**NOBODY, "unknown": [["wet"], ["speed"]]},
    "said twice": {**NOBODY, "unknown": [["wet"], ["gap", "gap"]]},
    "of all and of one": {
        "step": [0, 0],
        "object": [None, "v"],
        "type": [None, "car"],
        "speed": [None, 3.0],
        "unknown": [["speed"], None],
    },
}
NOT_FROM_COLUMNS = {"said, too", "said twice", "of all and of one"}


def block():
    """One block with a trace for each case."""
    columns = {name: [] for name in ("trace", "step", "object", "type", "speed", "unknown")}
    # What comes last may go on in another block.
    for name, rows in {**ROWS, "last": ROWS["known"]}.items():
        columns["trace"] += [name] * len(rows["step"])
        for column, cells in rows.items():
            columns[column] += cells
    columns["unknown"] = pyarrow.array(columns["unknown"], TEXTS)
    columns["speed"] = pyarrow.array(columns["speed"], pyarrow.float64())
    stream = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), stream)
    stream.seek(0)
    found, _ = read_chunks(stream, "t.parquet", "parquet")
    return found


def said(item):
    return item.diagnostics if isinstance(item, RulecError) else item


@pytest.mark.parametrize("case", ROWS)
def test_what_is_unknown_is_read_from_columns_as_it_is_row_by_row(case):
    by_row = block()
    read = []

    def rows(start, stop):
        read.append(stop - start)
        return by_row.rows(start, stop)

    place = list(ROWS).index(case)
    together = replace(by_row, outline=outlined(by_row), rows=rows)
    assert said(together[place]) == said(by_row[place])
    # One row says what the first is called.
    assert (max(read) > 1) == (case in NOT_FROM_COLUMNS)


def test_traces_that_are_not_wholly_known_are_told_apart():
    found = block()
    unknown = {"a name without a value", "of an object", *NOT_FROM_COLUMNS}
    assert {list(ROWS)[place] for place in found.partial} == unknown
    assert not found.unsaid
    assert found[2].states[1] == {"speed": 2.0, "wet": UNKNOWN, "gap": UNKNOWN}
