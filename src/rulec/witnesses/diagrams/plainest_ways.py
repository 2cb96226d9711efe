"""Ways through decision diagrams with fewest digits other than default ones.

Nodes that share no read are walked apart, for what one of them chooses is nothing to the others.
Those of settled classes are left behind, so that a walk is the same whatever has been settled.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import count
from operator import itemgetter

from rulec.witnesses.diagrams.decision_diagrams import DecisionDiagrams
from rulec.witnesses.undecided import UndecidedError

MOST_NODES = 200_000

Nodes = tuple[int, ...]

Ways = Mapping[tuple[int, ...], tuple[int, int]]
"""For some classes how many digits are not the default ones, at least, and the digits chosen.

They come in the order of the first ways to them: smaller digits at earlier levels first.
"""

_BITS = 16
_DIGIT = (1 << _BITS) - 1


def chosen_digit(level: int, digit: int) -> int:
    """The number of one chosen digit; of several, at different levels, it is the sum."""
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
    """The number of digits, those that may be chosen, and the default one, of each level.

    At the ``usual`` levels, the bits of an integer, there is a single one, the default.
    """

    sizes: Sequence[int]
    digits: Sequence[Sequence[int]]
    defaults: Sequence[int | None]
    usual: int = 0


@dataclass(frozen=True, slots=True)
class _Parts:
    """What hangs together among some nodes.

    Open ``keys``, each once, with the axioms ``around`` them, and groups of axioms ``apart``.
    ``whole`` picks the classes of all keys from those of open ones, followed by the ``settled``; it
    is None if they are the same.
    """

    keys: Nodes
    around: Nodes
    apart: Sequence[Nodes]
    settled: tuple[int, ...]
    whole: Callable[[tuple[int, ...]], tuple[int, ...]] | None


@dataclass(frozen=True, slots=True)
class KnownWays:
    """What searches in the same diagrams have found."""

    walked: dict[object, Ways] = field(default_factory=dict)
    parts: dict[tuple[Nodes, Nodes], _Parts] = field(default_factory=dict)


class WaySearch:
    """A search for the plainest ways, which tells ``take`` of its steps.

    What other searches in the same diagrams have found is ``known``. Raises UndecidedError if there
    are too many ways.
    """

    def __init__(
        self,
        diagrams: DecisionDiagrams,
        choices: Choices,
        take: Callable[[int], None],
        known: KnownWays,
    ) -> None:
        self._diagrams, self._choices = diagrams, choices
        self._take, self._known = take, known
        self._n_nodes = 0

    def ways(self, keys: Nodes, axioms: Nodes) -> Ways:
        """The ways to each of the classes of these keys on which no axiom is broken."""
        parts = self._known.parts.get((keys, axioms))
        if parts is None:
            parts = self._known.parts[keys, axioms] = self._parts(keys, axioms)
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
            # There are two places or more, for some are open, and not all.
            whole = itemgetter(
                *(open_keys.index(key) if key in open_keys else next(numbers) for key in keys)
            )
        around, *apart = self._groups(open_keys, axioms)
        return _Parts(open_keys, around, apart, settled, whole)

    def _groups(self, keys: Nodes, axioms: Nodes) -> list[Nodes]:
        """The axioms that hang together with the keys, then other groups of them."""
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
        """The ways for keys that are open, each once, and axioms that hang together with them."""
        choices, diagrams = self._choices, self._diagrams
        nodes = keys + axioms
        # What is as usual matters only to nodes that read it; others are known from other searches.
        key = keys, axioms, choices.usual and choices.usual & diagrams.support(nodes)
        known = self._known.walked.get(key)
        if known is not None:
            return known
        self._n_nodes += 1
        if self._n_nodes > MOST_NODES:
            raise UndecidedError("too many different states of the world have to be told apart")
        level = int(diagrams.level(nodes))
        default = choices.defaults[level]
        ways: dict[tuple[int, ...], tuple[int, int]] = {}
        rows = diagrams.restricted(nodes, level, choices.sizes[level])
        for digit in choices.digits[level]:
            left = diagrams.open_axioms(rows[digit][len(keys) :])
            if left is None:
                continue
            own, step = int(default is not None and digit != default), chosen_digit(level, digit)
            for classes, (cost, chosen) in self.ways(rows[digit][: len(keys)], left).items():
                fewest = ways.get(classes)
                if fewest is None or own + cost < fewest[0]:
                    ways[classes] = own + cost, chosen + step
        self._known.walked[key] = ways
        self._take(len(ways))
        return ways
