"""On which words an open verdict depends, and how it comes out by their values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from itertools import chain, combinations, groupby, product
from typing import TypeAlias

from rulec.automata.outcome_machine import KEPT, OutcomeRange, SetMonitor
from rulec.monitoring.uncertainty.prospects import Prospects, agreement
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters

MOST_WAYS = 1 << 12
"""So many sets of states are told apart while looking for what decides, from each start."""

MOST_REMEMBERED = 1 << 14
"""Steps that are kept before all are forgotten."""

MOST_WORDS = 1 << 9
"""Words whose prospects are kept before all is forgotten."""

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


class Ways:
    """The ways that words of one machine lead, step by step, remembered from word to word.

    Letters have numbers: states are many, their letters few. So have the choices that letters of
    words leave, side by side, once the digits of some reads are fixed; fewer still, and what comes
    of many letters is the same.
    """

    def __init__(self, monitor: SetMonitor, classes: LetterClasses) -> None:
        self.monitor = monitor
        self._classes = classes
        self._prospects = Prospects(monitor.machine)
        self._forget()

    def _forget(self) -> None:
        self._numbers: dict[Letters, int] = {}
        self._letters: list[Letters] = []
        self._choices: dict[tuple[_Word, tuple[int, ...]], int] = {}
        self._places: dict[frozenset[tuple[int, ...]], int] = {}
        self._sets: list[frozenset[tuple[int, ...]]] = []
        self._after: dict[tuple[frozenset[_Way], int], frozenset[_Way]] = {}
        self._onward: dict[tuple[_Way, int], list[_Way]] = {}
        self._along: dict[_Word, list[bytes]] = {}

    def forget_many(self) -> None:
        """Forget what has been met, if it is much; numbers mean nothing any more."""
        most = max(len(self._after), len(self._onward), len(self._choices))
        if most > MOST_REMEMBERED or len(self._along) > MOST_WORDS:
            self._forget()

    def word(self, states: Sequence[Letters]) -> _Word:
        """A word in numbers."""
        numbers = self._numbers
        for letters in dict.fromkeys(states):
            if numbers.setdefault(letters, len(self._letters)) == len(self._letters):
                self._letters.append(letters)
        return tuple([numbers[letters] for letters in states])

    def prospects(self, word: _Word) -> list[bytes]:
        """For each letter of a word what may come of each state: see ``Prospects``."""
        found = self._along.get(word)
        if found is None:
            classes = {number: self._classes.of(self._letters[number]) for number in set(word)}
            found = self._prospects.along([classes[number] for number in word])
            self._along[word] = found
        return found

    def choices(self, letters: _Word, fixed: tuple[int, ...]) -> int:
        """The number of the choices of digits of fixed reads that some word has."""
        key = letters, fixed
        found = self._choices.get(key)
        if found is None:
            groups = [self._classes.groups(self._letters[number], fixed) for number in letters]
            parts = dict.fromkeys(part for group in groups for part in group)
            choices = frozenset(tuple([group.get(part, 0) for group in groups]) for part in parts)
            found = self._places.setdefault(choices, len(self._sets))
            if found == len(self._sets):
                self._sets.append(choices)
            self._choices[key] = found
        return found

    def after(self, ways: frozenset[_Way], choices: int) -> frozenset[_Way]:
        """The ways after one step of each word."""
        key = ways, choices
        found = self._after.get(key)
        if found is None:
            found = frozenset(chain.from_iterable([self._after_one(way, choices) for way in ways]))
            self._after[key] = found
        return found

    def _after_one(self, way: _Way, choices: int) -> list[_Way]:
        key = way, choices
        found = self._onward.get(key)
        if found is None:
            found = self._onward[key] = [
                tuple([None if step is None else step.states for step in row])
                for row in self.steps((way,), choices)
            ]
        return found

    def steps(self, ways: Iterable[_Way], choices: int) -> Iterator[list[OutcomeRange | None]]:
        """Steps from each way, for each of some choices."""
        step_of = self.monitor.step
        for way, choice in product(ways, self._sets[choices]):
            steps = [
                None if here is None or not classes else step_of(here, classes)
                for here, classes in zip(way, choice, strict=True)
            ]
            if any(steps):
                yield steps


class Dependence:
    """What decides the outcome of one rule and binding.

    ``unknown`` has for each read the names of unknown values that it depends on.
    """

    def __init__(
        self,
        ways: Ways,
        alternatives: Sequence[PossibleAlternative],
        unknown: Sequence[frozenset[str]],
    ) -> None:
        ways.forget_many()
        self._ways = ways
        self._monitor = ways.monitor
        self._unknown = unknown
        self._alternatives = [(ways.word(own.letters), own.constants) for own in alternatives]

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
        most = MOST_WAYS * len(starts)
        word = list(zip(*group, strict=True))
        prospects = self._ways.prospects(group[0]) if len(group) == 1 else None
        known = {letters: self._ways.choices(letters, fixed) for letters in set(word)}
        *before, last = [known[letters] for letters in word]
        begin = 0
        for choices, alike in groupby(before):
            length, look = len(list(alike)), 0
            for place in range(length):
                if place == look and prospects is not None:
                    # To look is worth while now and then
                    look = 2 * look + 1
                    ways, is_split = self._undecided(ways, prospects[begin + place])
                    if is_split or not ways:
                        return not is_split
                after = self._ways.after(ways, choices)
                if len(after) > most:
                    return False
                if after == ways:
                    break  # the same again, however often
                ways = after
            begin += length
        return all(_is_one(row) for row in self._ways.steps(ways, last))

    def _undecided(self, ways: frozenset[_Way], outcomes: bytes) -> tuple[frozenset[_Way], bool]:
        """The ways that may come to one outcome or several, and whether some surely comes to more.

        They are of one word each.
        """
        found = []
        for way in ways:
            (number,) = way
            assert number is not None, "a word can be"
            agree = agreement(outcomes, self._monitor.states(number))
            if agree is None:
                found.append(way)
            elif not agree:
                return ways, True
        return frozenset(found), False


def _is_one(steps: Sequence[OutcomeRange | None]) -> bool:
    best = min([step.best for step in steps if step], default=KEPT)
    return best == max([step.worst for step in steps if step], default=KEPT)
