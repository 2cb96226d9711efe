"""On which words an open verdict depends, and how it comes out by their values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from rulec.automata.outcome_machine import KEPT, OutcomeRange, SetMonitor
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters

MOST_WAYS = 1 << 12
"""So many sets of states are told apart while looking for what decides."""

BEFORE = ""
"""Stands among names for what was before the first state."""


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
        self._alternatives = alternatives
        self._unknown = unknown

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
        start = self._monitor.start
        starts = [start]
        if BEFORE in names:
            starts = [self._monitor.number(state) for state in self._monitor.machine.starts]
        return all(
            self._agree(group, fixed, first) for group in self._groups(names) for first in starts
        )

    def _groups(self, names: frozenset[str]) -> Iterator[list[PossibleAlternative]]:
        """Alternatives that have the same values of these constants."""
        groups: dict[tuple[object, ...], list[PossibleAlternative]] = {}
        for alternative in self._alternatives:
            key = tuple([value for name, value in alternative.constants.items() if name in names])
            groups.setdefault(key, []).append(alternative)
        yield from groups.values()

    def _agree(
        self, group: Sequence[PossibleAlternative], fixed: tuple[int, ...], start: int
    ) -> bool:
        """Whether words that have the same digits of fixed reads come to the same."""
        ways: set[tuple[int | None, ...]] = {(start,) * len(group)}
        before: tuple[Letters, ...] = ()
        settled = agree = False
        for letters in zip(*(alternative.letters for alternative in group), strict=True):
            # In most recordings most states have the letters of the one before.
            if settled and letters == before:
                continue
            options = [self._classes.groups(own, fixed) for own in letters]
            parts = dict.fromkeys(part for option in options for part in option)
            after: set[tuple[int | None, ...]] = set()
            agree = True
            for way, part in product(ways, parts):
                steps = [
                    None
                    if here is None or part not in option
                    else self._monitor.step(here, option[part])
                    for here, option in zip(way, options, strict=True)
                ]
                agree = agree and _is_one([step for step in steps if step])
                if any(steps):
                    after.add(tuple([None if x is None else x.states for x in steps]))
            if len(after) > MOST_WAYS:
                return False
            settled, ways, before = after == ways, after, letters
        return agree


def _is_one(steps: Sequence[OutcomeRange]) -> bool:
    best = min((step.best for step in steps), default=KEPT)
    return best == max((step.worst for step in steps), default=KEPT)
