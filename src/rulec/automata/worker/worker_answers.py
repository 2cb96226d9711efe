"""Messages from a compiler's process: its abilities, then answers to jobs.

Without processes, as in a browser, this process computes the answers.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from rulec.automata.clocks.clocked_machine import ClockedMachine
from rulec.automata.compiler_jobs import Compiler, Done, Failed, Job
from rulec.automata.tables import MOST_STEPS_AHEAD
from rulec.automata.worker import compiler_choice
from rulec.automata.worker.confinement import Confinement
from rulec.automata.worker.job_answers import answer_to

HAS_PROCESSES = sys.platform != "emscripten"
"""A browser has no processes; a page that runs Python can end its worker instead."""

_MOST_REMEMBERED = 1 << 10


@dataclass(frozen=True, slots=True)
class WorkerGreeting:
    """The first message of a worker: Spot's version, or None and a ``problem`` if it cannot work.

    The version is empty if it works without Spot. ``confined``: what the worker is kept from.
    """

    spot: str | None
    problem: str = ""
    confined: Confinement | tuple[()] = ()


def chosen(choice: str) -> Compiler:
    """The compiler of a choice (empty: the default). ImportError if required Spot is missing."""
    if choice != compiler_choice.DIAGRAMS:
        try:
            # Spot is loaded only in the worker.
            from rulec.automata import spot_bridge

            return spot_bridge.COMPILER
        except ImportError:
            if choice == compiler_choice.SPOT:
                raise
    # The library may come with NetworkX, so it is loaded only where Spot is not used.
    from rulec.automata.decision_diagrams import diagram_compiler

    sys.setrecursionlimit(MOST_STEPS_AHEAD)
    return diagram_compiler.COMPILER


def answered(job: Job, compiler: Compiler) -> Done | ClockedMachine | Failed:
    """The answer to a job, whatever happens."""
    try:
        return answer_to(job, compiler)
    except (MemoryError, RecursionError):
        return Failed("memory")
    except Exception:
        return Failed("bug", traceback.format_exc())


def answered_here(jobs: Iterable[Job]) -> list[Done | ClockedMachine | Failed]:
    """Answers of decision diagrams in this process, without limits on time or memory.

    An editor asks for all rules of a rulebook again and again, so answers are remembered.
    """
    return [_remembered(job) for job in jobs]


@lru_cache(maxsize=_MOST_REMEMBERED)
def _remembered(job: Job) -> Done | ClockedMachine | Failed:
    return answered(job, chosen(compiler_choice.DIAGRAMS))
