"""Worker process for Spot: jobs on standard input, tables on standard output.

It may use bounded time and memory only, and may die of either; the caller sees that it did.
"""

from __future__ import annotations

import pickle
import resource
import sys
import time
import traceback
from dataclasses import dataclass, replace
from typing import Literal

from rulec.automata.alphabet import AND, count_letters, joined, propositions_of
from rulec.automata.axiom_instances import AxiomGroup, AxiomInstance, possible_letters
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read
from rulec.automata.random_words import agrees
from rulec.automata.tables import build_machine
from rulec.logic.formula import Constant, Formula
from rulec.logic.semantics import Semantics

MEMORY_LIMIT_BYTES = 2 << 30
MOST_LETTERS = 1 << 16


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


@dataclass(frozen=True, slots=True)
class WorkerGreeting:
    """First message of a worker: Spot's version, or None and a ``problem``."""

    spot: str | None
    problem: str = ""


@dataclass(frozen=True, slots=True)
class Done:
    """A rule's machine, and its automaton in HOA."""

    machine: MealyMonitor
    hoa: str


@dataclass(frozen=True, slots=True)
class Failed:
    """Reason for no monitor: ``letters``, ``memory``, ``check``, ``facts`` or ``bug``.

    ``facts``: those of ``contradiction`` cannot hold together. ``bug`` is anything that nobody
    thought of, with the traceback.
    """

    why: Literal["letters", "memory", "check", "facts", "bug"]
    traceback: str = ""
    contradiction: tuple[AxiomInstance, ...] = ()


def main() -> None:
    """Answer jobs until standard input ends."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _limit(resource.RLIMIT_AS, MEMORY_LIMIT_BYTES)
    answers = sys.stdout.buffer
    try:
        from rulec.automata import spot_bridge  # Spot is loaded in the worker alone
    except ImportError as problem:
        pickle.dump(WorkerGreeting(None, str(problem)), answers)
        return
    pickle.dump(WorkerGreeting(spot_bridge.VERSION), answers)
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

    if count_letters(job.reads) > MOST_LETTERS:
        return Failed("letters")
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


def _contradiction(group: AxiomGroup) -> tuple[AxiomInstance, ...]:
    """Minimal set of a group's axioms that contradict each other."""
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
