"""The words on which an open verdict depends, and its outcome by their values.

Two completions that agree on some names and differ in the outcome are two runs of a rule's machine,
side by side, on letters that agree where these names are read. So it suffices to follow pairs of
states, of which there are few, instead of all sets of states. Only the pairs that are farthest
apart, by their states' possible outcomes, are followed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, groupby, product
from typing import TypeAlias

from rulec.monitoring.uncertainty.run_pairs import Pairs, RunPairs, Word
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters
from rulec.trace.remembered import Remembered

BEFORE = ""
"""Stands among names for the time before the first state."""

_Stretch: TypeAlias = tuple[tuple[int, int], int]
"""The letters of two words, and how often they are repeated."""


@dataclass(frozen=True, slots=True)
class PossibleAlternative:
    """The possible letters of a word, for some values of the constants.

    ``stretches`` are the letters in their order, each with the number of successive states in which
    they are possible. ``constants`` are the values by name, as text for comparison.
    """

    stretches: tuple[tuple[Letters, int], ...]
    constants: Mapping[str, object]


class Dependence:
    """What determines the outcome of one rule and binding.

    ``unknown`` has for each read the names of the unknown values on which it depends.
    """

    def __init__(
        self,
        runs: RunPairs,
        alternatives: Sequence[PossibleAlternative],
        unknown: Sequence[frozenset[str]],
    ) -> None:
        runs.forget_many()
        self._runs = runs
        self._unknown = unknown
        self._alternatives = [(runs.word(own.stretches), own.constants) for own in alternatives]
        self._alike = Remembered(_alike, None)

    def smallest(self, names: Sequence[str]) -> tuple[str, ...] | None:
        """The smallest set of names that decides; of equally small ones the first in order.

        ``names`` are in the order in which ties are broken; ``BEFORE`` may be among them. None if
        all of them together do not decide, or if the search is too large.
        """
        every = frozenset(names)
        if not self.decides(every):
            return None
        needed = [name for name in names if not self.decides(every - {name})]
        others = [name for name in names if name not in needed]
        for size in range(len(others) + 1):
            for more in combinations(others, size):
                if self.decides(frozenset((*needed, *more))):
                    return tuple([name for name in names if name in needed or name in more])
        return None

    def decides(self, names: frozenset[str]) -> bool:
        """Whether completions that agree on these names agree on the outcome."""
        fixed = tuple([n for n, about in enumerate(self._unknown) if about and about <= names])
        is_same = BEFORE in names
        is_one = is_same or self._runs.n_starts == 1
        starts = self._runs.starts(same=is_same)
        for group in self._groups(names):
            # Runs on different words differ in outcome more often than runs on the same word
            for word, other in sorted(product(group, repeat=2), key=lambda two: two[0] is two[1]):
                # A word whose reads are all fixed has only one run
                if word is other and is_one and self._runs.are_settled(word, set(fixed)):
                    continue
                if not self._agree(word, other, fixed, starts):
                    return False
        return True

    def _groups(self, names: frozenset[str]) -> Iterator[list[Word]]:
        """The alternatives, grouped by equal values of these constants."""
        groups: dict[tuple[object, ...], list[Word]] = {}
        for word, constants in self._alternatives:
            key = tuple([value for name, value in constants.items() if name in names])
            groups.setdefault(key, []).append(word)
        yield from groups.values()

    def _agree(self, first: Word, second: Word, fixed: tuple[int, ...], pairs: Pairs) -> bool:
        """Whether runs on two words, from pairs of states, cannot have different outcomes."""
        runs, stretches = self._runs, self._alike[first, second]
        first_prospects, second_prospects = runs.prospects(first), runs.prospects(second)
        begin = 0
        for letters, length in stretches:
            choices = runs.choices(*letters, fixed)
            for at in range(begin, begin + length):
                undecided = runs.undecided(pairs, first_prospects[at], second_prospects[at])
                if not undecided:
                    return undecided is not None
                pairs = runs.after(undecided, choices)
                if pairs == undecided:
                    break  # the same again, however often
            begin += length
        return runs.agree(pairs, runs.choices(first[-1], second[-1], fixed))


def _alike(words: tuple[Word, Word]) -> list[_Stretch]:
    """The pairs of letters of two words, except the last, each with its repetitions."""
    first, second = words
    together = groupby(zip(first[:-1], second[:-1], strict=True))
    return [(letters, len(list(alike))) for letters, alike in together]
