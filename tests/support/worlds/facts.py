"""What is true of a vehicle under a rule, by the simulator's state."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Fact:
    """A violation from a time to another (s); if it is not ``sure``, nobody is blamed or missed."""

    vehicle: str
    rule: str
    begin: float
    end: float
    sure: bool
    why: str = ""


def runs(mask):
    """The first and last indices of stretches where a mask holds."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], np.asarray(mask, dtype=int), [0]))))
    return [(begin, end - 1) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


def graded(world, track, rule, masks):
    """Facts where a violation is sure for so long, and unsure ones where it may be.

    ``masks``: sure, possible, and the least duration (s) of a sure one.
    """
    sure, possible, least_s = masks
    for begin, end in runs(possible):
        within = [
            (a, b) for a, b in runs(sure[begin : end + 1]) if (b - a) * world.step_s >= least_s
        ]
        times = (world.time(track, begin), world.time(track, end))
        yield Fact(track.id, rule, *times, bool(within))
