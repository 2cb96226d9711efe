"""Source texts and locations in them."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class SourceLocation:
    """Source location for readers: lines and columns count from 1.

    ``end_column`` is the column behind the last character. ``excerpt`` is the text of line ``line``
    (without its line end); empty when there is nothing worth showing.
    """

    file: str
    line: int | None = None
    column: int | None = None
    end_line: int | None = None
    end_column: int | None = None
    excerpt: str = ""

    @property
    def start(self) -> tuple[int, int]:
        """Line and column as a sort key; an unknown one is 0."""
        return self.line or 0, self.column or 0


def address(place: SourceLocation) -> str:
    """``file:line:column``, as far as it is known."""
    parts = [place.file, place.line, place.column]
    return ":".join(str(part) for part in parts if part is not None)


@dataclass(frozen=True, slots=True)
class Source:
    """A text with the name of the file it came from."""

    name: str
    text: str = field(repr=False)
    _line_starts: list[int] = field(default_factory=list, init=False, repr=False, compare=False)
    _known: dict[int, str] = field(default_factory=dict, init=False, repr=False, compare=False)

    def _lines(self) -> list[int]:
        if not self._line_starts:
            starts = [0]
            while (end := self.text.find("\n", starts[-1])) >= 0:
                starts.append(end + 1)
            self._line_starts.extend(starts)
        return self._line_starts

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column, both from 1, of a character offset."""
        starts = self._lines()
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1

    def offset(self, line: int, column: int) -> int:
        """The character offset of a line and a column, both from 1."""
        return self._lines()[line - 1] + column - 1

    def line(self, number: int) -> str:
        """The text of a line, counted from 1, without its line end."""
        # However many mistakes a long line has, its text is copied once.
        if number not in self._known:
            starts = self._lines()
            end = starts[number] if number < len(starts) else len(self.text)
            self._known[number] = self.text[starts[number - 1] : end].rstrip("\r\n")
        return self._known[number]


@dataclass(frozen=True, slots=True)
class Span:
    """Characters ``start`` to ``end`` (exclusive) of a source."""

    source: Source
    start: int
    end: int

    @property
    def text(self) -> str:
        """The characters themselves."""
        return self.source.text[self.start : self.end]

    @property
    def place(self) -> SourceLocation:
        """The source location of the span, with its first line's text."""
        line, column = self.source.position(self.start)
        end_line, end_column = self.source.position(max(self.start, self.end))
        excerpt = self.source.line(line)
        return SourceLocation(
            file=self.source.name,
            line=line,
            column=column,
            end_line=end_line,
            end_column=end_column,
            excerpt=excerpt,
        )
