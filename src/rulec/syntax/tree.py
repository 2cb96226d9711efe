"""The syntax tree: a file as written, every node with its span.

Nodes are equal when their structure is. Operators are spelled in words (``"weak until"``), whatever
the file uses. Formulas and expressions are one kind of node: types are checked where names are
resolved.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Source, Span

NOWHERE = Span(Source("", ""), 0, 0)
"""The span of a node that was made by a program and not read from a file."""


@dataclass(frozen=True, slots=True)
class _SyntaxNode:
    """A part of a file; its ``span`` does not take part in comparison."""

    span: Span = field(default=NOWHERE, kw_only=True, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Grouping(_SyntaxNode):
    """A node that may have parentheses around it, if ``grouped``: no part of the meaning."""

    grouped: bool = field(default=False, kw_only=True, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Name(_SyntaxNode):
    """An identifier."""

    text: str


@dataclass(frozen=True, slots=True)
class Text(_SyntaxNode):
    """Text in double quotes; ``value`` has no quotes and no escapes."""

    value: str


@dataclass(frozen=True, slots=True)
class Parameter(_SyntaxNode):
    """Parameter with its type: ``name: type``.

    In a declaration, not in a rule's head, the type may be left out.
    """

    name: Name
    type: Name | None = None


@dataclass(frozen=True, slots=True)
class AtomUse(_SyntaxNode):
    """Use of a declared name, perhaps with arguments: ``name(arguments)``."""

    name: Name
    arguments: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class TruthLiteral(_SyntaxNode):
    """``true`` or ``false``."""

    value: bool


@dataclass(frozen=True, slots=True)
class NumberLiteral(_SyntaxNode):
    """Unsigned number as written, with its unit or none: ``1.5 km/h``."""

    text: str
    unit: str = ""


Amount = NumberLiteral | AtomUse
"""A time in a bound: a number of seconds or steps, or a parameter."""


@dataclass(frozen=True, slots=True)
class BoundNode(_SyntaxNode):
    """``[<= high]``, ``[>= low]``, ``[low .. high]``, or ``[low]``, which is ``exact``."""

    low: Amount | None
    high: Amount | None
    exact: bool = False


@dataclass(frozen=True, slots=True)
class Prefix(Grouping):
    """A unary operator before its operand."""

    operator: str
    operand: Formula
    bound: BoundNode | None = None
    sign: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Infix(Grouping):
    """A binary operator between its operands."""

    operator: str
    left: Formula
    right: Formula
    bound: BoundNode | None = None
    sign: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Compare(Grouping):
    """Comparison of two numbers: ``left < right``. ``relation`` is one of ``< <= = != >= >``."""

    relation: Literal["<", "<=", "=", "!=", ">=", ">"]
    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Arithmetic(Grouping):
    """``left + right``; ``operator`` is one of ``+ - * /``."""

    operator: str
    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Minus(Grouping):
    """``-operand``."""

    operand: Formula


@dataclass(frozen=True, slots=True)
class Conditional(Grouping):
    """Conditional expression: ``value if condition else otherwise``."""

    value: Formula
    condition: Formula
    otherwise: Formula


@dataclass(frozen=True, slots=True)
class Aggregate(_SyntaxNode):
    """``some x: type (body)``, ``every …`` or ``count …``."""

    kind: Literal["some", "every", "count"]
    variable: Parameter
    body: Formula


Operation = Prefix | Infix | Compare | Arithmetic | Minus | Conditional
Formula = AtomUse | TruthLiteral | NumberLiteral | Operation | Aggregate


@dataclass(frozen=True, slots=True)
class StateLiteral(_SyntaxNode):
    """Literal of an example's state: ``atom``, ``not atom``, or ``atom = value``.

    A ``value`` is a number, with ``Minus`` around it if it is negative.
    """

    atom: AtomUse
    negated: bool = False
    value: NumberLiteral | Minus | None = None


@dataclass(frozen=True, slots=True)
class ExampleState(_SyntaxNode):
    """Literals of an example's state; none if all is by default."""

    literals: tuple[StateLiteral, ...]


@dataclass(frozen=True, slots=True)
class ExampleItem(_SyntaxNode):
    """``accept "label" (objects) { state; … }`` or ``reject …``."""

    accepts: bool
    states: tuple[ExampleState, ...]
    label: str = ""
    objects: tuple[Parameter, ...] = ()


Certainty = Literal["", "verified", "secondary", "unverified"]
"""How sure something is: read in the law itself, read elsewhere, from memory; empty if unsaid."""

Scope = Literal["initially", "at start", "throughout", "at some point", "at end"]


@dataclass(frozen=True, slots=True)
class Unless(_SyntaxNode):
    """``unless formula scope``; None where no scope is written.

    ``also unless`` is added to the exceptions that an override inherits.
    """

    formula: Formula
    scope: Scope | None = None
    also: bool = False


@dataclass(frozen=True, slots=True)
class RuleItem(_SyntaxNode):
    """Rule, or an ``override`` with only the changed clauses.

    ``confirm``: it is an override that says no more than whose law the rule is.
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
    level: Name | None = None
    weight: NumberLiteral | None = None
    override: bool = False
    unless: tuple[Unless, ...] = ()
    when: Formula | None = None
    source: Text | None = None
    certainty: Certainty = ""
    in_force: InForce | None = None
    confirm: bool = False
    topics: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class TypeItem(_SyntaxNode):
    """``type name is parent``."""

    name: Name
    parent: Name | None = None


@dataclass(frozen=True, slots=True)
class EnumerationItem(_SyntaxNode):
    """``name(parameters) is one of values default value``."""

    name: Name
    parameters: tuple[Parameter, ...]
    values: tuple[Name, ...]
    default: Name | None = None


@dataclass(frozen=True, slots=True)
class SignalHead(_SyntaxNode):
    """One of the signals of a ``signal`` line."""

    name: Name
    parameters: tuple[Parameter, ...] = ()


@dataclass(frozen=True, slots=True)
class SignalItem(_SyntaxNode):
    """``signal p, q(o: type) default false``."""

    signals: tuple[SignalHead, ...]
    default: bool | None = None


@dataclass(frozen=True, slots=True)
class QuantityItem(_SyntaxNode):
    """``quantity name(parameters) in unit default number``."""

    name: Name
    parameters: tuple[Parameter, ...]
    unit: str
    default: float | None = None
    unit_span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class FactItem(_SyntaxNode):
    """``fact formula``: what always holds, for all objects that it speaks of."""

    formula: Formula


@dataclass(frozen=True, slots=True)
class ConstantItem(_SyntaxNode):
    """``constant names``: their values stay the same as long as a trace goes on."""

    names: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class PresumedItem(_SyntaxNode):
    """``presumed names``: where no source tells them, their defaults hold."""

    names: tuple[Name, ...]


Declaration = (
    TypeItem | EnumerationItem | SignalItem | QuantityItem | FactItem | ConstantItem | PresumedItem
)


@dataclass(frozen=True, slots=True)
class InForce(_SyntaxNode):
    """Dates in force: ``in force from DATE until DATE``.

    ISO texts, empty where open. The last day counts.
    """

    since: str = ""
    until: str = ""


@dataclass(frozen=True, slots=True)
class OptionItem(_SyntaxNode):
    """Declaration of an option: ``option name = on``."""

    name: Name
    value: bool


@dataclass(frozen=True, slots=True)
class ParamItem(_SyntaxNode):
    """Declaration of a parameter: ``param name : dimension = value``.

    The dimension may be left out; ``in force …`` may follow.
    """

    name: Name
    dimension: Name | None
    value: Formula
    in_force: InForce | None = None


@dataclass(frozen=True, slots=True)
class SetItem(_SyntaxNode):
    """``set name = value``: of an inherited option (a bool) or parameter."""

    name: Name
    value: bool | Formula
    in_force: InForce | None = None


@dataclass(frozen=True, slots=True)
class DefineItem(_SyntaxNode):
    """Definition of a macro: ``define name(parameters) = body``.

    A parameter without a type may be a relation.

    ``again``: it is a ``redefine`` of an inherited definition.
    """

    name: Name
    parameters: tuple[Parameter, ...]
    body: Formula
    again: bool = False


@dataclass(frozen=True, slots=True)
class DropItem(_SyntaxNode):
    """``drop rule name because "…"``."""

    name: Name
    because: Text


@dataclass(frozen=True, slots=True)
class SoftenItem(_SyntaxNode):
    """``soften rule name in level weight number because "…"``."""

    name: Name
    level: Name | None = None
    weight: NumberLiteral | None = None
    because: Text | None = None


@dataclass(frozen=True, slots=True)
class SilentItem(_SyntaxNode):
    """``silent on name because "…"``."""

    name: Name
    because: Text


Definition = OptionItem | ParamItem | SetItem | DefineItem | DropItem | SoftenItem | SilentItem


@dataclass(frozen=True, slots=True)
class TopicEntry(_SyntaxNode):
    """``name "title" of rules``: rules of these names are about it, if they say nothing else."""

    name: Name
    title: Text
    rules: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class TopicsItem(_SyntaxNode):
    """``topics { … }``: what rules can be about."""

    entries: tuple[TopicEntry, ...]


Treatment = Literal["to do", "silent", "not machine-readable"]
"""What is said of an article that no rule cites."""


@dataclass(frozen=True, slots=True)
class ArticleEntry(_SyntaxNode):
    """``"number" "heading" silent because "…"``: an article, and why no rule comes from it."""

    number: Text
    heading: Text
    treatment: Treatment = "to do"
    because: Text | None = None


@dataclass(frozen=True, slots=True)
class ProvisionsItem(_SyntaxNode):
    """``provisions "link" as of DATE certainty WORD { … }``: the articles of a law on a day.

    The date is ISO text, empty when not given, as is how sure the headings are.
    """

    link: Text
    as_of: str
    entries: tuple[ArticleEntry, ...]
    certainty: Certainty = ""


Listing = TopicsItem | ProvisionsItem


@dataclass(frozen=True, slots=True)
class HeaderLine(_SyntaxNode):
    """A line of a file's header."""


@dataclass(frozen=True, slots=True)
class FileLine(HeaderLine):
    """``rulebook NAME`` or ``vocabulary NAME``."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name


@dataclass(frozen=True, slots=True)
class TitleLine(HeaderLine):
    """``title "…"``."""

    text: Text


@dataclass(frozen=True, slots=True)
class LawLine(HeaderLine):
    """Header line of the law: ``law "…" as of DATE``.

    The date is ISO text, empty when not given.
    """

    text: Text
    as_of: str = ""


@dataclass(frozen=True, slots=True)
class UseLine(HeaderLine):
    """``use NAME``: a vocabulary."""

    name: Name


@dataclass(frozen=True, slots=True)
class ExtendsLine(HeaderLine):
    """``extends NAME``: the rulebook that this one builds upon."""

    name: Name


@dataclass(frozen=True, slots=True)
class TrafficLine(HeaderLine):
    """``traffic left`` or ``traffic right``."""

    side: Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class SemanticsLine(HeaderLine):
    """``semantics stutter`` or ``semantics finite``."""

    kind: Literal["stutter", "finite"]


@dataclass(frozen=True, slots=True)
class StepLine(HeaderLine):
    """``step 0.5 s``: how far the states of examples are apart."""

    amount: NumberLiteral


@dataclass(frozen=True, slots=True)
class PriorityLine(HeaderLine):
    """Order of priority levels: ``priority a > b = c``.

    ``relations[i]`` stands between levels i and i + 1.
    """

    levels: tuple[Name, ...]
    relations: tuple[Literal[">", "="], ...]


@dataclass(frozen=True, slots=True)
class BrokenItem(_SyntaxNode):
    """Unreadable item; it may have declared any of ``names``.

    ``word`` is its first word, ``"rule"`` for a rule whose head could not be read. A ``nameless``
    one lacks the name that it declares.
    """

    names: frozenset[str]
    word: str = ""
    nameless: bool = False


Item = Declaration | Definition | Listing | RuleItem | BrokenItem


@dataclass(frozen=True, slots=True)
class File(_SyntaxNode):
    """Syntax tree of a file; ``name`` is None if unreadable."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name | None
    title: TitleLine | None = None
    law: LawLine | None = None
    uses: tuple[UseLine, ...] = ()
    items: tuple[Item, ...] = ()
    complete: bool = True
    """False when a header line could not be read, or anything that might be one."""
    extends: ExtendsLine | None = None
    traffic: TrafficLine | None = None
    semantics: SemanticsLine | None = None
    step: StepLine | None = None
    priorities: tuple[PriorityLine, ...] = ()
