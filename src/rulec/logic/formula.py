"""Formulas: small frozen nodes, and the operators as two enumerations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum


class UnaryOperator(Enum):
    """Value: the operator in words, as a rulebook spells it."""

    NOT = "not"
    ALWAYS = "always"
    NEVER = "never"
    EVENTUALLY = "eventually"
    NEXT = "next"
    WEAK_NEXT = "weak next"
    ONCE = "once"
    HISTORICALLY = "historically"
    PREVIOUSLY = "previously"
    WEAK_PREVIOUSLY = "weak previously"


class BinaryOperator(Enum):
    """Value: the operator in words, as a rulebook spells it."""

    AND = "and"
    OR = "or"
    IMPLIES = "implies"
    IFF = "iff"
    XOR = "xor"
    THEN = "then"
    UNTIL = "until"
    RELEASE = "release"
    WEAK_UNTIL = "weak until"
    STRONG_RELEASE = "strong release"
    SINCE = "since"


@dataclass(frozen=True, slots=True)
class Atom:
    """``value(arguments)`` for the value of an enumeration, ``name(arguments)`` for a signal.

    ``name`` is the declaration's name, ``arguments`` the rule's variables (or a trace's objects),
    ``value`` the enumeration's value, None for a signal.
    """

    name: str
    arguments: tuple[str, ...] = ()
    value: str | None = None

    def __str__(self) -> str:
        arguments = f"({', '.join(self.arguments)})" if self.arguments else ""
        return f"{self.value or self.name}{arguments}"


@dataclass(frozen=True, slots=True)
class Constant:
    """``true`` or ``false``."""

    value: bool


@dataclass(frozen=True, slots=True)
class Unary:
    """An operator on one formula."""

    operator: UnaryOperator
    operand: Formula


@dataclass(frozen=True, slots=True)
class Binary:
    """An operator between two formulas."""

    operator: BinaryOperator
    left: Formula
    right: Formula


Formula = Atom | Constant | Unary | Binary


def atoms_of(formula: Formula) -> Iterator[Atom]:
    """The formula's atoms from left to right, with repetitions."""
    match formula:
        case Atom():
            yield formula
        case Unary(_, operand):
            yield from atoms_of(operand)
        case Binary(_, left, right):
            yield from atoms_of(left)
            yield from atoms_of(right)
        case Constant():
            return
