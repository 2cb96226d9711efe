"""Limits of comparisons: whether examples come close to them on both sides."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import prod
from typing import TypeGuard

from rulec.automata.alphabet import letters_with
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic.formula import Comparison, Formula, QuantityTerm, atoms_of
from rulec.logic.kleene import ObjectBinding, PartialState, Unknown, weighted_sum
from rulec.logic.linear_comparison import stands
from rulec.rulebook.rulebook_model import ExampleState
from rulec.vocabulary import Vocabulary
from rulec.witnesses.coverage_witness import can_be

_MOST_PLACES = 2
"""Limits with more decimals result from converting units; close to them means within 1."""


@dataclass(frozen=True, slots=True)
class LimitSide:
    """One side of a limit: the states close to it in which a comparison has the value ``holds``."""

    comparison: Comparison
    holds: bool


def sides_of(formula: Formula) -> tuple[LimitSide, ...]:
    """Both sides of every limit in a formula; counts of objects have none."""
    return tuple(
        LimitSide(atom, holds)
        for atom in dict.fromkeys(atoms_of(formula))
        if isinstance(atom, Comparison)
        and all(isinstance(term, QuantityTerm) for _, term in atom.terms)
        for holds in (True, False)
    )


def grain(limit: Fraction) -> Fraction:
    """The distance that is close: one in the last digit of a limit, such as 0.1 for 1.5."""
    for places in range(_MOST_PLACES + 1):
        unit = Fraction(1, 10**places)
        if (limit / unit).denominator == 1:
            return unit
    return Fraction(1)


def touched(
    sides: Iterable[LimitSide], binding: ObjectBinding, state: PartialState
) -> Iterator[LimitSide]:
    """The sides of limits that a state of an example is close to."""
    for side in sides:
        number = weighted_sum(side.comparison.terms, binding, state)
        if not isinstance(number, Unknown) and _stands_at(number, side):
            yield side


def _stands_at(number: Fraction, side: LimitSide) -> bool:
    limit = side.comparison.limit
    holds = stands(number, side.comparison.relation, limit)
    return holds is side.holds and abs(number - limit) <= grain(limit)


def close_state(
    says: ExampleState, side: LimitSide, machine: MealyMonitor, vocabulary: Vocabulary
) -> ExampleState | None:
    """The state with its number moved close to a limit on one side; None if impossible."""
    limit, terms = side.comparison.limit, side.comparison.terms
    numbers = dict(says)
    if len(terms) == 1:
        ((_, term),) = terms
        assert isinstance(term, QuantityTerm), "sides have no other terms"
        (read,) = (read for read in machine.reads if _reads(read, side))
        before = numbers.get((term.name, term.arguments))
        for number in (limit, limit - grain(limit), limit + grain(limit)):
            if (
                before is not None
                and (number >= 0 or limit < 0)
                and _stands_at(number, side)
                and read.digit(number) == read.digit(exact(float(before)))
            ):
                numbers[term.name, term.arguments] = float(number)
                break
    return numbers if _is_near(numbers, side, vocabulary) else None


def _is_near(says: ExampleState, side: LimitSide, vocabulary: Vocabulary) -> bool:
    total = Fraction(0)
    for factor, term in side.comparison.terms:
        assert isinstance(term, QuantityTerm), "sides have no other terms"
        default = vocabulary.declarations[term.name].default
        number = says.get((term.name, term.arguments), default)
        if number is None:
            return False
        total += factor * exact(float(number))
    return _stands_at(total, side)


def _reads(read: Read | NumberRead, side: LimitSide) -> TypeGuard[NumberRead]:
    return isinstance(read, NumberRead) and read.terms == side.comparison.terms


def deciding_edges(
    side: LimitSide, machine: MealyMonitor, sources: Callable[[int], tuple[int, ...]]
) -> Iterator[tuple[int, int]]:
    """States of a machine with letters on one side of a limit whose other side leads elsewhere.

    ``sources`` gives the states in which a letter can be read and the verdict is not final.
    """
    (true,) = letters_with(machine.reads, [side.comparison]).values()
    reads = machine.reads
    (place,) = (place for place, read in enumerate(reads) if _reads(read, side))
    negative = side.comparison.limit < 0
    stride, size = prod(read.size for read in reads[:place]), reads[place].size

    @cache
    def told_apart(here: int, beyond: int, states: tuple[int, ...]) -> int | None:
        for state in states:
            ways = (machine.successors[state], machine.outputs[state])
            if any(way[here] != way[beyond] for way in ways):
                return state
        return None

    for letter, here in enumerate(machine.letters):
        if bool(true >> letter & 1) is not side.holds or here == IMPOSSIBLE:
            continue
        digit = letter // stride % size
        for beyond in (letter - stride,) * (digit > 0) + (letter + stride,) * (digit + 1 < size):
            if bool(true >> beyond & 1) is side.holds or machine.letters[beyond] == IMPOSSIBLE:
                continue
            state = told_apart(here, machine.letters[beyond], sources(letter))
            wanted = (can_be(machine, symbol, below_zero=negative) for symbol in (letter, beyond))
            if state is not None and all(wanted):
                yield state, letter
