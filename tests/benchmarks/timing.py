"""How long things take, in turns: a busy moment of the machine meets all of them."""

from __future__ import annotations

import resource
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from figure import Figure

Timed = Callable[[], float]
"""Does something once and returns how long that took, in the unit of its figure."""

TURN_S = 0.01
"""A turn lasts at least so long: what is short is done several times in it, as `timeit` does."""


@dataclass(frozen=True)
class Taken:
    """The median of all rounds, and the least, which is nearest to a machine with nothing else."""

    median: float
    least: float

    def figure(self, what: str, unit: str, most: float | None = None) -> Figure:
        """A figure that stands alone."""
        return Figure(what, unit, self.median, self.least, most)

    def against(
        self,
        peer: Taken,
        name: str,
        what: str,
        unit: str,
        most: float | None = None,
        least_ratio: float | None = None,
    ) -> Figure:
        """A figure compared with a peer's."""
        ratio = peer.median / self.median
        return Figure(what, unit, self.median, self.least, most, name, ratio, least_ratio)


def processor_time(run: Callable[[], object], unit_ns: float = 1.0) -> Timed:
    """Processor time of this process, in units of so many nanoseconds."""

    def timed() -> float:
        start = time.process_time_ns()
        run()
        return (time.process_time_ns() - start) / unit_ns

    return timed


def children_ms() -> float:
    """Milliseconds of processor time of all processes that this one has started and seen end."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (used.ru_utime + used.ru_stime) * 1e3


def in_turns(tasks: Mapping[str, Timed], rounds: int) -> dict[str, Taken]:
    """What each task takes, in so many rounds after one that warms up."""
    times: dict[str, list[float]] = {name: [] for name in tasks}
    for turn in range(rounds + 1):
        for name, timed in tasks.items():
            taken = _mean_of_a_turn(timed)
            if turn:
                times[name].append(taken)
    return {name: Taken(statistics.median(all_), min(all_)) for name, all_ in times.items()}


def _mean_of_a_turn(timed: Timed) -> float:
    end = time.perf_counter() + TURN_S
    taken = [timed()]
    while time.perf_counter() < end:
        taken.append(timed())
    return statistics.mean(taken)


def once(timed: Timed) -> Taken:
    """What takes too long to be done often."""
    taken = timed()
    return Taken(taken, taken)
