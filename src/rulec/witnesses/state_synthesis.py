"""States of the world in which the columns see what they are to see."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic.formula import Count, Quantity, Term
from rulec.vocabulary import Declaration, Enumeration, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity
from rulec.witnesses.fourier_motzkin import LinearBound, solve
from rulec.witnesses.letter_witness import bounds_of
from rulec.witnesses.object_universe import ObjectUniverse

Subject = tuple[str, tuple[str, ...]]
"""A declaration and the objects that it is asked about."""

Value = bool | str | float

NumberDigits = tuple[tuple[NumberRead, int], ...]
"""Sums, and how many of its thresholds each passes."""


@dataclass(frozen=True, slots=True)
class JointState:
    """A state: the values that decide, all others may be anything.

    ``sides`` are the sums that decide, ``counted`` is how many of the scene's own objects count.
    """

    values: Mapping[Subject, Value]
    sides: NumberDigits
    counted: tuple[tuple[Count, int], ...]

    def value(self, key: Subject, vocabulary: Vocabulary) -> Value:
        """What decides, or the usual value."""
        found = self.values.get(key)
        return default_value(vocabulary.declarations[key[0]]) if found is None else found

    def number(self, term: Quantity, vocabulary: Vocabulary) -> Fraction:
        """The value of a quantity."""
        value = self.value((term.name, term.arguments), vocabulary)
        assert not isinstance(value, str), "a quantity is a number"
        return exact(value)


def synthesize_state(
    scene: ObjectUniverse,
    digits: Sequence[tuple[Read | NumberRead, int]],
    counted: tuple[tuple[Count, int], ...],
) -> JointState | None:
    """A state in which the reads come out as these digits; None if there is none."""
    sides = tuple((read, digit) for read, digit in digits if isinstance(read, NumberRead))
    numbers = solve_numbers(sides, scene.vocabulary, dict(counted)) if sides else {}
    if numbers is None:
        return None
    values: dict[Subject, Value] = {
        (read.name, read.variables): value_of(read, digit, scene.vocabulary)
        for read, digit in digits
        if isinstance(read, Read)
    }
    for term, number in numbers.items():
        if isinstance(term, Quantity):
            values[term.name, term.arguments] = float(number)
    return JointState(values, sides, counted)


def solve_numbers(
    sides: Sequence[tuple[NumberRead, int]],
    vocabulary: Vocabulary,
    least: Mapping[Count, int],
) -> dict[Term, Fraction] | None:
    """Numbers on the wanted sides, ``least`` being how much a count comes to at least."""
    terms = list(dict.fromkeys(term for read, _ in sides for _, term in read.terms))
    counts = [term for term in terms if isinstance(term, Count)]
    quantities = [term for term in terms if isinstance(term, Quantity)]
    system = [one for read, digit in sides for one in bounds_of(read, digit)]
    system += [
        LinearBound({count: Fraction(-1)}, Fraction(-least.get(count, 0))) for count in counts
    ]
    preferred: dict[Term, Fraction] = {}
    for term in quantities:
        default = vocabulary.declarations[term.name].default
        if isinstance(default, int | float):
            preferred[term] = exact(default)
    # Most quantities are nothing below zero, though nobody has said so.
    natural = [LinearBound({term: Fraction(-1)}, Fraction(0)) for term in quantities]
    order: list[Term] = [*quantities, *counts]
    whole: frozenset[Term] = frozenset(counts)
    found = solve([*system, *natural], order, preferred, whole)
    return solve(system, order, preferred, whole) if found is None else found


def value_of(read: Read, digit: int, vocabulary: Vocabulary) -> bool | str:
    """A value of a signal or an enumeration with this digit."""
    declaration = vocabulary.declarations[read.name]
    if not isinstance(declaration, Enumeration):
        return bool(digit)
    if digit < len(read.values):
        return read.values[digit]
    if declaration.default is not None and declaration.default not in read.values:
        return declaration.default
    return next(value for value in declaration.values if value not in read.values)


def default_value(declaration: Declaration) -> Value:
    """The value of what nobody asks about."""
    if declaration.default is not None:
        return declaration.default
    if isinstance(declaration, Enumeration):
        return declaration.values[0]
    return 0.0 if isinstance(declaration, DeclaredQuantity) else False


def default_digit(read: Read | NumberRead, vocabulary: Vocabulary) -> int | None:
    """The digit of what a state need not mention; None if there is none."""
    if isinstance(read, Read):
        default = vocabulary.declarations[read.name].default
        return None if default is None else read.digit(default)
    total = Fraction(0)
    for coefficient, term in read.terms:
        if isinstance(term, Quantity):
            default = vocabulary.declarations[term.name].default
            if not isinstance(default, int | float):
                return None
            total += coefficient * exact(default)
    return read.digit(total)


def keys_of(
    vocabulary: Vocabulary, objects: Mapping[str, str]
) -> Iterator[tuple[Subject, Declaration]]:
    """All that a state could say of these objects, an object and itself included."""
    for name, declaration in vocabulary.declarations.items():
        fitting = [
            [item for item, kind in objects.items() if vocabulary.is_subtype(kind, wanted)]
            for wanted in declaration.parameters
        ]
        for items in product(*fitting):
            yield (name, items), declaration
