"""Formulas in negation normal form over letters: each part once, past parts numbered.

A part is a number. Conditions on one state are sets of letters, as bits; for the future there are
bounded ``until`` and its dual ``release``, for the past ``since``. All other operators are
expressed by these, as docs/language.md and docs/meaning.md define them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor
from typing import Any, Literal, TypeAlias

from rulec.validation.formula_words import parted
from rulec.validation.functions import FALSE, MOST_WORK, TRUE, Function, FunctionAlgebra
from rulec.validation.unprovable import UnprovableError, exact, require

LONGEST_BOUND = 1 << 12
"""Tables of formulas with longer bounds (in steps) are not proved."""

_BESIDE = ("next", "weak next", "previously", "weak previously")
"""Operators that look at a single instant: without a bound, at the adjacent one."""


@dataclass(frozen=True, slots=True)
class Now:
    """A condition on one state: the letters that satisfy it, as bits."""

    letters: int


@dataclass(frozen=True, slots=True)
class Joined:
    """``and`` (``conjoined``) or ``or`` of two parts."""

    conjoined: bool
    left: int
    right: int


@dataclass(frozen=True, slots=True)
class Future:
    """``left until right`` or (``dual``) ``left release right``, ``low`` to ``high`` steps ahead.

    If no instant is left, ``until`` is false and ``release`` true.
    """

    dual: bool
    low: int
    high: int | None
    left: int
    right: int


@dataclass(frozen=True, slots=True)
class Past:
    """``left since right``, ``low`` to ``high`` steps back."""

    low: int
    high: int | None
    left: int
    right: int


@dataclass(frozen=True, slots=True)
class OfPast:
    """The value of the past part with this number, or its negation."""

    number: int
    holds: bool


Part: TypeAlias = Now | Joined | Future | OfPast


class Demands:
    """The parts of one formula; ``everything`` is the set of all letters, as bits.

    ``most_work`` limits the work of combining functions (``FunctionAlgebra``).
    """

    def __init__(self, everything: int, most_work: int = MOST_WORK) -> None:
        self.everything = everything
        self.parts: list[Part] = []
        self.past: list[Past] = []
        self._numbers: dict[Part, int] = {}
        self._negations: dict[int, int] = {}
        self.algebra = FunctionAlgebra(self._implies, most_work)

    def number(self, part: Part) -> int:
        """The number of a part, which is added if it is new."""
        known = self._numbers.get(part)
        if known is None:
            known = self._numbers[part] = len(self.parts)
            self.parts.append(part)
            self.algebra.count(1)
        return known

    def _implies(self, demand: int, other: int) -> bool:
        """Whether a demand implies another, as far as their ranges show it."""
        if demand == other:
            return True
        first, second = self.parts[demand], self.parts[other]
        if not (isinstance(first, Future) and isinstance(second, Future)):
            return False
        same = (first.dual, first.left, first.right) == (second.dual, second.left, second.right)
        narrow, wide = (second, first) if first.dual else (first, second)
        return same and wide.low <= narrow.low and _at_most(narrow.high, wide.high)

    def negated(self, number: int) -> int:
        """The negation of a part."""
        if number not in self._negations:
            self._negations[number] = self.number(self._negation(self.parts[number]))
            self._negations[self._negations[number]] = number
        return self._negations[number]

    def _negation(self, part: Part) -> Part:
        match part:
            case Now(letters):
                return Now(self.everything & ~letters)
            case Joined(conjoined, left, right):
                return Joined(not conjoined, self.negated(left), self.negated(right))
            case Future(dual, low, high, left, right):
                return Future(not dual, low, high, self.negated(left), self.negated(right))
            case OfPast(number, holds):
                return OfPast(number, not holds)

    def negated_function(self, function: Function) -> Function:
        """The negation of a function of demands."""
        result = TRUE
        for term in function:
            negations = frozenset([frozenset([self.negated(literal)]) for literal in term])
            result = self.algebra.both(result, negations or FALSE)
        return result

    def constant(self, value: bool) -> int:
        """The part that is always true, or always false."""
        return self.number(Now(self.everything if value else 0))

    def joined(self, conjoined: bool, left: int, right: int) -> int:
        """``and`` or ``or`` of two parts; two conditions on one state become one condition."""
        first, second = self.parts[left], self.parts[right]
        if isinstance(first, Now) and isinstance(second, Now):
            both, either = first.letters & second.letters, first.letters | second.letters
            return self.number(Now(both if conjoined else either))
        neutral = self.constant(conjoined)
        if left == neutral:
            return right
        return left if right == neutral else self.number(Joined(conjoined, left, right))

    def future(self, limits: tuple[int, int | None], left: int, right: int, *, dual: bool) -> int:
        """``until`` or ``release``; over an empty range these are false and true."""
        low, high = limits
        if high is not None and low > high:
            return self.constant(dual)
        return self.number(Future(dual, low, high, left, right))

    def since(self, limits: tuple[int, int | None], left: int, right: int) -> int:
        """``since``, as a numbered past part; false over an empty range."""
        low, high = limits
        if high is not None and low > high:
            return self.constant(False)
        part = Past(low, high, left, right)
        if part not in self.past:
            self.past.append(part)
        return self.number(OfPast(self.past.index(part), True))

    def read(self, tree: Any, step: Fraction | None, letters_of: Callable[[Any], int]) -> int:
        """The part for a formula's tree.

        ``letters_of`` gives the letters in which an atom or a comparison is true, ``step`` is the
        time step in seconds.
        """
        if isinstance(tree, bool):
            return self.constant(tree)
        if isinstance(tree, dict):
            return self.number(Now(letters_of(tree)))
        require(isinstance(tree, list) and 2 <= len(tree) <= 4, "its tree is not a formula")
        operator, rest, bound = parted(tree)
        limits = _limits(operator, bound, step)
        operands = [self.read(operand, step, letters_of) for operand in rest]
        if len(operands) == 1:
            return self._unary(operator, limits, operands[0])
        require(len(operands) == 2, "its tree is not a formula")
        return self._binary(operator, limits, *operands)

    def _unary(self, operator: str, limits: tuple[int, int | None], operand: int) -> int:
        true, false = self.constant(True), self.constant(False)
        match operator:
            case "not":
                return self.negated(operand)
            case "next" | "eventually":
                return self.future(limits, true, operand, dual=False)
            case "weak next" | "always":
                return self.future(limits, false, operand, dual=True)
            case "never":
                return self.future(limits, false, self.negated(operand), dual=True)
            case "previously" | "once":
                return self.since(limits, true, operand)
            case "weak previously" | "historically":
                return self.negated(self.since(limits, true, self.negated(operand)))
        raise UnprovableError(f"its tree has an unknown operator: {operator!a}")

    def _binary(self, operator: str, limits: tuple[int, int | None], left: int, right: int) -> int:
        true, false = self.constant(True), self.constant(False)
        match operator:
            case "and" | "or":
                return self.joined(operator == "and", left, right)
            case "implies":
                return self.joined(False, self.negated(left), right)
            case "iff" | "xor":
                other = right if operator == "iff" else self.negated(right)
                same = self.joined(True, left, other)
                neither = self.joined(True, self.negated(left), self.negated(other))
                return self.joined(False, same, neither)
            case "until" | "then":
                return self.future(limits, left, right, dual=False)
            case "release":
                return self.future(limits, left, right, dual=True)
            case "weak until":
                until = self.future(limits, left, right, dual=False)
                throughout = self.future((0, limits[1]), false, left, dual=True)
                return self.joined(False, until, throughout)
            case "strong release":
                release = self.future(limits, left, right, dual=True)
                sometime = self.future((0, limits[1]), true, left, dual=False)
                return self.joined(True, release, sometime)
            case "since":
                return self.since(limits, left, right)
        raise UnprovableError(f"its tree has an unknown operator: {operator!a}")


def _at_most(first: int | None, second: int | None) -> bool:
    return second is None or (first is not None and first <= second)


def _limits(operator: str, bound: Any, step: Fraction | None) -> tuple[int, int | None]:
    """The first and the last step that an operator looks at; those of ``then`` begin at 1."""
    least = int(operator == "then")
    if bound is None:
        return (1, 1) if operator in _BESIDE else (least, None)
    low = ceil(_steps(bound["from"], bound["unit"], step))
    high = None if bound["to"] is None else floor(_steps(bound["to"], bound["unit"], step))
    return max(low, least), high


def _steps(text: str, unit: Literal["s", "steps"], step: Fraction | None) -> Fraction:
    """How many steps a bound has; a part of one is shorter than the way to the next state."""
    amount = exact(text)
    if unit == "s":
        require(step is not None and step > 0, "it has a bound in seconds but no time step")
        amount /= step or 1
    require(amount >= 0 and (unit == "s" or amount.denominator == 1), "a bound is no number")
    require(amount <= LONGEST_BOUND, f"a bound has more than {LONGEST_BOUND} steps")
    return amount
