"""Products of machines, with joint letters and the verdicts of all machines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.tables import minimise

MOST_ENTRIES = 256
"""The most states times letters of a joint machine: what one byte can number."""

MOST_VERDICTS = 8
"""The most machines in one joint machine: the bits of a byte."""


@dataclass(frozen=True, slots=True)
class JointMachine:
    """Machines that run together as one.

    ``members`` are the places of the machines among those given. ``letters[cell]`` is the letter of
    a cell, ``successors[state][letter]`` the next state, and ``verdicts[state][letter]`` an integer
    whose bit k says whether the k-th member accepts a word that ends with this letter, read in this
    state. Runs start in state 0.
    """

    members: tuple[int, ...]
    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    verdicts: tuple[tuple[int, ...], ...]

    @property
    def n_letters(self) -> int:
        """Number of letters."""
        return len(self.successors[0])


LetteredMachine = tuple[MealyMonitor, tuple[int, ...]]
"""A machine, and for each cell the class of the letter that the machine reads there."""


def join_machines(machines: Sequence[LetteredMachine]) -> Iterator[JointMachine]:
    """Join neighbouring machines into products, in their order.

    A product has at most ``MOST_ENTRIES``, else each half is joined; a machine that is larger by
    itself stays alone.
    """
    for start in range(0, len(machines), MOST_VERDICTS):
        yield from _joined(tuple(range(len(machines)))[start : start + MOST_VERDICTS], machines)


def _joined(
    members: tuple[int, ...], machines: Sequence[LetteredMachine]
) -> Iterator[JointMachine]:
    joint = _join(members, tuple([machines[member] for member in members]))
    if joint is not None:
        yield joint
    elif len(members) == 1:
        machine, letters = machines[members[0]]
        outputs = tuple(tuple(map(int, row)) for row in machine.outputs)
        yield JointMachine(members, letters, machine.successors, outputs)
    else:
        for half in (members[: len(members) // 2], members[len(members) // 2 :]):
            yield from _joined(half, machines)


@lru_cache(maxsize=256)
def _join(members: tuple[int, ...], machines: tuple[LetteredMachine, ...]) -> JointMachine | None:
    """The minimal product of machines; None if it gets too large.

    Cached, because traces come in many chunks that need the same product.
    """
    columns = list(zip(*(letters for _, letters in machines), strict=True))
    distinct = list(dict.fromkeys(columns))
    states = {(0,) * len(machines): 0}
    successors: list[list[int]] = []
    verdicts: list[list[int]] = []
    waiting = list(states)
    while waiting:
        state = waiting.pop(0)
        if len(states) * len(distinct) > 4 * MOST_ENTRIES:
            return None
        successors.append([])
        verdicts.append([])
        for column in distinct:
            target, verdict = [], 0
            for bit, ((machine, _), own_state, letter) in enumerate(
                zip(machines, state, column, strict=True)
            ):
                target.append(machine.successors[own_state][letter])
                verdict |= machine.outputs[own_state][letter] << bit
            reached = tuple(target)
            if reached not in states:
                states[reached] = len(states)
                waiting.append(reached)
            successors[-1].append(states[reached])
            verdicts[-1].append(verdict)
    smaller, outputs = minimise(successors, verdicts, 0)
    effects = list(zip(*smaller, *outputs, strict=True))
    numbers = {effect: number for number, effect in enumerate(dict.fromkeys(effects))}
    if len(smaller) * len(numbers) > MOST_ENTRIES:
        return None
    kept = [effects.index(effect) for effect in numbers]
    letter_of = dict(zip(distinct, map(numbers.__getitem__, effects), strict=True))
    return JointMachine(
        members,
        tuple([letter_of[column] for column in columns]),
        tuple([tuple([row[place] for place in kept]) for row in smaller]),
        tuple([tuple([row[place] for place in kept]) for row in outputs]),
    )
