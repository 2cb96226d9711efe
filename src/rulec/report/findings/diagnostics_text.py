"""Diagnostics as plain text, with underlined source lines and help."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.source_text import SourceLocation
from rulec.report.findings.source_excerpt import Underline, excerpt_lines, visible

_BOLD, _RESET = "\x1b[1m", "\x1b[0m"
_COLORS = {"error": "\x1b[1;31m", "warning": "\x1b[1;33m", "frame": "\x1b[1;34m"}


def render_diagnostics(
    diagnostics: Iterable[Diagnostic], color: bool = False, summary: bool = True
) -> str:
    """All diagnostics and a line that counts them; empty text for none.

    Control characters in messages and in the shown lines are escaped, so that a hostile file cannot
    drive the terminal. ``color`` adds ANSI colours.
    """
    every = list(diagnostics)
    if not every:
        return ""
    paint = _Paint(color)
    blocks = ["\n".join(_block(diagnostic, paint)) for diagnostic in every]
    return "\n\n".join([*blocks, _summary(every)] if summary else blocks) + "\n"


class _Paint:
    """Colours a piece of text, or leaves it alone."""

    def __init__(self, color: bool) -> None:
        self._color = color

    def __call__(self, style: str, text: str) -> str:
        if not self._color or not text:
            return text
        return f"{_COLORS.get(style, _BOLD)}{text}{_RESET}"


def _summary(every: Sequence[Diagnostic]) -> str:
    parts = []
    for severity in ("error", "warning"):
        number = sum(diagnostic.severity == severity for diagnostic in every)
        if number:
            parts.append(f"{number} {severity}{'' if number == 1 else 's'}")
    return ", ".join(parts)


def _block(diagnostic: Diagnostic, paint: _Paint) -> Iterator[str]:
    head = paint(diagnostic.severity, f"{diagnostic.severity}[{diagnostic.code}]")
    yield f"{head}{paint('bold', ': ' + visible(diagnostic.message))}"
    width = _number_width(diagnostic)
    gutter = " " * width
    for position, (file, marks) in enumerate(_by_file(diagnostic)):
        arrow = "-->" if position == 0 else ":::"
        yield f"{gutter}{paint('frame', arrow)} {visible(_address(file, marks[0]))}"
        shown = [mark for mark in marks if mark.place.line is not None and _worth_showing(mark)]
        if not shown:
            continue
        yield paint("frame", f"{gutter} |")
        for left, text, style in _lines(shown, diagnostic.severity):
            number = paint("frame", f"{left:>{width}} |")
            yield f"{number} {paint(style, text)}".rstrip()
    # Without a line there is no underlined place for it to stand beside.
    unplaced = (
        ""
        if diagnostic.place is not None and diagnostic.place.line is not None
        else diagnostic.expected
    )
    notes = (("note", note) for note in diagnostic.notes)
    for word, text in (("note", unplaced), ("help", diagnostic.help), *notes):
        if text:
            yield f"{gutter} {paint('frame', '=')} {paint('bold', word + ':')} {visible(text)}"


def _worth_showing(mark: Underline) -> bool:
    return bool(mark.place.excerpt.strip()) or bool(mark.words)


def _by_file(diagnostic: Diagnostic) -> list[tuple[str, list[Underline]]]:
    """The marks of a diagnostic by file, the primary place's file first."""
    marks = (
        [] if diagnostic.place is None else [Underline(diagnostic.place, diagnostic.expected, "^")]
    )
    marks += [Underline(label.place, label.message, "-") for label in diagnostic.labels]
    files = list(dict.fromkeys(mark.place.file for mark in marks))
    return [(file, [mark for mark in marks if mark.place.file == file]) for file in files]


def _address(file: str, mark: Underline) -> str:
    place: SourceLocation = mark.place
    parts = [file, place.line, place.column]
    return ":".join(str(part) for part in parts if part is not None)


def _number_width(diagnostic: Diagnostic) -> int:
    places = [diagnostic.place, *(label.place for label in diagnostic.labels)]
    lines = [place.line for place in places if place is not None and place.line is not None]
    return max((len(str(line)) for line in lines), default=1)


def _lines(marks: Sequence[Underline], severity: str) -> Iterator[tuple[str, str, str]]:
    """Line number left of the frame, text right of it, and style."""
    before: int | None = None
    in_order = sorted(marks, key=lambda mark: mark.place.start)
    for number, group in groupby(in_order, key=lambda mark: mark.place.line):
        assert number is not None, "places without a line are not shown"
        if before is not None and number > before + 1:
            yield "", "...", "frame"
        before = number
        texts = list(excerpt_lines(list(group)))
        yield str(number), texts[0][0], "plain" if severity else ""
        for text, sign in texts[1:]:
            yield "", text, severity if sign == "^" else "frame"
