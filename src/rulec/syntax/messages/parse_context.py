"""The place where a piece cannot go on, and what surrounds it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rulec.diagnostics import Source
from rulec.syntax.messages.expectations import wants_operand, wants_operator, wants_quantity
from rulec.syntax.scanner import Token


@dataclass(frozen=True, slots=True)
class ParseContext:
    """Context of a syntax error: a piece, readable up to ``at``."""

    source: Source
    kind: str
    tokens: Sequence[Token]
    at: int
    accepted: frozenset[str]

    def token(self, index: int) -> Token | None:
        """The token at an index of the piece; None outside of it."""
        return self.tokens[index] if 0 <= index < len(self.tokens) else None

    def text_at(self, index: int) -> str:
        """The text of a token; empty outside of the piece."""
        token = self.token(index)
        return token.text if token else ""

    @property
    def unexpected(self) -> Token | None:
        """The unexpected token; None if the piece ends too early."""
        return self.token(self.at)

    @property
    def before(self) -> Token | None:
        """The token before that."""
        return self.token(self.at - 1)

    @property
    def first(self) -> str:
        """The piece's first word."""
        return self.text_at(0)

    @property
    def text(self) -> str:
        """The text of ``unexpected``."""
        return self.text_at(self.at)

    @property
    def text_before(self) -> str:
        """The text of ``before``."""
        return self.text_at(self.at - 1)

    @property
    def text_behind(self) -> str:
        """The text behind ``unexpected``."""
        return self.text_at(self.at + 1)

    def is_number(self, index: int) -> bool:
        """Tell whether a number stands at an index."""
        token = self.token(index)
        return token is not None and token.kind == "number"

    def is_word(self) -> bool:
        """Tell whether ``unexpected`` is a word."""
        return self.unexpected is not None and self.unexpected.kind == "word"

    def touches(self) -> bool:
        """Tell whether no space precedes ``unexpected``."""
        return bool(self.unexpected and self.before and self.before.end == self.unexpected.start)

    @property
    def operand(self) -> bool:
        """Tell whether a formula could begin here."""
        return wants_operand(self.accepted)

    @property
    def quantity(self) -> bool:
        """Tell whether a quantity or a number could stand here."""
        return wants_quantity(self.accepted)

    @property
    def operator(self) -> bool:
        """Tell whether a binary operator could stand here."""
        return wants_operator(self.accepted)

    def opened(self, opening: str, closing: str) -> int | None:
        """The index of the last ``opening`` before ``at`` that is not closed."""
        depth = 0
        for index in range(self.at - 1, -1, -1):
            token = self.tokens[index]
            if token.kind == "symbol" and token.text == closing:
                depth += 1
            elif token.kind == "symbol" and token.text == opening:
                if depth == 0:
                    return index
                depth -= 1
        return None
