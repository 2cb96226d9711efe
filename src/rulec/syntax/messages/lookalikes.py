"""Misleading characters in comments, and confusable names.

After UTS #39 (Unicode Security Mechanisms): two names are confusable if they have the same
skeleton, which is the text with each letter replaced by the common representative of all letters
that look like it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from unicodedata import name as name_of
from unicodedata import normalize

from rulec.diagnostics import Diagnostic, Fix, Label, Source, Span
from rulec.diagnostics.code import Code
from rulec.diagnostics.ways_out import offering
from rulec.resources import grammar_file
from rulec.syntax.keywords import RESERVED
from rulec.syntax.messages.literals import misleads
from rulec.syntax.scanner import Token

HIDDEN_IN_COMMENT = Code("R0118")

CONFUSABLE_NAME = Code("R0119")


def hidden_in_comment(place: Span) -> Diagnostic:
    return HIDDEN_IN_COMMENT.at(
        place,
        "a comment may not hold this invisible character",
        help="delete it",
        fix=Fix(place.place, ""),
    )


def looks_like(place: Span, other: str, first: Span | None) -> Diagnostic:
    codes = ", ".join(f"U+{ord(letter):04X}" for letter in place.text if not letter.isascii())
    return CONFUSABLE_NAME.at(
        place,
        f"`{place.text}` ({codes}) looks like `{other}`, and is another name",
        help=offering("write it in the letters of the other names, or call it otherwise", other),
        labels=() if first is None else (Label(first.place, "the other name is here"),),
        severity="warning",
    )


HIDES = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
"""Characters that hide or reorder the text around them in a comment."""
MOST = 20
"""The most places of a kind that are named."""


def hidden_meaning(source: Source, tokens: Sequence[Token]) -> list[Diagnostic]:
    """Errors for comments that hide or reorder a line, and warnings for confusable names."""
    diagnostics = []
    if HIDES.search(source.text):
        diagnostics += [hidden_in_comment(place) for place in _hidden(source, tokens)]
    if not source.text.isascii():
        diagnostics += _alike(source, tokens)
    return diagnostics


def _hidden(source: Source, tokens: Sequence[Token]) -> Iterator[Span]:
    """The first hidden character of each comment; texts are checked elsewhere."""
    ends = [token.end for token in tokens]
    starts = [token.start for token in tokens]
    for end, start in zip([0, *ends], [*starts, len(source.text)], strict=True):
        for comment in re.finditer(r"#[^\n]*", source.text[end:start]):
            at = next((n for n, sign in enumerate(comment[0]) if _is_hidden(sign)), None)
            if at is not None:
                place = end + comment.start() + at
                yield Span(source, place, place + 1)


def _is_hidden(character: str) -> bool:
    return misleads(character) or character in "\u061c\u200e\u200f"


def _alike(source: Source, tokens: Sequence[Token]) -> Iterator[Diagnostic]:
    first = {token.text: token for token in reversed(tokens) if token.kind == "word"}
    foreign = [name for name in reversed(first) if not name.isascii()]
    own = _own_scripts(foreign)
    skeletons: dict[str, str] = {name: name for name in (*RESERVED, *first) if name.isascii()}
    left = MOST
    for name in foreign:
        skeleton = skeleton_of(name)
        other = skeletons.setdefault(skeleton, name)
        token = first[name]
        place = Span(source, token.start, token.end)
        scripts = {_script(letter) for letter in name if letter.isalpha()}
        seems_latin = skeleton.isascii() and scripts != {"LATIN"}
        is_odd = seems_latin and (len(scripts) > 1 or not scripts <= own)
        if left and (other != name or is_odd):
            left -= 1
            seen = first.get(other) if other != name else None
            label = None if seen is None else Span(source, seen.start, seen.end)
            yield looks_like(place, other if other != name else skeleton, label)


def _own_scripts(names: Sequence[str]) -> set[str]:
    """The scripts that the file uses for more than letters that look like Latin ones."""
    letters = {letter for name in names for letter in name}
    return {_script(letter) for letter in letters if not skeleton_of(letter).isascii()}


@cache
def _script(letter: str) -> str:
    """The first word of a letter's Unicode name, which is nearly always its script."""
    return name_of(letter, "").partition(" ")[0]


def skeleton_of(name: str) -> str:
    """A text that is equal for all names that look alike (UTS #39, section 4)."""
    table = _table()
    letters = normalize("NFD", name)
    return normalize("NFD", "".join(table.get(letter, letter) for letter in letters))


@cache
def _table() -> Mapping[str, str]:
    data = json.loads(grammar_file("confusables.json").read_text(encoding="utf-8"))
    alike: Mapping[str, str] = data["alike"]
    return {letter: prototype for prototype, letters in alike.items() for letter in letters}
