"""Differences of two rulebooks as a table with a line per rule."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from rulec.analysis.diff.rulebook_comparison import RulebookDiff
from rulec.rulebook.rulebook_model import Rule

COLUMNS = ("rule", "relation", "strength 1", "strength 2", "cite 1", "cite 2")


def as_csv(rulebook_diff: RulebookDiff) -> str:
    """The lines, below one that names the columns."""
    rows = [_row(pair.relation, pair.first, pair.second) for pair in rulebook_diff.pairs]
    rows += [
        _row(f"only in {rulebook_diff.first.name}", one_sided.rule, None)
        for one_sided in rulebook_diff.only_first
    ]
    rows += [
        _row(f"only in {rulebook_diff.second.name}", None, one_sided.rule)
        for one_sided in rulebook_diff.only_second
    ]
    return table([COLUMNS, *rows])


def _row(relation: str, first: Rule | None, second: Rule | None) -> Sequence[str]:
    one = first or second
    assert one is not None
    return (
        one.name,
        relation,
        first.strength if first else "",
        second.strength if second else "",
        first.cite if first else "",
        second.cite if second else "",
    )


def table(rows: Iterable[Sequence[str]]) -> str:
    """Comma-separated values (RFC 4180), without the last line's end."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().rstrip("\n")
