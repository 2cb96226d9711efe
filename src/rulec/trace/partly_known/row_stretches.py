"""Operators of time on masks with rows of states, each of a stretch with a beginning and an end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.logic.bounds import Range
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.partly_known.temporal_operators import Beyond, Instants


@dataclass(frozen=True, slots=True, eq=False)
class RowStretches(Instants[Flags]):
    """The ``first`` and ``last`` state (both included) of each row, or of each state's own stretch.

    That is rows x 1, or one of each state where several drives are laid end to end. Masks may have
    one row for all, or one column for all ``n_states``.
    """

    first: Indices
    last: Indices
    n_states: int
    ends: Beyond

    @property
    def always(self) -> Truth:
        """What is true in every state."""
        return Truth.known(np.ones((1, 1), dtype=bool))

    def is_somewhere(self, half: Flags) -> bool:
        """Whether some state of some row is flagged."""
        return bool(half.any())

    def since(self, left: Truth, right: Truth, span: Range) -> Truth:
        """``right`` in the span back, and ``left`` in all states after it up to the present one."""
        return _looked_back(left, right, span, self, "cut" if self.ends == "cut" else "over")

    def until(self, left: Truth, right: Truth, span: Range) -> Truth:
        """``right`` in the span ahead, and ``left`` in all states from the present to before it."""
        # The same as since, on reversed states
        last = self.n_states - 1
        turned = np.s_[..., ::-1]
        behind, ahead = (last - ends[turned] for ends in (self.last, self.first))
        reverse = RowStretches(behind, ahead, self.n_states, self.ends)
        own, other = (truth.each(lambda half: half[turned]) for truth in (left, right))
        found = _looked_back(own, other, span, reverse, self.ends)
        return found.each(lambda half: half[turned])


def _looked_back(
    left: Truth, right: Truth, span: Range, stretches: RowStretches, beyond: Beyond
) -> Truth:
    """Since, with the given truth ``beyond`` a row's first state."""
    goes_on = beyond == "goes on"
    sure, unbroken = _since_known(left.sure, right.sure, span, stretches, goes_on=goes_on)
    possible = sure
    if not (left.is_known and right.is_known):
        possible, unbroken = _since_known(
            left.possible, right.possible, span, stretches, goes_on=goes_on
        )
    if beyond == "cut" and (span.high is None or span.low <= span.high):
        state = np.arange(stretches.n_states)
        reaches = True if span.high is None else state - span.high < stretches.first
        possible = possible | (unbroken & reaches)
    return Truth(sure, possible)


def _since_known(
    left: Flags, right: Flags, span: Range, stretches: RowStretches, *, goes_on: bool
) -> tuple[Flags, Flags]:
    """Since for known operands, and where ``left`` holds in all states back to the first one."""
    first, n_states = stretches.first, stretches.n_states
    state = np.arange(n_states)
    there = state >= first
    latest = np.maximum.accumulate(np.where(right & there, state, -1), axis=-1)
    broken = np.maximum.accumulate(np.where(~left & there, state, -1), axis=-1)
    unbroken = (broken < first) & there
    if span.low:
        earlier = np.full_like(latest, -1)
        earlier[..., span.low :] = latest[..., : max(n_states - span.low, 0)]
        latest = earlier
    result = (latest >= first) & (broken <= latest)
    if span.high is not None:
        result &= latest >= state - span.high
    if goes_on and span.low and (span.high is None or span.low <= span.high):
        # States before the first one count as equal to it.
        shape = np.broadcast_shapes(right.shape, there.shape)
        at_first = np.broadcast_to(first, shape)
        like_first = np.take_along_axis(np.broadcast_to(right, shape), at_first, axis=-1)
        result = result | (like_first & unbroken & (state - span.low < first))
    return result, unbroken
