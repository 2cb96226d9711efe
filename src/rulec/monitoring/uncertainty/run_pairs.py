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
from rulec.trace.remembered import Remembered

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
        self._starts = Remembered(self._start_pairs)
        self._forget()

    def _forget(self) -> None:
        self._numbers: dict[Letters, int] = {}
        self._letters: list[Letters] = []
        self._open: list[frozenset[int]] = []
        self._choices = Remembered(self._choices_left, None)
        self._places: dict[frozenset[tuple[int, int]], int] = {}
        self._sets: list[frozenset[tuple[int, int]]] = []
        self._after = Remembered(self._pairs_after, None)
        self._onward = Remembered(self._from, None)
        self._least = Remembered(self._least_behind, None)
        self._greatest = Remembered(self._greatest_behind, None)
        self._ends = Remembered(self._agree, None)
        self._along = Remembered(self._prospects_along, None)
        self._undecided = Remembered(_undecided, None)

    def starts(self, *, same: bool) -> Pairs:
        """The pairs of start states, optionally only pairs of equal states."""
        return self._starts[same]

    def _start_pairs(self, same: bool) -> Pairs:
        states = self._machine.starts
        every = sum(1 << state for state in states)
        return self._furthest({state: 1 << state if same else every for state in states})

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
        return self._along[word]

    def _prospects_along(self, word: Word) -> list[bytes]:
        classes = {number: self._classes.of(self._letters[number]) for number in set(word)}
        return self._prospects.along([classes[number] for number in word])

    def undecided(self, pairs: Pairs, first: bytes, second: bytes) -> Pairs | None:
        """The pairs for which it is open which run has the lesser outcome.

        None if for some pair the first run surely has. ``first`` and ``second`` are the outcomes,
        as bits, that the rest of each run's word may have, by state.
        """
        return self._undecided[pairs, first, second]

    def choices(self, first: int, second: int, fixed: tuple[int, ...]) -> int:
        """The number of the possible pairs of two letters with equal digits of fixed reads."""
        if first == second:
            # Reads with one digit distinguish nothing.
            fixed = tuple([n for n in fixed if n in self._open[first]])
        return self._choices[first, second, fixed]

    def _choices_left(self, about: tuple[int, int, tuple[int, ...]]) -> int:
        first, second, fixed = about
        classes = self._classes.side_by_side(self._letters[first], self._letters[second], fixed)
        number = self._places.setdefault(classes, len(self._sets))
        if number == len(self._sets):
            self._sets.append(classes)
        return number

    def after(self, pairs: Pairs, choices: int) -> Pairs:
        """The pairs after one more step."""
        return self._after[pairs, choices]

    def _pairs_after(self, about: tuple[Pairs, int]) -> Pairs:
        pairs, choices = about
        rows: dict[int, int] = {}
        for row in pairs:
            for state, others in self._onward[row, choices]:
                rows[state] = rows.get(state, 0) | others
        return self._furthest(rows)

    def _from(self, about: tuple[tuple[int, int], int]) -> list[tuple[int, int]]:
        (state, others), choices = about
        rows: dict[int, int] = {}
        for first, second in self._sets[choices]:
            targets = self._greatest[others, second]
            for target in self._least[state, first]:
                rows[target] = rows.get(target, 0) | targets
        return list(rows.items())

    def _least_behind(self, about: tuple[int, int]) -> tuple[int, ...]:
        return bits_of(self._machine.least(_behind(self._machine, *about)))

    def _greatest_behind(self, about: tuple[int, int]) -> int:
        machine, (states, classes) = self._machine, about
        return machine.greatest(_united(_behind(machine, x, classes) for x in bits_of(states)))

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
        return self._ends[pairs, choices]

    def _agree(self, about: tuple[Pairs, int]) -> bool:
        outputs, (pairs, choices) = self._machine.outputs, about
        return all(
            min([outputs[state][symbol] for symbol in bits_of(first)])
            >= max([outputs[n][symbol] for n in bits_of(others) for symbol in bits_of(second)])
            for (state, others), (first, second) in product(pairs, self._sets[choices])
        )


def _undecided(about: tuple[Pairs, bytes, bytes]) -> Pairs | None:
    (pairs, first, second), undecided = about, []
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
        self._before = Remembered(self._number, None)

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
                known = self._before[here, classes]
                if known == here:
                    # The table repeats itself from here on.
                    backward += [self._tables[here]] * (length - done)
                    break
                here = known
                backward.append(self._tables[here])
        return backward[::-1]

    def _number(self, about: tuple[int, int]) -> int:
        after, classes = about
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
