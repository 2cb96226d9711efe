"""Reduced ordered decision diagrams of functions of joint letters.

A multiple-valued variant of Bryant, "Graph-based algorithms for Boolean function manipulation"
(1986): each read is tested once on a path, and equal subdiagrams are shared. A node is a number;
nodes are equal if and only if their functions are.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache, reduce
from math import inf
from operator import or_

from rulec.witnesses.joint_reads import JointDigits
from rulec.witnesses.letter_functions import LetterFunction

Children = tuple[int, ...]


class _Nodes:
    """The unique table: every node exists once. The only child of a leaf is its class."""

    def __init__(self) -> None:
        self._known: dict[tuple[float, Children], int] = {}
        self._nodes: list[tuple[float, Children]] = []

    def add(self, level: float, *children: int) -> int:
        """The node that tests a level, or a leaf, whose level is infinity."""
        if level != inf and children.count(children[0]) == len(children):
            return children[0]
        key = (level, children)
        node = self._known.get(key)
        if node is None:
            node = self._known[key] = len(self._nodes)
            self._nodes.append(key)
        return node

    def level(self, nodes: Iterable[int]) -> float:
        """The index of the first read that any of some nodes tests; infinity for leaves."""
        known = self._nodes
        return min([known[node][0] for node in nodes])

    def is_open(self, node: int) -> bool:
        """Whether a node tests something, so that it is not a leaf."""
        return self._nodes[node][0] != inf

    def value(self, node: int) -> int:
        """The class of a leaf."""
        return self._nodes[node][1][0]


class _OwnDiagram(_Nodes):
    """Decision diagram of a function over its own reads, last read first."""

    def __init__(self, letters: Sequence[int], sizes: Sequence[int]) -> None:
        super().__init__()
        self._after: dict[tuple[int, int, int], int] = {}
        leaves = {symbol: self.add(inf, symbol) for symbol in dict.fromkeys(letters)}
        nodes = [leaves[symbol] for symbol in letters]
        for place, size in enumerate(sizes):
            groups = list(zip(*[iter(nodes)] * size, strict=True))
            added = {group: self.add(place, *group) for group in dict.fromkeys(groups)}
            nodes = [added[group] for group in groups]
        (self.root,) = nodes

    def after(self, node: int, place: int, digit: int) -> int:
        """The restriction of a node to one digit of a read."""
        own, children = self._nodes[node]
        if own == place:
            return children[digit]
        if own == inf or own < place:
            return node
        key = (node, place, digit)
        if key not in self._after:
            inner = [self.after(child, place, digit) for child in children]
            self._after[key] = self.add(own, *inner)
        return self._after[key]


@lru_cache(maxsize=1024)
def _own_diagram(letters: bytes | tuple[int, ...], sizes: tuple[int, ...]) -> _OwnDiagram:
    """The diagram of a letter function; cached, because a rule is compared with many others."""
    return _OwnDiagram(letters, sizes)


class DecisionDiagrams(_Nodes):
    """All nodes of some diagrams over the same joint reads.

    ``false`` and ``true`` are the leaves of functions with classes 0 and 1 only.
    """

    def __init__(self) -> None:
        super().__init__()
        self._supports: list[int] = []
        self.false, self.true = self.add(inf, 0), self.add(inf, 1)

    def of(self, function: LetterFunction, views: Sequence[JointDigits]) -> int:
        """The diagram of a function in terms of the joint digits."""
        own = _own_diagram(function.letters, tuple(read.size for read in function.reads))
        by_level: dict[int, list[tuple[int, JointDigits]]] = {}
        for place, view in enumerate(views):
            by_level.setdefault(view.joint, []).append((place, view))
        levels = sorted(by_level.items())
        known: dict[tuple[int, int], int] = {}

        def built(node: int, depth: int) -> int:
            if depth == len(levels):
                return self.add(inf, own.value(node))
            if (node, depth) not in known:
                level, here = levels[depth]
                children = []
                for digit in range(len(here[0][1].digits)):
                    inner = node
                    for place, view in here:
                        inner = own.after(inner, place, view.digits[digit])
                    children.append(built(inner, depth + 1))
                known[node, depth] = self.add(level, *children)
            return known[node, depth]

        return built(own.root, 0)

    def restricted(self, nodes: Sequence[int], level: float, size: int) -> list[tuple[int, ...]]:
        """The restrictions of nodes to each of the digits of a joint read."""
        known = self._nodes
        rows = [
            children if own == level else (node,) * size
            for node in nodes
            for own, children in (known[node],)
        ]
        return list(zip(*rows, strict=True))

    def open_axioms(self, nodes: Iterable[int]) -> tuple[int, ...] | None:
        """The distinct functions among some that are not yet true; None if one is false."""
        left = {*nodes}
        if self.false in left:
            return None
        left.discard(self.true)
        return tuple(sorted(left))

    def support(self, nodes: Iterable[int]) -> int:
        """A bit set of the joint reads on which functions of some nodes depend."""
        supports = self._supports
        # Children have smaller numbers than their parents.
        for level, children in self._nodes[len(supports) :]:
            own = 0 if level == inf else 1 << int(level)
            supports.append(reduce(or_, [supports[child] for child in children], own) if own else 0)
        return reduce(or_, [supports[node] for node in nodes], 0)
