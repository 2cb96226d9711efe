"""A machine compared with direct evaluation, on random words."""

from __future__ import annotations

import random
from collections.abc import Iterator

from rulec.automata.letters import count_letters, letters_with, propositions_of
from rulec.automata.machine import Machine
from rulec.logic.formula import Formula, Proposition
from rulec.logic.semantics import Semantics, holds
from rulec.logic.timing import reach

N_WORDS = 300
_LONGEST = 400


def agrees(machine: Machine, formula: Formula, semantics: Semantics) -> bool:
    """Does the machine judge some hundred random words, always the same ones, as it should?

    Letters stay for a while: of words that change with every letter few are long enough about one
    thing for a bound to matter.
    """
    chance = random.Random(0)
    n_letters = count_letters(machine.reads)
    sets = letters_with(machine.reads, propositions_of(formula))
    longest = min(2 * reach(formula) + 8, _LONGEST)
    for _ in range(N_WORDS):
        numbers = list(_word(chance, n_letters, chance.randint(1, longest)))
        word: list[frozenset[Proposition]] = [
            frozenset(one for one, letters in sets.items() if letters >> number & 1)
            for number in numbers
        ]
        if verdict(machine, numbers) != holds(formula, word, semantics):
            return False
    return True


def _word(chance: random.Random, n_letters: int, length: int) -> Iterator[int]:
    stay = chance.choice((0.0, 0.5, 0.9, 0.98))
    # Between a few letters more happens twice than between all of them.
    some = [chance.randrange(n_letters) for _ in range(chance.randint(1, 4))]
    number = chance.choice(some)
    for _ in range(length):
        yield number
        if chance.random() >= stay:
            number = chance.choice(some)


def verdict(machine: Machine, numbers: list[int]) -> bool:
    """The machine's verdict on a word of letters, given by their numbers."""
    state, accepted = 0, False
    for number in numbers:
        symbol = machine.letters[number]
        accepted = machine.accepting[state][symbol]
        state = machine.following[state][symbol]
    return accepted
