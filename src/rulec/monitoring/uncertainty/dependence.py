"""On which words an open verdict depends, and how it comes out by their values.

Two completions that agree on some names and disagree on the outcome are two runs of a rule's
machine, side by side on the same letters but for what is not fixed. So it is enough to follow pairs
of states, of which there are few: not all sets of them. Of pairs only those count that are the
furthest apart, by what can still come of their states.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, groupby, product
from typing import TypeAlias

from rulec.automata.outcome_machine import OutcomeMachine, bits_of
from rulec.monitoring.uncertainty.prospects import Prospects
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters

MOST_REMEMBERED = 1 << 14
"""Steps that are kept before all are forgotten."""

MOST_WORDS = 1 << 9
"""Words whose prospects are kept before all is forgotten."""

MOST_TRIED = 2
"""Pairs that are followed first: that some run comes to less than another is mostly told by few."""

BEFORE = ""
"""Stands among names for what was before the first state."""

_Word: TypeAlias = tuple[int, ...]
_Pairs: TypeAlias = frozenset[tuple[int, int]]
"""States of a first run, each with the states, as bits, that a second run may be in.

They are of words on which the fixed reads have the same digits. It is asked whether the first run
may come to less than the second one.
"""

_Stretch: TypeAlias = tuple[tuple[int, int], int]
"""The letters of two words, and for how long they stay."""


@dataclass(frozen=True, slots=True)
class PossibleAlternative:
    """The possible letters of a word, for some values of what does not change.

    ``stretches`` are the letters in their order, and in how many states on end they are possible.
    ``constants`` are the values by name, as text to compare them by.
    """

    stretches: tuple[tuple[Letters, int], ...]
    constants: Mapping[str, object]


class RunPairs:
    """Pairs of runs of one machine, step by step, remembered from word to word.

    Letters have numbers: states are many, their letters few. So have the choices that two letters
    leave, side by side, once the digits of some reads are fixed; fewer still.
    """

    def __init__(self, machine: OutcomeMachine, classes: LetterClasses) -> None:
        self._machine = machine
        self._classes = classes
        self._prospects = Prospects(machine)
        self._safe = sum(1 << state for state in machine.safe)
        self._starts: dict[bool, _Pairs] = {}
        self._below: dict[int, int] = {}
        self._forget()

    def _forget(self) -> None:
        self._numbers: dict[Letters, int] = {}
        self._letters: list[Letters] = []
        self._open: list[frozenset[int]] = []
        self._choices: dict[tuple[int, int, tuple[int, ...]], int] = {}
        self._places: dict[frozenset[tuple[int, int]], int] = {}
        self._sets: list[frozenset[tuple[int, int]]] = []
        self._after: dict[tuple[_Pairs, int], _Pairs] = {}
        self._onward: dict[tuple[tuple[int, int], int], list[tuple[int, int]]] = {}
        self._least: dict[tuple[int, int], list[int]] = {}
        self._greatest: dict[tuple[int, int], int] = {}
        self._ends: dict[tuple[_Pairs, int], bool] = {}
        self._along: dict[_Word, list[bytes]] = {}
        self._undecided: dict[tuple[_Pairs, bytes, bytes], _Pairs | None] = {}

    def starts(self, *, same: bool) -> _Pairs:
        """The pairs of states that runs begin in, optionally only in the same."""
        if same not in self._starts:
            states = self._machine.starts
            every = sum(1 << state for state in states)
            rows = {state: 1 << state if same else every for state in states}
            self._starts[same] = self._furthest(rows)
        return self._starts[same]

    def forget_many(self) -> None:
        """Forget what has been met, if it is much; numbers mean nothing any more."""
        most = max(len(self._after), len(self._onward), len(self._choices), len(self._undecided))
        if most > MOST_REMEMBERED or len(self._along) > MOST_WORDS:
            self._forget()

    def word(self, stretches: Sequence[tuple[Letters, int]]) -> _Word:
        """A word in numbers."""
        word: list[int] = []
        for letters, length in stretches:
            number = self._numbers.setdefault(letters, len(self._letters))
            if number == len(self._letters):
                self._letters.append(letters)
                digits = [_united(masks) for masks in zip(*letters, strict=True)]
                self._open.append(frozenset(n for n, own in enumerate(digits) if own & own - 1))
            word += [number] * length
        return tuple(word)

    @property
    def n_starts(self) -> int:
        """In how many states runs may begin."""
        return len(self._machine.starts)

    def are_settled(self, word: _Word, fixed: Set[int]) -> bool:
        """Whether each letter of a word is one, once the digits of some reads are fixed."""
        return all(self._open[number] <= fixed for number in set(word))

    def prospects(self, word: _Word) -> list[bytes]:
        """For each letter of a word what may come of each state: see ``Prospects``."""
        found = self._along.get(word)
        if found is None:
            classes = {number: self._classes.of(self._letters[number]) for number in set(word)}
            found = self._prospects.along([classes[number] for number in word])
            self._along[word] = found
        return found

    def undecided(self, pairs: _Pairs, first: bytes, second: bytes) -> _Pairs | None:
        """The pairs of which it is open whether the first run comes to less than the second one.

        None if it surely does for some. ``first`` and ``second`` are the outcomes, as bits, that
        the rest of each run's word may have, by state.
        """
        key = pairs, first, second
        if key not in self._undecided:
            self._undecided[key] = _undecided(pairs, first, second)
        return self._undecided[key]

    def choices(self, one: int, other: int, fixed: tuple[int, ...]) -> int:
        """The number of what two letters may be, with the same digits of fixed reads."""
        if one == other:
            # Reads with one digit divide nothing.
            fixed = tuple([n for n in fixed if n in self._open[one]])
        key = one, other, fixed
        found = self._choices.get(key)
        if found is None:
            choices = self._classes.side_by_side(self._letters[one], self._letters[other], fixed)
            found = self._places.setdefault(choices, len(self._sets))
            if found == len(self._sets):
                self._sets.append(choices)
            self._choices[key] = found
        return found

    def after(self, pairs: _Pairs, choices: int) -> _Pairs:
        """The pairs after one more step."""
        key = pairs, choices
        found = self._after.get(key)
        if found is None:
            rows: dict[int, int] = {}
            for row in pairs:
                for one, others in self._onward.get((row, choices)) or self._from(row, choices):
                    rows[one] = rows.get(one, 0) | others
            found = self._after[key] = self._furthest(rows)
        return found

    def _from(self, row: tuple[int, int], choices: int) -> list[tuple[int, int]]:
        rows: dict[int, int] = {}
        for first, second in self._sets[choices]:
            targets = self._greatest_behind(row[1], second)
            for target in self._least_behind(row[0], first):
                rows[target] = rows.get(target, 0) | targets
        found = self._onward[row, choices] = list(rows.items())
        return found

    def _least_behind(self, state: int, classes: int) -> list[int]:
        key = state, classes
        found = self._least.get(key)
        if found is None:
            machine = self._machine
            targets = _behind(machine, state, classes)
            found = [*bits_of(machine.least(targets))]
            self._least[key] = found
        return found

    def _greatest_behind(self, states: int, classes: int) -> int:
        key = states, classes
        found = self._greatest.get(key)
        if found is None:
            machine, targets = self._machine, 0
            for state in bits_of(states):
                targets |= _behind(machine, state, classes)
            found = self._greatest[key] = machine.greatest(targets)
        return found

    def _furthest(self, rows: Mapping[int, int]) -> _Pairs:
        """The pairs without those of which nothing can come that does not come of another.

        So it is if the other's first state is no worse and its second one no better.
        """
        if all(others == 1 << one for one, others in rows.items()):
            return frozenset(rows.items())
        machine, found = self._machine, []
        below, lost, safe = machine.below, machine.lost, self._safe
        rows = {
            one: left
            for one, others in rows.items()
            if one not in lost and (left := others & ~safe)
        }
        if len(rows) == 1:
            ((one, others),) = rows.items()
            return frozenset([(one, machine.greatest(others))])
        ranks = self._ranks
        own = {ranks[one]: one for one in rows}
        firsts = sum(1 << rank for rank in own)
        # By rank what its own second states reach, and those of all whose first one is no worse
        reached: dict[int, int] = {}
        for rank in sorted(own):
            one = own[rank]
            others = rows[one]
            better = self._ranks_below(one) & firsts & (1 << rank) - 1
            beyond = 0
            while better:
                nearest = better.bit_length() - 1
                beyond |= reached[nearest]
                better &= ~self._ranks_below(own[nearest])
            reached[rank] = beyond | _reach(others, below)
            others &= ~beyond
            if others:
                found.append((one, machine.greatest(others)))
        return frozenset(found)

    @cached_property
    def _ranks(self) -> list[int]:
        """For each state its place among all, behind those that come to no more.

        Of states that are alike the first one comes first, and counts.
        """
        below = self._machine.below
        order = sorted(range(len(below)), key=lambda state: (below[state].bit_count(), state))
        ranks = [0] * len(order)
        for rank, state in enumerate(order):
            ranks[state] = rank
        return ranks

    def _ranks_below(self, state: int) -> int:
        """The ranks, as bits, of the states that come to no more than one, and its own."""
        found = self._below.get(state)
        if found is None:
            ranks = self._ranks
            found = sum([1 << ranks[other] for other in bits_of(self._machine.below[state])])
            self._below[state] = found
        return found

    def agree(self, pairs: _Pairs, choices: int) -> bool:
        """Whether no first run of pairs comes to less than the second one with a last letter."""
        key = pairs, choices
        found = self._ends.get(key)
        if found is None:
            outputs = self._machine.outputs
            found = self._ends[key] = all(
                min([outputs[one][symbol] for symbol in bits_of(first)])
                >= max([outputs[n][symbol] for n in bits_of(others) for symbol in bits_of(second)])
                for (one, others), (first, second) in product(pairs, self._sets[choices])
            )
        return found


def _some(pairs: _Pairs, number: int) -> list[tuple[int, int]]:
    """Some pairs, those with the most second states."""
    return sorted(pairs, key=lambda pair: (-pair[1].bit_count(), pair[0]))[:number]


def _undecided(pairs: _Pairs, first: bytes, second: bytes) -> _Pairs | None:
    found = []
    for one, others in pairs:
        own, left = first[one], 0
        # A lower bit is a better outcome.
        most = 2 * (own & -own)
        for other in bits_of(others):
            theirs = second[other]
            if theirs & -theirs > own:
                return None
            if theirs >= most:
                left |= 1 << other
        if left:
            found.append((one, left))
    return frozenset(found)


def _behind(machine: OutcomeMachine, state: int, classes: int) -> int:
    """The states, as bits, that some classes lead to."""
    row, found = machine.successors[state], 0
    for symbol in bits_of(classes):
        found |= 1 << row[symbol]
    return found


def _united(masks: Iterable[int]) -> int:
    found = 0
    for mask in masks:
        found |= mask
    return found


def _reach(states: int, below: Sequence[int]) -> int:
    """The states, as bits, that come to no more than one of some."""
    found = 0
    for state in bits_of(states):
        found |= below[state]
    return found


class Dependence:
    """What decides the outcome of one rule and binding.

    ``unknown`` has for each read the names of unknown values that it depends on.
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
        self._stretches: dict[tuple[_Word, _Word], list[_Stretch]] = {}

    def smallest(self, names: Sequence[str]) -> tuple[str, ...] | None:
        """The smallest set of names that decides; of equally small ones the first in order.

        ``names`` are in the order that ties are broken by; ``BEFORE`` may be among them. None if
        all of them together do not decide, or there is too much to look at.
        """
        every = frozenset(names)
        if not self.decides(every):
            return None
        told = {name: self._decides(every - {name}, thoroughly=False) for name in names}
        surely = tuple([name for name in names if told[name] is False])
        # If these decide, so do they with any others: none of which is needed.
        if len(surely) == len(names) or self.decides(frozenset(surely)):
            return surely
        needed = [
            name
            for name in names
            if told[name] is False or (told[name] is None and not self.decides(every - {name}))
        ]
        others = [name for name in names if name not in needed]
        for size in range(len(others) + 1):
            for more in combinations(others, size):
                if self.decides(frozenset((*needed, *more))):
                    return tuple([name for name in names if name in needed or name in more])
        return None

    def decides(self, names: frozenset[str]) -> bool:
        """Whether completions that agree on these names agree on the outcome."""
        return self._decides(names, thoroughly=True) is True

    def _decides(self, names: frozenset[str], *, thoroughly: bool) -> bool | None:
        """The same; None if it is not to be found out ``thoroughly``, and few pairs do not tell."""
        fixed = tuple([n for n, about in enumerate(self._unknown) if about and about <= names])
        is_same = BEFORE in names
        is_one = is_same or self._runs.n_starts == 1
        starts = self._runs.starts(same=is_same)
        agree = self._agree if thoroughly else self._agree_by_few
        found: bool | None = True
        for group in self._groups(names):
            # Different words come to something else more often than one does
            for one, other in sorted(product(group, repeat=2), key=lambda both: both[0] is both[1]):
                # There is one run of a word all of whose reads are fixed
                if one is other and is_one and self._runs.are_settled(one, set(fixed)):
                    continue
                told = agree(one, other, fixed, starts)
                if told is False:
                    return False
                found = found and told
        return found

    def _groups(self, names: frozenset[str]) -> Iterator[list[_Word]]:
        """Alternatives that have the same values of these constants."""
        groups: dict[tuple[object, ...], list[_Word]] = {}
        for word, constants in self._alternatives:
            key = tuple([value for name, value in constants.items() if name in names])
            groups.setdefault(key, []).append(word)
        yield from groups.values()

    def _agree(self, one: _Word, other: _Word, fixed: tuple[int, ...], pairs: _Pairs) -> bool:
        """Whether runs on two words, from pairs of states, cannot come to less and to more.

        That they can is often told by few pairs.
        """
        found = self._agree_by_few(one, other, fixed, pairs)
        if found is None:
            found = self._agree_by(None, one, other, fixed=fixed, pairs=pairs)
        assert found is not None, "all pairs were followed"
        return found

    def _agree_by_few(
        self, one: _Word, other: _Word, fixed: tuple[int, ...], pairs: _Pairs
    ) -> bool | None:
        """The same by some pairs of each state; None if these do not tell."""
        return self._agree_by(MOST_TRIED, one, other, fixed=fixed, pairs=pairs)

    def _agree_by(
        self, most: int | None, one: _Word, other: _Word, *, fixed: tuple[int, ...], pairs: _Pairs
    ) -> bool | None:
        """The same by so many pairs after each letter; None if these do not tell."""
        runs, stretches = self._runs, self._alike(one, other)
        first, second = runs.prospects(one), runs.prospects(other)
        begin, all_followed = 0, True
        for letters, length in stretches:
            choices, look = runs.choices(*letters, fixed), 0
            for place in range(length):
                if place == look:
                    # To look is worth while now and then
                    look = 2 * look + 1 if most is None else look + 1
                    at = begin + place
                    undecided = runs.undecided(pairs, first[at], second[at])
                    if undecided is None:
                        return False
                    if not undecided:
                        return True if all_followed else None
                    pairs = undecided
                    if most is not None and len(pairs) > most:
                        pairs, all_followed = frozenset(_some(pairs, most)), False
                after = runs.after(pairs, choices)
                if after == pairs:
                    break  # the same again, however often
                pairs = after
            begin += length
        agree = runs.agree(pairs, runs.choices(one[-1], other[-1], fixed))
        return agree if all_followed or not agree else None

    def _alike(self, one: _Word, other: _Word) -> list[_Stretch]:
        """What two words have for a while, without their last letters."""
        found = self._stretches.get((one, other))
        if found is None:
            together = groupby(zip(one[:-1], other[:-1], strict=True))
            found = [(letters, len(list(alike))) for letters, alike in together]
            self._stretches[one, other] = found
        return found
