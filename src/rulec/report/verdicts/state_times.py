"""Times of a trace's states, beside their numbers."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.thresholds import exact
from rulec.logic.printing import number_in_words

_DIGITS = 9
"""Sums of steps are said without the noise of floats."""

_LONGEST_S = 10**12
"""A file may have any step; of later states, after 30,000 years, the number says enough."""


@dataclass(frozen=True, slots=True)
class StateTimes:
    """Times of states: the first one is at ``start_s``, the next ones ``step_s`` apart.

    From 0 on, a second apart, which is also the step where nobody has told one, numbers say it all.
    """

    start_s: float = 0.0
    step_s: float = 1.0

    def of(self, first: int, last: int | None = None) -> str:
        """What is said behind the number of a state, such as `` (3.7 s)``, or behind a stretch."""
        if self == NUMBERS_ALONE or self._time(first if last is None else last) > _LONGEST_S:
            return ""
        if last in (None, first):
            return f" ({self._at(first)} s)"
        return f" ({self._at(first)}-{self._at(last)} s)"

    def _at(self, state: int) -> str:
        return number_in_words(round(self._time(state), _DIGITS))

    def _time(self, state: int) -> Fraction:
        return exact(self.start_s) + state * exact(self.step_s)


NUMBERS_ALONE = StateTimes()
