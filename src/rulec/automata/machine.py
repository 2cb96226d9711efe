"""A rule as a table: what it reads of a state, and what each letter does to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Read:
    """One thing that a rule reads of every state: an enumeration or a signal.

    ``name`` is the declaration, ``variables`` the rule's variables that it is asked about.
    ``values`` are the enumeration's values that the rule tells apart, none for a signal.
    ``others`` says that the enumeration has further values, which the rule treats alike.
    """

    name: str
    variables: tuple[str, ...]
    values: tuple[str, ...] = ()
    others: bool = False

    @property
    def size(self) -> int:
        """How many different digits this read contributes to a letter."""
        return len(self.values) + self.others if self.values else 2

    def digit(self, value: bool | float | str) -> int:
        """The digit of a value: its index in ``values``, behind them for all others; 0 or 1."""
        if not self.values:
            return int(bool(value))
        return self.values.index(str(value)) if value in self.values else len(self.values)


@dataclass(frozen=True, slots=True)
class Machine:
    """A deterministic machine that judges a finite word under stutter semantics.

    A letter is a number in mixed radix: the digit of ``reads[0]`` counts ones, that of ``reads[1]``
    counts ``reads[0].size``, and so on. ``letters[letter]`` is its class; letters of one class do
    the same everywhere. ``following[state][class]`` is the next state; ``accepting[state][class]``
    is the verdict on a word that ends with such a letter read in that state, which is the verdict
    on repeating it for ever. Runs start in state 0. From state ``dead`` no word is accepted, from
    state ``safe`` every word is; None where there is no such state. The machine is minimal.
    """

    reads: tuple[Read, ...]
    letters: tuple[int, ...]
    following: tuple[tuple[int, ...], ...]
    accepting: tuple[tuple[bool, ...], ...]
    dead: int | None
    safe: int | None


def trap(
    following: Sequence[Sequence[int]], accepting: Sequence[Sequence[bool]], *, verdict: bool
) -> int | None:
    """The state that gives ``verdict`` whatever comes; a minimal machine has at most one."""
    for state, row in enumerate(following):
        if set(row) == {state} and all(value is verdict for value in accepting[state]):
            return state
    return None
