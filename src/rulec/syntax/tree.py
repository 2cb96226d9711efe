"""The syntax tree: a file as written, every node with its span.

Spans do not take part in comparison, so trees are equal when their structure is. Operators are
spelled in words (``"weak until"``), whatever the file uses.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Source, Span

NOWHERE = Span(Source("", ""), 0, 0)
"""The span of a node that was made by a program and not read from a file."""


@dataclass(frozen=True, slots=True)
class Name:
    """An identifier."""

    text: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Text:
    """A text in double quotes; ``value`` is what it means, without quotes and escapes."""

    value: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Parameter:
    """``name: type``; in a declaration, not in a rule's head, the type may be left out."""

    name: Name
    type: Name | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# Formulas


@dataclass(frozen=True, slots=True)
class AtomUse:
    """``name`` or ``name(arguments)``: a signal or an enumeration's value."""

    name: Name
    arguments: tuple[Name, ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Truth:
    """``true`` or ``false``."""

    value: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Prefix:
    """A unary operator before its operand."""

    operator: str
    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Infix:
    """A binary operator between its operands."""

    operator: str
    left: Formula
    right: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Formula = AtomUse | Truth | Prefix | Infix


# Header lines


@dataclass(frozen=True, slots=True)
class FileLine:
    """``rulebook NAME`` or ``vocabulary NAME``."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TitleLine:
    """``title "…"``."""

    text: Text
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class LawLine:
    """``law "…" as of DATE``; the date is ISO text, empty when not given."""

    text: Text
    as_of: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class UseLine:
    """``use NAME``: a vocabulary."""

    name: Name
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# Declarations


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


Declaration = TypeItem | EnumerationItem | SignalItem | QuantityItem


# Rules


@dataclass(frozen=True, slots=True)
class StateLiteral:
    """``atom`` or ``not atom`` in an example's state."""

    atom: AtomUse
    negated: bool = False
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ExampleState:
    """What one state of an example mentions."""

    literals: tuple[StateLiteral, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Example:
    """``accept "label" { state; … }`` or ``reject …``."""

    accepts: bool
    states: tuple[ExampleState, ...]
    label: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RuleItem:
    """A rule. ``complete`` is false when a clause of it could not be read and is missing here."""

    strength: Literal["hard", "soft"]
    name: Name
    variables: tuple[Parameter, ...] = ()
    require: Formula | None = None
    cite: Text | None = None
    says: Text | None = None
    examples: tuple[Example, ...] = ()
    complete: bool = True
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class BrokenItem:
    """An item that could not be read; it may have declared any of ``names``.

    ``word`` is its first word, ``"rule"`` for a rule whose head could not be read. A ``nameless``
    one lacks the name that it declares.
    """

    names: frozenset[str]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    word: str = ""
    nameless: bool = False


@dataclass(frozen=True, slots=True)
class File:
    """A rulebook or a vocabulary. ``name`` is None when its line could not be read."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name | None
    title: TitleLine | None = None
    law: LawLine | None = None
    uses: tuple[UseLine, ...] = ()
    items: tuple[Declaration | RuleItem | BrokenItem, ...] = ()
    complete: bool = True
    """False when a header line could not be read, or anything that might be one."""
    span: Span = field(default=NOWHERE, compare=False, repr=False)
