"""Help together with the edits that it states."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from rulec.diagnostics.diagnostic import Fix, Offer, SourceLocation, Span
from rulec.diagnostics.phrases import nearest_name


@dataclass(frozen=True, slots=True)
class WayOut:
    """A help text, and the edits that it states, the most likely first.

    An edit that is only a text is written in place of what the message marks.
    """

    text: str
    offers: tuple[Offer | str, ...]

    def __str__(self) -> str:
        return self.text


Help: TypeAlias = str | WayOut
"""A help text, with or without edits."""


def offering(text: str, *offers: Offer | str) -> WayOut:
    """Help with edits; those that are only texts are written in place of what is marked."""
    return WayOut(text, offers)


def meant(name: str, known: Iterable[str], alike: float = 0.6, *, longer: bool = True) -> Help:
    """``did_you_mean``, with the known name in place of what is marked."""
    near = nearest_name(name, known, alike, longer=longer)
    return "" if near is None else offering(f"did you mean `{near}`?", near)


def offers_of(help_: Help, marked: SourceLocation | None) -> tuple[Offer, ...]:
    """The edits of a help text in a message that marks a place."""
    if marked is None or isinstance(help_, str):
        return ()
    return tuple(
        Offer(f"Write `{short(one)}`", (Fix(marked, one),)) if isinstance(one, str) else one
        for one in help_.offers
    )


def short(text: str) -> str:
    """A text on one line, for a title."""
    line = " ".join(text.split())
    return line if len(line) <= 50 else f"{line[:49]}…"


def write(words: str, span: Span) -> Offer:
    """Words in place of others."""
    return Offer(f"Write `{short(words)}`", (Fix(span.place, words),))


def put(title: str, text: str, span: Span, at: int) -> Offer:
    """A text at a character of a span's source, where nothing is replaced."""
    return Offer(title, (Fix(Span(span.source, at, at).place, text),))


_MOST_BEFORE = 2000
"""How many characters before a place are looked through, however long the text is."""


def text_before(span: Span) -> str:
    """The characters before a place, as far as an edit there may be about them."""
    return span.source.text[max(0, span.start - _MOST_BEFORE) : span.start]


def end_before(span: Span) -> int:
    """The end of what comes before a place, without the space between."""
    before = text_before(span)
    return span.start - len(before) + len(before.rstrip())


def put_before(sign: str, span: Span) -> Offer:
    """A sign that is missing right behind what comes before a place."""
    return put(f"Put `{sign.strip()}` before it", sign, span, end_before(span))


def another_name(span: Span) -> Offer:
    """A name that is not in the file; a message may have been made before other parts changed."""
    return Offer("", (Fix(span.place, span.text),))


def left_out(span: Span, title: str = "") -> Offer:
    """Nothing in place of a span."""
    return Offer(title or leaving_out(span.text), (Fix(span.place, ""),))


def leaving_out(text: str) -> str:
    """The title for leaving out a text; invisible characters are named by their numbers."""
    if not short(text).isprintable():
        return f"Leave out {', '.join(f'U+{ord(sign):04X}' for sign in text)}"
    return f"Leave out {'the comment' if text.lstrip().startswith('#') else f'`{short(text)}`'}"


def line_of(span: Span, *beginnings: str) -> Iterator[Span]:
    """The lines that a span is on, with their ends, if they begin with one of some words."""
    text = span.source.text
    last = text.find("\n", span.end) + 1 or len(text)
    whole = Span(span.source, text.rfind("\n", 0, span.start) + 1, last)
    if whole.text.lstrip().startswith(tuple(f"{word} " for word in beginnings)):
        yield whole


def line_left_out(span: Span, *beginnings: str) -> Iterator[Offer]:
    """The lines that a span is on left out, if they begin with one of some words."""
    title = f"Leave out the line of `{short(span.text)}`"
    yield from (left_out(line, title) for line in line_of(span, *beginnings))


def in_header(line: str, file: str) -> Offer:
    """A line that is missing in the header of a file."""
    title = f"Use `{line[4:]}`" if line.startswith("use ") else f"Say `{line}`"
    return Offer(title, (Fix(SourceLocation(file), f"{line}\n"),))


def line_above(title: str, line: str, span: Span) -> Offer:
    """A line that is missing above the item of a span."""
    place = SourceLocation(span.source.name, span.place.line)
    return Offer(title, (Fix(place, f"{line}\n"),))


def declared(words: str, span: Span) -> Offer:
    """A declaration that is missing above the item of a span."""
    return line_above(f"Declare `{short(words)}`", words, span)
