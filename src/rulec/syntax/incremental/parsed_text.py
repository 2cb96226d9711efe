"""A text as last parsed, from which its next version is parsed."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

from rulec.diagnostics import Diagnostic, Fix, Label, RulecError, Source, SourceLocation
from rulec.files.source_detection import is_foreign
from rulec.syntax import tree
from rulec.syntax.assembly import Part, assemble_file
from rulec.syntax.file_pieces import Piece, RulePieces
from rulec.syntax.messages.lookalikes import HIDES, hidden_meaning
from rulec.syntax.parser import PieceReader, by_place, parse
from rulec.syntax.scanner import Token, checked, scan
from rulec.syntax.split_file import FileSplitter

MOST_CHARACTERS = 1_000_000
"""Longer texts are always parsed as a whole."""

_MOST_GROWTH = 64
"""A source that is this many times longer than its text is rebuilt at once."""

_LITTLE_GROWTH = 8
"""In a pause, a source is rebuilt if it is this many times longer than its text."""


class GrowingSource(Source):
    """The texts of a file's parts, in the order in which they were read.

    Text that replaces a part is appended; the replaced text stays, unused. Each text consists of
    whole lines. A source is equal only to itself, whatever is appended.
    """

    __slots__ = ()

    def append(self, text: str) -> tuple[int, int]:
        """Append lines; returns where they begin: line (from 1) and character (from 0)."""
        starts = self._lines()
        offset = len(self.text)
        if offset and not self.text.endswith("\n"):
            object.__setattr__(self, "text", self.text + "\n")
            offset += 1
            starts.append(offset)
        first = len(starts)
        at = 0
        while (at := text.find("\n", at) + 1) > 0:
            starts.append(offset + at)
        object.__setattr__(self, "text", self.text + text)
        return first, offset

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)


@dataclass(frozen=True, slots=True)
class Segment:
    """Whole lines of a file, with the comments above them, and the items parsed from them.

    ``line`` and ``start`` are where they begin in the growing source: a line from 1, and a
    character. One that ``is_clean`` has no mistakes, and its parts whatever its surroundings are.
    """

    text: str
    line: int
    start: int
    parts: tuple[Part, ...]
    is_clean: bool


@dataclass(frozen=True, slots=True)
class ParsedText:
    """A text, its tree and its mistakes, with places in the text.

    The spans in ``file`` are those of ``source``; ``offset`` and ``placed`` map them to the text.
    Without ``segments`` the text was parsed as a whole, and they are the same.
    """

    text: str
    file: tree.File
    mistakes: tuple[Diagnostic, ...]
    source: Source
    segments: tuple[Segment, ...] = ()
    lines: tuple[int, ...] = ()
    """How many lines of the text are above each segment."""
    starts: tuple[int, ...] = ()
    """How many characters of the text are above each segment."""
    by_start: tuple[int, ...] = ()
    """The segments in their order in ``source``."""

    def offset(self, start: int) -> int:
        """The character of the text for a character of the source."""
        where = bisect_right(self.by_start, start, key=lambda n: self.segments[n].start) - 1
        if where < 0:
            return start
        number = self.by_start[where]
        inside = start - self.segments[number].start
        return self.starts[number] + inside if inside <= len(self.segments[number].text) else start

    def placed(self, place: SourceLocation) -> SourceLocation:
        """The place in the text for a place in the source."""
        if not self.segments or place.file != self.source.name or place.line is None:
            return place
        where = bisect_right(self.by_start, place.line, key=lambda n: self.segments[n].line) - 1
        number = self.by_start[max(0, where)]
        down = 1 + self.lines[number] - self.segments[number].line
        end = None if place.end_line is None else place.end_line + down
        return replace(place, line=place.line + down, end_line=end) if down else place

    def in_text(self, mistake: Diagnostic) -> Diagnostic:
        """The diagnostic with its places in the text instead of the source."""
        if not self.segments:
            return mistake

        def fixed(fix: Fix) -> Fix:
            return replace(fix, place=self.placed(fix.place))

        return replace(
            mistake,
            place=None if mistake.place is None else self.placed(mistake.place),
            labels=tuple(Label(self.placed(x.place), x.message) for x in mistake.labels),
            fix=None if mistake.fix is None else fixed(mistake.fix),
            offers=tuple(replace(x, fixes=tuple(map(fixed, x.fixes))) for x in mistake.offers),
        )


def parsed_text(source: Source, before: ParsedText | None = None) -> ParsedText:
    """Parse a text; items that are unchanged since ``before``, under the same name, are reused.

    Tree and mistakes are those of ``parse``, except for the spans (see ``ParsedText``).
    """
    text = source.text
    if before is not None and before.text == text:
        return before
    try:
        tokens = scan(checked(source))
    except RulecError:
        return _whole(source)
    if len(text) > MOST_CHARACTERS or is_foreign(text) or not tokens:
        return _whole(source)
    growing = GrowingSource(source.name, "")
    known: dict[str, list[Segment]] = {}
    earlier = None if before is None else before.source
    if isinstance(earlier, GrowingSource) and not _has_grown(earlier, text, _MOST_GROWTH):
        growing = earlier
        for segment in reversed(before.segments if before else ()):
            known.setdefault(segment.text, []).append(segment)
    splitter = FileSplitter(source, tokens)
    reading = _Reading(PieceReader(source, tokens), growing)
    segments = []
    for group in _groups(splitter):
        old = known.get(text[group.begin : group.end])
        is_kept = old and old[-1].is_clean and not group.has_mistakes
        segments.append(old.pop() if old and is_kept else reading.segment(group))
    file, wrong_order = assemble_file(growing, [part for one in segments for part in one.parts])
    if file.kind != "rulebook":
        return _whole(source)
    order = sorted(range(len(segments)), key=lambda number: segments[number].start)
    parsed = ParsedText(
        text,
        file,
        (),
        growing,
        segments=tuple(segments),
        lines=tuple(accumulate((one.text.count("\n") for one in segments[:-1]), initial=0)),
        starts=tuple(accumulate((len(one.text) for one in segments[:-1]), initial=0)),
        by_start=tuple(order),
    )
    if wrong_order:
        # How to mend them depends on the text around, across segments.
        return replace(parsed, mistakes=parse(source)[1])
    mistakes = [*splitter.mistakes, *reading.plain.mistakes]
    if HIDES.search(text.replace("\r\n", "\n")) or any(map(_is_foreign_word, tokens)):
        mistakes += hidden_meaning(source, tokens)
    return replace(parsed, mistakes=tuple(sorted(mistakes, key=by_place)))


def _whole(source: Source) -> ParsedText:
    file, mistakes = parse(source)
    return ParsedText(source.text, file, mistakes, source)


def _is_foreign_word(token: Token) -> bool:
    return token.kind == "word" and not token.text.isascii()


@dataclass(frozen=True, slots=True)
class _Group:
    """The characters of a text from one item to the next that begins on its own line."""

    begin: int
    end: int
    pieces: Sequence[Piece | RulePieces]
    has_mistakes: bool


def _groups(splitter: FileSplitter) -> list[_Group]:
    tokens, text = splitter.tokens, splitter.source.text
    groups: list[_Group] = []
    begin = behind = n_mistakes = 0
    pieces: list[Piece | RulePieces] = []
    has_mistakes = False
    for part in splitter.split():
        if pieces:
            behind = text.find("\n", behind) + 1
            if 0 < behind <= tokens[part.first].start:
                groups.append(_Group(begin, behind, pieces, has_mistakes))
                begin, pieces, has_mistakes = behind, [], False
        pieces.append(part)
        has_mistakes |= len(splitter.mistakes) > n_mistakes
        n_mistakes = len(splitter.mistakes)
        behind = tokens[part.last - 1].end
    has_mistakes |= len(splitter.mistakes) > n_mistakes
    return [*groups, _Group(begin, len(text), pieces, has_mistakes)]


@dataclass(frozen=True, slots=True)
class _Reading:
    """Reads items into a growing source, and their mistakes by ``plain``, in the text itself."""

    plain: PieceReader
    growing: GrowingSource

    def segment(self, group: _Group) -> Segment:
        """A group as read anew."""
        text = self.plain.source.text[group.begin : group.end]
        line, start = self.growing.append(text)
        first, last, down = group.pieces[0].first, group.pieces[-1].last, start - group.begin
        # Pieces count tokens from the beginning of the text.
        tokens = self.plain.tokens if not down else self.plain.tokens[:last]
        for number in range(first, last) if down else ():
            token = tokens[number]
            tokens[number] = token._replace(start=token.start + down, end=token.end + down)
        reader = PieceReader(self.growing, tokens)
        parts = tuple(map(reader.part, group.pieces))
        is_clean = not (reader.mistakes or group.has_mistakes)
        if reader.mistakes:
            for piece in group.pieces:
                self.plain.part(piece)
        return Segment(text, line, start, parts, is_clean=is_clean)


def renewed(parsed: ParsedText) -> ParsedText:
    """The text parsed as a whole if its source has grown much; to be called when typing pauses."""
    if not _has_grown(parsed.source, parsed.text, _LITTLE_GROWTH):
        return parsed
    return parsed_text(Source(parsed.source.name, parsed.text))


def _has_grown(source: Source, text: str, times: int) -> bool:
    return len(source.text) > times * (len(text) + 10_000)
