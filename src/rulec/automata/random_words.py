"""A machine compared with direct evaluation, on random words."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import repeat

from rulec.automata.alphabet import letters_with, propositions_of
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor
from rulec.logic.bounds import operations_of, range_of
from rulec.logic.formula import Formula
from rulec.logic.semantics import Semantics, holds

MOST_WORDS, FEWEST_WORDS = 300, 40
_EFFORT = 200_000
"""About so many values are evaluated altogether, if that is possible with the fewest words."""


def agrees(machine: MealyMonitor, formula: Formula, semantics: Semantics) -> bool:
    """Compare a monitor with the semantics on pseudo-random possible words.

    Some letters stay about as long as one of the formula's bounds, which is where a bound matters.
    """
    chance = random.Random(0)
    possible = [n for n, symbol in enumerate(machine.letters) if symbol != IMPOSSIBLE]
    sets = letters_with(machine.reads, propositions_of(formula))
    bounds = _bounds(formula)
    size = 1 + sum(1 for _ in operations_of(formula))
    affordable = _EFFORT // (size * (8 + max(bounds, default=0)))
    n_words = max(FEWEST_WORDS, min(MOST_WORDS, affordable))
    for _ in range(n_words):
        numbers = list(_word(chance, possible, bounds))
        word = [
            frozenset(proposition for proposition, letters in sets.items() if letters >> number & 1)
            for number in numbers
        ]
        if verdict(machine, numbers) != holds(formula, word, semantics):
            return False
    return True


def _bounds(formula: Formula) -> list[int]:
    """Bounds of a formula in steps, and the numbers next to them."""
    ranges = {range_of(operation) for operation in operations_of(formula)}
    numbers = {number for limits in ranges for number in limits if number is not None}
    return sorted({near for number in numbers for near in range(number - 1, number + 3)} - {-1, 0})


def _word(chance: random.Random, letters: list[int], bounds: list[int]) -> Iterator[int]:
    # Between a few letters more happens twice than between all of them.
    some = [letters[chance.randrange(len(letters))] for _ in range(chance.randint(1, 4))]
    for _ in range(chance.randint(1, 8)):
        number = chance.choice(some)
        times = chance.choice(bounds) if bounds and chance.random() < 0.5 else 1
        yield from repeat(number, times)


def verdict(machine: MealyMonitor, numbers: list[int]) -> bool:
    """The machine's verdict on a word of letters, given by their numbers."""
    state, accepted = 0, False
    for number in numbers:
        symbol = machine.letters[number]
        accepted = machine.outputs[state][symbol]
        state = machine.successors[state][symbol]
    return accepted
