"""The deterministic machine of a formula, built by progression as states are reached.

A state holds what is still demanded of the rest of the word, as a function of parts of the formula
(Brzozowski's derivatives; Bacchus, Kabanza, "Planning for temporally extended goals", 1998), and
for each past part what its value will depend on: the values of its right side that still matter, by
age. If one demand implies another, or one occasion outlives another, only one is kept, so a bound
of n steps takes about n states, not 2^n. Nothing is shared with the compiler: neither Spot nor its
tables nor any of its code.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial, reduce
from typing import TypeAlias

from rulec.validation.demands import Demands, Future, Joined, Now, OfPast
from rulec.validation.functions import FALSE, TRUE, Function

Occasions: TypeAlias = tuple[tuple[int, Function], ...]
"""The values of a past part's right side that still matter, by age, the youngest first."""


@dataclass(frozen=True, slots=True)
class DemandState:
    """What is demanded from the next letter on, and what the past parts remember."""

    demand: Function
    memory: tuple[Occasions, ...]


class FormulaProgression:
    """The machine of a formula; ``root`` is the part of ``demands`` that is the formula."""

    def __init__(self, demands: Demands, root: int) -> None:
        self._demands, self._algebra = demands, demands.algebra
        self._full = demands.everything
        self.start = DemandState(frozenset({frozenset({root})}), ((),) * len(demands.past))
        self._moves: dict[DemandState, dict[DemandState, int]] = {}
        self._steps: dict[tuple[Occasions, ...], _Step] = {}
        self._repetitions: dict[tuple[Occasions, ...], _Repetition] = {}

    def moves(self, state: DemandState) -> dict[DemandState, int]:
        """The successor states, each with the letters that lead there."""
        if state not in self._moves:
            step = self._step(state.memory)
            memories = step.remembered()
            rest = step.after(state.demand)
            self._moves[state] = self._algebra.combined(rest, memories, _state)
        return self._moves[state]

    def memories(self, memory: tuple[Occasions, ...]) -> dict[tuple[Occasions, ...], int]:
        """What the past parts may remember next, each with its letters."""
        return self._step(memory).remembered()

    def _step(self, memory: tuple[Occasions, ...]) -> _Step:
        if memory not in self._steps:
            self._steps[memory] = _Step(self._demands, memory)
        return self._steps[memory]

    def holds_at_the_end(self, state: DemandState) -> bool:
        """The verdict if the word ends when this state is reached."""
        parts = self._demands.parts
        return any(all(_is_dual(parts[literal]) for literal in term) for term in state.demand)

    def kept_for_ever(self, state: DemandState) -> int:
        """The letters that satisfy a state's demand if they are repeated for ever from there on."""
        if state.memory not in self._repetitions:
            self._repetitions[state.memory] = _Repetition(self._demands, state.memory)
        return self._repetitions[state.memory].first(state.demand)


def _with_occasion(age: int, known: Occasions, value: Function) -> Occasions:
    return (*known, (age, value))


def _state(demand: Function, memory: tuple[Occasions, ...]) -> DemandState:
    # A decided demand no longer depends on the past.
    return DemandState(demand, () if demand in (TRUE, FALSE) else memory)


def _is_dual(part: object) -> bool:
    return isinstance(part, Future) and part.dual


class _Step:
    """The values of parts at one instant, by letters: functions of demands on later instants."""

    def __init__(self, demands: Demands, memory: tuple[Occasions, ...]) -> None:
        self._demands, self._algebra = demands, demands.algebra
        self._full = demands.everything
        # A state without demands remembers nothing.
        self._memory = memory or ((),) * len(demands.past)
        self._values: dict[int, dict[Function, int]] = {}
        self._occasions: dict[int, dict[Occasions, int]] = {}

    def after(self, function: Function) -> dict[Function, int]:
        """What a function of demands on this instant demands of the next one, by letters."""
        algebra = self._algebra
        whole: dict[Function, int] = {FALSE: self._full}
        for term in function:
            rest: dict[Function, int] = {TRUE: self._full}
            for literal in term:
                rest = algebra.combined(rest, self._value(literal), algebra.both)
            whole = algebra.combined(whole, rest, algebra.either)
        return whole

    def _value(self, number: int) -> dict[Function, int]:
        if number not in self._values:
            self._values[number] = self._evaluated(number)
        return self._values[number]

    def _evaluated(self, number: int) -> dict[Function, int]:
        algebra = self._algebra
        match self._demands.parts[number]:
            case Now(letters):
                sides = {TRUE: letters, FALSE: self._full & ~letters}
                return {value: side for value, side in sides.items() if side}
            case Joined(conjoined, left, right):
                join = algebra.both if conjoined else algebra.either
                return algebra.combined(self._value(left), self._value(right), join)
            case Future() as part:
                return self._future(part)
            case OfPast(past, holds):
                least = self._demands.past[past].low
                values: dict[Function, int] = {}
                for occasions, letters in self._occasions_of(past).items():
                    value = reduce(
                        algebra.either, [each for age, each in occasions if age >= least], FALSE
                    )
                    value = value if holds else self._demands.negated_function(value)
                    values[value] = values.get(value, 0) | letters
                return values

    def _future(self, part: Future) -> dict[Function, int]:
        """``right``, or ``left`` and the same from the next instant on; or the dual."""
        algebra = self._algebra
        extend, choose = (
            (algebra.either, algebra.both) if part.dual else (algebra.both, algebra.either)
        )
        rest: dict[Function, int] | None = None
        if part.high is None or part.high > 0:
            high = None if part.high is None else part.high - 1
            later = Future(part.dual, max(part.low - 1, 0), high, part.left, part.right)
            again = frozenset({frozenset({self._demands.number(later)})})
            rest = algebra.combined(self._value(part.left), {again: self._full}, extend)
        if part.low > 0 and rest is not None:
            return rest
        now = self._value(part.right)
        return now if rest is None else algebra.combined(now, rest, choose)

    def _occasions_of(self, past: int) -> dict[Occasions, int]:
        """What a past part remembers after this instant, by letters."""
        if past not in self._occasions:
            algebra, part = self._algebra, self._demands.past[past]
            left, right = self._value(part.left), self._value(part.right)
            remembered: dict[Occasions, int] = {(): self._full}
            news = [(0, right)]
            for age, function in self._memory[past]:
                older = age + 1 if part.high is not None else min(age + 1, part.low)
                if part.high is None or older <= part.high:
                    still = algebra.combined(left, self.after(function), algebra.both)
                    news.append((older, still))
            for age, values in news:
                remembered = algebra.combined(remembered, values, partial(_with_occasion, age))
            kept: dict[Occasions, int] = {}
            for occasions, letters in remembered.items():
                normal = self._that_count(occasions, part.low, part.high)
                kept[normal] = kept.get(normal, 0) | letters
            self._occasions[past] = kept
        return self._occasions[past]

    def _that_count(self, occasions: Occasions, low: int, high: int | None) -> Occasions:
        """The occasions that no others outlive."""
        by_age: dict[int, Function] = {}
        for age, value in occasions:
            if value != FALSE:
                by_age[age] = self._algebra.either(by_age.get(age, FALSE), value)
        sure = sorted(age for age, value in by_age.items() if value == TRUE)
        if high is None:
            # The oldest comes within reach first, and stays there.
            least, most = (sure[-1] if sure else 0), low
        else:
            # Of those within reach, the youngest stays longest.
            least, most = 0, next((age for age in sure if age >= low), high)
        return tuple(sorted((age, by_age[age]) for age in by_age if least <= age <= most))

    def remembered(self) -> dict[tuple[Occasions, ...], int]:
        """What all past parts remember after this instant, by letters."""
        by_memory: dict[tuple[Occasions, ...], int] = {(): self._full}
        for past in range(len(self._demands.past)):
            by_memory = self._algebra.combined(
                by_memory, self._occasions_of(past), lambda known, own: (*known, own)
            )
        return by_memory


class _Repetition:
    """The truth of parts at each instant while one letter is repeated for ever, for all letters.

    Values are lists of sets of letters (as bits), one for each instant from now on; the last one
    also stands for all later instants.
    """

    def __init__(self, demands: Demands, memory: tuple[Occasions, ...]) -> None:
        self._demands, self._full = demands, demands.everything
        self._memory = memory or ((),) * len(demands.past)
        self._values: dict[int, list[int]] = {}

    def first(self, function: Function) -> int:
        """The letters for which a function of demands on the present instant is true."""
        true = 0
        for term in function:
            letters = self._full
            for literal in term:
                letters &= self._value(literal)[0]
            true |= letters
        return true

    def _value(self, number: int) -> list[int]:
        if number not in self._values:
            value = self._evaluated(number)
            self._demands.algebra.count(len(value))
            while len(value) > 1 and value[-1] == value[-2]:
                value.pop()
            self._values[number] = value
        return self._values[number]

    def _evaluated(self, number: int) -> list[int]:
        match self._demands.parts[number]:
            case Now(letters):
                return [letters]
            case Joined(conjoined, left, right):
                pairs = _aligned(self._value(left), self._value(right), 0)
                return [first & second if conjoined else first | second for first, second in pairs]
            case Future(True):
                until = self._value(self._demands.negated(number))
                return [self._full & ~letters for letters in until]
            case Future(_, low, high, left, right):
                return self._until(_aligned(self._value(left), self._value(right), 0), low, high)
            case OfPast(past, holds):
                values = self._since(past)
                return values if holds else [self._full & ~letters for letters in values]

    def _until(self, pairs: list[tuple[int, int]], low: int, high: int | None) -> list[int]:
        """Where ``right`` holds ``low`` to ``high`` instants later, and ``left`` until then.

        All instants after the last are like it.
        """
        lefts, rights = [left for left, _ in pairs], [right for _, right in pairs]
        nothing = [0] * len(pairs)
        if high is None:
            value = rights[:]
            for at in reversed(range(len(pairs) - 1)):
                value[at] |= lefts[at] & value[at + 1]
        else:
            value = self._instant_before(rights, lefts, rights, high - low)
        return self._instant_before(value, lefts, nothing, low)

    def _instant_before(
        self, value: list[int], lefts: list[int], rights: list[int], times: int
    ) -> list[int]:
        """``right``, or ``left`` and the value one instant later; applied ``times`` times."""
        for _ in range(times):
            self._demands.algebra.count(len(value))
            later = [*value[1:], value[-1]]
            again = [
                right | left & ahead
                for left, right, ahead in zip(lefts, rights, later, strict=True)
            ]
            if again == value:
                break
            value = again
        return value

    def _since(self, past: int) -> list[int]:
        part = self._demands.past[past]
        reach = part.low if part.high is None else part.high
        left_values, right_values = self._value(part.left), self._value(part.right)
        steady = max(len(left_values), len(right_values))
        occasions = {age: self.first(value) for age, value in self._memory[past]}
        values = []
        for at, (left, right) in enumerate(_aligned(left_values, right_values, reach)):
            older: dict[int, int] = {0: right}
            for age, letters in occasions.items():
                later = age + 1 if part.high is not None else min(age + 1, part.low)
                if letters & left and (part.high is None or later <= part.high):
                    older[later] = older.get(later, 0) | letters & left
            holds_for = 0
            for age, letters in older.items():
                if age >= part.low:
                    # Of occasions within reach, the youngest stays longest.
                    older[age] = letters & ~holds_for
                    holds_for |= letters
            before, occasions = occasions, {age: each for age, each in older.items() if each}
            self._demands.algebra.count(len(older))
            values.append(holds_for)
            if at >= steady and occasions == before:
                break
        return values


def _aligned(first: list[int], second: list[int], longer: int) -> list[tuple[int, int]]:
    """Pairs of two lists' values, instant by instant, and for ``longer`` more instants."""
    length = max(len(first), len(second)) + longer
    return [
        (first[min(at, len(first) - 1)], second[min(at, len(second) - 1)]) for at in range(length)
    ]
