"""A letter of a rule's machine as a state of the world: what an example would have to say."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import IMPOSSIBLE, NumberRead, Read
from rulec.logic.fold import Algebra, fold
from rulec.logic.formula import (
    Comparison,
    Count,
    Formula,
    Proposition,
    Quantity,
    Same,
    Term,
)
from rulec.rulebook.model import ExampleState
from rulec.vocabulary import Enumeration, Vocabulary
from rulec.witnesses.fourier_motzkin import LinearBound, solve

Facts = dict[tuple[str, tuple[str, ...]], bool | str | float]
"""What a state says, while it is being made up."""


@dataclass(frozen=True, slots=True)
class Witness:
    """What one state says, and how many objects of the moment it needs for the rule's counts."""

    facts: ExampleState
    counts: tuple[tuple[Count, int], ...] = ()


class Witnesses:
    """The letters of a rule's machine as states, those that no world can be in left out."""

    def __init__(self, rule: CompiledRule, vocabulary: Vocabulary) -> None:
        self._machine = rule.machine
        self._types = {variable.name: variable.type for variable in rule.variables}
        self._vocabulary = vocabulary
        self._states: dict[int, Witness | None] = {}
        self._digits = [self._split(letter) for letter in range(len(rule.machine.letters))]
        self._members: list[list[int]] = [[] for _ in rule.machine.successors[0]]
        for letter, symbol in enumerate(rule.machine.letters):
            if symbol != IMPOSSIBLE:
                self._members[symbol].append(letter)
        self._plain = tuple(self._usual(read) for read in rule.machine.reads)

    def plainest(self, symbol: int) -> int | None:
        """The possible letter of a class that has most to do with defaults; None if none is."""
        return self._closest(symbol, self._plain)

    def nearest(self, letter: int) -> list[tuple[int, int]]:
        """From every other class the possible letter most like this one.

        Each stands behind the number of reads in which it differs.
        """
        digits = self._digits[letter]
        own = self._machine.letters[letter]
        found = [
            near
            for symbol in range(len(self._machine.successors[0]))
            if symbol != own and (near := self._closest(symbol, digits)) is not None
        ]
        return [(_distance(self._digits[near], digits), near) for near in found]

    def state(self, letter: int) -> Witness | None:
        """What a state says that has this letter; None if no state has it."""
        if letter not in self._states:
            self._states[letter] = self._state(letter)
        return self._states[letter]

    def _split(self, letter: int) -> tuple[int, ...]:
        digits = []
        for read in self._machine.reads:
            letter, digit = divmod(letter, read.size)
            digits.append(digit)
        return tuple(digits)

    def _usual(self, read: Read | NumberRead) -> int:
        if isinstance(read, NumberRead):
            return 0
        default = self._vocabulary.declarations[read.name].default
        return 0 if default is None else read.digit(default)

    def _closest(self, symbol: int, digits: tuple[int, ...]) -> int | None:
        alike = sorted(
            self._members[symbol], key=lambda one: (_distance(self._digits[one], digits), one)
        )
        return next((one for one in alike if self.state(one) is not None), None)

    def _state(self, letter: int) -> Witness | None:
        facts: Facts = {}
        numbers: list[tuple[NumberRead, int]] = []
        for read, digit in zip(self._machine.reads, self._digits[letter], strict=True):
            if isinstance(read, NumberRead):
                numbers.append((read, digit))
            else:
                facts[read.name, read.variables] = self._value(read, digit)
        if not numbers:
            return Witness(facts)
        found = self._numbers(numbers, facts)
        if found is None:
            return None
        counts = []
        for term, value in found.items():
            if isinstance(term, Count):
                counts.append((term, int(value)))
            else:
                facts[term.name, term.arguments] = float(value)
        return Witness(facts, tuple(counts))

    def _value(self, read: Read, digit: int) -> bool | str:
        declaration = self._vocabulary.declarations[read.name]
        if not isinstance(declaration, Enumeration):
            return bool(digit)
        if digit < len(read.values):
            return read.values[digit]
        if declaration.default is not None and declaration.default not in read.values:
            return declaration.default
        return next(value for value in declaration.values if value not in read.values)

    def _numbers(
        self, numbers: list[tuple[NumberRead, int]], facts: ExampleState
    ) -> dict[Term, Fraction] | None:
        terms = list(dict.fromkeys(term for read, _ in numbers for _, term in read.terms))
        counts = [term for term in terms if isinstance(term, Count)]
        quantities = [term for term in terms if isinstance(term, Quantity)]
        system = [one for read, digit in numbers for one in bounds_of(read, digit)]
        system += [
            LinearBound({count: Fraction(-1)}, Fraction(-self._at_least(count, facts)))
            for count in counts
        ]
        preferred: dict[Term, Fraction] = {
            term: Fraction(repr(default))
            for term in quantities
            if (default := self._vocabulary.declarations[term.name].default) is not None
            and not isinstance(default, str)
        }
        # Most quantities are nothing below zero, though nobody has said so.
        natural = [LinearBound({term: Fraction(-1)}, Fraction(0)) for term in quantities]
        order: list[Term] = [*quantities, *counts]
        whole: frozenset[Term] = frozenset(counts)
        return solve([*system, *natural], order, preferred, whole) or solve(
            system, order, preferred, whole
        )

    def _at_least(self, count: Count, facts: ExampleState) -> int:
        """How many of the objects that the rule names are counted for sure."""
        return sum(
            value_in_state(count.body, {count.variable: name}, facts) is True
            for name, of_type in self._types.items()
            if self._vocabulary.is_subtype(of_type, count.type)
        )


def _distance(one: tuple[int, ...], other: tuple[int, ...]) -> int:
    return sum(a != b for a, b in zip(one, other, strict=True))


def bounds_of(read: NumberRead, digit: int) -> Iterator[LinearBound]:
    """What a digit says of the sum that is read."""
    terms: dict[Term, Fraction] = {term: coefficient for coefficient, term in read.terms}
    if digit > 0:
        passed = read.thresholds[digit - 1]
        below = {term: -coefficient for term, coefficient in terms.items()}
        yield LinearBound(below, -passed.limit, strict=not passed.inclusive)
    if digit < len(read.thresholds):
        ahead = read.thresholds[digit]
        yield LinearBound(terms, ahead.limit, strict=ahead.inclusive)


def value_in_state(formula: Formula, names: Mapping[str, str], facts: ExampleState) -> bool | None:
    """The value of a count's body, ``names`` for its variable; None if the state leaves it open."""

    def proposition(proposition: Proposition) -> bool | None:
        if isinstance(proposition, Comparison):
            return None
        objects = tuple(names.get(name, name) for name in proposition.arguments)
        value = facts.get((proposition.name, objects))
        expected = True if proposition.value is None else proposition.value
        return None if value is None else value == expected

    def identity(same: Same) -> bool:
        return names.get(same.left, same.left) == names.get(same.right, same.right)

    return fold(formula, replace(_KLEENE, proposition=proposition, identity=identity))


def _settled(by: bool, left: bool | None, right: bool | None) -> bool | None:
    """The conjunction, which an operand that is false settles, or the disjunction by a true one."""
    if left is by or right is by:
        return by
    return None if left is None or right is None else not by


_KLEENE: Algebra[bool | None] = Algebra(
    proposition=lambda _: None,
    constant=bool,
    negation=lambda operand: None if operand is None else not operand,
    conjunction=partial(_settled, False),
    disjunction=partial(_settled, True),
    equivalence=lambda left, right: None if left is None or right is None else left == right,
)
