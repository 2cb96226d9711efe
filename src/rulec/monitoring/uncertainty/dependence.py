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

MOST_TRIED = 2
"""How many pairs are followed first: few usually show that some run has a lesser outcome."""

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
        self._stretches: dict[tuple[Word, Word], list[_Stretch]] = {}

    def smallest(self, names: Sequence[str]) -> tuple[str, ...] | None:
        """The smallest set of names that decides; of equally small ones the first in order.

        ``names`` are in the order in which ties are broken; ``BEFORE`` may be among them. None if
        all of them together do not decide, or if the search is too large.
        """
        every = frozenset(names)
        if not self.decides(every):
            return None
        names = [name for name in names if not self.is_idle(name)]
        every = frozenset(names)
        without = {name: self._decides(every - {name}, thoroughly=False) for name in names}
        surely = tuple([name for name in names if without[name] is False])
        # If these decide, they also decide with any others, so no other is needed.
        if len(surely) == len(names) or self.decides(frozenset(surely)):
            return surely
        needed = [
            name
            for name in names
            if without[name] is False
            or (without[name] is None and not self.decides(every - {name}))
        ]
        others = [name for name in names if name not in needed]
        for size in range(len(others) + 1):
            for more in combinations(others, size):
                if self.decides(frozenset((*needed, *more))):
                    return tuple([name for name in names if name in needed or name in more])
        return None

    def is_idle(self, name: str) -> bool:
        """Whether a name is in no smallest deciding set, as far as single letters show.

        This holds if no value of it ever makes a difference to the rule's machine, whatever the
        other values are: completions that agree on the other names have the same outcome as if they
        agreed on it, too.
        """
        if name == BEFORE or any(name in constants for _, constants in self._alternatives):
            return False
        words = [word for word, _ in self._alternatives]
        about = [n for n, names in enumerate(self._unknown) if name in names]
        return all(self._runs.are_indifferent(words, read) for read in about)

    def needs(self, name: str, every: frozenset[str]) -> bool:
        """Whether all other names together do not decide, as far as few pairs show."""
        return self._decides(every - {name}, thoroughly=False) is False

    def decides(self, names: frozenset[str]) -> bool:
        """Whether completions that agree on these names agree on the outcome."""
        return self._decides(names, thoroughly=True) is True

    def _decides(self, names: frozenset[str], *, thoroughly: bool) -> bool | None:
        """As ``decides``; None if few pairs do not show it, unless ``thoroughly``."""
        fixed = tuple([n for n, about in enumerate(self._unknown) if about and about <= names])
        is_same = BEFORE in names
        is_one = is_same or self._runs.n_starts == 1
        starts = self._runs.starts(same=is_same)
        agree = self._agree if thoroughly else self._agree_by_few
        decides: bool | None = True
        for group in self._groups(names):
            # Runs on different words differ in outcome more often than runs on the same word
            for word, other in sorted(product(group, repeat=2), key=lambda two: two[0] is two[1]):
                # A word whose reads are all fixed has only one run
                if word is other and is_one and self._runs.are_settled(word, set(fixed)):
                    continue
                agrees = agree(word, other, fixed, starts)
                if agrees is False:
                    return False
                decides = decides and agrees
        return decides

    def _groups(self, names: frozenset[str]) -> Iterator[list[Word]]:
        """The alternatives, grouped by equal values of these constants."""
        groups: dict[tuple[object, ...], list[Word]] = {}
        for word, constants in self._alternatives:
            key = tuple([value for name, value in constants.items() if name in names])
            groups.setdefault(key, []).append(word)
        yield from groups.values()

    def _agree(self, first: Word, second: Word, fixed: tuple[int, ...], pairs: Pairs) -> bool:
        """Whether runs on two words, from pairs of states, cannot have different outcomes.

        If they can, few pairs often suffice to show it.
        """
        agree = self._agree_by_few(first, second, fixed, pairs)
        if agree is None:
            agree = self._agree_by(None, first, second, fixed=fixed, pairs=pairs)
        assert agree is not None, "all pairs were followed"
        return agree

    def _agree_by_few(
        self, first: Word, second: Word, fixed: tuple[int, ...], pairs: Pairs
    ) -> bool | None:
        """The same, by some pairs of each state; None if these do not show it."""
        return self._agree_by(MOST_TRIED, first, second, fixed=fixed, pairs=pairs)

    def _agree_by(
        self, most: int | None, first: Word, second: Word, *, fixed: tuple[int, ...], pairs: Pairs
    ) -> bool | None:
        """The same, by this many pairs after each letter; None if these do not show it."""
        runs, stretches = self._runs, self._alike(first, second)
        first_prospects, second_prospects = runs.prospects(first), runs.prospects(second)
        begin, all_followed = 0, True
        for letters, length in stretches:
            choices, look = runs.choices(*letters, fixed), 0
            for place in range(length):
                if place == look:
                    # Checking pays off only now and then
                    look = 2 * look + 1 if most is None else look + 1
                    at = begin + place
                    undecided = runs.undecided(pairs, first_prospects[at], second_prospects[at])
                    if undecided is None:
                        return False
                    if not undecided:
                        return True if all_followed else None
                    pairs = undecided
                    if most is not None and len(pairs) > most:
                        pairs, all_followed = frozenset(_most_promising(pairs, most)), False
                after = runs.after(pairs, choices)
                if after == pairs:
                    break  # the same again, however often
                pairs = after
            begin += length
        agree = runs.agree(pairs, runs.choices(first[-1], second[-1], fixed))
        return agree if all_followed or not agree else None

    def _alike(self, first: Word, second: Word) -> list[_Stretch]:
        """The pairs of letters of two words, except the last, each with its repetitions."""
        stretches = self._stretches.get((first, second))
        if stretches is None:
            together = groupby(zip(first[:-1], second[:-1], strict=True))
            stretches = [(letters, len(list(alike))) for letters, alike in together]
            self._stretches[first, second] = stretches
        return stretches


def _most_promising(pairs: Pairs, number: int) -> list[tuple[int, int]]:
    """Some pairs, those with the most second states."""
    return sorted(pairs, key=lambda pair: (-pair[1].bit_count(), pair[0]))[:number]
