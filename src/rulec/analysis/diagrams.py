"""Decision diagrams: functions of joint letters, each test once on a way, equal parts shared.

A multiple-valued variant of Bryant, "Graph-based algorithms for Boolean function manipulation"
(1986). A node is a number; nodes are equal if and only if their functions are.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from rulec.analysis.columns import Column
from rulec.analysis.joint import View

Children = tuple[int, ...]


class Diagrams:
    """All nodes of some diagrams."""

    def __init__(self) -> None:
        self._known: dict[tuple[float, Children], int] = {}
        self._nodes: list[tuple[float, Children]] = []

    def of(self, column: Column, views: Sequence[View]) -> int:
        """The diagram of a column: its class as a function of the joint digits."""
        strides = []
        stride = 1
        for read in column.reads:
            strides.append(stride)
            stride *= read.size
        by_level: dict[int, list[tuple[int, View]]] = {}
        for place, view in zip(strides, views, strict=True):
            by_level.setdefault(view.joint, []).append((place, view))
        return self._built(sorted(by_level.items()), 0, 0, column.letters)

    def _built(
        self,
        levels: Sequence[tuple[int, Sequence[tuple[int, View]]]],
        depth: int,
        offset: int,
        letters: Sequence[int],
    ) -> int:
        if depth == len(levels):
            return self._node(inf, (letters[offset],))
        level, read_here = levels[depth]
        known: dict[int, int] = {}
        children = []
        for digit in range(len(read_here[0][1].digits)):
            inner = offset + sum(stride * view.digits[digit] for stride, view in read_here)
            if inner not in known:
                known[inner] = self._built(levels, depth + 1, inner, letters)
            children.append(known[inner])
        return self._node(level, tuple(children))

    def _node(self, level: float, children: Children) -> int:
        if level < inf and len(set(children)) == 1:
            return children[0]
        key = (level, children)
        if key not in self._known:
            self._known[key] = len(self._nodes)
            self._nodes.append(key)
        return self._known[key]

    def level(self, node: int) -> float:
        """The joint read that a node tests; infinity for one that tests nothing any more."""
        return self._nodes[node][0]

    def child(self, node: int, level: float, digit: int) -> int:
        """What is left of a node when a joint read has this digit."""
        own, children = self._nodes[node]
        return children[digit] if own == level else node

    def value(self, node: int) -> int:
        """The class of a node that tests nothing any more."""
        return self._nodes[node][1][0]
