"""Pairs of runs of one machine, side by side on letters that agree on what is fixed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from functools import cached_property
from itertools import product
from typing import TypeAlias

from rulec.automata.outcome_machine import OutcomeMachine, bits_of
from rulec.monitoring.uncertainty.prospects import Prospects
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters

MOST_REMEMBERED = 1 << 14
"""Steps that are kept before all are forgotten."""

MOST_WORDS = 1 << 9
"""Words whose prospects are kept before all is forgotten."""

Word: TypeAlias = tuple[int, ...]
"""Letters by their numbers."""

Pairs: TypeAlias = frozenset[tuple[int, int]]
"""States of a first run, each with the states, as bits, that a second run may be in.

They are of words on which the fixed reads have the same digits. It is asked whether the first run
may come to less than the second one.
"""


class RunPairs:
    """Pairs of runs of one machine, step by step, remembered from word to word.

    Letters have numbers: states are many, their letters few. So have the choices that two letters
    leave, side by side, once the digits of some reads are fixed; fewer still.
    """

    def __init__(self, machine: OutcomeMachine, classes: LetterClasses) -> None:
        self._machine = machine
        self._classes = classes
        self._prospects = Prospects(machine)
        self._safe = sum(1 << state for state in machine.safe)
        self._starts: dict[bool, Pairs] = {}
        self._below: dict[int, int] = {}
        self._forget()

    def _forget(self) -> None:
        self._numbers: dict[Letters, int] = {}
        self._letters: list[Letters] = []
        self._open: list[frozenset[int]] = []
        self._choices: dict[tuple[int, int, tuple[int, ...]], int] = {}
        self._places: dict[frozenset[tuple[int, int]], int] = {}
        self._sets: list[frozenset[tuple[int, int]]] = []
        self._after: dict[tuple[Pairs, int], Pairs] = {}
        self._onward: dict[tuple[tuple[int, int], int], list[tuple[int, int]]] = {}
        self._least: dict[tuple[int, int], list[int]] = {}
        self._greatest: dict[tuple[int, int], int] = {}
        self._ends: dict[tuple[Pairs, int], bool] = {}
        self._along: dict[Word, list[bytes]] = {}
        self._undecided: dict[tuple[Pairs, bytes, bytes], Pairs | None] = {}

    def starts(self, *, same: bool) -> Pairs:
        """The pairs of states that runs begin in, optionally only in the same."""
        if same not in self._starts:
            states = self._machine.starts
            every = sum(1 << state for state in states)
            rows = {state: 1 << state if same else every for state in states}
            self._starts[same] = self._furthest(rows)
        return self._starts[same]

    def forget_many(self) -> None:
        """Forget what has been met, if it is much; numbers mean nothing any more."""
        most = max(len(self._after), len(self._onward), len(self._choices), len(self._undecided))
        if most > MOST_REMEMBERED or len(self._along) > MOST_WORDS:
            self._forget()

    def word(self, stretches: Sequence[tuple[Letters, int]]) -> Word:
        """A word in numbers."""
        word: list[int] = []
        for letters, length in stretches:
            number = self._numbers.setdefault(letters, len(self._letters))
            if number == len(self._letters):
                self._letters.append(letters)
                digits = [_united(masks) for masks in zip(*letters, strict=True)]
                self._open.append(frozenset(n for n, own in enumerate(digits) if own & own - 1))
            word += [number] * length
        return tuple(word)

    @property
    def n_starts(self) -> int:
        """In how many states runs may begin."""
        return len(self._machine.starts)

    def are_settled(self, word: Word, fixed: Set[int]) -> bool:
        """Whether each letter of a word is one, once the digits of some reads are fixed."""
        return all(self._open[number] <= fixed for number in set(word))

    def are_indifferent(self, words: Sequence[Word], read: int) -> bool:
        """Whether a read may have the same digits in all words, and none of them ever matters."""
        return all(
            self._classes.are_indifferent([self._letters[number] for number in side_by_side], read)
            for side_by_side in set(zip(*words, strict=True))
        )

    def prospects(self, word: Word) -> list[bytes]:
        """For each letter of a word what may come of each state: see ``Prospects``."""
        found = self._along.get(word)
        if found is None:
            classes = {number: self._classes.of(self._letters[number]) for number in set(word)}
            found = self._prospects.along([classes[number] for number in word])
            self._along[word] = found
        return found

    def undecided(self, pairs: Pairs, first: bytes, second: bytes) -> Pairs | None:
        """The pairs of which it is open whether the first run comes to less than the second one.

        None if it surely does for some. ``first`` and ``second`` are the outcomes, as bits, that
        the rest of each run's word may have, by state.
        """
        key = pairs, first, second
        if key not in self._undecided:
            self._undecided[key] = _undecided(pairs, first, second)
        return self._undecided[key]

    def choices(self, one: int, other: int, fixed: tuple[int, ...]) -> int:
        """The number of what two letters may be, with the same digits of fixed reads."""
        if one == other:
            # Reads with one digit divide nothing.
            fixed = tuple([n for n in fixed if n in self._open[one]])
        key = one, other, fixed
        found = self._choices.get(key)
        if found is None:
            choices = self._classes.side_by_side(self._letters[one], self._letters[other], fixed)
            found = self._places.setdefault(choices, len(self._sets))
            if found == len(self._sets):
                self._sets.append(choices)
            self._choices[key] = found
        return found

    def after(self, pairs: Pairs, choices: int) -> Pairs:
        """The pairs after one more step."""
        key = pairs, choices
        found = self._after.get(key)
        if found is None:
            rows: dict[int, int] = {}
            for row in pairs:
                for one, others in self._onward.get((row, choices)) or self._from(row, choices):
                    rows[one] = rows.get(one, 0) | others
            found = self._after[key] = self._furthest(rows)
        return found

    def _from(self, row: tuple[int, int], choices: int) -> list[tuple[int, int]]:
        rows: dict[int, int] = {}
        for first, second in self._sets[choices]:
            targets = self._greatest_behind(row[1], second)
            for target in self._least_behind(row[0], first):
                rows[target] = rows.get(target, 0) | targets
        found = self._onward[row, choices] = list(rows.items())
        return found

    def _least_behind(self, state: int, classes: int) -> list[int]:
        key = state, classes
        found = self._least.get(key)
        if found is None:
            machine = self._machine
            targets = _behind(machine, state, classes)
            found = [*bits_of(machine.least(targets))]
            self._least[key] = found
        return found

    def _greatest_behind(self, states: int, classes: int) -> int:
        key = states, classes
        found = self._greatest.get(key)
        if found is None:
            machine, targets = self._machine, 0
            for state in bits_of(states):
                targets |= _behind(machine, state, classes)
            found = self._greatest[key] = machine.greatest(targets)
        return found

    def _furthest(self, rows: Mapping[int, int]) -> Pairs:
        """The pairs without those of which nothing can come that does not come of another.

        So it is if the other's first state is no worse and its second one no better.
        """
        if all(others == 1 << one for one, others in rows.items()):
            return frozenset(rows.items())
        machine, found = self._machine, []
        below, lost, safe = machine.below, machine.lost, self._safe
        rows = {
            one: left
            for one, others in rows.items()
            if one not in lost and (left := others & ~safe)
        }
        if len(rows) == 1:
            ((one, others),) = rows.items()
            return frozenset([(one, machine.greatest(others))])
        ranks = self._ranks
        own = {ranks[row]: row for row in rows}
        firsts = sum(1 << rank for rank in own)
        # By rank what its own second states reach, and those of all whose first one is no worse
        reached: dict[int, int] = {}
        for rank in sorted(own):
            one = own[rank]
            others = rows[one]
            better = self._ranks_below(one) & firsts & (1 << rank) - 1
            beyond = 0
            while better:
                nearest = better.bit_length() - 1
                beyond |= reached[nearest]
                better &= ~self._ranks_below(own[nearest])
            reached[rank] = beyond | _reach(others, below)
            others &= ~beyond
            if others:
                found.append((one, machine.greatest(others)))
        return frozenset(found)

    @cached_property
    def _ranks(self) -> list[int]:
        """For each state its place among all, behind those that come to no more.

        Of states that are alike the first one comes first, and counts.
        """
        below = self._machine.below
        order = sorted(range(len(below)), key=lambda state: (below[state].bit_count(), state))
        ranks = [0] * len(order)
        for rank, state in enumerate(order):
            ranks[state] = rank
        return ranks

    def _ranks_below(self, state: int) -> int:
        """The ranks, as bits, of the states that come to no more than one, and its own."""
        found = self._below.get(state)
        if found is None:
            ranks = self._ranks
            found = sum([1 << ranks[other] for other in bits_of(self._machine.below[state])])
            self._below[state] = found
        return found

    def agree(self, pairs: Pairs, choices: int) -> bool:
        """Whether no first run of pairs comes to less than the second one with a last letter."""
        key = pairs, choices
        found = self._ends.get(key)
        if found is None:
            outputs = self._machine.outputs
            found = self._ends[key] = all(
                min([outputs[one][symbol] for symbol in bits_of(first)])
                >= max([outputs[n][symbol] for n in bits_of(others) for symbol in bits_of(second)])
                for (one, others), (first, second) in product(pairs, self._sets[choices])
            )
        return found


def _undecided(pairs: Pairs, first: bytes, second: bytes) -> Pairs | None:
    found = []
    for one, others in pairs:
        own, left = first[one], 0
        # A lower bit is a better outcome.
        most = 2 * (own & -own)
        for other in bits_of(others):
            theirs = second[other]
            if theirs & -theirs > own:
                return None
            if theirs >= most:
                left |= 1 << other
        if left:
            found.append((one, left))
    return frozenset(found)


def _behind(machine: OutcomeMachine, state: int, classes: int) -> int:
    """The states, as bits, that some classes lead to."""
    row = machine.successors[state]
    return _united([1 << row[symbol] for symbol in bits_of(classes)])


def _united(masks: Iterable[int]) -> int:
    found = 0
    for mask in masks:
        found |= mask
    return found


def _reach(states: int, below: Sequence[int]) -> int:
    """The states, as bits, that come to no more than one of some."""
    return _united([below[state] for state in bits_of(states)])
