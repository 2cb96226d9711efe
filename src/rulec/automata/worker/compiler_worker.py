"""Worker process of the compilers: jobs on standard input, tables on standard output.

It may use bounded time and memory only, and may die of either; the caller sees that it did.
"""

from __future__ import annotations

import pickle
import resource
import sys
import time
import traceback
from contextlib import suppress
from dataclasses import dataclass

from rulec.automata.compiler_jobs import MOST_STEPS_AHEAD, Compiler, Failed, Job
from rulec.automata.worker.compiler_choice import DIAGRAMS, SPOT
from rulec.automata.worker.confinement import Confinement
from rulec.automata.worker.job_answers import answer_to

MEMORY_LIMIT_BYTES = 2 << 30


@dataclass(frozen=True, slots=True)
class WorkerGreeting:
    """First message of a worker: Spot's version, or None and a ``problem`` if it cannot work.

    The version is empty if it works without Spot. ``confined``: what the worker is kept from.
    """

    spot: str | None
    problem: str = ""
    confined: Confinement | tuple[()] = ()


def main(confined: Confinement, choice: str) -> None:
    """Answer jobs until standard input ends, by the compiler that is chosen."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # Not every system that is not Linux has such a limit.
    with suppress(OSError, ValueError):
        _limit(resource.RLIMIT_AS, MEMORY_LIMIT_BYTES)
    answers = sys.stdout.buffer
    try:
        compiler = chosen(choice)
    except ImportError as problem:
        pickle.dump(WorkerGreeting(None, str(problem)), answers)
        return
    pickle.dump(WorkerGreeting(compiler.version, confined=confined), answers)
    answers.flush()
    while True:
        try:
            job: Job = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        _limit(resource.RLIMIT_CPU, int(time.process_time()) + 1 + job.cpu_s)
        try:
            answer = answer_to(job, compiler)
        except (MemoryError, RecursionError):
            answer = Failed("memory")
        except Exception:
            answer = Failed("bug", traceback.format_exc())
        pickle.dump(answer, answers)
        answers.flush()


def chosen(choice: str) -> Compiler:
    """The compiler of a choice, empty for the usual one.

    Raises ImportError if it has to be Spot, and that is not there.
    """
    if choice != DIAGRAMS:
        try:
            # Spot is loaded in the worker alone.
            from rulec.automata import spot_bridge

            return spot_bridge.COMPILER
        except ImportError:
            if choice == SPOT:
                raise
    # The library comes with NetworkX: only where Spot does not translate.
    from rulec.automata.decision_diagrams import diagram_compiler

    sys.setrecursionlimit(MOST_STEPS_AHEAD)
    return diagram_compiler.COMPILER


def _limit(kind: int, amount: int) -> None:
    _, most = resource.getrlimit(kind)
    amount = amount if most == resource.RLIM_INFINITY else min(amount, most)
    resource.setrlimit(kind, (amount, most))
