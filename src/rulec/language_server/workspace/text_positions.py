"""Positions in a text as editors count them: lines, and code units within a line."""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass, field

from lsprotocol import types as lsp

from rulec.diagnostics import SourceLocation, Span

_LINE_END = re.compile(r"\r\n|\r|\n")

_WIDTHS = {
    lsp.PositionEncodingKind.Utf8: lambda text: len(text.encode("utf-8", "surrogatepass")),
    lsp.PositionEncodingKind.Utf16: lambda text: (
        len(text.encode("utf-16-le", "surrogatepass")) // 2
    ),
    lsp.PositionEncodingKind.Utf32: len,
}


@dataclass(frozen=True, slots=True)
class TextPositions:
    r"""Positions and ranges in one text; ``encoding`` is what editor and server have agreed on.

    Line ends are those of the protocol: ``\n``, ``\r\n`` and ``\r``. In rulec a line ends only with
    ``\n``.
    """

    text: str
    encoding: lsp.PositionEncodingKind | str = lsp.PositionEncodingKind.Utf16
    _starts: list[int] = field(default_factory=list, init=False, repr=False)
    _own_starts: list[int] = field(default_factory=list, init=False, repr=False)

    def _lines(self) -> list[int]:
        if not self._starts:
            self._starts.append(0)
            self._starts.extend(match.end() for match in _LINE_END.finditer(self.text))
        return self._starts

    def _own_lines(self) -> list[int]:
        if not self._own_starts:
            self._own_starts.append(0)
            self._own_starts.extend(match.end() for match in re.finditer("\n", self.text))
        return self._own_starts

    def _line_text(self, number: int) -> str:
        starts = self._lines()
        end = starts[number + 1] if number + 1 < len(starts) else len(self.text)
        return self.text[starts[number] : end].rstrip("\r\n")

    def position(self, offset: int) -> lsp.Position:
        """The position of a character offset."""
        starts = self._lines()
        offset = max(0, min(offset, len(self.text)))
        line = bisect_right(starts, offset) - 1
        before = self.text[starts[line] : offset]
        width = len(before) if before.isascii() else _WIDTHS[_kind(self.encoding)](before)
        return lsp.Position(line, width)

    def offset(self, position: lsp.Position) -> int:
        """The character offset of a position, clipped to the end of its line and of the text."""
        starts = self._lines()
        if position.line >= len(starts):
            return len(self.text)
        line = self._line_text(position.line)
        if line.isascii():
            return starts[position.line] + min(position.character, len(line))
        width_of = _WIDTHS[_kind(self.encoding)]
        left = position.character
        for column, character in enumerate(line):
            left -= width_of(character)
            if left < 0:
                return starts[position.line] + column
        return starts[position.line] + len(line)

    def range(self, start: int, end: int) -> lsp.Range:
        """The range between two character offsets."""
        return lsp.Range(self.position(start), self.position(max(start, end)))

    def of(self, span: Span) -> lsp.Range:
        """The range of a span of the text."""
        return self.range(span.start, span.end)

    def offset_of(self, line: int | None, column: int | None) -> int:
        """The character offset of a line and a column of a ``SourceLocation``."""
        starts = self._own_lines()
        if line is None or line > len(starts):
            return 0 if line is None else len(self.text)
        end = starts[line] if line < len(starts) else len(self.text)
        return min(starts[line - 1] + max(0, (column or 1) - 1), end)

    def place(self, place: SourceLocation) -> lsp.Range:
        """The range of a diagnostic's place; the first line if it names none."""
        start = self.offset_of(place.line, place.column)
        if place.end_line is None:
            return self.range(start, start)
        return self.range(start, self.offset_of(place.end_line, place.end_column))

    def whole(self) -> lsp.Range:
        """The range of the whole text."""
        return self.range(0, len(self.text))


def _kind(encoding: lsp.PositionEncodingKind | str) -> lsp.PositionEncodingKind:
    return lsp.PositionEncodingKind(encoding)
