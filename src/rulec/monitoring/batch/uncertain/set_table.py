"""A rule's machine on sets of letters, as tables: the subset construction on demand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.outcome_machine import KEPT, VIOLATED, SetMonitor
from rulec.monitoring.batch.machines.joint_machine import JointMachine
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import LetterSets, Numbers
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine

MOST_ENTRIES = 1 << 18
"""If there are more sets of states times sets of letters, no machine is built."""

_MOST_KINDS = 1 << 6
"""How many kinds of codes keep their letters before all are discarded."""

POSSIBLE, CERTAIN = 1, 2
"""Bits of a verdict: some completion is not violated; every completion is kept."""

_LOST = -1
"""Stands for all sets of states from which every word is violated."""


@dataclass(frozen=True, slots=True)
class SetTable:
    """A machine over numbers of letter sets; ``impossible`` are those that no state can have.

    ``joint`` has the verdicts ``POSSIBLE`` and ``CERTAIN``, ``possible`` only the first of these.
    """

    joint: JointMachine
    possible: MealyMonitor
    impossible: frozenset[int]


class SetTables:
    """The set machine of a rule for all letter sets met so far."""

    def __init__(self, machine: UncertainMachine, meanings: Sequence[Sequence[int]]) -> None:
        self.machine = machine
        self._meanings = meanings
        self.letters = LetterSets(machine.classes.diagram, meanings)
        self._known: tuple[int, SetTable | None] = 0, None
        self._by_codes: dict[object, dict[object, int]] = {}

    def digits(self, read: int, numbers: Numbers, places: NDArray[np.intp]) -> list[int]:
        """The digits, as bits, that a read may have at some places of a column of its numbers."""
        own = self._meanings[read]
        if not isinstance(numbers, np.ndarray):
            return [own[numbers]] * len(places)
        return [own[number] for number in numbers[places].tolist()]

    def by_codes(self, about: object) -> dict[object, int]:
        """The numbers of letter sets found by codes, for one kind of codes."""
        known = self._by_codes.setdefault(about, {})
        if len(self._by_codes) > _MOST_KINDS or len(known) > MOST_ENTRIES:
            self._by_codes.clear()
            known = self._by_codes[about] = {}
        return known

    def width(self, read: int) -> int:
        """How many numbers a read may have."""
        return len(self._meanings[read])

    def now(self) -> SetTable | None:
        """The machine for all sets met so far.

        None if it gets too large, and then they are discarded.
        """
        sets = self.letters.sets
        if self._known[0] != len(sets):
            self._known = len(sets), set_table(self.machine.monitor, sets)
            if self._known[1] is None:
                self.letters = LetterSets(self.machine.classes.diagram, self._meanings)
                self._by_codes.clear()
        return self._known[1]


@lru_cache(maxsize=1 << 10)
def set_tables(machine: UncertainMachine, meanings: tuple[tuple[int, ...], ...]) -> SetTables:
    """The set machines of a rule, by what the numbers of its reads stand for."""
    return SetTables(machine, meanings)


def set_table(monitor: SetMonitor, sets: Sequence[int]) -> SetTable | None:
    """Determinise for these sets of classes, as bits; None if it gets too large."""
    lost = monitor.machine.lost

    def key(number: int) -> int:
        return _LOST if lost.issuperset(monitor.states(number)) else number

    numbers = {key(monitor.start): 0}
    successors: list[list[int]] = []
    verdicts: list[list[int]] = []
    possible_sets = [classes for classes in sets if classes]
    if not possible_sets:
        return None
    for here in (waiting := [monitor.start]):
        if len(waiting) * len(sets) > MOST_ENTRIES:
            return None
        steps = [monitor.step(here, classes) for classes in possible_sets]
        row = []
        for step in steps:
            target = key(step.states)
            if target not in numbers:
                numbers[target] = len(numbers)
                waiting.append(step.states)
            row.append(numbers[target])
        successors.append(row)
        verdicts.append(
            [POSSIBLE * (step.best != VIOLATED) | CERTAIN * (step.worst == KEPT) for step in steps]
        )
    # Letter sets with the same effects form one letter.
    effects = list(zip(*successors, *verdicts, strict=True))
    places: dict[tuple[int, ...], int] = {}
    letter_of = [places.setdefault(effect, len(places)) for effect in effects]
    n_states = len(successors)
    next_states = tuple(zip(*[effect[:n_states] for effect in places], strict=True))
    outputs = tuple(zip(*[effect[n_states:] for effect in places], strict=True))
    letters = iter(letter_of)
    joint = JointMachine(
        (0,), tuple([next(letters) if classes else 0 for classes in sets]), next_states, outputs
    )
    can_be_kept = tuple([tuple([bool(x & POSSIBLE) for x in row]) for row in outputs])
    sink = numbers.get(_LOST)
    impossible = frozenset(n for n, classes in enumerate(sets) if not classes)
    return SetTable(
        joint,
        MealyMonitor(
            (),
            (),
            next_states,
            can_be_kept,
            rejecting_sink=sink,
            accepting_sink=None,
        ),
        impossible,
    )
