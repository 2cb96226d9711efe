"""Machines with outcomes as outputs, and their runs on unknown letters.

A word of sets of letters stands for every word with one letter of each set. The machine then steps
on sets of states (the subset construction, built lazily). Only those states of a set need to be
kept whose possible outcomes are the least or the greatest: the others stay between them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import groupby
from typing import Literal, TypeAlias

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.value_display import short_repr

KEPT, PENDING, VIOLATED = range(3)
"""Outcomes, best first; pending: not kept if the word ends here, but not lost for good either."""

Outcome: TypeAlias = Literal[0, 1, 2]

MOST_COMPARED = 1 << 10
"""Larger machines' states are not compared; sets of them are kept whole."""


@dataclass(frozen=True, eq=False)
class OutcomeMachine:
    """A complete deterministic machine from letter classes to outcomes.

    ``reads`` and ``letters`` are as in ``MealyMonitor``; ``outputs[state][class]`` is the outcome
    of a word that ends with such a letter. A run begins in any of ``starts``; there are several if
    what preceded the word is unknown. ``order`` is ``above`` if already known: for each state a row
    of bits in whole bytes, lowest bit first.
    """

    __repr__ = short_repr

    reads: tuple[Read | NumberRead, ...]
    letters: tuple[int, ...]
    successors: Sequence[Sequence[int]]
    outputs: Sequence[Sequence[int]]
    starts: frozenset[int]
    order: bytes | None = None

    @property
    def n_classes(self) -> int:
        """The number of letter classes."""
        return len(self.outputs[0])

    @cached_property
    def lost(self) -> frozenset[int]:
        """The states from which every word is violated."""
        return self._never_left(VIOLATED)

    @cached_property
    def safe(self) -> frozenset[int]:
        """The states from which every word is kept."""
        return self._never_left(KEPT)

    def _never_left(self, outcome: int) -> frozenset[int]:
        """The states from which every word has this outcome."""
        outputs, successors = self.outputs, self.successors
        never_left = {state for state, row in enumerate(outputs) if row.count(outcome) == len(row)}
        before: dict[int, list[int]] = {}
        for state in never_left:
            for target in set(successors[state]):
                before.setdefault(target, []).append(state)
        for left in (waiting := [target for target in before if target not in never_left]):
            fresh = never_left.intersection(before.get(left, ()))
            never_left -= fresh
            waiting += fresh
        return frozenset(never_left)

    @cached_property
    def above(self) -> tuple[int, ...]:
        """For each state, the bit set of states from which no word has a lower outcome."""
        if self.order is None:
            return self._found_order
        width = (len(self.successors) + 7) // 8
        return tuple(
            [
                int.from_bytes(self.order[start : start + width], "little")
                for start in range(0, len(self.order), width)
            ]
        )

    def in_order(self) -> OutcomeMachine:
        """The machine with its ``order``."""
        if self.order is not None:
            return self
        width = (len(self.successors) + 7) // 8
        rows = [above.to_bytes(width, "little") for above in self.above]
        return replace(self, order=b"".join(rows))

    @property
    def _found_order(self) -> tuple[int, ...]:
        size = len(self.successors)
        if size <= MOST_COMPARED:
            try:
                return _order(self.successors, self.outputs)
            except ModuleNotFoundError:
                # Without NumPy (in a browser), sets are kept whole, with the same results.
                pass
        return tuple([1 << state for state in range(size)])

    @cached_property
    def below(self) -> tuple[int, ...]:
        """For each state, the bit set of states from which no word has a higher outcome."""
        # Transposes the bit matrix as text; each row's first digit is that of the last state.
        size = len(self.above)
        digits = "".join([f"{above:0{size}b}" for above in reversed(self.above)])
        return tuple([int(digits[place::size], 2) for place in reversed(range(size))])

    def least(self, states: int) -> int:
        """The least of these states as a bit set; of equivalent ones only the first."""
        return _foremost(states, self.below, self.above)

    def greatest(self, states: int) -> int:
        """The greatest of these states as a bit set; of equivalent ones only the first."""
        return _foremost(states, self.above, self.below)

    def extremes(self, states: Iterable[int]) -> frozenset[int]:
        """The least and the greatest of these states; of equivalent ones only the first."""
        members = frozenset(states)
        if len(members) < 3:
            return members
        bits = sum([1 << state for state in members])
        return frozenset(bits_of(self.least(bits) | self.greatest(bits)))


@lru_cache(maxsize=1 << 14)
def bits_of(mask: int) -> tuple[int, ...]:
    """The positions of the set bits, ascending."""
    places = []
    while mask:
        lowest = mask & -mask
        places.append(lowest.bit_length() - 1)
        mask ^= lowest
    return tuple(places)


def _order(
    successors: Sequence[Sequence[int]], outputs: Sequence[Sequence[int]]
) -> tuple[int, ...]:
    """For each state, the bit set of states from which no word has a lower outcome."""
    # NumPy takes 0.1 s to import, and a browser does not have it.
    import numpy as np

    size = len(successors)
    targets_of, outcomes = np.array(successors), np.array(outputs, dtype=np.int8)
    order = np.ones((size, size), dtype=bool)
    for column in {column.tobytes(): column for column in outcomes.T}.values():
        order &= column[:, None] <= column[None, :]
    targets = list({column.tobytes(): column for column in targets_of.T}.values())
    while True:
        before = order.sum()
        for target in targets:
            # Two calls of take are several times as fast as one index of two arrays.
            order &= order.take(target, axis=0).take(target, axis=1)
        if order.sum() == before:
            rows = np.packbits(order, axis=1, bitorder="little")
            return tuple([int.from_bytes(row.tobytes(), "little") for row in rows])


def _foremost(states: int, beyond: Sequence[int], before: Sequence[int]) -> int:
    """The states that no other of them is strictly beyond, as bits; of equivalent ones the first.

    ``beyond`` and ``before``: for each state, the bit sets of itself and of those beyond or before.
    """
    left = states
    if not states & (states - 1):
        return states
    for state in bits_of(states):
        others = beyond[state] & left & ~(1 << state)
        if others & ~before[state] or others & ((1 << state) - 1):
            left ^= 1 << state
    return left


def of_complete_words(machine: MealyMonitor) -> OutcomeMachine:
    """The machine for complete words: outcomes are kept or violated."""
    outputs = [[KEPT if kept else VIOLATED for kept in row] for row in machine.outputs]
    return OutcomeMachine(
        machine.reads, machine.letters, machine.successors, outputs, frozenset({0})
    )


def of_running_words(machine: MealyMonitor) -> OutcomeMachine:
    """The machine for words that may go on: violated only if lost for good."""
    lost = machine.rejecting_sink
    outputs = [
        [
            KEPT if kept else VIOLATED if target == lost else PENDING
            for target, kept in zip(targets, row, strict=True)
        ]
        for targets, row in zip(machine.successors, machine.outputs, strict=True)
    ]
    return OutcomeMachine(
        machine.reads, machine.letters, machine.successors, outputs, frozenset({0})
    )


def of_prefixes(
    machine: MealyMonitor, finite: MealyMonitor, starts: Iterable[tuple[int, int]] = ((0, 0),)
) -> OutcomeMachine:
    """The machine for words that continue unobserved, from the two machines of one rule.

    Violated: ``machine`` accepts no continuation. Kept: ``finite``, which judges words as they are,
    accepts the word. Pending: neither. ``starts`` are pairs of states of the two machines.
    """
    pairs = dict.fromkeys(zip(machine.letters, finite.letters, strict=True))
    classes = {pair: place for place, pair in enumerate(x for x in pairs if IMPOSSIBLE not in x)}
    places = {pair: place for place, pair in enumerate(dict.fromkeys(starts))}
    successors, outputs = [], []
    for own, other in (waiting := list(places)):
        row, outcomes = [], []
        for symbol, finite_symbol in classes:
            target = machine.successors[own][symbol], finite.successors[other][finite_symbol]
            if target not in places:
                places[target] = len(places)
                waiting.append(target)
            row.append(places[target])
            lost = target[0] == machine.rejecting_sink and not machine.outputs[own][symbol]
            kept = finite.outputs[other][finite_symbol]
            outcomes.append(VIOLATED if lost else KEPT if kept else PENDING)
        successors.append(tuple(row))
        outputs.append(tuple(outcomes))
    letters = tuple(
        [
            classes.get(pair, IMPOSSIBLE)
            for pair in zip(machine.letters, finite.letters, strict=True)
        ]
    )
    first = frozenset(places[pair] for pair in starts)
    return OutcomeMachine(machine.reads, letters, tuple(successors), tuple(outputs), first)


@dataclass(frozen=True, slots=True)
class OutcomeRange:
    """The best and the worst outcome of words, and the number of the set of states reached."""

    states: int
    best: int
    worst: int


class SetMonitor:
    """Runs of an outcome machine on sets of letter classes, given as bit sets."""

    def __init__(self, machine: OutcomeMachine) -> None:
        self.machine = machine
        self._numbers: dict[frozenset[int], int] = {}
        self._sets: list[frozenset[int]] = []
        self._steps: dict[tuple[int, int], OutcomeRange] = {}
        self.start = self.number(*machine.starts)

    def states(self, number: int) -> frozenset[int]:
        """The members of a set of states, by its number."""
        return self._sets[number]

    def step(self, number: int, classes: int) -> OutcomeRange:
        """Take a step from a set of states on any of these classes (at least one)."""
        key = number, classes
        known = self._steps.get(key)
        if known is None:
            symbols, states, machine = bits_of(classes), self._sets[number], self.machine
            rows = [machine.outputs[state] for state in states]
            outcomes = {row[symbol] for row in rows for symbol in symbols}
            rows = [machine.successors[state] for state in states]
            targets = {row[symbol] for row in rows for symbol in symbols}
            known = OutcomeRange(self.number(*targets), min(outcomes), max(outcomes))
            self._steps[key] = known
        return known

    def run(self, word: Sequence[int]) -> tuple[int, int, int | None]:
        """The best and the worst outcome of a non-empty word of sets of classes.

        The third item is the index of the letter after which every completion was lost, or None.
        """
        return self.run_stretches((classes, len(list(own))) for classes, own in groupby(word))

    def run_stretches(self, stretches: Iterable[tuple[int, int]]) -> tuple[int, int, int | None]:
        """``run`` of a word given as pairs of a set of classes and its number of repetitions."""
        here, lost, start = self.start, self.machine.lost, 0
        step = OutcomeRange(here, KEPT, KEPT)
        for classes, length in stretches:
            for index in range(start, start + length):
                before, step = here, self.step(here, classes)
                here = step.states
                if step.best == VIOLATED and lost.issuperset(self._sets[here]):
                    return VIOLATED, VIOLATED, index
                if here == before:
                    break  # a fixed point: more repetitions change nothing
            start += length
        return step.best, step.worst, None

    def number(self, *states: int) -> int:
        """The number of a set of states, reduced to its extremes."""
        members = self.machine.extremes(states)
        number = self._numbers.setdefault(members, len(self._sets))
        if number == len(self._sets):
            self._sets.append(members)
        return number
