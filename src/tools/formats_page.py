"""The tables of formats in the documentation, generated from the tables in the code."""

from __future__ import annotations

from pathlib import Path

import rulec
from rulec.report.recordings import format_listing

PAGE = Path(__file__).resolve().parents[2] / "docs" / "formats.md"
BEGIN = "<!-- formats: `.ci/task regenerate` writes this table -->\n"
END = "<!-- end of formats -->\n"

_HEAD = """\
# What each format provides

For each word of the vocabulary [`road`](vocabulary.md), the [formats](formats.md) of which some
file provides it, so that a rulebook can be judged by it. A particular file may lack signs, lamps or
weather: `rulec audit R --source FILE` shows the words of one file and the rules that can be judged
on it. [The words of recorded traffic](recorded_words.md) says how each word is found.
`.ci/task regenerate` writes this page from the table of
`rulec formats --words --output-format markdown`.

"""


def formats_page() -> str:
    """Render ``docs/formats.md`` with the table of formats brought up to date."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    _, _, after = rest.partition(END)
    table = format_listing.as_markdown(rulec.formats(), (), words=False)
    return f"{before}{BEGIN}\n{table}\n\n{END}{after}"


def format_words_page() -> str:
    """Render ``docs/format_words.md``, the table of words and formats."""
    order = format_listing.words_in_order()
    return f"{_HEAD}{format_listing.words_as_markdown(rulec.formats(), order)}\n"
