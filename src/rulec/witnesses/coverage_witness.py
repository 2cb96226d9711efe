"""States that witness uncovered letters of a rule's monitor."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import compress
from math import inf
from typing import TypeAlias

from rulec.automata.alphabet import letters_with, propositions_of
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.automata.thresholds import exact, scale
from rulec.logic.formula import Comparison, Formula, Proposition, QuantityTerm, atoms_of
from rulec.logic.free_names import variables_of
from rulec.logic.kleene import holds
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import ExampleState
from rulec.rulebook.rules.axioms import ExampleValues
from rulec.vocabulary import Vocabulary
from rulec.witnesses.letter_functions import (
    Digits,
    all_digits,
    constant_reads,
    counts_read,
    digits_of,
    is_natural,
)
from rulec.witnesses.state_synthesis import (
    NumberDigits,
    apart,
    are_consistent,
    default_digit,
    numbers_near_thresholds,
    values_of,
)

_USUAL_PART = 10
"""A number that is told is usually this part of the default that says that it is not."""


@dataclass(frozen=True, slots=True)
class CoverageWitness:
    """A state for a letter; ``besides`` describes in words what cannot be chosen."""

    says: ExampleState
    besides: tuple[str, ...] = ()


def asks_whether_told(comparison: Comparison, vocabulary: Vocabulary) -> bool:
    """Whether a comparison such as ``limit < 1000 km/h`` only asks whether a number is told.

    Its limit is the default, which larger than all that is usual stands for none.
    """
    match comparison:
        case Comparison(((1, QuantityTerm(name)),), "<" | ">=", limit) if limit > 0:
            default = vocabulary.declarations[name].default
            return isinstance(default, int | float) and exact(default) == limit
    return False


def asked_whether_told(formula: Formula, vocabulary: Vocabulary) -> Mapping[QuantityTerm, Fraction]:
    """The quantities of which a formula asks whether they are told, each with its default."""
    return {
        term: atom.limit
        for atom in atoms_of(formula)
        if isinstance(atom, Comparison) and asks_whether_told(atom, vocabulary)
        for _, term in atom.terms
        if isinstance(term, QuantityTerm)
    }


def is_possible(read: Read | NumberRead, digit: int) -> bool:
    """Whether a state can have this digit; False only if that is certain."""
    if isinstance(read, Read) or scale(read).quantity is None:
        return True
    bounds = (-inf, *scale(read).floors, inf)
    return bounds[digit] < bounds[digit + 1]


def can_be(monitor: MealyMonitor, letter: int, *, below_zero: bool = False) -> bool:
    """Whether some state has a letter; numbers below zero only if ``below_zero``."""
    digits = digits_of(letter, monitor.reads)
    return (
        monitor.letters[letter] != IMPOSSIBLE
        and all(map(is_possible, monitor.reads, digits))
        and (below_zero or all(map(is_natural, monitor.reads, digits)))
    )


def go_together(monitor: MealyMonitor) -> Callable[[Digits], bool]:
    """A test of whether the numbers of a letter with these digits can have them all at once.

    False only if that is certain: counts of objects are not examined.
    """
    sums = {
        place: read
        for place, read in enumerate(monitor.reads)
        if isinstance(read, NumberRead) and not counts_read([read])
    }
    places = list(sums)
    groups = [
        [places[number] for number in group]
        for group in apart(list(sums.values()))
        if len(group) > 1
    ]

    @cache
    def exists(number: int, own: Digits) -> bool:
        return are_consistent([*zip([sums[place] for place in groups[number]], own, strict=True)])

    return lambda digits: all(
        exists(number, tuple([digits[place] for place in group]))
        for number, group in enumerate(groups)
    )


LettersByConstants: TypeAlias = Mapping[Digits, Mapping[int, int]]
"""The first letter of each letter class, by the digits of what is constant in a trace."""


def possible_letters(monitor: MealyMonitor, vocabulary: Vocabulary) -> LettersByConstants:
    """The first letter of each letter class that some state has, if possible without negatives.

    All letters of a trace have the same constants; constants with default values come first.
    """
    constant = constant_reads(monitor.reads, vocabulary)
    fit = go_together(monitor)
    first: dict[Digits, dict[int, int]] = {}
    natural: dict[Digits, dict[int, int]] = {}
    for letter, (letter_class, digits) in enumerate(
        zip(monitor.letters, all_digits(monitor.reads), strict=True)
    ):
        constants = tuple(compress(digits, constant))
        if letter_class == IMPOSSIBLE or letter_class in natural.get(constants, ()):
            continue
        if all(map(is_possible, monitor.reads, digits)) and fit(digits):
            first.setdefault(constants, {}).setdefault(letter_class, letter)
            if all(map(is_natural, monitor.reads, digits)):
                natural.setdefault(constants, {})[letter_class] = letter
    plain = [default_digit(read, vocabulary) for read in compress(monitor.reads, constant)]

    def off_default(digits: Digits) -> tuple[int, Digits]:
        return sum(map(operator.ne, digits, plain)), digits

    return {
        constants: first[constants] | natural.get(constants, {})
        for constants in sorted(first, key=off_default)
    }


def truth_values(
    propositions: Sequence[Proposition], monitor: MealyMonitor
) -> Mapping[Proposition, tuple[bool, ...]]:
    """The truth values of each proposition in possible states, True first."""
    excluded = {
        (place, digit)
        for place, read in enumerate(monitor.reads)
        for digit in range(read.size)
        if not is_possible(read, digit)
    }
    bits = [
        letter_class != IMPOSSIBLE and excluded.isdisjoint(enumerate(digits))
        for letter_class, digits in zip(monitor.letters, all_digits(monitor.reads), strict=True)
    ]
    possible = int("".join("1" if bit else "0" for bit in reversed(bits)), 2)
    return {
        proposition: tuple(
            value for value, letters in ((True, true), (False, ~true)) if letters & possible
        )
        for proposition, true in letters_with(monitor.reads, propositions).items()
    }


def coverage_witness(
    letter: int,
    monitor: MealyMonitor,
    formula: Formula,
    vocabulary: Vocabulary,
    axioms: Sequence[Formula] = (),
) -> CoverageWitness:
    """Synthesise a state in which a rule's monitor reads the letter.

    Numbers whose choice would contradict one of the ``axioms`` are left to the reader.
    """
    digits = list(zip(monitor.reads, digits_of(letter, monitor.reads), strict=True))
    says = values_of(digits, vocabulary)
    numbers = [(read, digit) for read, digit in digits if isinstance(read, NumberRead)]
    # Quantities compared by themselves have less choice than those that are also in sums.
    numbers.sort(key=lambda pair: len(pair[0].terms))
    usual = {
        term: default / _USUAL_PART
        for term, default in asked_whether_told(formula, vocabulary).items()
    }
    sums = [pair for pair in numbers if not counts_read(pair[:1])]
    chosen, left = _choose(sums, vocabulary, usual)
    says.update({(term.name, term.arguments): number for term, number in chosen.items()})
    letters = letters_with(monitor.reads, propositions_of(formula))
    texts = [
        (proposition.terms, proposition.text if true >> letter & 1 else f"not {proposition.text}")
        for proposition, true in letters.items()
        if isinstance(proposition, Comparison)
    ]

    def in_text(read: NumberRead) -> Iterator[str]:
        return (text for terms, text in texts if terms == read.terms)

    besides = [
        text for read, _ in numbers if counts_read([read]) or read in left for text in in_text(read)
    ]
    for axiom in axioms:
        own_names = {name: name for name in variables_of(axiom)}
        if holds(axiom, own_names, ExampleValues(says, frozenset(), {}, vocabulary)) is False:
            dropped = {
                term
                for atom in atoms_of(axiom)
                for _, term in (atom.terms if isinstance(atom, Comparison) else ())
                if isinstance(term, QuantityTerm)
                if says.pop((term.name, term.arguments), None) is not None
            }
            for read, _ in numbers:
                if not dropped.isdisjoint(term for _, term in read.terms):
                    besides += in_text(read)
            besides.append(formula_text(axiom))
    return CoverageWitness(says, tuple(dict.fromkeys(besides)))


def _choose(
    numbers: NumberDigits, vocabulary: Vocabulary, usual: Mapping[QuantityTerm, Fraction]
) -> tuple[dict[QuantityTerm, float], list[NumberRead]]:
    """Numbers with these digits, and the sums for which none were chosen."""
    chosen = numbers_near_thresholds(numbers, vocabulary, usual)
    if chosen is not None:
        return chosen, []
    chosen = {}
    good: list[tuple[NumberRead, int]] = []
    left: list[NumberRead] = []
    for number in numbers:
        more = numbers_near_thresholds([*good, number], vocabulary, usual)
        if more is None:
            left.append(number[0])
        else:
            chosen = more
            good.append(number)
    return chosen, left
