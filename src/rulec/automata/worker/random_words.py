"""Comparison of monitors with the semantics on pseudo-random words."""

from __future__ import annotations

import random
from collections.abc import Container, Iterator, Mapping
from itertools import repeat

from rulec.automata.alphabet import letters_with, propositions_of
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor
from rulec.logic.bounds import BOOLEAN, operations_of, range_of
from rulec.logic.formula import Atom, Binary, Constant, Formula, Unary, atoms_of, with_operands
from rulec.logic.semantics import Semantics, holds, truth_values

MOST_WORDS, FEWEST_WORDS = 300, 40
_EFFORT = 200_000
"""The approximate number of values evaluated in all, unless the fewest words need more."""


def agrees(machine: MealyMonitor, formula: Formula, semantics: Semantics) -> bool:
    """Whether a monitor agrees with the semantics on pseudo-random possible words.

    Some letters are repeated about as often as a bound of the formula, where bounds matter.
    """
    chance = random.Random(0)
    possible = [n for n, symbol in enumerate(machine.letters) if symbol != IMPOSSIBLE]
    sets = letters_with(machine.reads, propositions_of(formula))
    bounds = _bounds(formula)
    size = 1 + sum(1 for _ in operations_of(formula))
    affordable = _EFFORT // (size * (8 + max(bounds, default=0)))
    n_words = max(FEWEST_WORDS, min(MOST_WORDS, affordable))
    words = [list(_word(chance, possible, bounds)) for _ in range(n_words)]
    letters = {
        number: frozenset([each for each, true_in in sets.items() if true_in >> number & 1])
        for number in {number for word in words for number in word}
    }
    timed, parts = outlined(formula)
    phases: dict[int, set[Atom]] = {number: set() for number in letters}
    for part, atom in parts.items():
        values = truth_values(part, list(letters.values()))
        for true, value in zip(phases.values(), values, strict=True):
            true.update([atom] if value else [])
    return all(
        verdict(machine, word)
        == holds(timed, [frozenset(phases[number]) for number in word], semantics)
        for word in words
    )


def outlined(formula: Formula) -> tuple[Formula, Mapping[Formula, Atom]]:
    """The formula with each part about the present state alone replaced by an atom, and these."""
    parts: dict[Formula, Atom] = {}
    return outline(formula, parts), parts


def outline(
    formula: Formula, parts: dict[Formula, Atom], apart: Container[Formula] = ()
) -> Formula:
    """The formula with each part about the present state alone replaced by its atom in ``parts``.

    New ones are added there. Atoms kept ``apart`` stay, and are in no part.
    """

    def written(part: Formula) -> Formula:
        if isinstance(part, Constant) or part in apart:
            return part
        if isinstance(part, Unary | Binary) and not _is_plain(part, apart):
            return with_operands(part, written)
        return parts.setdefault(part, Atom(f"part {len(parts)}"))

    return written(formula)


def _is_plain(formula: Formula, apart: Container[Formula]) -> bool:
    is_timed = any(operation.operator not in BOOLEAN for operation in operations_of(formula))
    return not is_timed and not any(atom in apart for atom in atoms_of(formula))


def _bounds(formula: Formula) -> list[int]:
    """The bounds of a formula in steps, and the numbers next to them."""
    ranges = {range_of(operation) for operation in operations_of(formula)}
    numbers = {number for limits in ranges for number in limits if number is not None}
    return sorted({near for number in numbers for near in range(number - 1, number + 3)} - {-1, 0})


def _word(chance: random.Random, letters: list[int], bounds: list[int]) -> Iterator[int]:
    # With only a few letters, repetitions are more likely than with all of them.
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
