"""The words of the language: reserved words, operators, precedence."""

from __future__ import annotations

from typing import Final

from rulec.files.source_detection import FILE_WORDS

HEADER_WORDS: Final = (
    *FILE_WORDS,
    *("title", "law", "use", "extends", "traffic", "semantics", "step", "priority"),
)
DECLARATION_WORDS: Final = ("type", "signal", "quantity", "fact", "constant", "presumed")
PROVISION_WORDS: Final = (
    *("option", "param", "set", "define", "redefine"),
    *("drop", "soften", "silent"),
)
LISTING_WORDS: Final = ("topics", "provisions")
"""The first words of items with a block of entries."""

RULE_WORDS: Final = ("hard", "soft")
CHANGE_WORDS: Final = ("override", "confirm")
"""The first words of rules that change inherited ones."""
ITEM_WORDS: Final = frozenset(
    (
        *HEADER_WORDS,
        *DECLARATION_WORDS,
        *PROVISION_WORDS,
        *LISTING_WORDS,
        *RULE_WORDS,
        "rule",
        *CHANGE_WORDS,
    )
)
CLAUSE_WORDS: Final = frozenset(
    (
        *("cite", "says", "source", "certainty"),
        *("require", "also", "unless", "when", "topic", "accept", "reject"),
    )
)
"""The first words of a rule's clauses, except ``in force``, which begins with ``in``."""

CONTEXTUAL: Final = frozenset(
    (
        *("left", "right", "stutter", "finite", "on", "off", "verified", "secondary", "unverified"),
        *("weight", "force", "from", "at"),
    )
)
"""Words that are keywords only in their place; elsewhere they may be names."""

OPERATOR_WORDS: Final = frozenset(
    (
        *("not", "and", "or", "implies", "iff", "xor", "then"),
        *("always", "never", "eventually", "next", "until", "release", "weak", "strong"),
        *("once", "historically", "previously", "since"),
    )
)
PREFIX_LETTERS: Final = "GFXOHY"
INFIX_LETTERS: Final = "URWMS"
OPERATOR_LETTERS: Final = frozenset(PREFIX_LETTERS + INFIX_LETTERS)

RESERVED: Final = (
    ITEM_WORDS
    | CLAUSE_WORDS
    | OPERATOR_WORDS
    | OPERATOR_LETTERS
    | frozenset(("as", "of", "is", "one", "in", "default", "true", "false"))
    | frozenset(("some", "every", "count", "if", "else"))
    | frozenset(("initially", "throughout", "because"))
)
"""Words that cannot be names."""

SYMBOLS: Final = {
    "not": "!",
    "and": "&",
    "or": "|",
    "implies": "->",
    "iff": "<->",
    "xor": "^",
    "then": "then",
    "always": "G",
    "never": "never",
    "eventually": "F",
    "next": "X",
    "weak next": "weak next",
    "until": "U",
    "release": "R",
    "weak until": "W",
    "strong release": "M",
    "once": "O",
    "historically": "H",
    "previously": "Y",
    "weak previously": "weak previously",
    "since": "S",
}
"""Operators as words -> as symbols; those without a symbol keep their words."""

UNARY_OPERATORS: Final = (
    *("not", "always", "never", "eventually", "next", "weak next"),
    *("once", "historically", "previously", "weak previously"),
)

OF_ONE_STATE: Final = frozenset(("not", "and", "or", "implies", "iff", "xor"))
"""The operators that are not temporal."""

LOOKS_BACK: Final = frozenset(("once", "historically", "previously", "weak previously", "since"))
"""The temporal operators of the past, which the first state has none of."""

BINDS_NARROWLY: Final = frozenset(("always", "never", "eventually"))
"""The operators that readers often take to apply to everything that follows."""

JOINS_ALIKE: Final = frozenset(("and", "or", "xor"))
"""The operators between parts that may each have a temporal operator: `always p and never q`."""

_LOOSEST_FIRST: Final = ("iff", "implies", "then", "xor", "or", "and")
PRECEDENCE: Final = {
    **{word: level for level, word in enumerate(_LOOSEST_FIRST, 1)},
    **dict.fromkeys(("until", "release", "weak until", "strong release", "since"), 7),
}
"""Binary operators -> their precedence; every unary operator binds tighter."""

UNARY_PRECEDENCE: Final = 8
COMPARISON_PRECEDENCE: Final = 9
ARITHMETIC_PRECEDENCE: Final = {"+": 10, "-": 10, "*": 11, "/": 11}
MINUS_PRECEDENCE: Final = 12

RIGHT_ASSOCIATIVE: Final = frozenset(
    ("implies", "then", "until", "release", "weak until", "strong release", "since")
)
"""The others associate to the left, which makes no difference to their meaning."""


def token_kind(words: str) -> str:
    """The grammar's name of a keyword: ``weak until`` is ``WEAK_UNTIL``."""
    return words.upper().replace(" ", "_")
