"""Proof that a machine which reads clocks judges words as its formula does, at two steps.

A clock of ``left since[low .. high] right`` keeps how many steps ago right held, for each time
since left was false; it holds if one of these is between low and high.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, gcd, lcm
from typing import Any, TypeAlias

from rulec.validation.table_proof import FormulaMachine
from rulec.validation.unprovable import exact, require

MOST_PAIRS = 1 << 16
"""Beyond so many pairs of states nothing is proved."""

_Ages: TypeAlias = tuple[int, ...]
_State: TypeAlias = tuple[int, tuple[_Ages, ...]]
"""A state of the table, and for each clock how many steps ago its right operand held."""


@dataclass(frozen=True, slots=True)
class _Clock:
    """A clock; the ages that it keeps are ascending."""

    low: int
    high: int | None
    operands: Sequence[int]

    @classmethod
    def read(cls, entry: Mapping[str, Any], step: Fraction | None) -> _Clock:
        """The clock of an entry, in steps of so many seconds."""
        low, to = exact(entry["from"]), entry["to"]
        high = None if to is None else exact(to)
        require(entry["unit"] in ("s", "steps"), "a clock has an unknown unit")
        if entry["unit"] == "s":
            require(step is not None and step > 0, "a clock has no step")
            low, high = low / (step or 1), None if high is None else high / (step or 1)
        first = floor(low) if entry.get("early", False) else ceil(low)
        last = None if high is None else floor(high)
        return cls(max(first, entry.get("least", 0)), last, entry["operands"])

    def after(self, ages: _Ages, letter: int) -> tuple[_Ages, bool]:
        """The ages after a letter of the table, and whether the clock holds."""
        code = self.operands[letter]
        kept = tuple([age + 1 for age in ages]) if code & 1 else ()
        if code & 2:
            kept = (0, *kept)
        if self.high is None:
            # The oldest decides for all; from ``low`` on it makes no difference how old it is.
            kept = tuple([min(age, self.low) for age in kept[-1:]])
        else:
            kept = tuple([age for age in kept if age <= self.high])
            if self.low == 0:
                kept = kept[:1]  # the youngest decides
        return kept, any(age >= self.low for age in kept)


class _Clocked:
    """The machine of an entry beside its clocks, over groups of letters."""

    def __init__(self, entry: Mapping[str, Any], step: Fraction | None, *, ends: bool) -> None:
        self.n_groups = max(entry["groups"]) + 1
        self._clocks = [_Clock.read(clock, step) for clock in entry["clocks"]]
        self._letters, self._following = entry["letters"], entry["following"]
        self._accepting, self._ends = entry["accepting"], ends
        self.start: _State = 0, ((),) * len(self._clocks)
        # Where every word has one verdict the past makes no difference.
        self._sinks = {
            state
            for state, row in enumerate(self._following)
            if {*row} == {state} and len({*self._accepting[state]}) == 1
        }
        self._settled: dict[tuple[_State, int], bool] = {}
        self._known: dict[tuple[_State, int], tuple[_State, bool]] = {}

    def behaviour(self, group: int) -> tuple[object, ...]:
        """What tells a group from others: what is read in its letters, whatever the clocks say."""
        letters = range(group, len(self._letters), self.n_groups)
        codes = [[clock.operands[letter] for letter in letters] for clock in self._clocks]
        return *[self._letters[letter] for letter in letters], *map(tuple, codes)

    def _read(self, state: _State, group: int) -> tuple[_State, bool]:
        known = self._known.get((state, group))
        if known is None:
            known = self._known[state, group] = self._step(state, group)
        return known

    def _step(self, state: _State, group: int) -> tuple[_State, bool]:
        letter, weight, later = group, self.n_groups, []
        for clock, ages in zip(self._clocks, state[1], strict=True):
            kept, holds = clock.after(ages, letter)
            letter += weight * holds
            weight *= 2
            later.append(kept)
        number = self._letters[letter]
        require(number >= 0, "its clocks read a letter that has no class")
        target = self._following[state[0]][number]
        held = self.start[1] if target in self._sinks else tuple(later)
        return (target, held), self._accepting[state[0]][number]

    def after(self, state: _State, group: int) -> tuple[_State, bool]:
        """The state after a letter of a group, and the verdict on a word that ends with it."""
        target, verdict = self._read(state, group)
        if self._ends:
            return target, verdict
        path: dict[tuple[_State, int], bool] = {}
        here = state
        while (here, group) not in path and (here, group) not in self._settled:
            following, accepted = self._read(here, group)
            path[here, group] = accepted
            here = following
        if (here, group) not in self._settled:
            loop = list(path)[list(path).index((here, group)) :]
            self._settled[here, group] = any(path[each] for each in loop)
        settled = self._settled[here, group]
        self._settled.update(dict.fromkeys(path, settled))
        return target, settled


def proof_steps(tree: Any) -> tuple[Fraction, ...]:
    """The steps (s) at which clocks are proved: bounds of a formula fit the first, not the second.

    So that no bound has many steps.
    """
    bounds = [number for number in _seconds(tree) if number]
    whole = lcm(*[number.denominator for number in bounds])
    fits = Fraction(gcd(*[int(number * whole) for number in bounds]) or 1, whole)
    return fits, fits * 2 / 3


def _seconds(tree: Any) -> Iterator[Fraction]:
    if isinstance(tree, list):
        bound = tree[-1]
        if isinstance(bound, dict) and bound.get("unit") == "s":
            yield from [exact(bound[end]) for end in ("from", "to") if bound[end] is not None]
        for part in tree[1:]:
            yield from _seconds(part)


def prove_clocks(
    entry: Mapping[str, Any], formula: FormulaMachine, step: Fraction, *, ends: bool
) -> None:
    """Raise UnprovableError unless a machine with clocks judges each word as a formula does."""
    clocked = _Clocked(entry, step, ends=ends)
    # Letters that are read alike, whatever the clocks say, as bits; and one group of them
    alike: dict[tuple[object, ...], tuple[int, bytearray]] = {}
    behaviour: dict[int, tuple[object, ...]] = {}
    for letter, group in enumerate(entry["groups"]):
        if group >= 0:
            key = behaviour.setdefault(group, clocked.behaviour(group))
            _, row = alike.setdefault(key, (group, bytearray(len(entry["groups"]) // 8 + 1)))
            row[letter // 8] |= 1 << letter % 8
    kinds = [(group, int.from_bytes(row, "little")) for group, row in alike.values()]
    same = sum([letters for _, letters in kinds]) == formula.possible
    require(same, "its clocks leave out other letters than the facts")
    reached = {(formula.progression.start, clocked.start)}
    for state, other in (waiting := list(reached)):
        for move in formula.moves(state):
            for group, letters in kinds:
                if letters & move.letters:
                    after, verdict = clocked.after(other, group)
                    require(
                        verdict is move.kept, "its clocks judge a word otherwise than its formula"
                    )
                    pair = move.target, after
                    if pair not in reached:
                        require(len(reached) < MOST_PAIRS, "its clocks have too many states")
                        reached.add(pair)
                        waiting.append(pair)
