"""Times of a trace's states, beside their numbers."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.thresholds import exact
from rulec.logic.printing import number_in_words

_DIGITS = 9
"""Number of decimals shown, which hides the rounding errors of floats."""

_LONGEST_S = 10**12
"""A file may have any step; after this time (s), 30,000 years, only the state's number is shown."""


@dataclass(frozen=True, slots=True)
class StateTimes:
    """Times of states: the first one is at ``start_s``, later ones ``step_s`` apart.

    With start 0 and step 1 s, which is also the step if none is known, only numbers are shown.
    """

    start_s: float = 0.0
    step_s: float = 1.0

    def of(self, first: int, last: int | None = None) -> str:
        """The text after a state's number, such as `` (3.7 s)``, or after a range of states."""
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
