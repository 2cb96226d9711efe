"""Words for the tokens that the grammar would have accepted."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rulec.diagnostics import any_of
from rulec.syntax.keywords import PRECEDENCE, UNARY_OPERATORS, token_kind

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
"""Spelling of the tokens whose names in the grammar are not their words in capitals."""

_ORDER: Final = (
    *("NAME", "STRING", "DATE", "NUMBER", "UNIT", "NOT"),
    *("RPAR", "RSQB", "LPAR", "LSQB", "COLON", "COMMA", "EQUALS", "AT_MOST"),
)


def spelling(kind: str) -> str:
    """The spelling of a grammar token: ``AT_END`` is ``at end``."""
    return _SPELLINGS.get(kind) or kind.lower().replace("_", " ")


def in_words(accepted: Iterable[str]) -> str:
    """Phrase for the accepted tokens, such as ``expected a name``."""
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


def wants_operand(accepted: frozenset[str]) -> bool:
    """Tell whether a formula could begin here."""
    return accepted >= _OPERANDS


def wants_quantity(accepted: frozenset[str]) -> bool:
    """Tell whether a quantity or a number could stand here."""
    return accepted >= _QUANTITIES


def wants_operator(accepted: frozenset[str]) -> bool:
    """Tell whether a binary operator could stand here."""
    return accepted >= _OPERATORS
