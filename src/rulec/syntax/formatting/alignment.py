"""Alignment of columns that the author made over several lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby

from rulec.syntax.formatting.document import WIDTH, LaidOutLine

_BEFORE_COMMENT = 2


def align_marks(rows: Iterable[tuple[LaidOutLine | None, int]]) -> None:
    """Align the column marks that were aligned in the file.

    Args:
        rows: consecutive rows, each with the column of its mark in the file; None for what has no
            mark and comes between two that have.
    """
    for (_, marked), together in groupby(rows, key=lambda one: (one[1], one[0] is not None)):
        same = [row for row, _ in together if row is not None]
        column = max((row.mark for row in same), default=0)
        if not marked or any(len(row.code) + column - row.mark > WIDTH for row in same):
            continue
        for row in same:
            at = row.mark
            row.code = row.code[:at] + " " * (column - at) + row.code[at:]


def with_comments(rows: Sequence[LaidOutLine]) -> list[str]:
    """Rows with trailing comments, aligned where they were aligned before."""
    commented = [row for row in rows if row.comment is not None]
    for _, group in groupby(commented, key=lambda row: row.comment and row.comment.column):
        same = list(group)
        column = max(len(row.code) for row in same)
        if any(_width(row, len(row.code)) <= WIDTH < _width(row, column) for row in same):
            continue
        for row in same:
            row.code = row.code.ljust(column)
    gap = " " * _BEFORE_COMMENT
    return [row.code + (f"{gap}{row.comment.text}" if row.comment else "") for row in rows]


def _width(row: LaidOutLine, column: int) -> int:
    assert row.comment is not None, "only rows with comments are asked for"
    return column + _BEFORE_COMMENT + len(row.comment.text)
