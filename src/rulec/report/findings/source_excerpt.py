"""One line of a file with places underlined, whatever characters it holds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rulec.diagnostics.source_text import SourceLocation
from rulec.report.text.terminal_text import cell_width, visible

MAX_WIDTH = 100
"""Terminal columns of a shown line; a longer one is cut around the place."""

TAB = 4
_LEAD = 30


@dataclass(frozen=True, slots=True)
class Underline:
    """A place to underline with ``sign``, and what to write beside it."""

    place: SourceLocation
    words: str
    sign: str


def excerpt_lines(marks: Sequence[Underline]) -> Iterator[tuple[str, str]]:
    """The line shared by all marks, then each mark's underline and sign."""
    excerpt = marks[0].place.excerpt
    primary = next((mark for mark in marks if mark.sign == "^"), marks[0])
    cells, first, cut_before, cut_after = _window(excerpt, primary.place)
    before, after = "…" * cut_before, "…" * cut_after
    yield before + "".join(cells) + after, ""
    for mark in marks:
        start = (mark.place.column or 1) - 1 - first
        end = _end_column(mark.place, len(excerpt)) - 1 - first
        begin = len(before) + cell_width("".join(cells[: max(0, start)]))
        inside = cells[max(0, start) : max(0, end)]
        length = max(1, cell_width("".join(inside)))
        words = f" {visible(mark.words)}" if mark.words else ""
        yield " " * begin + mark.sign * length + words, mark.sign


def _end_column(place: SourceLocation, length: int) -> int:
    """End of an underline, at most the first line's end."""
    if place.end_line is not None and place.line is not None and place.end_line > place.line:
        return length + 1
    return place.end_column or (place.column or 1) + 1


def _window(excerpt: str, place: SourceLocation) -> tuple[list[str], int, bool, bool]:
    """The characters shown, the first one's index, and marks for cut ends."""
    column = (place.column or 1) - 1
    # A hostile line may have millions of characters: look only at what can be shown.
    start = max(0, column - MAX_WIDTH)
    cells = [_cell(one) for one in excerpt[start : column + MAX_WIDTH]]
    widths = [cell_width(cell) for cell in cells]
    whole = start == 0 and len(excerpt) == len(cells)
    if whole and sum(widths) <= MAX_WIDTH:
        return cells, 0, False, False
    here = column - start
    first = here
    lead = 0
    while first > 0 and lead + widths[first - 1] <= _LEAD:
        first -= 1
        lead += widths[first]
    if start == 0 and sum(widths[:here]) <= _LEAD * 2:
        first = 0
    last = first
    room = MAX_WIDTH
    while last < len(cells) and room >= widths[last]:
        room -= widths[last]
        last += 1
    return cells[first:last], start + first, start + first > 0, start + last < len(excerpt)


def _cell(character: str) -> str:
    return " " * TAB if character == "\t" else visible(character)
