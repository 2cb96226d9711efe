"""What the grammar would have accepted, in words."""

from __future__ import annotations

from collections.abc import Iterable

from rulec.diagnostics import any_of
from rulec.syntax.keywords import PRECEDENCE, UNARY_OPERATORS, token_kind

_OPERANDS = frozenset(map(token_kind, UNARY_OPERATORS)) | {
    *("LPAR", "TRUE", "FALSE", "NAME"),
    *("SOME", "EVERY", "COUNT", "NUMBER", "MINUS"),
}
_OPERATORS = frozenset(map(token_kind, PRECEDENCE))
_COMPARISONS = frozenset(("LESS", "AT_MOST", "EQUALS", "NOT_EQUAL", "AT_LEAST", "GREATER"))
_ARITHMETIC = frozenset(("PLUS", "MINUS", "TIMES", "OVER"))
_WORDS = {
    "NAME": "a name",
    "STRING": "a text in double quotes",
    "DATE": "a date such as 2006-03-28",
    "NUMBER": "a number",
    "UNIT": "a unit such as km/h",
    "LPAR": "`(`",
    "RPAR": "`)`",
    "COMMA": "`,`",
    "COLON": "`:`",
    "AND": "`and`",
    "NOT": "`not`",
    "$END": "nothing more",
}
_ORDER = ("NAME", "STRING", "DATE", "NUMBER", "UNIT", "NOT", "RPAR", "LPAR", "COLON", "COMMA")


def in_words(accepted: Iterable[str]) -> str:
    """``expected an atom, `not`, or `(``` for the grammar's names of tokens."""
    rest = set(accepted)
    before: list[str] = []
    behind: list[str] = []
    if rest >= _OPERANDS:
        before = ["an atom", "`not`", "`(`"]
        rest -= _OPERANDS
    if rest >= _OPERATORS:
        behind = ["an operator such as `and`"]
        rest -= _OPERATORS | _COMPARISONS | _ARITHMETIC | {"LPAR", "UNIT"}
    rest.discard("$END" if before or behind or len(rest) > 1 else "")
    ranked = sorted(rest, key=lambda kind: (_rank(kind), kind))
    parts = [*before, *(_WORDS.get(kind, f"`{kind.lower()}`") for kind in ranked), *behind]
    return f"expected {any_of(parts or [_WORDS['$END']])}"


def _rank(kind: str) -> int:
    return _ORDER.index(kind) if kind in _ORDER else len(_ORDER)


def wants_operand(accepted: frozenset[str]) -> bool:
    """Could a formula begin here?"""
    return accepted >= _OPERANDS


def wants_operator(accepted: frozenset[str]) -> bool:
    """Could a binary operator stand here?"""
    return accepted >= _OPERATORS
