"""The outlines of many bodies concatenated, so that all are projected in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.recordings.recording import Points

_REACH_FACTOR, _REACH_MORE_M = 2.0, 3.0


@dataclass(frozen=True, eq=False)
class JoinedOutlines:
    """Concatenated outlines: the ``corners`` of all (m), and how many each has, at least 1."""

    corners: Points
    counts: NDArray[intp]

    @classmethod
    def of(cls, outlines: Sequence[Points]) -> JoinedOutlines:
        """Join outlines; at least one is needed."""
        return cls(np.concatenate(outlines), np.array([len(outline) for outline in outlines]))

    @classmethod
    def of_bodies(cls, bodies: Sequence[NDArray[float64] | Sequence[Points]]) -> JoinedOutlines:
        """Join the outlines of bodies; at least one is needed.

        The outlines of a rigid body may be one array (axes: moment, corner, and x and y).
        """
        corners: list[Points] = []
        counts: list[int] = []
        repeats: list[int] = []
        for own in bodies:
            if isinstance(own, np.ndarray):
                corners.append(own.reshape(-1, 2))
                counts.append(own.shape[1])
                repeats.append(len(own))
            else:
                corners += own
                counts += map(len, own)
                repeats += [1] * len(own)
        return cls(np.concatenate(corners), np.repeat(counts, repeats))

    def part(self, own: slice) -> JoinedOutlines:
        """Some consecutive outlines, at least one."""
        counts, begin = self.counts[own], self.starts[own][0]
        return JoinedOutlines(self.corners[begin : begin + counts.sum()], counts)

    @cached_property
    def starts(self) -> NDArray[intp]:
        """The index of each outline's first corner."""
        return np.append(0, self.counts.cumsum()[:-1])

    @cached_property
    def middles(self) -> Points:
        """The mean of each outline's corners."""
        middles: Points = np.add.reduceat(self.corners, self.starts) / self.counts[:, None]
        return middles

    @cached_property
    def reach(self) -> NDArray[float64]:
        """How far (m) along a line the corners' feet may be from that of an outline's middle."""
        x, y = self.corners.T - self.middles.T.repeat(self.counts, axis=1)
        farthest = np.sqrt(np.maximum.reduceat(x * x + y * y, self.starts))
        reach: NDArray[float64] = farthest * _REACH_FACTOR + _REACH_MORE_M
        return reach

    def least_and_greatest(
        self, values: NDArray[float64]
    ) -> tuple[NDArray[float64], NDArray[float64]]:
        """Least and greatest of the corners' values (a row per coordinate), a row per outline."""
        bounds = (f.reduceat(values, self.starts, axis=1).T for f in (np.minimum, np.maximum))
        least, greatest = bounds
        return least, greatest
