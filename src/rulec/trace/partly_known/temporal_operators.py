"""Operators of time on truth that is partly known, with a place for each state.

They follow ``logic.semantics``, and know where traces begin and end: what they would have to look
up beyond is unknown if the trace is cut.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
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
        return bool(half & self._all)

    def since(self, left: Truth[int], right: Truth[int], span: Range) -> Truth[int]:
        """``right`` in the span back, and ``left`` in all states after it up to the present one."""
        outside = Truth(0, -1) if self.ends == "cut" else Truth.known(0)
        return self._found(left, right, span, (outside, outside), way=1)

    def until(self, left: Truth[int], right: Truth[int], span: Range) -> Truth[int]:
        """``right`` in the span ahead, and ``left`` in all states from the present to before it."""
        outside = Truth(0, -1) if self.ends == "cut" else Truth.known(0)
        beyond = outside, outside
        if self.ends == "goes on":
            beyond = self._last(left), self._last(right)
        return self._found(left, right, span, beyond, way=-1)

    @property
    def _all(self) -> int:
        return (1 << self.n_states) - 1

    def _last(self, truth: Truth[int]) -> Truth[int]:
        """The truth in the last state, for every state."""
        sure, possible = (
            -(half >> (self.n_states - 1) & 1) for half in (truth.sure, truth.possible)
        )
        return Truth.known(sure) if sure == possible else Truth(sure, possible)

    def _found(
        self,
        left: Truth[int],
        right: Truth[int],
        span: Range,
        beyond: tuple[Truth[int], Truth[int]],
        *,
        way: Literal[1, -1],
    ) -> Truth[int]:
        search = _Search(self.n_states, way, beyond[0].sure, beyond[1].sure)
        sure = search.found(left.sure, right.sure, span)
        if all(truth.is_known for truth in (left, right, *beyond)):
            return Truth.known(sure)
        search = _Search(self.n_states, way, beyond[0].possible, beyond[1].possible)
        return Truth(sure, search.found(left.possible, right.possible, span))


@dataclass(frozen=True, slots=True)
class _Search:
    """A search back (``way`` 1) or ahead (-1), with what holds beyond the states: 0 or -1."""

    n_states: int
    way: Literal[1, -1]
    left_beyond: int
    right_beyond: int

    def found(self, left: int, right: int, span: Range) -> int:
        """The bits of the states that find ``right`` in the span, with ``left`` in all between.

        Each step doubles how far it looks, as in Kogge, Stone, "A parallel algorithm for the
        efficient solution of a general class of recurrence equations" (1973).
        """
        # Farther away all states are alike
        low = min(span.low, self.n_states + 1)
        high = low + self.n_states if span.high is None else min(span.high, low + self.n_states)
        if high < low:
            return 0
        reached, clear, width = right, left, 1
        while width <= high - low:
            more = min(width, high - low + 1 - width)
            reached |= clear & self._shifted(reached, more, self.right_beyond)
            clear &= self._shifted(clear, more, self.left_beyond)
            width += more
        result, clear, width = self._shifted(reached, low, self.right_beyond), left, 1
        while width < low:
            more = min(width, low - width)
            clear &= self._shifted(clear, more, self.left_beyond)
            width += more
        return result & clear if low else result

    def _shifted(self, bits: int, steps: int, beyond: int) -> int:
        """What holds so many steps back or ahead."""
        inside = (1 << self.n_states) - 1
        if self.way > 0:
            return (bits << steps | beyond & ((1 << steps) - 1)) & inside
        return (bits & inside | beyond & ~inside) >> steps & inside
