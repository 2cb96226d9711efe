"""Operators of time on truth that is partly known, with a place for each state.

They follow ``logic.semantics``, and know where traces begin and end: what they would have to look
up beyond is unknown if the trace is cut.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from operator import lshift, rshift
from typing import Generic, Literal

from rulec.logic import formula as ltl
from rulec.logic.bounds import Range
from rulec.logic.fold import Algebra, temporal_operation
from rulec.trace.partly_known.partly_known_values import Half, Truth

Beyond = Literal["over", "goes on", "cut"]
"""What follows the last state: nothing, the same state for ever, or unobserved states.

If cut, the states before the first one are unobserved, too.
"""


class Instants(ABC, Generic[Half]):
    """The states that operators of time look at, and what lies beyond them. Bounds are in steps."""

    @property
    @abstractmethod
    def always(self) -> Truth[Half]:
        """What is true in every state."""

    @abstractmethod
    def is_somewhere(self, half: Half) -> bool:
        """Whether half of a truth holds in some state."""

    @abstractmethod
    def since(self, left: Truth[Half], right: Truth[Half], span: Range) -> Truth[Half]:
        """``right`` in the span back, and ``left`` in all states after it up to the present one."""

    @abstractmethod
    def until(self, left: Truth[Half], right: Truth[Half], span: Range) -> Truth[Half]:
        """``right`` in the span ahead, and ``left`` in all states from the present to before it."""

    def algebra(
        self,
        proposition: Callable[[ltl.Proposition], Truth[Half]],
        identity: Callable[[ltl.Same], Truth[Half]] | None = None,
    ) -> Algebra[Truth[Half]]:
        """The meaning of formulas in these states, from that of their propositions."""
        return Algebra(
            proposition=proposition,
            identity=identity,
            constant=lambda value: self.always if value else ~self.always,
            negation=Truth.__invert__,
            conjunction=Truth.__and__,
            disjunction=Truth.__or__,
            equivalence=Truth.same_as,
            is_false=lambda truth: not self.is_somewhere(truth.possible),
            operation=temporal_operation(
                Truth.__invert__,
                until=partial(self._joined, self.until),
                release=lambda left, right, span: (
                    ~self._joined(self.until, None if left is None else ~left, ~right, span)
                ),
                weak_until=self._weak_until,
                strong_release=lambda left, right, span: ~self._weak_until(~left, ~right, span),
                since=partial(self._joined, self.since),
            ),
        )

    def _joined(
        self,
        join: Callable[[Truth[Half], Truth[Half], Range], Truth[Half]],
        left: Truth[Half] | None,
        right: Truth[Half],
        span: Range,
    ) -> Truth[Half]:
        return join(self.always if left is None else left, right, span)

    def _weak_until(self, left: Truth[Half], right: Truth[Half], span: Range) -> Truth[Half]:
        """Until, or ``left`` up to the end of the span."""
        breaks = self.until(self.always, ~left, Range(0, span.high))
        return self.until(left, right, span) | ~breaks


@dataclass(frozen=True, slots=True)
class BitInstants(Instants[int]):
    """The states of one trace, as bits of integers: the first is the lowest bit."""

    n_states: int
    ends: Beyond

    @property
    def always(self) -> Truth[int]:
        """What is true in every state."""
        return Truth.known(-1)

    def is_somewhere(self, half: int) -> bool:
        """Whether a bit of a state is set."""
        return half & self._inside != 0

    def since(self, left: Truth[int], right: Truth[int], span: Range) -> Truth[int]:
        """``right`` in the span back, and ``left`` in all states after it up to the present one."""
        return self._found(left, right, span, _from_ones if self.ends == "cut" else lshift)

    def until(self, left: Truth[int], right: Truth[int], span: Range) -> Truth[int]:
        """``right`` in the span ahead, and ``left`` in all states from the present to before it."""
        left, right = self._continued(left), self._continued(right)
        return self._found(left, right, span, rshift)

    @property
    def _inside(self) -> int:
        return (1 << self.n_states) - 1

    def _continued(self, truth: Truth[int]) -> Truth[int]:
        """The truth with bits for all that follows the last state."""
        inside, last = self._inside, self.n_states - 1
        if self.ends == "cut":
            return Truth(truth.sure & inside, truth.possible | ~inside)
        if self.ends == "over":
            return truth.each(lambda half: half & inside)
        return truth.each(lambda half: half & inside | -(half >> last & 1) & ~inside)

    def _found(
        self, left: Truth[int], right: Truth[int], span: Range, shifted: Callable[[int, int], int]
    ) -> Truth[int]:
        """A search by shifts; those of what is sure let in no states from beyond the first one."""
        surely = lshift if shifted is _from_ones else shifted
        sure = _bits_found(left.sure, right.sure, span, self.n_states, surely)
        if left.is_known and right.is_known and surely is shifted:
            return Truth.known(sure)
        return Truth(sure, _bits_found(left.possible, right.possible, span, self.n_states, shifted))


def _from_ones(bits: int, steps: int) -> int:
    """Bits shifted to the left, with ones behind them."""
    return ~(~bits << steps)


def _bits_found(
    left: int, right: int, span: Range, n_states: int, shifted: Callable[[int, int], int]
) -> int:
    """The bits of the states that find ``right`` in the span, with ``left`` in all between.

    Each step doubles how far it looks, as in Kogge, Stone, "A parallel algorithm for the efficient
    solution of a general class of recurrence equations" (1973).
    """
    # Farther away all states are alike
    low = min(span.low, n_states + 1)
    high = low + n_states if span.high is None else min(span.high, low + n_states)
    if high < low:
        return 0
    reached, clear, width = right, left, 1
    while width <= high - low:
        more = min(width, high - low + 1 - width)
        reached |= clear & shifted(reached, more)
        clear &= shifted(clear, more)
        width += more
    clear, width = left if low else -1, 1
    while width < low:
        more = min(width, low - width)
        clear &= shifted(clear, more)
        width += more
    return shifted(reached, low) & clear & (1 << n_states) - 1
