"""Pairs of objects of traces end to end, and where the values about each pair are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rulec.array_types import Indices
from rulec.trace.trace_arrays import starts_of


@dataclass(frozen=True, eq=False)
class ObjectPairs:
    """Pairs of ``objects`` (pairs x 2) that something is said about, of ``n_objects``.

    ``spans`` (pairs x 2) are the first and last state, among all, in which both are present. Values
    lie pair by pair; those of all other pairs have one place, behind these.
    """

    objects: Indices
    n_objects: int
    spans: Indices

    @cached_property
    def starts(self) -> Indices:
        """Where the values of each pair begin, and where those of the last one end."""
        return starts_of(self.spans)

    @cached_property
    def state_of(self) -> Indices:
        """The state of each value."""
        lengths = self.starts[1:] - self.starts[:-1]
        states: Indices = np.arange(self.starts[-1])
        return states + (self.spans[:, 0] - self.starts[:-1]).repeat(lengths)

    @cached_property
    def _order(self) -> tuple[Indices, Indices]:
        """The pairs' numbers, ascending, and the pairs in this order."""
        numbers = self._numbers(self.objects[:, 0], self.objects[:, 1])
        order = numbers.argsort()
        return numbers[order], order

    def _numbers(self, first: Indices, second: Indices) -> Indices:
        return first * self.n_objects + second

    def places(self, first: Indices, second: Indices, states: Indices) -> Indices:
        """Where the values about pairs of objects in some states are."""
        known, order = self._order
        end = self.starts[-1]
        if not len(known):
            return np.full(len(states), end)
        numbers = self._numbers(first, second)
        at = known.searchsorted(numbers).clip(max=len(known) - 1)
        pairs = order[at]
        places: Indices = states + (self.starts[:-1] - self.spans[:, 0])[pairs]
        return np.where(known[at] == numbers, places, end)
