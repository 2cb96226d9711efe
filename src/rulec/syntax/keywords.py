"""The words of the language: reserved words, operators, precedence."""

from __future__ import annotations

from typing import Final

FILE_WORDS: Final = ("rulebook", "vocabulary")
HEADER_WORDS: Final = (*FILE_WORDS, "title", "law", "use")
DECLARATION_WORDS: Final = ("type", "signal", "quantity")
RULE_WORDS: Final = ("hard", "soft")
ITEM_WORDS: Final = frozenset((*HEADER_WORDS, *DECLARATION_WORDS, *RULE_WORDS, "rule"))
CLAUSE_WORDS: Final = frozenset(("cite", "says", "require", "accept", "reject"))

OPERATOR_WORDS: Final = frozenset(
    (
        *("not", "and", "or", "implies", "iff", "xor"),
        *("always", "eventually", "next", "until", "release", "weak", "strong"),
    )
)
OPERATOR_LETTERS: Final = frozenset("GFXURWM")

RESERVED: Final = (
    ITEM_WORDS
    | CLAUSE_WORDS
    | OPERATOR_WORDS
    | OPERATOR_LETTERS
    | frozenset(("as", "of", "is", "one", "in", "default", "true", "false"))
)
"""What cannot be a name."""

SYMBOLS: Final = {
    "not": "!",
    "and": "&",
    "or": "|",
    "implies": "->",
    "iff": "<->",
    "xor": "^",
    "always": "G",
    "eventually": "F",
    "next": "X",
    "weak next": "weak next",
    "until": "U",
    "release": "R",
    "weak until": "W",
    "strong release": "M",
}
"""Operator in words -> in symbols; ``weak next`` has no symbol."""

UNARY_OPERATORS: Final = ("not", "always", "eventually", "next", "weak next")

PRECEDENCE: Final = {
    "iff": 1,
    "implies": 2,
    "xor": 3,
    "or": 4,
    "and": 5,
    "until": 6,
    "release": 6,
    "weak until": 6,
    "strong release": 6,
}
"""Binary operator -> how tightly it binds; every unary operator binds tighter."""

UNARY_PRECEDENCE: Final = 7

RIGHT_ASSOCIATIVE: Final = frozenset(
    ("implies", "until", "release", "weak until", "strong release")
)
"""The others associate to the left, which for them makes no difference to the meaning."""


def token_kind(words: str) -> str:
    """What the grammar calls an operator or another word: ``weak until`` is ``WEAK_UNTIL``."""
    return words.upper().replace(" ", "_")
