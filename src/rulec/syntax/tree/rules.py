"""Nodes of rules and of their examples."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Span
from rulec.syntax.tree.definitions import InForce
from rulec.syntax.tree.formulas import AtomUse, Formula, Minus, NumberLiteral
from rulec.syntax.tree.names import NOWHERE, Name, Parameter, Text


@dataclass(frozen=True, slots=True)
class StateLiteral:
    """Literal of an example's state: ``atom``, ``not atom``, or ``atom = value``.

    A ``value`` is a number, with ``Minus`` around it if it is negative.
    """

    atom: AtomUse
    negated: bool = False
    value: NumberLiteral | Minus | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ExampleState:
    """Literals of an example's state; none if all is by default."""

    literals: tuple[StateLiteral, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ExampleItem:
    """``accept "label" (objects) { state; … }`` or ``reject …``."""

    accepts: bool
    states: tuple[ExampleState, ...]
    label: str = ""
    objects: tuple[Parameter, ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Scope = Literal["initially", "at start", "throughout", "at some point", "at end"]


@dataclass(frozen=True, slots=True)
class Unless:
    """``unless formula scope``; None where no scope is written."""

    formula: Formula
    scope: Scope | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RuleItem:
    """Rule, or an ``override`` with only the changed clauses.

    ``complete`` is false when a clause of it could not be read and is missing here.
    """

    strength: Literal["hard", "soft"] | None
    name: Name
    variables: tuple[Parameter, ...] = ()
    require: Formula | None = None
    cite: Text | None = None
    says: Text | None = None
    examples: tuple[ExampleItem, ...] = ()
    complete: bool = True
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    level: Name | None = None
    weight: NumberLiteral | None = None
    override: bool = False
    unless: tuple[Unless, ...] = ()
    when: Formula | None = None
    source: Text | None = None
    certainty: Literal["", "verified", "secondary", "unverified"] = ""
    in_force: InForce | None = None
