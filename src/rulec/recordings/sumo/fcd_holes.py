"""TrackHoles in floating-car data: teleports of SUMO's, and states that are missing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy import float64, int64, intp
from numpy.typing import NDArray

from rulec.recordings.mending.cut_tracks import cut_remark, first_ids
from rulec.recordings.mending.short_holes import HOLES_WHY, TrackHoles, holes_of

_MOVING_MPS = 1.0
"""SUMO takes out vehicles that wait for too long; of one that moves, states are missing."""


class FcdGrid(NamedTuple):
    """The time step of each moment of a file, and its length (s)."""

    steps: Sequence[int]
    step_s: float


@dataclass(slots=True)
class FcdHoles:
    """The ids of vehicles with holes: cut there, or not recorded while they drive.

    Persons are away while they ride.
    """

    cut: list[str] = field(default_factory=list)
    jumped: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)

    def note(self, key: str, found: TrackHoles, speeds: NDArray[float64]) -> None:
        """Count the holes of a vehicle, whose speeds (m/s) are given by row."""
        if len(found.longer):
            self.cut.append(key)
        if len(found.with_jumps):
            self.jumped.append(key)
        if len(found.short) or (speeds[found.longer] > _MOVING_MPS).any():
            self.missing.append(key)

    def remarks(self) -> Iterator[str]:
        """What the recording says of them."""
        if self.cut:
            yield cut_remark(self.cut, HOLES_WHY)
        if self.jumped:
            yield cut_remark(self.jumped, "holes in which it jumps")
        if self.missing:
            yield (
                "vehicles are missing while they drive, so others may be missing, too, and it is "
                f"unknown whether all traffic is recorded: {first_ids(self.missing)}"
            )


def holes_of_rows(
    steps: NDArray[int64], rows: NDArray[float64], step_s: float
) -> TrackHoles | None:
    """The holes of a track, if there are any; ``rows``: x, y (m), angle (degrees), speed (m/s)."""
    if int(steps[-1] - steps[0]) < len(steps):
        return None
    x, y, angle, speed = rows.T
    return holes_of(steps, np.stack((x, y, np.pi / 2 - np.radians(angle), speed), axis=1), step_s)


def starts_of(holes: TrackHoles | None) -> NDArray[intp]:
    """The rows at which a track begins: the first, and each after a cut."""
    if holes is None:
        return np.zeros(1, dtype=intp)
    cuts = np.concatenate((holes.longer, holes.with_jumps)) + 1
    return np.append(0, np.sort(cuts))
