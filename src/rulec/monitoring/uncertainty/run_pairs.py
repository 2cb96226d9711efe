"""Pairs of runs of one machine, side by side on letters that agree on what is fixed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from functools import reduce
from itertools import groupby, product
from operator import or_
from typing import TypeAlias

from rulec.automata.outcome_machine import OutcomeMachine, bits_of
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters

MOST_REMEMBERED = 1 << 14
"""How many steps are kept before all are discarded."""

MOST_TABLES = 1 << 12
"""How many tables of outcomes are kept before all are discarded."""

MOST_WORDS = 1 << 9
"""For how many words the prospects are kept before all are discarded."""

Word: TypeAlias = tuple[int, ...]
"""Letters by their numbers."""

Pairs: TypeAlias = frozenset[tuple[int, int]]
"""States of a first run, each with the states, as bits, in which a second run may be.

The runs read words on which the fixed reads have the same digits. The question is whether the first
run may have a lesser outcome than the second.
"""


class RunPairs:
    """Pairs of runs of one machine, step by step, cached from word to word.

    Letters are numbered, since they recur in many states. So are the choices that two letters
    leave, side by side, once the digits of some reads are fixed, of which there are even fewer.
    """

    def __init__(self, machine: OutcomeMachine, classes: LetterClasses) -> None:
        self._machine = machine
        self._classes = classes
        self._prospects = Prospects(machine)
        self._safe = sum(1 << state for state in machine.safe)
        self._starts: dict[bool, Pairs] = {}
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
        """The pairs of start states, optionally only pairs of equal states."""
        if same not in self._starts:
            states = self._machine.starts
            every = sum(1 << state for state in states)
            rows = {state: 1 << state if same else every for state in states}
            self._starts[same] = self._furthest(rows)
        return self._starts[same]

    def forget_many(self) -> None:
        """Discard what has been cached, if it is much; the numbers then become invalid."""
        most = max(len(self._after), len(self._onward), len(self._choices), len(self._undecided))
        if most > MOST_REMEMBERED or len(self._along) > MOST_WORDS:
            self._forget()

    def word(self, stretches: Sequence[tuple[Letters, int]]) -> Word:
        """A word, with its letters as numbers."""
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
        """The number of start states."""
        return len(self._machine.starts)

    def are_settled(self, word: Word, fixed: Set[int]) -> bool:
        """Whether each letter of a word is determined once the digits of some reads are fixed."""
        return all(self._open[number] <= fixed for number in set(word))

    def prospects(self, word: Word) -> list[bytes]:
        """For each letter of a word the possible outcomes from each state: see ``Prospects``."""
        prospects = self._along.get(word)
        if prospects is None:
            classes = {number: self._classes.of(self._letters[number]) for number in set(word)}
            prospects = self._prospects.along([classes[number] for number in word])
            self._along[word] = prospects
        return prospects

    def undecided(self, pairs: Pairs, first: bytes, second: bytes) -> Pairs | None:
        """The pairs for which it is open which run has the lesser outcome.

        None if for some pair the first run surely has. ``first`` and ``second`` are the outcomes,
        as bits, that the rest of each run's word may have, by state.
        """
        key = pairs, first, second
        if key not in self._undecided:
            self._undecided[key] = _undecided(pairs, first, second)
        return self._undecided[key]

    def choices(self, first: int, second: int, fixed: tuple[int, ...]) -> int:
        """The number of the possible pairs of two letters with equal digits of fixed reads."""
        if first == second:
            # Reads with one digit distinguish nothing.
            fixed = tuple([n for n in fixed if n in self._open[first]])
        key = first, second, fixed
        number = self._choices.get(key)
        if number is None:
            classes = self._classes.side_by_side(self._letters[first], self._letters[second], fixed)
            number = self._places.setdefault(classes, len(self._sets))
            if number == len(self._sets):
                self._sets.append(classes)
            self._choices[key] = number
        return number

    def after(self, pairs: Pairs, choices: int) -> Pairs:
        """The pairs after one more step."""
        key = pairs, choices
        onward = self._after.get(key)
        if onward is None:
            rows: dict[int, int] = {}
            for row in pairs:
                for state, others in self._onward.get((row, choices)) or self._from(row, choices):
                    rows[state] = rows.get(state, 0) | others
            onward = self._after[key] = self._furthest(rows)
        return onward

    def _from(self, row: tuple[int, int], choices: int) -> list[tuple[int, int]]:
        rows: dict[int, int] = {}
        for first, second in self._sets[choices]:
            targets = self._greatest_behind(row[1], second)
            for target in self._least_behind(row[0], first):
                rows[target] = rows.get(target, 0) | targets
        targets_of = self._onward[row, choices] = list(rows.items())
        return targets_of

    def _least_behind(self, state: int, classes: int) -> list[int]:
        key = state, classes
        least = self._least.get(key)
        if least is None:
            machine = self._machine
            targets = _behind(machine, state, classes)
            least = [*bits_of(machine.least(targets))]
            self._least[key] = least
        return least

    def _greatest_behind(self, states: int, classes: int) -> int:
        key = states, classes
        greatest = self._greatest.get(key)
        if greatest is None:
            machine, targets = self._machine, 0
            for state in bits_of(states):
                targets |= _behind(machine, state, classes)
            greatest = self._greatest[key] = machine.greatest(targets)
        return greatest

    def _furthest(self, rows: Mapping[int, int]) -> Pairs:
        """The pairs of states that no other pair dominates.

        A pair is dominated by one whose first state is no worse and whose second is no better:
        everything that can follow from the dominated pair can follow from the other, too.
        """
        if all(others == 1 << state for state, others in rows.items()):
            return frozenset(rows.items())
        machine, furthest = self._machine, []
        below, lost, safe = machine.below, machine.lost, self._safe
        rows = {
            state: left
            for state, others in rows.items()
            if state not in lost and (left := others & ~safe)
        }
        if len(rows) == 1:
            ((state, others),) = rows.items()
            return frozenset([(state, machine.greatest(others))])
        # By first state what its own second states reach, and those of all that are no worse
        reached: dict[int, int] = {}
        # Of equivalent states the first one represents all
        for state in sorted(rows, key=lambda own: (below[own].bit_count(), own)):
            beyond = _united([own for other, own in reached.items() if below[state] >> other & 1])
            others = rows[state]
            reached[state] = beyond | _reach(others, below)
            others &= ~beyond
            if others:
                furthest.append((state, machine.greatest(others)))
        return frozenset(furthest)

    def agree(self, pairs: Pairs, choices: int) -> bool:
        """Whether, on a last letter, no first run has a lesser outcome than the second."""
        key = pairs, choices
        agree = self._ends.get(key)
        if agree is None:
            outputs = self._machine.outputs
            agree = self._ends[key] = all(
                min([outputs[state][symbol] for symbol in bits_of(first)])
                >= max([outputs[n][symbol] for n in bits_of(others) for symbol in bits_of(second)])
                for (state, others), (first, second) in product(pairs, self._sets[choices])
            )
        return agree


def _undecided(pairs: Pairs, first: bytes, second: bytes) -> Pairs | None:
    undecided = []
    for state, others in pairs:
        own, left = first[state], 0
        # A lower bit means a better outcome.
        most = 2 * (own & -own)
        for other in bits_of(others):
            theirs = second[other]
            if theirs & -theirs > own:
                return None
            if theirs >= most:
                left |= 1 << other
        if left:
            undecided.append((state, left))
    return frozenset(undecided)


def _behind(machine: OutcomeMachine, state: int, classes: int) -> int:
    """The states, as bits, reached by some classes."""
    row = machine.successors[state]
    return _united([1 << row[symbol] for symbol in bits_of(classes)])


def _united(masks: Iterable[int]) -> int:
    union = 0
    for mask in masks:
        union |= mask
    return union


def _reach(states: int, below: Sequence[int]) -> int:
    """The states, as bits, whose outcomes are no greater than those of some given state."""
    return _united([below[state] for state in bits_of(states)])


class Prospects:
    """The outcomes, as bits, that words from each state may have, in numbered tables.

    They are computed backwards from a word's end and cached, since words often end alike.
    """

    def __init__(self, machine: OutcomeMachine) -> None:
        # By classes of letters, one after the other.
        self._successors = list(zip(*machine.successors, strict=True))
        self._outcomes = [
            bytes([1 << outcome for outcome in column])
            for column in zip(*machine.outputs, strict=True)
        ]
        self._forget()

    def _forget(self) -> None:
        self._tables: list[bytes] = []
        self._numbers: dict[bytes, int] = {}
        self._before: dict[tuple[int, int], int] = {}

    def along(self, word: Sequence[int]) -> list[bytes]:
        """For each letter of a word, the outcomes by state of the rest of the word from there on.

        Letters are sets of classes, as bits.
        """
        if len(self._tables) > MOST_TABLES:
            self._forget()
        backward: list[bytes] = []
        here = -1
        for classes, stretch in groupby(reversed(word)):
            length = len(list(stretch))
            for done in range(length):
                key = here, classes
                known = self._before.get(key)
                if known is None:
                    known = self._before[key] = self._number(here, classes)
                if known == here:
                    # The table repeats itself from here on.
                    backward += [self._tables[here]] * (length - done)
                    break
                here = known
                backward.append(self._tables[here])
        return backward[::-1]

    def _number(self, after: int, classes: int) -> int:
        symbols = [n for n in range(classes.bit_length()) if classes >> n & 1]
        if after < 0:
            columns = {self._outcomes[symbol] for symbol in symbols}
        else:
            behind = self._tables[after].__getitem__
            columns = {
                bytes(map(behind, targets))
                for targets in {self._successors[symbol] for symbol in symbols}
            }
        joined, *others = columns
        if others:
            every = reduce(or_, [int.from_bytes(column, "little") for column in columns])
            joined = every.to_bytes(len(joined), "little")
        number = self._numbers.setdefault(joined, len(self._tables))
        if number == len(self._tables):
            self._tables.append(joined)
        return number
