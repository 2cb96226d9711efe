"""Ways through decision diagrams with the fewest digits that are not defaults.

Groups of nodes that share no read are searched separately, since their choices are independent.
Nodes of settled classes are dropped, so that a search is the same whatever has been settled.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from operator import itemgetter

from rulec.witnesses.diagrams.decision_diagrams import DecisionDiagrams
from rulec.witnesses.undecided import UndecidedError

MOST_NODES = 200_000

Nodes = tuple[int, ...]

Ways = Mapping[tuple[int, ...], tuple[int, int]]
"""For each tuple of classes the least number of non-default digits, and the digits chosen.

In the order of the first ways to them: smaller digits at earlier levels first.
"""

_BITS = 16
_DIGIT = (1 << _BITS) - 1


def chosen_digit(level: int, digit: int) -> int:
    """A number that encodes one chosen digit; several, at different levels, are added."""
    return (digit + 1) << level * _BITS


def digits_chosen(chosen: int) -> list[tuple[int, int]]:
    """The levels, in order, with the digit chosen at each."""
    digits, level = [], 0
    while chosen:
        if chosen & _DIGIT:
            digits.append((level, (chosen & _DIGIT) - 1))
        chosen >>= _BITS
        level += 1
    return digits


@dataclass(frozen=True, slots=True)
class Choices:
    """For each level the number of digits, and the default one."""

    sizes: Sequence[int]
    defaults: Sequence[int | None]


@dataclass(frozen=True, slots=True)
class _Parts:
    """Nodes divided into groups that share reads.

    Distinct open ``keys``, the axioms ``around`` them, and groups of axioms ``apart``. ``whole``
    builds the classes of all keys from those of the open ones, followed by the ``settled``; None if
    these are the same.
    """

    keys: Nodes
    around: Nodes
    apart: Sequence[Nodes]
    settled: tuple[int, ...]
    whole: Callable[[tuple[int, ...]], tuple[int, ...]] | None


class WaySearch:
    """A search for the plainest ways, which reports its steps to ``take``.

    Raises UndecidedError if there are too many ways.
    """

    def __init__(
        self, diagrams: DecisionDiagrams, choices: Choices, take: Callable[[int], None]
    ) -> None:
        self._diagrams, self._choices, self._take = diagrams, choices, take
        self._known: dict[tuple[Nodes, Nodes], Ways] = {}
        self._divided: dict[tuple[Nodes, Nodes], _Parts] = {}
        self._n_nodes = 0

    def ways(self, keys: Nodes, axioms: Nodes) -> Ways:
        """The plainest way to each tuple of classes of the keys such that no axiom is violated."""
        parts = self._divided.get((keys, axioms))
        if parts is None:
            parts = self._divided[keys, axioms] = self._parts(keys, axioms)
        cost = chosen = 0
        for group in parts.apart:
            alone = self._walked((), group).get(())
            if alone is None:
                return {}
            cost, chosen = cost + alone[0], chosen + alone[1]
        whole, settled = parts.whole, parts.settled
        if not parts.keys:
            return {settled: (cost, chosen)}
        ways = self._walked(parts.keys, parts.around)
        if whole is not None:
            return {
                whole(classes + settled): (cost + more, chosen + digits)
                for classes, (more, digits) in ways.items()
            }
        if not chosen:
            return ways
        return {classes: (cost + more, chosen + digits) for classes, (more, digits) in ways.items()}

    def _parts(self, keys: Nodes, axioms: Nodes) -> _Parts:
        diagrams = self._diagrams
        open_keys = tuple(dict.fromkeys(filter(diagrams.is_open, keys)))
        settled = tuple([diagrams.value(key) for key in keys if not diagrams.is_open(key)])
        whole = None
        if open_keys and open_keys != keys:
            numbers = count(len(open_keys))
            # There are at least two keys, some open and some not, so itemgetter gives a tuple.
            whole = itemgetter(
                *(open_keys.index(key) if key in open_keys else next(numbers) for key in keys)
            )
        around, *apart = self._groups(open_keys, axioms)
        return _Parts(open_keys, around, apart, settled, whole)

    def _groups(self, keys: Nodes, axioms: Nodes) -> list[Nodes]:
        """The axioms connected with the keys by shared reads, then further connected groups."""
        support = self._diagrams.support
        left = {axiom: support((axiom,)) for axiom in axioms}
        reached, groups = support(keys), []
        while True:
            group: list[int] = []
            while more := [axiom for axiom, own in left.items() if own & reached]:
                group += more
                for axiom in more:
                    reached |= left.pop(axiom)
            groups.append(tuple(sorted(group)))
            if not left:
                return groups
            reached = next(iter(left.values()))

    def _walked(self, keys: Nodes, axioms: Nodes) -> Ways:
        """The ways for distinct open keys and the axioms connected with them."""
        choices, diagrams = self._choices, self._diagrams
        nodes = keys + axioms
        known = self._known.get((keys, axioms))
        if known is not None:
            return known
        self._n_nodes += 1
        if self._n_nodes > MOST_NODES:
            raise UndecidedError("too many different states of the world have to be distinguished")
        level = int(diagrams.level(nodes))
        default = choices.defaults[level]
        ways: dict[tuple[int, ...], tuple[int, int]] = {}
        rows = diagrams.restricted(nodes, level, choices.sizes[level])
        for digit in range(choices.sizes[level]):
            left = diagrams.open_axioms(rows[digit][len(keys) :])
            if left is None:
                continue
            own, step = int(default is not None and digit != default), chosen_digit(level, digit)
            for classes, (cost, chosen) in self.ways(rows[digit][: len(keys)], left).items():
                fewest = ways.get(classes)
                if fewest is None or own + cost < fewest[0]:
                    ways[classes] = own + cost, chosen + step
        self._known[keys, axioms] = ways
        self._take(len(ways))
        return ways
