"""The comments of a file and their places, which the tree lacks."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from rulec.diagnostics import Source
from rulec.syntax.scanner import Token

_COMMENT = re.compile(r"#[^\n]*")


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment from its ``#`` at ``start``, without trailing blanks.

    ``trails``: something else comes before it on its line. ``column`` counts from 0.
    """

    text: str
    start: int
    column: int
    trails: bool


def comments_of(source: Source, tokens: Sequence[Token]) -> list[Comment]:
    """All comments of a file in order."""
    text = source.text
    starts = [*(token.start for token in tokens), len(text)]
    ends = [0, *(token.end for token in tokens)]
    return [
        _comment(source, match_)
        for end, start in zip(ends, starts, strict=True)
        if start > end + 1 or (start > end and text[end] == "#")
        for match_ in _COMMENT.finditer(text, end, start)
    ]


def _comment(source: Source, match_: re.Match[str]) -> Comment:
    start = match_.start()
    line_start = source.text.rfind("\n", 0, start) + 1
    trails = bool(source.text[line_start:start].strip())
    return Comment(match_.group().rstrip(), start, start - line_start, trails)


def blank_line_before(text: str, position: int) -> bool:
    """Whether an empty line precedes the token at ``position``."""
    before = position
    while before and text[before - 1].isspace():
        before -= 1
    return text.count("\n", before, position) > 1
