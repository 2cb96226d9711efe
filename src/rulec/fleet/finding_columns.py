"""The columns of a fleet's table of findings: one row per drive, per rule of it and per finding."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import Any, Optional, TypeAlias

from rulec.report.findings import verdict_finding
from rulec.report.json_document import JsonDocument, made_class
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.arrow.parquet import arrow

Cell: TypeAlias = "str | float | tuple[str, ...] | None"

COLUMNS: Mapping[str, type] = {
    "kind": str,
    **verdict_finding.COLUMNS,
    **dict.fromkeys(("ego", "source", "country", "road"), str),
    "remarks": list,
    "state": int,
    "states": int,
    **dict.fromkeys(("duration_s", "distance_m"), float),
    **dict.fromkeys(("opportunities", "perhaps_opportunities"), int),
    **dict.fromkeys(("opportunities_s", "perhaps_opportunities_s"), float),
    **dict.fromkeys(("violated", "perhaps_violated"), int),
    **dict.fromkeys(("rulebook_hash", "rulec", "thresholds", "assumptions"), str),
}
"""Name -> the type of its values: the columns of findings, and those needed for rates.

docs/fleet.md explains each column. Where a column does not apply, a text is empty, a list has no
items and a number is None.
"""

_IN_JSON: Mapping[type, Any] = {str: str, list: list[str]}
"""The types of columns that are never null."""

FindingRowLine = made_class(
    "FindingRowLine",
    {
        name: _IN_JSON.get(kind) or Optional[kind]  # noqa: UP045
        for name, kind in COLUMNS.items()
    },
    "A row of a drive, of a rule of it, or a finding.\n\n"
    "See docs/rates.md; where one does not apply, a text is empty and a number null.",
    JsonDocument,
)
"""A row as a line of JSON."""

EMPTY: Mapping[str, Cell] = {
    name: verdict_finding.EMPTY_CELLS.get(kind) for name, kind in COLUMNS.items()
}
"""The values of columns that do not apply."""

_ROWS_AT_ONCE = 1 << 11

Row: TypeAlias = Mapping[str, Cell]
"""A row's columns that apply."""


def arrow_schema() -> Any:
    """The ``pyarrow.Schema`` of the table. Raises RulecError R0706 without pyarrow."""
    pyarrow, _ = arrow("the table of findings")
    texts = pyarrow.list_(pyarrow.string())
    kinds = {str: pyarrow.string(), int: pyarrow.int64(), float: pyarrow.float64(), list: texts}
    return pyarrow.schema([(name, kinds[kind]) for name, kind in COLUMNS.items()])


def arrow_table(rows: Iterable[Row]) -> Any:
    """Rows as a ``pyarrow.Table`` with all columns. Raises RulecError R0706 without pyarrow."""
    schema = arrow_schema()
    pyarrow, _ = arrow("the table of findings")
    parts = []
    waiting = iter(rows)
    # Rows converted to columns take a tenth of the memory.
    while listed := list(islice(waiting, _ROWS_AT_ONCE)):
        arrays = [
            _array([row.get(name, EMPTY[name]) for row in listed], kind)
            for name, kind in COLUMNS.items()
        ]
        parts.append(pyarrow.table(arrays, schema=schema))
    whole = pyarrow.concat_tables(parts) if parts else pyarrow.Table.from_batches([], schema)
    return whole.combine_chunks()


def _array(cells: Sequence[Any], kind: type) -> Any:
    if kind is str:
        return arrow_tables.array_of_texts(cells)
    return (
        arrow_tables.array_of_lists(cells)
        if kind is list
        else arrow_tables.array_of_numbers(cells, kind)
    )
