"""Segments of a file: lines with the items that begin in them, and the parsed result."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from rulec.diagnostics import Diagnostic, Source, SourceLocation
from rulec.syntax.assembly import Part
from rulec.syntax.file_pieces import Piece, RulePieces
from rulec.syntax.parser import PieceReader
from rulec.syntax.scanner import Token, scan
from rulec.syntax.split_file import FileSplitter


@dataclass(frozen=True, slots=True)
class Segment:
    """Whole lines of a file, with the comments above them, and the items parsed from them.

    ``line`` and ``start`` are where they begin in the growing source: a line from 1, and a
    character. ``split`` are mistakes about braces, ``read`` those within pieces; the places of both
    may lie in surrounding lines as these were at that time. ``closes``: its last part is a rule.
    ``foreign``: it has words that are not ASCII.
    """

    text: str
    line: int
    start: int
    parts: tuple[Part, ...] = ()
    split: tuple[Diagnostic, ...] = ()
    read: tuple[Diagnostic, ...] = ()
    closes: bool = False
    foreign: bool = False

    @property
    def is_clean(self) -> bool:
        """Whether it has no mistakes, so that its surroundings can be parsed independently."""
        return bool(self.parts) and not (self.split or self.read)

    def lines(self) -> int:
        """The number of line ends in it."""
        return self.text.count("\n")

    def reaches_before(self) -> bool:
        """Whether one of its mistakes depends on text above: it refers to it, or lacks it."""
        if any(not mistake.labels for mistake in self.split):
            return True
        return any(
            place.line is not None and place.line < self.line
            for mistake in (*self.split, *self.read)
            for place in places_of(mistake)
        )


def places_of(mistake: Diagnostic) -> Iterator[SourceLocation]:
    """All places that a diagnostic shows."""
    if mistake.place is not None:
        yield mistake.place
    yield from (label.place for label in mistake.labels)
    if mistake.fix is not None:
        yield mistake.fix.place
    yield from (fix.place for offer in mistake.offers for fix in offer.fixes)


def shifted(place: SourceLocation, lines: int) -> SourceLocation:
    """A place moved down by some lines."""
    if place.line is None or not lines:
        return place
    end = None if place.end_line is None else place.end_line + lines
    return replace(place, line=place.line + lines, end_line=end)


@dataclass(frozen=True, slots=True)
class _Group:
    """The characters of a window from one item to the next that begins on its own line."""

    begin: int
    end: int
    pieces: list[Piece | RulePieces]
    mistakes: list[Diagnostic]


@dataclass(frozen=True, slots=True)
class Window:
    """Lines of a file, from the beginning of an item or of the file; ``start`` is in ``source``.

    ``above`` and ``below`` are existing segments at its beginning and end. Clean segments of these
    are reused if they end where they did.
    """

    source: Source
    text: str
    line: int
    start: int
    above: Sequence[Segment] = ()
    below: Sequence[Segment] = ()


def segments_of(window: Window) -> list[Segment]:
    """The segments of a window. Raises RulecError if it has too many tokens."""
    source, start = window.source, window.start
    tokens = [
        Token(token.kind, token.text, token.start + start, token.end + start, token.first)
        for token in scan(Source(source.name, window.text))
    ]
    groups = _groups(FileSplitter(source, tokens), window)
    kept: dict[int, Segment] = dict(enumerate(window.above))
    kept.update(
        (len(groups) - number, segment) for number, segment in enumerate(reversed(window.below), 1)
    )
    reader = PieceReader(source, tokens)
    segments: list[Segment] = []
    line = window.line
    for number, group in enumerate(groups):
        text = window.text[group.begin - start : group.end - start]
        old = kept.get(number)
        if old is None or old.text != text or not old.is_clean or group.mistakes:
            n_before = len(reader.mistakes)
            parts = tuple(reader.part(pieces) for pieces in group.pieces)
            old = Segment(
                text,
                line=line,
                start=group.begin,
                parts=parts,
                split=tuple(group.mistakes),
                read=tuple(reader.mistakes[n_before:]),
                closes=bool(group.pieces) and isinstance(group.pieces[-1], RulePieces),
                foreign=not text.isascii() and _has_foreign_word(tokens, group),
            )
        segments.append(old)
        line += old.lines()
    return segments


def _groups(splitter: FileSplitter, window: Window) -> list[_Group]:
    tokens, end = splitter.tokens, window.start + len(window.text)
    groups: list[_Group] = []
    begin = window.start
    pieces: list[Piece | RulePieces] = []
    n_assigned = behind = 0
    mistakes: list[Diagnostic] = []
    for part in splitter.split():
        if pieces:
            behind = window.text.find("\n", behind - window.start) + 1 + window.start
            if window.start < behind <= tokens[part.first].start:
                groups.append(_Group(begin, behind, pieces, mistakes))
                begin, pieces, mistakes = behind, [], []
        pieces.append(part)
        mistakes += splitter.mistakes[n_assigned:]
        n_assigned = len(splitter.mistakes)
        behind = tokens[part.last - 1].end
    mistakes += splitter.mistakes[n_assigned:]
    last = window.text.find("\n", max(0, behind - window.start)) + 1 + window.start
    if not pieces or last == window.start:
        last = end
    groups.append(_Group(begin, last, pieces, mistakes))
    if last < end:
        groups.append(_Group(last, end, [], []))
    return groups


def _has_foreign_word(tokens: Sequence[Token], group: _Group) -> bool:
    if not group.pieces:
        return False
    words = tokens[group.pieces[0].first : group.pieces[-1].last]
    return any(token.kind == "word" and not token.text.isascii() for token in words)
