"""The page of the documentation that shows what benchmarks have found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain

from figure import COLUMNS, Result, cells

HEAD = """\
# How fast it is

What `tests/benchmarks/run --write` has measured; it writes this page. `tests/benchmarks/run NAME`
measures a part. Every figure is processor time, the median of several rounds in which everything in
a table takes its turn, so that a busy moment of the machine meets all of it; the fastest round is
nearest to a machine with nothing else to do. A turn lasts ten milliseconds or more: what is short
is done again and again in it, and its mean counts. "Peer takes" says how many times as long another
way of doing the same work takes, in the same rounds. Ratios carry over to other machines, times do
not. "Wanted" is what rulec aims at on a machine of this kind. Where the load average below is above
the number of cores, other programs had their share of cores, caches and memory, which lengthens
processor time, too; by how much is not known. Copying an array and `python -c pass` are there to
compare machines by.
"""


def page(found: Mapping[str, Sequence[Result]], about: Sequence[str]) -> str:
    """The page, in Markdown."""
    lines = chain.from_iterable(
        section(name, result) for name, results in found.items() for result in results
    )
    return "\n".join([HEAD, *(f"- {line}" for line in about), *lines, ""])


def section(name: str, result: Result) -> Iterator[str]:
    """A heading, what the input was, a table, and notes."""
    yield from ("", f"## {result.title}", "", f"`{name}`: {result.input}.", "")
    yield row(COLUMNS)
    yield row(["---", "---", "---:", "---:", "---:"])
    for figure in result.figures:
        yield row(cells(figure))
    if result.notes:
        yield ""
        yield from (f"- {note}" for note in result.notes)
    if result.table:
        head, *rows = result.table
        yield ""
        yield row(head)
        yield row(["---", *["---:"] * (len(head) - 1)])
        yield from map(row, rows)


def row(texts: Sequence[str]) -> str:
    """A row of a table."""
    return "| " + " | ".join(text.replace("|", "\\|") for text in texts) + " |"
