"""Worker process for Spot: jobs on standard input, tables on standard output.

It may use bounded time and memory only, and may die of either; the caller sees that it did.
"""

from __future__ import annotations

import pickle
import random
import resource
import sys
import time
import traceback
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import repeat
from typing import Literal

from rulec.automata.alphabet import AND, count_letters, joined, letters_with, propositions_of
from rulec.automata.axiom_instances import AxiomGroup, AxiomInstance, possible_letters
from rulec.automata.confinement import Confinement
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read
from rulec.automata.tables import build_machine
from rulec.logic.bounds import BOOLEAN, operations_of, range_of
from rulec.logic.formula import Atom, Binary, Constant, Formula, Unary, with_operands
from rulec.logic.semantics import Letter, Semantics, holds, truth_values

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
    words = [list(_word(chance, possible, bounds)) for _ in range(n_words)]
    letters = {
        number: frozenset([each for each, true_in in sets.items() if true_in >> number & 1])
        for number in {number for word in words for number in word}
    }
    outline, phases = _outlined(formula, letters)
    return all(
        verdict(machine, word) == holds(outline, [phases[number] for number in word], semantics)
        for word in words
    )


def _outlined(
    formula: Formula, letters: Mapping[int, Letter]
) -> tuple[Formula, Mapping[int, Letter]]:
    """The formula with an atom for each part that looks at the present alone, and its letters.

    Such a part is evaluated once for all letters, not in every word.
    """
    found: dict[Formula, Atom] = {}
    true_in: dict[int, set[Atom]] = {number: set() for number in letters}

    def outlined(part: Formula) -> Formula:
        is_timed = any(operation.operator not in BOOLEAN for operation in operations_of(part))
        if is_timed and isinstance(part, Unary | Binary):
            return with_operands(part, outlined)
        atom = found.setdefault(part, Atom(f"part {len(found)}"))
        values = truth_values(part, list(letters.values()))
        for true, value in zip(true_in.values(), values, strict=True):
            true.update([atom] if value else [])
        return atom

    return outlined(formula), true_in


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


MEMORY_LIMIT_BYTES = 2 << 30
MOST_LETTERS = 1 << 16
MOST_STEPS_AHEAD = 10_000
"""An automaton has a state for each step of a bound, at least; no more can be built in time."""


@dataclass(frozen=True, slots=True)
class Job:
    """One rule to translate, its bounds in steps.

    ``groups`` are the facts that hold of its variables. ``cpu_s``: the processor time it may use,
    in whole seconds.
    """

    name: str
    formula: Formula
    reads: tuple[Read | NumberRead, ...]
    remarks: tuple[str, ...]
    semantics: Semantics
    groups: tuple[AxiomGroup, ...]
    cpu_s: int
    most_letters: int = MOST_LETTERS


@dataclass(frozen=True, slots=True)
class WorkerGreeting:
    """First message of a worker: Spot's version, or None and a ``problem``.

    ``confined``: what the worker is kept from.
    """

    spot: str | None
    problem: str = ""
    confined: Confinement | tuple[()] = ()


@dataclass(frozen=True, slots=True)
class Done:
    """A rule's machine, and its automaton in HOA."""

    machine: MealyMonitor
    hoa: str


@dataclass(frozen=True, slots=True)
class Failed:
    """Reason for no monitor: ``letters``, ``steps``, ``memory``, ``check``, ``facts`` or ``bug``.

    ``facts``: those of ``contradiction`` cannot hold together. ``bug`` is anything that nobody
    thought of, with the traceback.
    """

    why: Literal["letters", "steps", "memory", "check", "facts", "bug"]
    traceback: str = ""
    contradiction: tuple[AxiomInstance, ...] = ()


def main(confined: Confinement) -> None:
    """Answer jobs until standard input ends."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _limit(resource.RLIMIT_AS, MEMORY_LIMIT_BYTES)
    answers = sys.stdout.buffer
    try:
        from rulec.automata import spot_bridge  # Spot is loaded in the worker alone
    except ImportError as problem:
        pickle.dump(WorkerGreeting(None, str(problem)), answers)
        return
    pickle.dump(WorkerGreeting(spot_bridge.VERSION, confined=confined), answers)
    answers.flush()
    while True:
        try:
            job: Job = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        _limit(resource.RLIMIT_CPU, int(time.process_time()) + 1 + job.cpu_s)
        try:
            answer = _answer(job)
        except (MemoryError, RecursionError):
            answer = Failed("memory")
        except Exception:
            answer = Failed("bug", traceback.format_exc())
        pickle.dump(answer, answers)
        answers.flush()


def _answer(job: Job) -> Done | Failed:
    from rulec.automata import spot_bridge  # Spot is loaded in the worker alone

    if count_letters(job.reads) > job.most_letters:
        return Failed("letters")
    if _farthest_step(job.formula) > MOST_STEPS_AHEAD:
        return Failed("steps")
    axioms = []
    for group in job.groups:
        axiom = spot_bridge.projected(group.known, propositions_of(job.formula))
        if axiom == Constant(False):
            return Failed("facts", contradiction=_contradiction(group))
        axioms += [axiom] if axiom != Constant(True) else []
    try:
        translation = spot_bridge.translate(job.formula, job.reads, job.semantics, axioms)
    except spot_bridge.CheckError:
        return Failed("check")
    possible = possible_letters(job.reads, joined(AND, axioms)) if axioms else None
    automaton = spot_bridge.explore(translation, job.reads)
    machine = build_machine(automaton, job.reads, possible)
    if not translation.is_checked and not agrees(machine, job.formula, job.semantics):
        return Failed("check")
    remarks = list(job.remarks)
    if translation.alive is not None:
        remarks.append(f'finite words: "{translation.alive}" is true as long as the word lasts')
    return Done(machine, spot_bridge.in_hoa(translation.automaton, job.name, remarks))


def _farthest_step(formula: Formula) -> Fraction:
    """The last step that a bound of a formula in steps names."""
    bounds = [operation.bound for operation in operations_of(formula)]
    ends = [bound.high or bound.low for bound in bounds if bound is not None]
    return max(ends, default=Fraction(0))


def _contradiction(group: AxiomGroup) -> tuple[AxiomInstance, ...]:
    from rulec.automata import spot_bridge  # Spot is loaded in the worker alone

    needed = group
    for instance in group.instances:
        without = tuple(other for other in needed.instances if other is not instance)
        fewer = replace(needed, instances=without)
        if spot_bridge.projected(fewer.known, ()) == Constant(False):
            needed = fewer
    return needed.instances


def _limit(kind: int, amount: int) -> None:
    _, most = resource.getrlimit(kind)
    amount = amount if most == resource.RLIM_INFINITY else min(amount, most)
    resource.setrlimit(kind, (amount, most))
