"""The pieces of a file that are parsed separately, as ranges of tokens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from rulec.diagnostics import Diagnostic, Source, Span
from rulec.syntax.scanner import Token

PieceKind = Literal["item", "rule_head", "clause", "example_head", "state", "formula", "junk"]


@dataclass(frozen=True, slots=True)
class Piece:
    """Tokens ``first`` to ``last`` (exclusive).

    A ``reported`` piece contains a mistake that has been reported, and is not parsed. ``then`` is
    reported if the piece itself is correct.
    """

    kind: PieceKind
    first: int
    last: int
    reported: bool = False
    then: Diagnostic | None = None


@dataclass(frozen=True, slots=True)
class ExamplePieces:
    """An example: its head and its states; ``last`` is the token after it."""

    head: Piece
    states: tuple[Piece, ...]
    last: int


@dataclass(frozen=True, slots=True)
class RulePieces:
    """The pieces of a rule; ``last`` is the token after it."""

    head: Piece
    body: tuple[Piece | ExamplePieces, ...]
    first: int
    last: int


def span_of(source: Source, tokens: list[Token], part: Piece | ExamplePieces | RulePieces) -> Span:
    """The span from a part's first token to its last.

    The span of an empty part is empty and lies after the previous token.
    """
    first = part.head.first if isinstance(part, ExamplePieces) else part.first
    if first >= part.last:
        end = tokens[first - 1].end if first else 0
        return Span(source, end, end)
    return Span(source, tokens[first].start, tokens[part.last - 1].end)
