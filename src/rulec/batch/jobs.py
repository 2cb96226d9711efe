"""Number of worker processes, and the time after which they start."""

from __future__ import annotations

import os
from dataclasses import dataclass

ALONE_S = 1.0
"""So many seconds of work are not worth the start of a process, which takes about as long."""


@dataclass(frozen=True, slots=True)
class Jobs:
    """How many processes may work, and how long this one works alone before it starts others."""

    processes: int
    alone_s: float = 0.0


def chosen_jobs(number: int | None) -> Jobs:
    """So many processes; 0 is one for each processor, None the same where it is worth it."""
    if number is None:
        return Jobs(available_processors(), ALONE_S)
    return Jobs(number or available_processors())


def available_processors() -> int:
    """How many processors this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
