"""The outlines of bodies end to end, so that all are projected together."""

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
    """Outlines end to end: the ``corners`` of all (m), and how many each one has, at least one."""

    corners: Points
    counts: NDArray[intp]

    @classmethod
    def of(cls, outlines: Sequence[Points]) -> JoinedOutlines:
        """Join outlines, of which there is one at least."""
        return cls(np.concatenate(outlines), np.array([len(outline) for outline in outlines]))

    @classmethod
    def of_bodies(cls, bodies: Sequence[NDArray[float64] | Sequence[Points]]) -> JoinedOutlines:
        """Join the outlines of bodies, of which there is one at least.

        Those of a rigid body may be one array (axes: moment, corner, and x and y).
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

    @cached_property
    def regular(self) -> bool:
        """True if all have as many corners."""
        return bool((self.counts == self.counts[0]).all())

    @cached_property
    def starts(self) -> NDArray[intp]:
        """The number of the first corner of each."""
        return np.append(0, self.counts.cumsum()[:-1])

    @cached_property
    def middles(self) -> Points:
        """The mean of the corners of each."""
        middles: Points = np.add.reduceat(self.corners, self.starts) / self.counts[:, None]
        return middles

    @cached_property
    def reach(self) -> NDArray[float64]:
        """How far (m) along a line the feet of corners may be from their middle's, for each."""
        x, y = self.corners.T - self.middles.T.repeat(self.counts, axis=1)
        farthest = np.sqrt(np.maximum.reduceat(x * x + y * y, self.starts))
        reach: NDArray[float64] = farthest * _REACH_FACTOR + _REACH_MORE_M
        return reach

    def least_and_greatest(
        self, values: NDArray[float64]
    ) -> tuple[NDArray[float64], NDArray[float64]]:
        """The bounds of the corners' values (a row of each kind): a row for each outline."""
        bounds = (f.reduceat(values, self.starts, axis=1).T for f in (np.minimum, np.maximum))
        least, greatest = bounds
        return least, greatest
