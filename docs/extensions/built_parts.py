"""Puts into pages, where they say `<!-- built: NAME -->`, what is made from other files."""

import csv
import re
from collections.abc import Callable, Mapping
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from grammar import grammar
from page import tables
from sphinx.application import Sphinx

import rulec
from rulec.report.recordings import format_listing
from rulec.report.text.markdown import table
from tools.coverage_table import coverage_table
from tools.schema_tables import schema_tables
from tools.vocabulary_tables import road_tables

ROOT = Path(__file__).resolve().parents[2]
PLACE = re.compile(r"^<!-- built: (\w+) -->$", re.MULTILINE)


def format_words() -> str:
    """The table of words and of the formats that provide them."""
    return format_listing.words_as_markdown(rulec.formats(), format_listing.words_in_order())


def rows_of(path: Path) -> list[list[str]]:
    """The rows of a table, the first of which has the names of columns."""
    with path.open(encoding="utf-8", newline="") as stream:
        return [*csv.reader(stream)]


def first_maneuvers() -> str:
    """The table of what ego does in recorded scenes."""
    head, *rows = rows_of(ROOT / "docs" / "first_maneuvers.csv")
    return table(head, rows)


def looked_up() -> str:
    """A table for each draw of violations that were checked by hand."""
    (_, *head), *rows = rows_of(ROOT / "docs" / "looked_up.csv")
    draws = groupby(rows, key=itemgetter(0))
    return "\n\n".join(
        f"### Draw {draw}\n\n{table(head, (row[1:] for row in of))}" for draw, of in draws
    )


PARTS: Mapping[str, Callable[[], str]] = {
    "benchmarks": lambda: tables((ROOT / "docs" / "benchmarks.jsonl").read_bytes()),
    "coverage": coverage_table,
    "first_maneuvers": first_maneuvers,
    "formats": lambda: format_listing.as_markdown(rulec.formats(), (), words=False),
    "format_words": format_words,
    "grammar": lambda: grammar((ROOT / "grammar" / "rulec.lark").read_text(encoding="utf-8")),
    "looked_up": looked_up,
    "schemas": schema_tables,
    "vocabulary": road_tables,
}
"""Name -> what makes the part, in Markdown."""


def filled(text: str) -> str:
    """A page with its parts in their places."""
    return PLACE.sub(lambda place: PARTS[place[1]](), text)


def fill(_: Sphinx, __: str, content: list[str]) -> None:
    """Called by Sphinx with the text of each page."""
    content[0] = filled(content[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("source-read", fill)
    return {"parallel_read_safe": True}
