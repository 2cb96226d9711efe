"""Mealy monitor of a rule: its reads, letters, successors and outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.logic.formula import Term
from rulec.value_display import short_repr

IMPOSSIBLE = -1
"""The class of letters that no state can have, because the vocabulary's facts exclude them."""


@dataclass(frozen=True, slots=True)
class Read:
    """An enumeration or signal that a rule reads in every state.

    ``name`` is the declaration's name, ``variables`` are the rule's variables used as arguments.
    ``values`` are the enumeration's values that the rule distinguishes (none for a signal);
    ``others`` is true if the enumeration has further values, which the rule treats alike.
    """

    name: str
    variables: tuple[str, ...]
    values: tuple[str, ...] = ()
    others: bool = False

    @property
    def size(self) -> int:
        """The number of different digits that this read contributes to a letter."""
        return len(self.values) + self.others if self.values else 2

    def digit(self, value: bool | float | str) -> int:
        """The digit of a value: 0 or 1 for a signal, else its index; all other values come last."""
        if not self.values:
            return int(bool(value))
        return self.values.index(str(value)) if value in self.values else len(self.values)


@dataclass(frozen=True, slots=True)
class Threshold:
    """A limit that splits the values of a number into two sides.

    Numbers above ``limit`` pass it; so does the limit itself if ``inclusive``.
    """

    limit: Fraction
    inclusive: bool


@dataclass(frozen=True, slots=True)
class NumberRead:
    """A linear combination of numbers that a rule reads in every state.

    ``terms`` are as in ``Comparison``. A number's digit is the number of ``thresholds`` that it
    passes; they are in ascending order (the inclusive one first where limits are equal).
    """

    terms: tuple[tuple[Fraction, Term], ...]
    thresholds: tuple[Threshold, ...]

    @property
    def size(self) -> int:
        """The number of different digits that this read contributes to a letter."""
        return len(self.thresholds) + 1

    def digit(self, value: Fraction) -> int:
        """The digit of a number."""
        return sum(
            value >= threshold.limit if threshold.inclusive else value > threshold.limit
            for threshold in self.thresholds
        )


@dataclass(frozen=True, slots=True)
class MealyMonitor:
    """A deterministic machine that judges a finite word.

    The verdict follows its rulebook's semantics: on the word with its last letter repeated for ever
    (stutter), or on the word as it is (finite). A letter is a number in mixed radix: the digit of
    ``reads[0]`` counts ones, that of ``reads[1]`` counts ``reads[0].size``, and so on.
    ``letters[letter]`` is its class; letters of one class behave the same in every state;
    ``IMPOSSIBLE`` marks those that axioms exclude. ``successors[state][class]`` is the next state;
    ``outputs[state][class]`` is the verdict on a word that ends with such a letter read in that
    state. Runs start in state 0. From state ``rejecting_sink`` no word is accepted, from
    ``accepting_sink`` every word is; None if there is no such state. The machine is minimal.
    """

    __repr__ = short_repr

    reads: tuple[Read | NumberRead, ...]
    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[bool, ...], ...]
    rejecting_sink: int | None
    accepting_sink: int | None


def sink_of(
    successors: Sequence[Sequence[int]], outputs: Sequence[Sequence[bool]], *, verdict: bool
) -> int | None:
    """The sink of a minimal machine with this constant ``verdict``; None if there is none."""
    for state, row in enumerate(successors):
        if set(row) == {state} and all(value is verdict for value in outputs[state]):
            return state
    return None


def stutter_invariant(machine: MealyMonitor) -> bool:
    """Whether repeating a letter never changes a verdict (Lamport's stuttering).

    Reading a letter once more must change neither the verdict on a word that ends there nor the
    future of any longer word. In a minimal machine no two states have the same future, so the table
    shows whether this holds.
    """
    successors, outputs = machine.successors, machine.outputs
    return all(
        successors[after][symbol] == after and outputs[after][symbol] == verdicts[symbol]
        for row, verdicts in zip(successors, outputs, strict=True)
        for symbol, after in enumerate(row)
    )
