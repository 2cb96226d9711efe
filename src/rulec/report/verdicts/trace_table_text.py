"""A trace as a table of text."""

from __future__ import annotations

from textwrap import wrap

from rulec.analysis.trace_display import TraceTable
from rulec.report.text.terminal_text import table_lines, visible
from rulec.report.verdicts.violation_table import shown

MOST_ROWS = 8
"""A table with more has no rows for what is by default in all its states."""

WIDTH = 96


def titles(table: TraceTable) -> list[str]:
    """The numbers of the states that each column stands for."""
    return [str(first) if first == last else f"{first}-{last}" for first, last in table.columns]


def rows(table: TraceTable) -> list[tuple[str, list[str]]]:
    """Title and cells of each row."""
    return [
        (
            visible(f"{row.title} in {row.unit}" if row.unit else row.title),
            ["" if value is None else shown(value) for value in row.values],
        )
        for row in table.rows
        if not (row.is_default and len(table.rows) > MOST_ROWS)
    ]


def left_out(table: TraceTable) -> list[str]:
    """Names without a row, since all their values are defaults."""
    usual = [visible(row.title) for row in table.rows if row.is_default]
    return usual if len(table.rows) > MOST_ROWS else []


def as_lines(table: TraceTable, indent: str) -> list[str]:
    """The table with a line below its head."""
    whole = [("state", titles(table)), *rows(table)]
    lines = table_lines(
        [(f"{title} ", *cells) for title, cells in whole], indent=indent, ruled=(0,)
    )
    rest = left_out(table)
    words = f"by default: {', '.join(rest)}" if rest else ""
    return lines + [f"{indent}{line}" for line in wrap(words, WIDTH - len(indent))]
