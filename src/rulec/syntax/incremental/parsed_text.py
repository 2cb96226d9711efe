"""A text as last parsed, from which its next version is parsed."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

from rulec.diagnostics import Diagnostic, Fix, Label, RulecError, Source, SourceLocation
from rulec.files.source_detection import is_foreign
from rulec.syntax import tree
from rulec.syntax.assembly import assemble_file
from rulec.syntax.incremental.growing_source import GrowingSource
from rulec.syntax.incremental.segments import Segment, Window, segments_of, shifted
from rulec.syntax.messages.lookalikes import HIDES, hidden_meaning
from rulec.syntax.parser import by_place, parse
from rulec.syntax.scanner import checked, scan

MOST_CHARACTERS = 1_000_000
"""Longer texts are always parsed as a whole."""

_RUN_ON = 21
"""A quoted text that is not closed is searched for in at most so many lines."""

_MOST_GROWTH = 64
"""A source that is this many times longer than its text is rebuilt at once."""

_LITTLE_GROWTH = 8
"""In a pause, a source is rebuilt if it is this many times longer than its text."""


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

    def _segment_at(self, start: int) -> int | None:
        """The number of the segment that contains a character of the source."""
        where = bisect_right(self.by_start, start, key=lambda n: self.segments[n].start) - 1
        if where < 0:
            return None
        number = self.by_start[where]
        segment = self.segments[number]
        return number if start <= segment.start + len(segment.text) else None

    def offset(self, start: int) -> int:
        """The character of the text for a character of the source."""
        number = self._segment_at(start)
        if number is None:
            return start
        return self.starts[number] + start - self.segments[number].start

    def placed(self, place: SourceLocation) -> SourceLocation:
        """The place in the text for a place in the source."""
        if not self.segments or place.file != self.source.name or place.line is None:
            return place
        where = bisect_right(self.by_start, place.line, key=lambda n: self.segments[n].line) - 1
        number = self.by_start[max(0, where)]
        return shifted(place, 1 + self.lines[number] - self.segments[number].line)

    def in_text(self, mistake: Diagnostic) -> Diagnostic:
        """The diagnostic with its places in the text instead of the source."""
        return self._moved(mistake, None) if self.segments else mistake

    def _moved(self, mistake: Diagnostic, of: int | None) -> Diagnostic:
        """A diagnostic with its places in the text; those of segment ``of`` move with it."""

        def moved(place: SourceLocation) -> SourceLocation:
            if of is None:
                return self.placed(place)
            if place.file != self.source.name:
                return place
            return shifted(place, 1 + self.lines[of] - self.segments[of].line)

        def fixed(fix: Fix) -> Fix:
            return replace(fix, place=moved(fix.place))

        fix = mistake.fix
        offers = tuple(replace(o, fixes=tuple(map(fixed, o.fixes))) for o in mistake.offers)
        return replace(
            mistake,
            place=None if mistake.place is None else moved(mistake.place),
            labels=tuple(Label(moved(label.place), label.message) for label in mistake.labels),
            fix=None if fix is None else fixed(fix),
            offers=offers,
        )


def parsed_text(source: Source, before: ParsedText | None = None) -> ParsedText:
    """Parse a text; parts that are unchanged since ``before``, under the same name, are reused.

    Tree and mistakes are those of ``parse``, except for the spans (see ``ParsedText``).
    """
    text = source.text
    if before is not None and before.text == text:
        return before
    try:
        checked(source)
    except RulecError:
        return _whole(source)
    if len(text) > MOST_CHARACTERS or is_foreign(text):
        return _whole(source)
    try:
        if before is not None and before.segments and isinstance(before.source, GrowingSource):
            edited = _edited(before, before.source, text)
            if edited is not None:
                return edited
        growing = GrowingSource(source.name, text)
        segments = segments_of(Window(growing, text, 1, 0))
    except RulecError:  # more tokens than there may be
        return _whole(source)
    return _assembled(growing, segments, text) or _whole(source)


def _whole(source: Source) -> ParsedText:
    file, mistakes = parse(source)
    return ParsedText(source.text, file, mistakes, source)


def _assembled(source: GrowingSource, segments: Sequence[Segment], text: str) -> ParsedText | None:
    """The file of the segments; None if it is not a rulebook, or empty."""
    parts = [part for segment in segments for part in segment.parts]
    if not parts:
        return None
    file, wrong_order = assemble_file(source, parts)
    if file.kind != "rulebook":
        return None
    lines = (0, *accumulate(segment.lines() for segment in segments))
    starts = (0, *accumulate(len(segment.text) for segment in segments))
    order = sorted(range(len(segments)), key=lambda number: segments[number].start)
    parsed = ParsedText(
        text,
        file,
        (),
        source,
        segments=tuple(segments),
        lines=lines[:-1],
        starts=starts[:-1],
        by_start=tuple(order),
    )
    mistakes = [
        *(
            parsed._moved(diagnostic, n)
            for n, segment in enumerate(segments)
            for diagnostic in segment.split
        ),
        *(
            parsed._moved(diagnostic, n)
            for n, segment in enumerate(segments)
            for diagnostic in segment.read
        ),
        *map(parsed.in_text, wrong_order),
    ]
    if HIDES.search(text.replace("\r\n", "\n")) or any(segment.foreign for segment in segments):
        plain = Source(source.name, text)
        mistakes += hidden_meaning(plain, scan(plain))
    return replace(parsed, mistakes=tuple(sorted(mistakes, key=by_place)))


def _edited(before: ParsedText, source: GrowingSource, text: str) -> ParsedText | None:
    """The text after an edit; None if all of it has to be parsed."""
    if _has_grown(source, text, _MOST_GROWTH):
        return None
    old = before.segments
    above = _alike(old, text)
    below = _alike_at_end(old[above:], text, sum(len(segment.text) for segment in old[:above]))
    first, last = _first(old, above), _last(old, len(old) - below)
    while True:
        lengths = [len(segment.text) for segment in old]
        begin, end = sum(lengths[:first]), len(text) - sum(lengths[last:])
        line, start = source.append(text[begin:end])
        window = Window(
            source,
            text[begin:end],
            line,
            start,
            above=old[first:above],
            below=old[len(old) - below : last],
        )
        segments = segments_of(window)
        holds_above = first == 0 or segments[0] is old[first]
        holds_below = last == len(old) or segments[-1] is old[last - 1]
        if holds_above and holds_below:
            return _assembled(source, [*old[:first], *segments, *old[last:]], text)
        if first == 0 and last == len(old):
            return None
        first = _first(old, max(0, first - 3))
        last = _last(old, min(len(old), last + 3))


def renewed(parsed: ParsedText) -> ParsedText:
    """The text parsed as a whole if its source has grown much; to be called when typing pauses."""
    if not _has_grown(parsed.source, parsed.text, _LITTLE_GROWTH):
        return parsed
    return parsed_text(Source(parsed.source.name, parsed.text))


def _has_grown(source: Source, text: str, times: int) -> bool:
    return len(source.text) > times * (len(text) + 10_000)


def _alike(segments: Sequence[Segment], text: str) -> int:
    """How many segments the text begins with."""
    at = 0
    for number, segment in enumerate(segments):
        if not text.startswith(segment.text, at):
            return number
        at += len(segment.text)
    return len(segments)


def _alike_at_end(segments: Sequence[Segment], text: str, least: int) -> int:
    """How many segments the text ends with; they must not extend above character ``least``."""
    end = len(text)
    for number, segment in enumerate(reversed(segments)):
        start = end - len(segment.text)
        if start < least or not text.startswith(segment.text, start):
            return number
        end = start
    return len(segments)


def _first(segments: Sequence[Segment], changed: int) -> int:
    """The first segment to parse again: nothing after it can change the segments before.

    It is clean and ends a rule, and no segment with mistakes is close enough above it to be
    affected by an unclosed quote.
    """
    first = max(0, changed - 1)
    while first > 0:
        near = _near_above(segments, min(first, changed))
        if segments[first].is_clean and segments[first].closes and near is None:
            break
        first = first - 1 if near is None else min(near, first - 1)
    return first


def _near_above(segments: Sequence[Segment], first: int) -> int | None:
    """A segment with mistakes that is no more lines above than an unclosed quote extends."""
    lines = 0
    for number in range(first - 1, -1, -1):
        if not segments[number].is_clean:
            return number
        lines += segments[number].lines()
        if lines > _RUN_ON:
            break
    return None


def _last(segments: Sequence[Segment], changed: int) -> int:
    """The segment before which to stop: the segments before it are unchanged."""
    last = min(len(segments), changed + 1)
    while last < len(segments):
        behind = "".join(segment.text for segment in segments[changed:last])
        quoted = '"' in behind or behind.count("\n") > _RUN_ON
        rest = _wrong_above(segments[last:])
        if segments[last - 1].is_clean and quoted and not rest:
            break
        last = last + (rest or 1)
    return min(last, len(segments))


def _wrong_above(segments: Sequence[Segment]) -> int:
    """How many segments there are up to the last one with a mistake shown above it."""
    reach = [number for number, segment in enumerate(segments, 1) if segment.reaches_before()]
    return reach[-1] if reach else 0
