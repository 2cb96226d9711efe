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


# Formulas and expressions: one kind of node for both, types are checked where names are resolved.
# ``sign`` is how an operator is spelled in the file, ``grouped`` whether parentheses stand around
# the node there: for the formatter, no part of the meaning.


@dataclass(frozen=True, slots=True)
class AtomUse:
    """``name`` or ``name(arguments)``: a signal, a value, a quantity, a parameter, a definition."""

    name: Name
    arguments: tuple[Name, ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Truth:
    """``true`` or ``false``."""

    value: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Number:
    """``1.5 km/h``: an unsigned number as written, and its unit, empty if there is none."""

    text: str
    unit: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Amount = Number | AtomUse
"""A time in a bound: a number of seconds or steps, or a parameter."""


@dataclass(frozen=True, slots=True)
class Bound:
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
    bound: Bound | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    sign: str = field(default="", compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Infix:
    """A binary operator between its operands."""

    operator: str
    left: Formula
    right: Formula
    bound: Bound | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    sign: str = field(default="", compare=False, repr=False)
    grouped: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Compare:
    """``left < right``; ``relation`` is one of ``< <= = != >= >``."""

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
    """``value if condition else otherwise``; inside a formula it always stands in parentheses."""

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
    | Truth
    | Number
    | Prefix
    | Infix
    | Compare
    | Arithmetic
    | Minus
    | Conditional
    | Aggregate
)


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


@dataclass(frozen=True, slots=True)
class ExtendsLine:
    """``extends NAME``: the rulebook that this one builds upon."""

    name: Name
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TrafficLine:
    """``traffic left`` or ``traffic right``."""

    side: Literal["left", "right"]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SemanticsLine:
    """``semantics stutter`` or ``semantics finite``."""

    kind: Literal["stutter", "finite"]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class StepLine:
    """``step 0.5 s``: how far the states of examples are apart."""

    amount: Number
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class PriorityLine:
    """``priority a > b = c``; ``relations[i]`` stands between levels i and i + 1."""

    levels: tuple[Name, ...]
    relations: tuple[Literal[">", "="], ...]
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


@dataclass(frozen=True, slots=True)
class FactItem:
    """``fact formula``: what always holds, for all objects that it speaks of."""

    formula: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Declaration = TypeItem | EnumerationItem | SignalItem | QuantityItem | FactItem


# Options, parameters, definitions


@dataclass(frozen=True, slots=True)
class InForce:
    """``in force from DATE until DATE``; ISO texts, empty where open. The last day counts."""

    since: str = ""
    until: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class OptionItem:
    """``option name = on``; with ``set`` in place of ``option`` it is a SetItem."""

    name: Name
    value: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ParamItem:
    """``param name : dimension = value in force …``; the dimension may be left out."""

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
    """``define name(parameters) = body``; a parameter without a type may be a relation.

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
    weight: Number | None = None
    because: Text | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class SilentItem:
    """``silent on name because "…"``."""

    name: Name
    because: Text
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Provision = OptionItem | ParamItem | SetItem | DefineItem | DropItem | SoftenItem | SilentItem


# Rules


@dataclass(frozen=True, slots=True)
class StateLiteral:
    """``atom``, ``not atom``, or ``atom = value`` for a quantity, in an example's state.

    A ``value`` is a number, with ``Minus`` around it if it is negative.
    """

    atom: AtomUse
    negated: bool = False
    value: Number | Minus | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ExampleState:
    """What one state of an example mentions."""

    literals: tuple[StateLiteral, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Example:
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
    """A rule; one that is an ``override`` says only what it changes, perhaps not its strength.

    ``complete`` is false when a clause of it could not be read and is missing here.
    """

    strength: Literal["hard", "soft"] | None
    name: Name
    variables: tuple[Parameter, ...] = ()
    require: Formula | None = None
    cite: Text | None = None
    says: Text | None = None
    examples: tuple[Example, ...] = ()
    complete: bool = True
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    level: Name | None = None
    weight: Number | None = None
    override: bool = False
    unless: tuple[Unless, ...] = ()
    when: Formula | None = None
    source: Text | None = None
    certainty: Literal["", "verified", "secondary", "unverified"] = ""
    in_force: InForce | None = None


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


HeaderLine = (
    TitleLine
    | LawLine
    | UseLine
    | ExtendsLine
    | TrafficLine
    | SemanticsLine
    | StepLine
    | PriorityLine
)

Item = Declaration | Provision | RuleItem | BrokenItem


@dataclass(frozen=True, slots=True)
class File:
    """A rulebook or a vocabulary. ``name`` is None when its line could not be read."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name | None
    title: TitleLine | None = None
    law: LawLine | None = None
    uses: tuple[UseLine, ...] = ()
    items: tuple[Item, ...] = ()
    complete: bool = True
    """False when a header line could not be read, or anything that might be one."""
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    extends: ExtendsLine | None = None
    traffic: TrafficLine | None = None
    semantics: SemanticsLine | None = None
    step: StepLine | None = None
    priorities: tuple[PriorityLine, ...] = ()
