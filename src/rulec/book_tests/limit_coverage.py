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
from rulec.logic.formula import Comparison, Formula, QuantityTerm, Term, atoms_of
from rulec.logic.kleene import ObjectBinding, PartialState, Unknown, weighted_sum
from rulec.logic.linear_comparison import stands
from rulec.rulebook.rulebook_model import ExampleState
from rulec.valuations.fourier_motzkin import LinearBound
from rulec.vocabulary import Vocabulary
from rulec.witnesses.coverage_witness import asks_whether_told, can_be, go_together
from rulec.witnesses.letter_functions import counts_read, digits_of
from rulec.witnesses.state_synthesis import numbers_beside

_MOST_PLACES = 2
"""Limits with more decimals result from converting units; close to them means within 1."""


@dataclass(frozen=True, slots=True)
class LimitSide:
    """One side of a limit: the states close to it in which a comparison has the value ``holds``."""

    comparison: Comparison
    holds: bool


def sides_of(formula: Formula, vocabulary: Vocabulary) -> tuple[LimitSide, ...]:
    """Both sides of every limit in a formula; counts of objects have none.

    Nor has ``limit < 1000 km/h`` if 1000 is the default: it only asks whether a limit is told.
    """
    return tuple(
        LimitSide(atom, holds)
        for atom in dict.fromkeys(atoms_of(formula))
        if isinstance(atom, Comparison)
        and all(isinstance(term, QuantityTerm) for _, term in atom.terms)
        and not asks_whether_told(atom, vocabulary)
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
    says: ExampleState,
    side: LimitSide,
    letter: int,
    machine: MealyMonitor,
    vocabulary: Vocabulary,
) -> ExampleState | None:
    """The state of a letter with its numbers moved close to a limit on one side.

    All that its rule reads keeps its digit. None if that is impossible.
    """
    limit, terms = side.comparison.limit, side.comparison.terms
    pairs = zip(machine.reads, digits_of(letter, machine.reads), strict=True)
    numbers = [
        (read, digit)
        for read, digit in pairs
        if isinstance(read, NumberRead) and not counts_read([read])
    ]
    sums: dict[Term, Fraction] = {term: factor for factor, term in terms}
    less = {term: -factor for term, factor in sums.items()}
    close = [LinearBound(sums, limit + grain(limit)), LinearBound(less, grain(limit) - limit)]
    wanted: dict[QuantityTerm, Fraction] = {}
    if len(terms) == 1:
        ((factor, term),) = terms
        assert isinstance(term, QuantityTerm), "sides have no other terms"
        nearest = (limit, limit - grain(limit), limit + grain(limit))
        number = next((number for number in nearest if _stands_at(number, side)), limit)
        wanted[term] = number / factor
    for term in {term: None for read, _ in numbers for _, term in read.terms}:
        before = says.get((term.name, term.arguments)) if isinstance(term, QuantityTerm) else None
        if isinstance(term, QuantityTerm) and before is not None:
            wanted.setdefault(term, exact(float(before)))
    chosen = numbers_beside(numbers, close, wanted)
    if chosen is None:
        return None
    moved = {(term.name, term.arguments): number for term, number in chosen.items()}
    state = {**says, **moved}
    return state if _is_near(state, side, vocabulary) else None


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
    fit = go_together(machine)
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
            if state is not None and all(wanted) and fit(digits_of(letter, reads)):
                yield state, letter
