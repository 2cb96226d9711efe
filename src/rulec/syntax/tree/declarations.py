"""Nodes of declarations: of types, enumerations, signals, quantities, facts."""

from __future__ import annotations

from dataclasses import dataclass, field

from rulec.diagnostics import Span
from rulec.syntax.tree.formulas import Formula
from rulec.syntax.tree.names import NOWHERE, Name, Parameter


@dataclass(frozen=True, slots=True)
class TypeItem:
    """``type name is parent``."""

    name: Name
    parent: Name | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class EnumerationItem:
    """``name(parameters) is one of values default value``."""

    name: Name
    parameters: tuple[Parameter, ...]
    values: tuple[Name, ...]
    default: Name | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SignalHead:
    """One of the signals of a ``signal`` line."""

    name: Name
    parameters: tuple[Parameter, ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SignalItem:
    """``signal p, q(o: type) default false``."""

    signals: tuple[SignalHead, ...]
    default: bool | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class QuantityItem:
    """``quantity name(parameters) in unit default number``."""

    name: Name
    parameters: tuple[Parameter, ...]
    unit: str
    default: float | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    unit_span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class FactItem:
    """``fact formula``: what always holds, for all objects that it speaks of."""

    formula: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Declaration = TypeItem | EnumerationItem | SignalItem | QuantityItem | FactItem
