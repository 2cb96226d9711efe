"""Nodes of options, parameters and definitions, and changes of inherited ones."""

from __future__ import annotations

from dataclasses import dataclass, field

from rulec.diagnostics import Span
from rulec.syntax.tree.formulas import Formula, NumberLiteral
from rulec.syntax.tree.names import NOWHERE, Name, Parameter, Text


@dataclass(frozen=True, slots=True)
class InForce:
    """Dates in force: ``in force from DATE until DATE``.

    ISO texts, empty where open. The last day counts.
    """

    since: str = ""
    until: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class OptionItem:
    """Declaration of an option: ``option name = on``."""

    name: Name
    value: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ParamItem:
    """Declaration of a parameter: ``param name : dimension = value``.

    The dimension may be left out; ``in force …`` may follow.
    """

    name: Name
    dimension: Name | None
    value: Formula
    in_force: InForce | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SetItem:
    """``set name = value``: of an inherited option (a bool) or parameter."""

    name: Name
    value: bool | Formula
    in_force: InForce | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class DefineItem:
    """Definition of a macro: ``define name(parameters) = body``.

    A parameter without a type may be a relation.

    ``again``: it is a ``redefine`` of an inherited definition.
    """

    name: Name
    parameters: tuple[Parameter, ...]
    body: Formula
    again: bool = False
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class DropItem:
    """``drop rule name because "…"``."""

    name: Name
    because: Text
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SoftenItem:
    """``soften rule name in level weight number because "…"``."""

    name: Name
    level: Name | None = None
    weight: NumberLiteral | None = None
    because: Text | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SilentItem:
    """``silent on name because "…"``."""

    name: Name
    because: Text
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Definition = OptionItem | ParamItem | SetItem | DefineItem | DropItem | SoftenItem | SilentItem
