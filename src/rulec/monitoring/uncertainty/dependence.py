"""On which words an open verdict depends, and how it comes out by their values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from itertools import combinations, product
from typing import TypeAlias

from rulec.automata.outcome_machine import KEPT, OutcomeRange, SetMonitor
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters

MOST_WAYS = 1 << 12
"""So many sets of states are told apart while looking for what decides, from each start."""

BEFORE = ""
"""Stands among names for what was before the first state."""

_Word: TypeAlias = tuple[int, ...]
_Way: TypeAlias = tuple[int | None, ...]
"""The set of states that each word has led to, None where a word cannot be."""


@dataclass(frozen=True, slots=True)
class PossibleAlternative:
    """The possible letters of a word, for some values of what does not change.

    ``constants`` are the values by name, as text to compare them by.
    """

    letters: tuple[Letters, ...]
    constants: Mapping[str, object]


class Dependence:
    """What decides the outcome of one rule and binding.

    ``unknown`` has for each read the names of unknown values that it depends on.
    """

    def __init__(
        self,
        monitor: SetMonitor,
        classes: LetterClasses,
        alternatives: Sequence[PossibleAlternative],
        unknown: Sequence[frozenset[str]],
    ) -> None:
        self._monitor = monitor
        self._classes = classes
        self._unknown = unknown
        # States are many, their letters few: words are of numbers of these.
        numbers: dict[Letters, int] = {}
        self._alternatives = [
            (tuple([numbers.setdefault(x, len(numbers)) for x in own.letters]), own.constants)
            for own in alternatives
        ]
        self._letters = list(numbers)

    def smallest(self, names: Sequence[str]) -> tuple[str, ...] | None:
        """The smallest set of names that decides; of equally small ones the first in order.

        ``names`` are in the order that ties are broken by; ``BEFORE`` may be among them. None if
        all of them together do not decide, or there is too much to look at.
        """
        if not self.decides(frozenset(names)):
            return None
        needed = [name for name in names if not self.decides(frozenset(names) - {name})]
        others = [name for name in names if name not in needed]
        for size in range(len(others) + 1):
            for more in combinations(others, size):
                if self.decides(frozenset((*needed, *more))):
                    return tuple([name for name in names if name in needed or name in more])
        return None

    def decides(self, names: frozenset[str]) -> bool:
        """Whether completions that agree on these names agree on the outcome."""
        fixed = tuple([n for n, about in enumerate(self._unknown) if about and about <= names])
        starts = {self._monitor.start}
        if BEFORE in names:
            starts = {self._monitor.number(state) for state in self._monitor.machine.starts}
        return all(self._agree(group, fixed, starts) for group in self._groups(names))

    def _groups(self, names: frozenset[str]) -> Iterator[list[_Word]]:
        """Alternatives that have the same values of these constants."""
        groups: dict[tuple[object, ...], list[_Word]] = {}
        for word, constants in self._alternatives:
            key = tuple([value for name, value in constants.items() if name in names])
            groups.setdefault(key, []).append(word)
        yield from groups.values()

    def _agree(self, group: Sequence[_Word], fixed: tuple[int, ...], starts: Set[int]) -> bool:
        """Whether words that have the same digits of fixed reads come to the same."""
        ways: frozenset[_Way] = frozenset([(start,) * len(group) for start in starts])
        known: dict[tuple[frozenset[_Way], _Word], frozenset[_Way]] = {}
        *before, last = zip(*group, strict=True)
        for letters in before:
            after = known.get((ways, letters))
            if after is None:
                steps = self._steps(ways, letters, fixed)
                after = frozenset(
                    tuple([None if x is None else x.states for x in row]) for row in steps
                )
                if len(after) > MOST_WAYS * len(starts):
                    return False
                known[ways, letters] = after
            ways = after
        return all(_is_one(row) for row in self._steps(ways, last, fixed))

    def _steps(
        self, ways: Iterable[_Way], letters: _Word, fixed: tuple[int, ...]
    ) -> Iterator[list[OutcomeRange | None]]:
        """Steps from each way, for each choice of digits of fixed reads that some word has."""
        groups = [self._classes.groups(self._letters[number], fixed) for number in letters]
        parts = dict.fromkeys(part for group in groups for part in group)
        choices = {tuple([group.get(part, 0) for group in groups]) for part in parts}
        for way, choice in product(ways, choices):
            steps = [
                None if here is None or not classes else self._monitor.step(here, classes)
                for here, classes in zip(way, choice, strict=True)
            ]
            if any(steps):
                yield steps


def _is_one(steps: Sequence[OutcomeRange | None]) -> bool:
    best = min([step.best for step in steps if step], default=KEPT)
    return best == max([step.worst for step in steps if step], default=KEPT)
