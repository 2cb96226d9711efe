"""Number of worker processes, and the time after which they start."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TypeVar

Task = TypeVar("Task")
Result = TypeVar("Result")

ALONE_S = 1.0
"""Work of fewer seconds is not worth starting a process, which takes about as long."""


@dataclass(frozen=True, slots=True)
class Jobs:
    """The number of processes, and how long (s) this one works alone before it starts others."""

    processes: int
    alone_s: float = 0.0


@dataclass(frozen=True, slots=True)
class LostTask:
    """A task whose process was killed twice before it was done; the signal, if known."""

    signal_number: int | None


ALONE = Jobs(1)
"""This process does all of the work."""


def chosen_jobs(number: int | None) -> Jobs:
    """``number`` processes; 0 is one per processor, None the same if the work takes long enough."""
    if number is None:
        return Jobs(available_processors(), ALONE_S)
    return Jobs(number or available_processors())


def available_processors() -> int:
    """The number of processors on which this process may run."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
