"""The syntax tree: a file as written, with the span of every node.

Nodes are equal when their structure is. Operators are spelled in words (``"weak until"``), whatever
the file uses. Formulas and expressions are the same kind of node: types are checked where names are
resolved.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from rulec.diagnostics import Source, Span

NOWHERE = Span(Source("", ""), 0, 0)
"""The span of a node that a program created, not read from a file."""


@dataclass(frozen=True, slots=True)
class SyntaxNode:
    """A part of a file; its ``span`` is ignored in comparisons."""

    span: Span = field(default=NOWHERE, kw_only=True, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Grouping(SyntaxNode):
    """A node with optional parentheses around it (``grouped``), which do not affect the meaning."""

    grouped: bool = field(default=False, kw_only=True, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Name(SyntaxNode):
    """An identifier."""

    text: str


@dataclass(frozen=True, slots=True)
class Text(SyntaxNode):
    """A text in double quotes; ``value`` is without quotes and escapes."""

    value: str


@dataclass(frozen=True, slots=True)
class Parameter(SyntaxNode):
    """A parameter with its type: ``name: type``.

    In a declaration, but not in a rule's head, the type may be omitted.
    """

    name: Name
    type: Name | None = None


@dataclass(frozen=True, slots=True)
class AtomUse(SyntaxNode):
    """A use of a declared name, possibly with arguments: ``name(arguments)``."""

    name: Name
    arguments: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class TruthLiteral(SyntaxNode):
    """``true`` or ``false``."""

    value: bool


@dataclass(frozen=True, slots=True)
class NumberLiteral(SyntaxNode):
    """An unsigned number as written, with its unit, if any: ``1.5 km/h``."""

    text: str
    unit: str = ""


Amount = NumberLiteral | AtomUse
"""A time in a bound: a number of seconds or steps, or a parameter."""


@dataclass(frozen=True, slots=True)
class BoundNode(SyntaxNode):
    """A bound: ``[<= high]``, ``[>= low]``, ``[low .. high]``, or ``[low]``, which is ``exact``."""

    low: Amount | None
    high: Amount | None
    exact: bool = False


@dataclass(frozen=True, slots=True)
class Prefix(Grouping):
    """A unary operator and its operand."""

    operator: str
    operand: Formula
    bound: BoundNode | None = None
    sign: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Infix(Grouping):
    """A binary operator and its operands."""

    operator: str
    left: Formula
    right: Formula
    bound: BoundNode | None = None
    sign: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Compare(Grouping):
    """A comparison of two numbers: ``left < right``. ``relation`` is one of ``< <= = != >= >``."""

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
    """A conditional expression: ``value if condition else otherwise``."""

    value: Formula
    condition: Formula
    otherwise: Formula


@dataclass(frozen=True, slots=True)
class Aggregate(SyntaxNode):
    """``some x: type (body)``, ``every …`` or ``count …``."""

    kind: Literal["some", "every", "count"]
    variable: Parameter
    body: Formula


Operation = Prefix | Infix | Compare | Arithmetic | Minus | Conditional
Formula = AtomUse | TruthLiteral | NumberLiteral | Operation | Aggregate


@dataclass(frozen=True, slots=True)
class StateLiteral(SyntaxNode):
    """A literal of an example's state: ``atom``, ``not atom``, or ``atom = value``.

    A ``value`` is a number, inside ``Minus`` if it is negative.
    """

    atom: AtomUse
    negated: bool = False
    value: NumberLiteral | Minus | None = None


@dataclass(frozen=True, slots=True)
class ExampleState(SyntaxNode):
    """The literals of an example's state; empty if everything has its default."""

    literals: tuple[StateLiteral, ...]


@dataclass(frozen=True, slots=True)
class ExampleItem(SyntaxNode):
    """``accept "label" (objects) { state; … }`` or ``reject …``."""

    accepts: bool
    states: tuple[ExampleState, ...]
    label: str = ""
    objects: tuple[Parameter, ...] = ()


Certainty = Literal["", "verified", "secondary", "unverified"]
"""How certain something is: read in the law itself, read elsewhere, or from memory.

Empty if unstated.
"""

Scope = Literal["initially", "at start", "throughout", "at some point", "at end"]


@dataclass(frozen=True, slots=True)
class Unless(SyntaxNode):
    """``unless formula scope``; the scope is None if none is written.

    ``also unless`` is added to the exceptions that an override inherits.
    """

    formula: Formula
    scope: Scope | None = None
    also: bool = False


@dataclass(frozen=True, slots=True)
class RuleItem(SyntaxNode):
    """A rule, or an ``override`` with only the changed clauses.

    ``confirm``: an override that only states whose law the rule is. ``complete`` is false if one of
    its clauses could not be read and is missing here.
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
class TypeItem(SyntaxNode):
    """``type name is parent``."""

    name: Name
    parent: Name | None = None


@dataclass(frozen=True, slots=True)
class EnumerationItem(SyntaxNode):
    """``name(parameters) is one of values default value``."""

    name: Name
    parameters: tuple[Parameter, ...]
    values: tuple[Name, ...]
    default: Name | None = None


@dataclass(frozen=True, slots=True)
class SignalHead(SyntaxNode):
    """One of the signals of a ``signal`` line."""

    name: Name
    parameters: tuple[Parameter, ...] = ()


@dataclass(frozen=True, slots=True)
class SignalItem(SyntaxNode):
    """``signal p, q(o: type) default false``."""

    signals: tuple[SignalHead, ...]
    default: bool | None = None


@dataclass(frozen=True, slots=True)
class QuantityItem(SyntaxNode):
    """``quantity name(parameters) in unit default number``."""

    name: Name
    parameters: tuple[Parameter, ...]
    unit: str
    default: float | None = None
    unit_span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class FactItem(SyntaxNode):
    """``fact formula``: a condition that always holds, for all objects in it."""

    formula: Formula


@dataclass(frozen=True, slots=True)
class ConstantItem(SyntaxNode):
    """``constant names``: their values do not change within a trace."""

    names: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class PresumedItem(SyntaxNode):
    """``presumed names``: they have their defaults if no source provides them."""

    names: tuple[Name, ...]


Declaration = (
    TypeItem | EnumerationItem | SignalItem | QuantityItem | FactItem | ConstantItem | PresumedItem
)


@dataclass(frozen=True, slots=True)
class InForce(SyntaxNode):
    """Dates in force: ``in force from DATE until DATE``.

    They are ISO texts, empty if open. The last day is included.
    """

    since: str = ""
    until: str = ""


@dataclass(frozen=True, slots=True)
class OptionItem(SyntaxNode):
    """The declaration of an option: ``option name = on``; ``cite "…"`` may follow."""

    name: Name
    value: bool
    cite: Text | None = None


@dataclass(frozen=True, slots=True)
class ParamItem(SyntaxNode):
    """The declaration of a parameter: ``param name : dimension = value``.

    The dimension may be omitted; ``in force …`` and ``cite "…"`` may follow.
    """

    name: Name
    dimension: Name | None
    value: Formula
    in_force: InForce | None = None
    cite: Text | None = None


@dataclass(frozen=True, slots=True)
class SetItem(SyntaxNode):
    """``set name = value``, for an inherited option (a bool) or parameter."""

    name: Name
    value: bool | Formula
    in_force: InForce | None = None
    cite: Text | None = None


@dataclass(frozen=True, slots=True)
class DefineItem(SyntaxNode):
    """The definition of a macro: ``define name(parameters) = body``.

    A parameter without a type may be a relation.

    ``again``: it is a ``redefine`` of an inherited definition.
    """

    name: Name
    parameters: tuple[Parameter, ...]
    body: Formula
    again: bool = False
    cite: Text | None = None


@dataclass(frozen=True, slots=True)
class DropItem(SyntaxNode):
    """``drop rule name because "…"``."""

    name: Name
    because: Text


@dataclass(frozen=True, slots=True)
class SoftenItem(SyntaxNode):
    """``soften rule name in level weight number because "…"``."""

    name: Name
    level: Name | None = None
    weight: NumberLiteral | None = None
    because: Text | None = None


@dataclass(frozen=True, slots=True)
class SilentItem(SyntaxNode):
    """``silent on name because "…"``."""

    name: Name
    because: Text


Definition = OptionItem | ParamItem | SetItem | DefineItem | DropItem | SoftenItem | SilentItem


@dataclass(frozen=True, slots=True)
class TopicEntry(SyntaxNode):
    """``name "title" of rules``: the topic of these rules, unless they state another."""

    name: Name
    title: Text
    rules: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class TopicsItem(SyntaxNode):
    """``topics { … }``: the topics that rules can have."""

    entries: tuple[TopicEntry, ...]


Treatment = Literal["to do", "silent", "not machine-readable"]
"""How an article that no rule cites is treated."""


@dataclass(frozen=True, slots=True)
class ArticleEntry(SyntaxNode):
    """``"number" "heading" silent because "…"``: an article, and why no rule is derived from it."""

    number: Text
    heading: Text
    treatment: Treatment = "to do"
    because: Text | None = None


@dataclass(frozen=True, slots=True)
class ProvisionsItem(SyntaxNode):
    """``provisions "link" as of DATE certainty WORD { … }``: the articles of a law on a day.

    The date is ISO text, empty if not given; so is the certainty of the headings.
    """

    link: Text
    as_of: str
    entries: tuple[ArticleEntry, ...]
    certainty: Certainty = ""


Listing = TopicsItem | ProvisionsItem


@dataclass(frozen=True, slots=True)
class HeaderLine(SyntaxNode):
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
    """``step 0.5 s``: the time step of examples."""

    amount: NumberLiteral


@dataclass(frozen=True, slots=True)
class PriorityLine(HeaderLine):
    """The order of priority levels: ``priority a > b = c``.

    ``relations[i]`` is between levels i and i + 1.
    """

    levels: tuple[Name, ...]
    relations: tuple[Literal[">", "="], ...]


@dataclass(frozen=True, slots=True)
class BrokenItem(SyntaxNode):
    """An unreadable item; it may have declared any of ``names``.

    ``word`` is its first word, ``"rule"`` for a rule whose head could not be read. A ``nameless``
    item lacks the name that it declares.
    """

    names: frozenset[str]
    word: str = ""
    nameless: bool = False


Item = Declaration | Definition | Listing | RuleItem | BrokenItem


@dataclass(frozen=True, slots=True)
class File(SyntaxNode):
    """The syntax tree of a file; ``name`` is None if unreadable."""

    kind: Literal["rulebook", "vocabulary"]
    name: Name | None
    title: TitleLine | None = None
    law: LawLine | None = None
    uses: tuple[UseLine, ...] = ()
    items: tuple[Item, ...] = ()
    complete: bool = True
    """False if a header line, or anything that might be one, could not be read."""
    extends: ExtendsLine | None = None
    traffic: TrafficLine | None = None
    semantics: SemanticsLine | None = None
    step: StepLine | None = None
    priorities: tuple[PriorityLine, ...] = ()


def parts_of(node: SyntaxNode) -> Iterator[tuple[str, SyntaxNode]]:
    """The nodes in a node, with the names of their fields; the two ends of a bound may be one."""
    before = None
    for own in node.__slots__:  # it inherits none that have nodes
        value = getattr(node, own)
        for part in value if isinstance(value, tuple) else (value,):
            if isinstance(part, SyntaxNode) and part is not before:
                yield own, part
                before = part


def nodes_in(node: SyntaxNode) -> Iterator[SyntaxNode]:
    """A node and all nodes in it."""
    yield node
    for _, part in parts_of(node):
        yield from nodes_in(part)
