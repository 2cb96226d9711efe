"""The nodes of a graph's layers as one sequence."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from functools import cached_property
from itertools import accumulate, chain, pairwise
from typing import TypeVar

from rulec.trace import State, TraceGraph

Item = TypeVar("Item")


class NodesInTurn:
    """The nodes of all layers in one sequence, as if they were the states of one trace."""

    def __init__(self, graph: TraceGraph) -> None:
        self._graph = graph
        self._begins = [0, *accumulate(map(len, graph.states))]

    @cached_property
    def states(self) -> tuple[State, ...]:
        """The states of all nodes."""
        return tuple(chain.from_iterable(self._graph.states))

    @cached_property
    def present(self) -> dict[str, tuple[int, int]]:
        """For each object that is not in all layers, the numbers of its first and last node."""
        return {item: self.stretch(*layers) for item, layers in self._graph.present.items()}

    def stretch(self, first: int, last: int) -> tuple[int, int]:
        """The numbers of the first and the last node of layers ``first`` to ``last``, inclusive."""
        return self._begins[first], self._begins[last + 1] - 1

    def layer_of(self, number: int) -> int:
        """The layer of a node."""
        return bisect_right(self._begins, number) - 1

    def by_layer(
        self, values: Sequence[Item], first: int, last: int
    ) -> tuple[tuple[Item, ...], ...]:
        """The nodes' ``values``, grouped by layer."""
        before = self._begins[first]
        bounds = [begin - before for begin in self._begins[first : last + 2]]
        return tuple([tuple(values[begin:end]) for begin, end in pairwise(bounds)])
