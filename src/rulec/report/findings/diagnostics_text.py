"""Diagnostics as plain text, with underlined source lines and help."""

from __future__ import annotations

import sys
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate, groupby
from pathlib import Path
from typing import TextIO

from rulec.diagnostics import Diagnostic, RulecError
from rulec.diagnostics.diagnostic import SourceLocation, address
from rulec.diagnostics.fault_messages import FAULT
from rulec.files.work_trees import leads_out
from rulec.report.text.console import page_width, print_aside
from rulec.report.text.terminal_text import broken, cell_width, styled, visible, wants_color

MAX_WIDTH = 100
"""Width of a shown source line outside a terminal; a longer line is cut around the place."""

_FRAME_COLUMNS = 9
"""Columns around a shown line: its number, the frame, and the marks of cut ends."""

TAB = 4
_LEAD = 30


@dataclass(frozen=True, slots=True)
class Underline:
    """A place to underline with ``sign``, and the words beside it."""

    place: SourceLocation
    words: str
    sign: str


def message_width(stream: TextIO) -> int:
    """The columns of a terminal to which messages are wrapped; elsewhere 0: they stay one line."""
    return page_width(stream) if stream.isatty() else 0


def excerpt_lines(marks: Sequence[Underline], columns: int) -> Iterator[tuple[str, str]]:
    """The source line of all marks, then the underline of each mark with its sign."""
    excerpt = marks[0].place.excerpt
    primary = next((mark for mark in marks if mark.sign == "^"), marks[0])
    cells, first, cut_before, cut_after = _window(excerpt, primary.place, columns)
    before, after = "…" * cut_before, "…" * cut_after
    yield before + "".join(cells) + after, ""
    for mark in marks:
        start = (mark.place.column or 1) - 1 - first
        end = _end_column(mark.place, len(excerpt)) - 1 - first
        begin = len(before) + cell_width("".join(cells[: max(0, start)]))
        inside = cells[max(0, start) : max(0, end)]
        length = max(1, cell_width("".join(inside)))
        line, words = " " * begin + mark.sign * length, visible(mark.words)
        if begin + length + 1 + cell_width(words) <= columns:
            yield f"{line} {words}".rstrip(), mark.sign
            continue
        yield line, mark.sign
        indent = " " * min(begin, columns // 2)
        yield from ((part, mark.sign) for part in broken(words, columns, indent, indent))


def _end_column(place: SourceLocation, length: int) -> int:
    if place.end_line is not None and place.line is not None and place.end_line > place.line:
        return length + 1
    return place.end_column or (place.column or 1) + 1


def _window(excerpt: str, place: SourceLocation, columns: int) -> tuple[list[str], int, bool, bool]:
    """The characters shown, the index of the first one, and whether each end is cut."""
    # An excerpt may have been cut before its line's end.
    column = min((place.column or 1) - 1, len(excerpt))
    # A hostile line may have millions of characters: look only at those that can be shown.
    start = max(0, column - columns)
    shown = excerpt[start : column + columns]
    cells = [" " * TAB if character == "\t" else visible(character) for character in shown]
    widths = [cell_width(cell) for cell in cells]
    whole = start == 0 and len(excerpt) == len(cells)
    if whole and sum(widths) <= columns:
        return cells, 0, False, False
    here = column - start
    first = here - _fitting(widths[:here][::-1], _LEAD)
    if start == 0 and sum(widths[:here]) <= _LEAD * 2:
        first = 0
    last = first + _fitting(widths[first:], columns)
    return cells[first:last], start + first, start + first > 0, start + last < len(excerpt)


def _fitting(widths: Iterable[int], columns: int) -> int:
    """How many of these cells, from the first one on, fit into some columns."""
    return bisect_right(list(accumulate(widths)), columns)


_FRAME = "bold blue"
_STYLES = {"error": "bold red", "warning": "bold yellow"}

printed: set[str] = set()
"""The faults that this process has printed."""

_Paint = Callable[[str, str], str]
"""Text and style -> styled text."""


def print_diagnostics(diagnostics: Sequence[Diagnostic], *, summary: bool = True) -> None:
    """Print errors and warnings on standard error, with their numbers."""
    printed.update([one.message for one in diagnostics if one.code == FAULT.code])
    if diagnostics:
        width = message_width(sys.stderr)
        text = render_diagnostics(diagnostics, wants_color(sys.stderr), summary, width)
        print_aside(text.rstrip("\n"))


class Complaints:
    """Errors about many inputs: the first of each kind are shown, others counted.

    Repetitions of the same text are only counted, too, such as an error in each drive of a file.
    """

    def __init__(self, errors: Iterable[RulecError] = (), most: int = 10) -> None:
        self._most = most
        self._seen: Counter[str] = Counter()
        self._shown: dict[str, list[Diagnostic]] = {}
        for error in errors:
            self.add(error)

    def __bool__(self) -> bool:
        return bool(self._seen)

    def add(self, error: RulecError) -> None:
        """Show an error, or only count it if many of its kind were shown."""
        for diagnostic in error.diagnostics:
            self._seen[diagnostic.code] += 1
            shown = self._shown.setdefault(diagnostic.code, [])
            if diagnostic not in shown and len(shown) < self._most:
                shown.append(diagnostic)
                print_diagnostics([diagnostic], summary=False)

    def close(self) -> None:
        """Print how many errors were not shown."""
        for code, count in self._seen.items():
            if hidden := count - len(self._shown[code]):
                print_aside(f"… and {hidden:,} more of this kind [{code}]")


def render_diagnostics(
    diagnostics: Iterable[Diagnostic],
    color: bool = False,
    summary: bool = True,
    width: int = 0,
) -> str:
    """All diagnostics and a line with their numbers; an empty text if there are none.

    Control characters in messages and in the shown lines are escaped, so that a hostile file cannot
    control the terminal. ``color`` adds escape sequences. All is fitted to a ``width``; if that is
    0, messages have one line, and source lines at most MAX_WIDTH columns.
    """
    every = list(diagnostics)
    if not every:
        return ""
    paint = partial(styled, color=color)
    blocks = ["\n".join(_block(diagnostic, paint, width)) for diagnostic in every]
    return "\n\n".join([*blocks, _summary(every)] if summary else blocks) + "\n"


def _summary(every: Sequence[Diagnostic]) -> str:
    parts = []
    for severity in ("error", "warning"):
        number = sum(diagnostic.severity == severity for diagnostic in every)
        if number:
            parts.append(f"{number} {severity}{'' if number == 1 else 's'}")
    return ", ".join(parts)


def _without_others_lines(diagnostic: Diagnostic) -> Diagnostic:
    """A diagnostic without quotes from files behind links that leave their tree.

    The author of the tree may not be allowed to read such a file, but may see what is printed.
    """
    places = [label.place for label in diagnostic.labels]
    if diagnostic.place is not None:
        places.append(diagnostic.place)
    # Look at each file once; a message may have a label for each of its lines.
    if not any(map(_is_behind_link, {place.file for place in places if place.excerpt})):
        return diagnostic
    labels = tuple([replace(label, place=_unquoted(label.place)) for label in diagnostic.labels])
    place = None if diagnostic.place is None else _unquoted(diagnostic.place)
    return replace(diagnostic, place=place, labels=labels)


def _unquoted(place: SourceLocation) -> SourceLocation:
    if not place.excerpt or not _is_behind_link(place.file):
        return place
    return replace(place, column=None, end_column=None, excerpt="")


def _is_behind_link(file: str) -> bool:
    with suppress(OSError, ValueError):  # a name that no file can have
        return leads_out(Path(file))
    return True


def _block(diagnostic: Diagnostic, paint: _Paint, columns: int) -> Iterator[str]:
    diagnostic = _without_others_lines(diagnostic)
    severity = _STYLES[diagnostic.severity]
    head = f"{diagnostic.severity}[{diagnostic.code}]"
    first, *rest = _wrapped(f"{head}: {visible(diagnostic.message)}", columns, "  ")
    yield f"{paint(head, severity)}{paint(first[len(head) :], 'bold')}"
    yield from (paint(line, "bold") for line in rest)
    files = _by_file(diagnostic)
    width = max((len(str(mark.place.line or 0)) for marks in files for mark in marks), default=1)
    gutter = " " * width
    for position, marks in enumerate(files):
        arrow = "-->" if position == 0 else ":::"
        yield f"{gutter}{paint(arrow, _FRAME)} {visible(address(marks[0].place))}"
        shown = [
            mark
            for mark in marks
            if mark.place.line is not None and (mark.place.excerpt.strip() or mark.words)
        ]
        if not shown:
            continue
        yield paint(f"{gutter} |", _FRAME)
        excerpt = columns - _FRAME_COLUMNS if columns else MAX_WIDTH
        for left, text, style in _lines(shown, severity, excerpt):
            yield f"{paint(f'{left:>{width}} |', _FRAME)} {paint(text, style)}".rstrip()
    # Without a shown line there is no underlined place beside which it could be.
    unplaced = "" if _is_shown(diagnostic.place) else diagnostic.expected
    notes = (("note", note) for note in diagnostic.notes)
    for word, text in (("note", unplaced), ("help", diagnostic.help), *notes):
        if text:
            head = f"{gutter} = {word}:"
            first, *rest = _wrapped(f"{head} {visible(text)}", columns, f"{gutter}   ")
            painted = f"{gutter} {paint('=', _FRAME)} {paint(f'{word}:', 'bold')}"
            yield f"{painted}{first[len(head) :]}"
            yield from rest


def _wrapped(text: str, width: int, later: str) -> list[str]:
    return broken(text, width, later=later, at_hyphens=False) if width else [text]


def _by_file(diagnostic: Diagnostic) -> list[list[Underline]]:
    """The marks of a diagnostic by file, the primary place's file first."""
    place = diagnostic.place
    expected = diagnostic.expected if _is_shown(place) else ""
    marks = [] if place is None else [Underline(place, expected, "^")]
    marks += [Underline(label.place, label.message, "-") for label in diagnostic.labels]
    files = list(dict.fromkeys(mark.place.file for mark in marks))
    return [[mark for mark in marks if mark.place.file == file] for file in files]


def _is_shown(place: SourceLocation | None) -> bool:
    """Whether the place has a line to show; of a row of a table only the number is known."""
    return (
        place is not None
        and place.line is not None
        and (place.column is not None or bool(place.excerpt.strip()))
    )


def _lines(
    marks: Sequence[Underline], severity: str, columns: int
) -> Iterator[tuple[str, str, str]]:
    """The number left of the frame, the text right of it, and the style of each line."""
    before: int | None = None
    in_order = sorted(marks, key=lambda mark: mark.place.start)
    for number, group in groupby(in_order, key=lambda mark: mark.place.line):
        assert number is not None, "places without a line are not shown"
        if before is not None and number > before + 1:
            yield "", "...", _FRAME
        before = number
        texts = list(excerpt_lines(list(group), columns))
        yield str(number), texts[0][0], "bold"
        for text, sign in texts[1:]:
            yield "", text, severity if sign == "^" else _FRAME
