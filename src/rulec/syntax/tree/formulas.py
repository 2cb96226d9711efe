"""Nodes of formulas and expressions.

One kind of node for both: types are checked where names are resolved. ``sign`` is how an operator
is spelled in the file, ``grouped`` whether parentheses stand around the node there: for the
formatter, no part of the meaning.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Span
from rulec.syntax.tree.names import NOWHERE, Name, Parameter


@dataclass(frozen=True, slots=True)
class AtomUse:
    """Use of a declared name, perhaps with arguments: ``name(arguments)``."""

    name: Name
    arguments: tuple[Name, ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TruthLiteral:
    """``true`` or ``false``."""

    value: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class NumberLiteral:
    """Unsigned number as written, with its unit or none: ``1.5 km/h``."""

    text: str
    unit: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Amount = NumberLiteral | AtomUse
"""A time in a bound: a number of seconds or steps, or a parameter."""


@dataclass(frozen=True, slots=True)
class BoundNode:
    """``[<= high]``, ``[>= low]``, ``[low .. high]``, or ``[low]``, which is ``exact``."""

    low: Amount | None
    high: Amount | None
    exact: bool = False
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Prefix:
    """A unary operator before its operand."""

    operator: str
    operand: Formula
    bound: BoundNode | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    sign: str = field(default="", compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Infix:
    """A binary operator between its operands."""

    operator: str
    left: Formula
    right: Formula
    bound: BoundNode | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    sign: str = field(default="", compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Compare:
    """Comparison of two numbers: ``left < right``.

    ``relation`` is one of ``< <= = != >= >``.
    """

    relation: Literal["<", "<=", "=", "!=", ">=", ">"]
    left: Formula
    right: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """``left + right``; ``operator`` is one of ``+ - * /``."""

    operator: str
    left: Formula
    right: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Minus:
    """``-operand``."""

    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Conditional:
    """Conditional expression: ``value if condition else otherwise``."""

    value: Formula
    condition: Formula
    otherwise: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Aggregate:
    """``some x: type (body)``, ``every …`` or ``count …``."""

    kind: Literal["some", "every", "count"]
    variable: Parameter
    body: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Formula = (
    AtomUse
    | TruthLiteral
    | NumberLiteral
    | Prefix
    | Infix
    | Compare
    | Arithmetic
    | Minus
    | Conditional
    | Aggregate
)
