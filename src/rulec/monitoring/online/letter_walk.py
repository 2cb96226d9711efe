"""Letters with unknown reads, found by walks through a rule's letter diagram.

A node is a set of the diagram's nodes: all that the digits so far may lead to. Nodes and edges are
built on demand, so that a new letter costs one look-up per read.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.monitoring.online.encoding.encoded_values import PARTIAL_DIGITS
from rulec.monitoring.online.four_valued import LetterClass
from rulec.monitoring.uncertainty.state_letters.letter_diagram import LetterDiagram

if TYPE_CHECKING:
    from rulec.monitoring.uncertainty.state_letters.read_digits import Cube

MOST_NODES = 1 << 14
"""How many nodes of a rule are kept before all are discarded."""


_NOTHING: tuple[int, Sequence[Cube]] = -1, ()


class WholeStateError(LookupError):
    """The letters that a rule may read depend on more than its own objects."""


class WalkedRead(NamedTuple):
    """A read with a digit of its own: its ``place`` among the rule's reads.

    ``masks`` are the possible digits, as bits, of a digit or a range of digits.
    ``decided_alone``: nothing else influences which of them it has. ``is_constant``: it is the same
    in every state.
    """

    place: int
    masks: Any
    decided_alone: bool
    is_constant: bool


class _Node(dict[Any, "_Node"]):
    """The nodes that digits may lead to.

    After the last digit the classes, and whether they are exact.
    """

    __slots__ = ("answer", "begin", "is_exact", "level", "sets", "walk")

    def __init__(
        self,
        walk: LetterWalk,
        level: int,
        begin: tuple[int, Sequence[Cube]],
        sets: tuple[int, ...],
        *,
        is_exact: bool,
    ) -> None:
        self.walk, self.level, self.begin, self.sets = walk, level, begin, sets
        self.is_exact = is_exact
        self.answer: tuple[LetterClass, bool] | None = None

    def __missing__(self, digit: Any) -> _Node:
        node = self[digit] = self.walk.step(self, digit)
        return node


class LetterWalk:
    """The walks through one rule's diagram.

    ``reads`` have digits of their own; the ``others`` have their digits, as bits, in each of the
    cubes with which a walk begins, and ``cubes_at`` has these by number. ``class_of`` is the class,
    or set of classes, that bits stand for.
    """

    def __init__(
        self,
        diagram: LetterDiagram,
        reads: Sequence[WalkedRead],
        others: Sequence[int],
        cubes_at: Callable[[int], Sequence[Cube]],
        class_of: Callable[[int], LetterClass | None],
    ) -> None:
        self._diagram = diagram
        self._reads = {read.place: read for read in reads}
        self._others = {place: n for n, place in enumerate(others)}
        self._class_of = class_of
        # The last read is the diagram's first level.
        self._order = range(len(reads) + len(others) - 1, -1, -1)
        # After this level no cube has a digit.
        self._n_begun = len(self._order) - min(others, default=len(self._order))
        self._cubes_at = cubes_at
        self._nodes: dict[Hashable, _Node] = {}
        self._starts: dict[int, _Node] = {}

    def classes(
        self, digits: Sequence[Any], begin: int = 0, *, is_exact: bool = True
    ) -> tuple[LetterClass, bool]:
        """The classes of the letters with these digits, and whether this is exact.

        ``digits`` are in the order of the reads; ``begin`` is the number of the cubes of the
        others. Raises LookupError if a digit is invalid or if axioms exclude all these letters, and
        WholeStateError if they depend on more than the rule's own objects.
        """
        node = self._starts.get(2 * begin + is_exact)
        if node is None:
            node = self._begun(begin, is_exact)
        try:
            for digit in reversed(digits):
                node = node[digit]
        except WholeStateError:
            # Any other digit is valid.
            for place, digit in zip(sorted(self._reads), digits, strict=True):
                self._reads[place].masks[digit]
            raise
        if node.answer is None:
            raise LookupError
        return node.answer

    def step(self, node: _Node, digit: Any) -> _Node:
        """The node after a digit of the next read that has its own. Raises like ``classes``."""
        place = self._order[node.level]
        read = self._reads[place]
        mask = read.masks[digit]
        if mask & (mask - 1) and not read.decided_alone:
            raise WholeStateError
        is_exact = node.is_exact and not (read.is_constant and type(digit) in PARTIAL_DIGITS)
        sets = tuple([self._diagram.step(place, here, mask) for here in node.sets])
        return self._node(node.level + 1, node.begin, sets, is_exact)

    def _begun(self, number: int, is_exact: bool) -> _Node:
        cubes = self._cubes_at(number)
        node = self._node(0, (number, cubes), (self._diagram.start,) * len(cubes), is_exact)
        self._starts[2 * number + is_exact] = node
        return node

    def _node(
        self,
        level: int,
        begin: tuple[int, Sequence[Cube]],
        sets: tuple[int, ...],
        is_exact: bool,
    ) -> _Node:
        """The node after the next reads without digits of their own."""
        number, cubes = begin
        while level < len(self._order) and (place := self._order[level]) in self._others:
            own = self._others[place]
            sets = tuple(
                [
                    self._diagram.step(place, here, cube[own])
                    for here, cube in zip(sets, cubes, strict=True)
                ]
            )
            level += 1
        if level >= self._n_begun:
            # The remaining digits are the same for all cubes.
            whole = 0
            for here in sets:
                whole |= here
            sets, number, begin = (whole,), -1, _NOTHING
        key = level, number, sets, is_exact
        known = self._nodes.get(key)
        if known is None:
            if len(self._nodes) >= MOST_NODES:
                self._nodes.clear()
                self._starts.clear()
            known = self._nodes[key] = _Node(self, level, begin, sets, is_exact=is_exact)
            if level == len(self._order):
                letter_class = self._class_of(sets[0] >> 1)
                if letter_class is not None and letter_class != IMPOSSIBLE:
                    known.answer = letter_class, is_exact
        return known
