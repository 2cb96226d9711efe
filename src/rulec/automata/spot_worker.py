"""A process of its own that asks Spot: jobs come in on standard input, tables go out on the other.

It may use bounded time and memory only, and may die of either; the caller sees that it did.
"""

from __future__ import annotations

import pickle
import resource
import sys
import time
import traceback
from dataclasses import dataclass
from typing import Literal

from rulec.automata.letters import count_letters
from rulec.automata.machine import Machine, NumberRead, Read
from rulec.automata.sampling import agrees
from rulec.automata.tables import build_machine
from rulec.logic.formula import Formula
from rulec.logic.semantics import Semantics

MEMORY_LIMIT_BYTES = 2 << 30
MOST_LETTERS = 1 << 16


@dataclass(frozen=True, slots=True)
class Job:
    """One rule to translate, its bounds in steps.

    ``cpu_s``: the processor time it may use, in whole seconds.
    """

    name: str
    formula: Formula
    reads: tuple[Read | NumberRead, ...]
    remarks: tuple[str, ...]
    semantics: Semantics
    cpu_s: int


@dataclass(frozen=True, slots=True)
class Ready:
    """The worker's first word: Spot's version, or None and why Spot can't be loaded."""

    spot: str | None
    problem: str = ""


@dataclass(frozen=True, slots=True)
class Done:
    """A rule's machine, and its automaton in HOA."""

    machine: Machine
    hoa: str


@dataclass(frozen=True, slots=True)
class Failed:
    """No machine: too many ``letters``, too much ``memory``, the automaton failed its ``check``.

    ``bug`` is anything that nobody thought of, with the traceback.
    """

    why: Literal["letters", "memory", "check", "bug"]
    traceback: str = ""


def main() -> None:
    """Answer jobs until standard input ends."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _limit(resource.RLIMIT_AS, MEMORY_LIMIT_BYTES)
    answers = sys.stdout.buffer
    try:
        from rulec.automata import spot_bridge
    except ImportError as problem:
        pickle.dump(Ready(None, str(problem)), answers)
        return
    pickle.dump(Ready(spot_bridge.VERSION), answers)
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
    from rulec.automata import spot_bridge

    n_letters = count_letters(job.reads)
    if n_letters > MOST_LETTERS:
        return Failed("letters")
    try:
        found = spot_bridge.translate(job.formula, job.reads, job.semantics)
    except spot_bridge.CheckError:
        return Failed("check")
    machine = build_machine(spot_bridge.explore(found, job.reads), job.reads, n_letters)
    if not found.is_checked and not agrees(machine, job.formula, job.semantics):
        return Failed("check")
    remarks = list(job.remarks)
    if found.alive is not None:
        remarks.append(f'finite words: "{found.alive}" is true as long as the word lasts')
    return Done(machine, spot_bridge.in_hoa(found.automaton, job.name, remarks))


def _limit(kind: int, amount: int) -> None:
    _, most = resource.getrlimit(kind)
    amount = amount if most == resource.RLIM_INFINITY else min(amount, most)
    resource.setrlimit(kind, (amount, most))
