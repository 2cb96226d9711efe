"""A trace as a table of text."""

from __future__ import annotations

from textwrap import wrap

from rulec.analysis.trace_display import TraceTable
from rulec.report.findings.source_excerpt import visible
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
    width = max(len(title) for title, _ in whole)
    widths = [max(len(cells[n]) for _, cells in whole) for n in range(len(table.columns))]
    lines = []
    for title, cells in whole:
        padded = "  ".join(cell.ljust(size) for cell, size in zip(cells, widths, strict=True))
        lines.append(f"{indent}{title:<{width}}   {padded}".rstrip())
    lines.insert(1, f"{indent}{'─' * (width + 1 + sum(widths) + 2 * len(widths))}")
    rest = left_out(table)
    words = f"by default: {', '.join(rest)}" if rest else ""
    return lines + [f"{indent}{line}" for line in wrap(words, WIDTH - len(indent))]
