"""The nodes of a graph's layers, one after the other."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from functools import cached_property
from itertools import accumulate, chain, pairwise
from typing import TypeVar

from rulec.trace import State, TraceGraph

Item = TypeVar("Item")


class NodesInTurn:
    """The nodes of all layers, one after the other, as if they were states of one trace."""

    def __init__(self, graph: TraceGraph) -> None:
        self._graph = graph
        self._begins = [0, *accumulate(map(len, graph.states))]

    @cached_property
    def states(self) -> tuple[State, ...]:
        """The states of all nodes."""
        return tuple(chain.from_iterable(self._graph.states))

    @cached_property
    def present(self) -> dict[str, tuple[int, int]]:
        """Among which nodes objects are that are not in all layers."""
        return {item: self.stretch(*layers) for item, layers in self._graph.present.items()}

    def stretch(self, first: int, last: int) -> tuple[int, int]:
        """The first and the last node of layers, both ends included."""
        return self._begins[first], self._begins[last + 1] - 1

    def layer_of(self, number: int) -> int:
        """The layer that a node is in."""
        return bisect_right(self._begins, number) - 1

    def by_layer(
        self, values: Sequence[Item], first: int, last: int
    ) -> tuple[tuple[Item, ...], ...]:
        """What nodes of layers have, by layer."""
        before = self._begins[first]
        bounds = [begin - before for begin in self._begins[first : last + 2]]
        return tuple([tuple(values[begin:end]) for begin, end in pairwise(bounds)])
