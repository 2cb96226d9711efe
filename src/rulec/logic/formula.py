"""Formulas as small frozen nodes, and their operators as two enumerations."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from fractions import Fraction
from typing import Literal

from rulec.diagnostics import Span


class UnaryOperator(Enum):
    """A unary operator; its value is its spelling in a rulebook."""

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
    """A binary operator; its value is its spelling in a rulebook."""

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
        return word_text(self.value or self.name, self.arguments)


def word_text(name: str, arguments: Sequence[str]) -> str:
    """``gap(v)``; a calculated comparison, which is no name, has its arguments inside."""
    if " " in name:
        names = {f"x{place}": argument for place, argument in enumerate(arguments, 1)}
        return with_arguments(name, names)
    return f"{name}({', '.join(arguments)})" if arguments else name


def with_arguments(text: str, names: Mapping[str, str]) -> str:
    """The text of a formula with other names of objects."""
    return _ARGUMENT.sub(lambda found: found[1] + names.get(found[2], found[2]), text)


_ARGUMENT = re.compile(r"([(,]\s*)(\w+)(?=\s*[,)])")


@dataclass(frozen=True, slots=True)
class QuantityTerm:
    """A number in every state, ``name(arguments)``, in the unit of its declaration."""

    name: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Count:
    """The number of present objects of ``type`` that satisfy ``body``.

    ``variable`` stands for each object present in the state in turn, including objects that other
    variables stand for. ``body`` refers to one state only: it has no temporal operator.
    """

    variable: str
    type: str
    body: Formula


Term = QuantityTerm | Count

Relation = Literal["<", "<=", "=", "!=", ">=", ">"]


@dataclass(frozen=True, slots=True)
class Comparison:
    """``sum of coefficient * term`` stands in ``relation`` to ``limit``.

    The terms are distinct and sorted by their text, no coefficient is 0 and the first one is 1, so
    comparisons of the same numbers have the same ``terms``. A quantity is in the unit of its
    declaration; other units have been converted exactly into the coefficients and the limit.
    ``text`` is the spelling in a rulebook, with units; equality ignores it.
    """

    terms: tuple[tuple[Fraction, Term], ...]
    relation: Relation
    limit: Fraction
    text: str = field(default="", compare=False)

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Operation:
    """The product of two numbers that change, or their quotient."""

    operator: Literal["*", "/"]
    left: NumberSum
    right: NumberSum


@dataclass(frozen=True, slots=True)
class NumberSum:
    """``sum of coefficient * part``, and a constant; quantities are in their declared units."""

    parts: tuple[tuple[Fraction, Term | Operation], ...]
    constant: Fraction


@dataclass(frozen=True, slots=True)
class Calculated(Atom):
    """``number`` stands in ``relation`` to 0; the number is no sum of coefficients times terms.

    Automata and analysis do not look into it: it is one proposition, and its spelling in a rulebook
    is its ``name``. The ``arguments`` stand for the variables `x1`, `x2`, … in name and number.
    """

    number: NumberSum = NumberSum((), Fraction(0))
    relation: Relation = "<"

    __str__ = Atom.__str__


@dataclass(frozen=True, slots=True)
class Same:
    """Equality of two variables' objects, only in the body of a ``Count``."""

    left: str
    right: str

    def __str__(self) -> str:
        return f"{self.left} = {self.right}"


@dataclass(frozen=True, slots=True)
class Constant:
    """``true`` or ``false``."""

    value: bool


TRUE, FALSE = Constant(True), Constant(False)


@dataclass(frozen=True, slots=True)
class Bound:
    """The bound of a temporal operator: ``low`` to ``high``, both inclusive.

    It counts forward or backward, depending on the operator.

    The unit is seconds or steps of the trace; ``high`` is None if there is no upper end. For
    ``next`` and ``previously`` both are the distance. ``span`` is its place in the source. No
    source has ``early`` bounds, whose lower end is the last instant before ``low`` if there is none
    at it, nor any that are at least some steps away (``least``).
    """

    low: Fraction
    high: Fraction | None
    unit: Literal["s", "steps"]
    span: Span | None = field(default=None, compare=False, repr=False)
    early: bool = field(default=False, kw_only=True)
    least: int = field(default=0, kw_only=True)


class _Hashed:
    """A formula with parts that caches its hash, since formulas are often used as keys."""

    __slots__ = ("_number",)
    _number: int

    def __hash__(self) -> int:
        try:
            return self._number
        except AttributeError:
            number = hash(tuple([getattr(self, name) for name in self.__slots__]))
            object.__setattr__(self, "_number", number)
            return number


@dataclass(frozen=True, slots=True)
class Unary(_Hashed):
    """An operator on one formula. Only a temporal operator has a ``bound``."""

    operator: UnaryOperator
    operand: Formula
    bound: Bound | None = None
    __hash__ = _Hashed.__hash__


@dataclass(frozen=True, slots=True)
class Binary(_Hashed):
    """An operator between two formulas. Only a temporal operator has a ``bound``."""

    operator: BinaryOperator
    left: Formula
    right: Formula
    bound: Bound | None = None
    __hash__ = _Hashed.__hash__


Formula = Atom | Comparison | Same | Constant | Unary | Binary

Proposition = Atom | Comparison
"""A formula that is true or false in one state; automata do not look into its parts."""


def atoms_of(formula: Formula) -> Iterator[Proposition]:
    """The formula's atoms and comparisons from left to right, with repetitions."""
    # Called very often: nested generators would take three times as long.
    waiting = [formula]
    while waiting:
        part = waiting.pop()
        if isinstance(part, Binary):
            waiting += (part.right, part.left)
        elif isinstance(part, Unary):
            waiting.append(part.operand)
        elif isinstance(part, Atom | Comparison):
            yield part


def subject_of(proposition: Proposition) -> object:
    """What a proposition is about: the terms of a comparison, or an atom's name and arguments."""
    if isinstance(proposition, Comparison):
        return proposition.terms
    return proposition.name, proposition.arguments


def with_operands(
    operation: Unary | Binary, transform: Callable[[Formula], Formula]
) -> Unary | Binary:
    """The operation with transformed operands; the left one is transformed first."""
    if isinstance(operation, Unary):
        return Unary(operation.operator, transform(operation.operand), operation.bound)
    left = transform(operation.left)
    return Binary(operation.operator, left, transform(operation.right), operation.bound)


def operands_of(formula: Formula | Term) -> tuple[Formula, ...]:
    """The operands of an operation, from left to right; nothing else has any."""
    match formula:
        case Unary(_, operand):
            return (operand,)
        case Binary(_, left, right):
            return left, right
    return ()


def parts_in(formula: Formula) -> Iterator[Formula]:
    """The formula and its parts, except in bodies of counts, each before its operands."""
    waiting = [formula]
    while waiting:
        part = waiting.pop()
        yield part
        waiting += reversed(operands_of(part))


def chain_of(operator: BinaryOperator, formula: Formula) -> Iterator[Formula]:
    """The operands of a chain of one operator from left to right, however it is grouped."""
    if isinstance(formula, Binary) and formula.operator is operator:
        yield from chain_of(operator, formula.left)
        yield from chain_of(operator, formula.right)
    else:
        yield formula


def negated(formula: Formula) -> Formula:
    """The negation of a formula, without a double one."""
    match formula:
        case Constant(value):
            return Constant(not value)
        case Unary(UnaryOperator.NOT, operand):
            return operand
    return Unary(UnaryOperator.NOT, formula)


def all_of(formulas: Iterable[Formula]) -> Formula:
    """The conjunction of formulas; true if there are none."""
    return _joined(BinaryOperator.AND, True, formulas)


def any_of(formulas: Iterable[Formula]) -> Formula:
    """The disjunction of formulas; false if there are none."""
    return _joined(BinaryOperator.OR, False, formulas)


def _joined(operator: BinaryOperator, neutral: bool, formulas: Iterable[Formula]) -> Formula:
    whole: Formula | None = None
    for formula in formulas:
        if formula == Constant(not neutral):
            return formula
        if formula != Constant(neutral):
            whole = formula if whole is None else Binary(operator, whole, formula)
    return Constant(neutral) if whole is None else whole


def with_terms(comparison: Comparison, transform: Callable[[Term], Term]) -> Comparison:
    """The comparison with transformed terms."""
    terms = [(factor, transform(term)) for factor, term in comparison.terms]
    return replace(comparison, terms=tuple(terms))


def with_parts(formula: Formula, transform: Callable[[Formula], Formula]) -> Formula:
    """The formula with transformed operands, or with transformed bodies of what it counts."""

    def counted(term: Term) -> Term:
        return replace(term, body=transform(term.body)) if isinstance(term, Count) else term

    match formula:
        case Unary() | Binary():
            return with_operands(formula, transform)
        case Comparison():
            return with_terms(formula, counted)
    return formula
