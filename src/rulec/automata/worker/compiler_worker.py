"""The compilers' worker process: jobs on standard input, tables on standard output.

It has limits on time and memory and may die of either; the caller notices.
"""

from __future__ import annotations

import pickle
import resource
import sys
import time
from contextlib import suppress
from math import ceil, isfinite

from rulec.automata.worker.confinement import Confinement
from rulec.automata.worker.worker_answers import WorkerGreeting, answered, chosen

MEMORY_LIMIT_BYTES = 2 << 30


def main(confined: Confinement, choice: str) -> None:
    """Answer jobs with the chosen compiler until standard input ends."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # Not every system other than Linux has this limit.
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
            job, most_s = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        began = time.process_time()
        if isfinite(most_s):
            _limit(resource.RLIMIT_CPU, ceil(began + most_s))
        answer = answered(job, compiler)
        pickle.dump((answer, time.process_time() - began), answers)
        answers.flush()


def _limit(kind: int, amount: int) -> None:
    _, most = resource.getrlimit(kind)
    amount = amount if most == resource.RLIM_INFINITY else min(amount, most)
    resource.setrlimit(kind, (amount, most))
