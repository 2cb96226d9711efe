"""The position of a syntax error, with the tokens expected there."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from rulec.diagnostics import Fix, Offer, Source, Span, any_of
from rulec.diagnostics.ways_out import left_out, put_before, write
from rulec.syntax.keywords import PRECEDENCE, UNARY_OPERATORS, token_kind
from rulec.syntax.scanner import Token

_QUANTITIES: Final = frozenset(
    ("NAME", "NUMBER", "LPAR", "MINUS", "TRUE", "FALSE", "SOME", "EVERY", "COUNT")
)
_OPERANDS: Final = _QUANTITIES | frozenset(map(token_kind, UNARY_OPERATORS))
_OPERATORS: Final = frozenset(map(token_kind, PRECEDENCE))
COMPARISONS: Final = frozenset(("LESS", "AT_MOST", "EQUALS", "NOT_EQUAL", "AT_LEAST", "GREATER"))
_ARITHMETIC: Final = frozenset(("PLUS", "MINUS", "TIMES", "OVER"))
SCOPES: Final = frozenset(("INITIALLY", "AT_START", "THROUGHOUT", "AT_SOME_POINT", "AT_END"))

_PHRASES: Final = {
    "NAME": "a name",
    "STRING": "a text in double quotes",
    "DATE": "a date such as 2006-03-28",
    "NUMBER": "a number",
    "UNIT": "a unit such as km/h",
    "$END": "nothing more",
}
_SPELLINGS: Final = {
    "NOT_MACHINE_READABLE": "not machine-readable",
    "ON_TOPIC": "on",
    "LPAR": "(",
    "RPAR": ")",
    "LSQB": "[",
    "RSQB": "]",
    "LBRACE": "{",
    "RBRACE": "}",
    "COMMA": ",",
    "COLON": ":",
    "SEMICOLON": ";",
    "TO": "..",
    "LESS": "<",
    "AT_MOST": "<=",
    "EQUALS": "=",
    "NOT_EQUAL": "!=",
    "AT_LEAST": ">=",
    "GREATER": ">",
    "PLUS": "+",
    "MINUS": "-",
    "TIMES": "*",
    "OVER": "/",
}
"""The spelling of tokens whose grammar names are not their words in capitals."""

_ORDER: Final = (
    *("NAME", "STRING", "DATE", "NUMBER", "UNIT", "NOT"),
    *("RPAR", "RSQB", "LPAR", "LSQB", "COLON", "COMMA", "EQUALS", "AT_MOST"),
)


def spelling(kind: str) -> str:
    """The spelling of a grammar token: ``AT_END`` is ``at end``."""
    return _SPELLINGS.get(kind) or kind.lower().replace("_", " ")


def in_words(accepted: Iterable[str]) -> str:
    """A phrase for the accepted tokens, such as ``expected a name``."""
    rest = set(accepted)
    before: list[str] = []
    behind: list[str] = []
    if rest >= _OPERANDS:
        # A bound may come first, but nobody who misses an operand looks for it.
        before = ["an atom", "a number", "`not`", "`(`"]
        rest -= _OPERANDS | {"LSQB"}
    elif rest >= _QUANTITIES:
        before = ["a name", "a number", "`(`"]
        rest -= _QUANTITIES
    if rest >= _OPERATORS:
        behind = ["an operator such as `and`"]
        rest -= _OPERATORS | COMPARISONS | _ARITHMETIC | {"LPAR", "UNIT", "IF", "IN"}
    if rest >= SCOPES:
        behind.insert(0, "a scope such as `throughout`")
        rest -= SCOPES
    rest.discard("MINUS" if "NUMBER" in rest else "")
    rest.discard("$END" if before or behind or len(rest) > 1 else "")
    ranked = sorted(rest, key=lambda kind: (_rank(kind), kind))
    parts = [*before, *(_PHRASES.get(kind, f"`{spelling(kind)}`") for kind in ranked), *behind]
    return f"expected {any_of(parts or [_PHRASES['$END']])}"


def _rank(kind: str) -> int:
    return _ORDER.index(kind) if kind in _ORDER else len(_ORDER)


@dataclass(frozen=True, slots=True)
class ParseContext:
    """The context of a syntax error in a piece that is readable up to ``at``."""

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
        return self.token(self.at - 1)

    @property
    def first(self) -> str:
        return self.text_at(0)

    @property
    def text(self) -> str:
        return self.text_at(self.at)

    @property
    def text_before(self) -> str:
        return self.text_at(self.at - 1)

    @property
    def text_behind(self) -> str:
        return self.text_at(self.at + 1)

    def is_number(self, index: int) -> bool:
        token = self.token(index)
        return token is not None and token.kind == "number"

    def is_word(self) -> bool:
        return self.unexpected is not None and self.unexpected.kind == "word"

    def touches(self) -> bool:
        """Whether no space precedes ``unexpected``."""
        return bool(self.unexpected and self.before and self.before.end == self.unexpected.start)

    @property
    def operand(self) -> bool:
        """Whether a formula could begin here."""
        return self.accepted >= _OPERANDS

    @property
    def quantity(self) -> bool:
        """Whether a quantity or a number could come here."""
        return self.accepted >= _QUANTITIES

    @property
    def operator(self) -> bool:
        """Whether a binary operator could come here."""
        return self.accepted >= _OPERATORS

    def span(self, first: int, last: int | None = None) -> Span:
        """The characters of a token, or from one to another."""
        end = self.tokens[first if last is None else last].end
        return Span(self.source, self.tokens[first].start, end)

    def write(self, words: str, first: int, last: int | None = None) -> Offer:
        """Words in place of a token, or of those from one to another."""
        return write(words, self.span(first, last))

    def write_sign(self, word: str) -> Offer:
        """A sign or a word in place of the unexpected token, apart from the words beside it."""
        marked = self.span(self.at)
        beside = (
            self.source.text[marked.start - 1 : marked.start],
            self.source.text[marked.end : marked.end + 1],
        )
        before, behind = (" " if word.isalpha() and one.isalnum() else "" for one in beside)
        return Offer(f"Write `{word}`", (Fix(marked.place, f"{before}{word}{behind}"),))

    def leave_out(self, first: int, last: int | None = None) -> Offer:
        """Nothing in place of a token, or of those from one to another."""
        return left_out(self.span(first, last))

    def separate(self, sign: str) -> Offer:
        """A separator in place of another one, or before the unexpected token."""
        is_other = self.text in (",", ";", "and", "or", "|")
        return self.write(sign, self.at) if is_other else self.put_before(sign)

    def put_before(self, sign: str) -> Offer:
        """A sign that is missing before the unexpected token, or at the end."""
        end = self.tokens[self.at - 1].end
        return put_before(sign, Span(self.source, end, end))

    def opened(self, opening: str, closing: str) -> int | None:
        """The index of the last unclosed ``opening`` before ``at``."""
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


COMMENT: Final = "a comment begins with `#`"


def is_comment(tokens: Sequence[Token], at: int) -> bool:
    """Whether a comment of another language begins at a token: ``//``, ``/*``, ``--``, a dash."""
    signs = "".join(token.text for token in tokens[at : at + 2])
    return signs[:2] in ("//", "/*", "--") or signs[:1] in ("—", "–")


DELETE_IT: Final = "delete the character there, which cannot be seen"


def is_invisible(text: str) -> bool:
    """Whether a character is invisible, such as those that word processors insert."""
    return len(text) == 1 and unicodedata.category(text) == "Cf"
