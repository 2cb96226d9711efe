"""Operators of time on truth with a row for each choice of objects, and a column for each state.

They follow ``logic.semantics`` on the stretch of a row.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.logic import formula as ltl
from rulec.logic.bounds import PAST, Range, range_of
from rulec.trace.partial_truth import Truth

RowEnding = Literal["over", "goes on", "cut"]
"""What follows a row's last state: nothing, the same state for ever, or unobserved states.

In a cut row the states before the first one are unobserved, too.
"""


@dataclass(frozen=True, slots=True, eq=False)
class RowStretches:
    """The ``first`` and the ``last`` state (rows x 1, both included) of each row."""

    first: NDArray[np.intp]
    last: NDArray[np.intp]
    ends: RowEnding


def temporal_unary(
    formula: ltl.Unary, operand: Truth, stretches: RowStretches, n_states: int
) -> Truth:
    """A temporal operator on one formula; its bound is in steps."""
    always = _always(n_states)
    join = _since if formula.operator in PAST else _until
    span = range_of(formula)
    match formula.operator:
        case (
            ltl.UnaryOperator.NEXT
            | ltl.UnaryOperator.EVENTUALLY
            | ltl.UnaryOperator.PREVIOUSLY
            | ltl.UnaryOperator.ONCE
        ):
            return join(always, operand, span, stretches)
        case ltl.UnaryOperator.NEVER:
            return ~join(always, operand, span, stretches)
        case _:
            return ~join(always, ~operand, span, stretches)


def temporal_binary(
    formula: ltl.Binary, left: Truth, right: Truth, stretches: RowStretches
) -> Truth:
    """A temporal operator between two formulas; its bound is in steps."""
    span = range_of(formula)
    match formula.operator:
        case ltl.BinaryOperator.UNTIL | ltl.BinaryOperator.THEN:
            return _until(left, right, span, stretches)
        case ltl.BinaryOperator.SINCE:
            return _since(left, right, span, stretches)
        case ltl.BinaryOperator.WEAK_UNTIL:
            return _weak_until(left, right, span, stretches)
        case ltl.BinaryOperator.RELEASE:
            return ~_until(~left, ~right, span, stretches)
        case _:
            return ~_weak_until(~left, ~right, span, stretches)


def _weak_until(left: Truth, right: Truth, span: Range, stretches: RowStretches) -> Truth:
    """Until, or ``left`` up to the end of the range."""
    breaks = _until(_always(left.sure.shape[-1]), ~left, Range(0, span.high), stretches)
    return _until(left, right, span, stretches) | ~breaks


def _always(n_states: int) -> Truth:
    return Truth.known(np.broadcast_to(np.True_, (1, n_states)))


def _since(left: Truth, right: Truth, span: Range, stretches: RowStretches) -> Truth:
    beyond: RowEnding = "cut" if stretches.ends == "cut" else "over"
    return _looked_back(left, right, span, stretches.first, beyond)


def _until(left: Truth, right: Truth, span: Range, stretches: RowStretches) -> Truth:
    """Until, computed as since on reversed states."""
    behind = left.sure.shape[-1] - 1 - stretches.last
    turned = np.s_[:, ::-1]
    return _looked_back(left[turned], right[turned], span, behind, stretches.ends)[turned]


def _looked_back(
    left: Truth,
    right: Truth,
    span: Range,
    first: NDArray[np.intp],
    beyond: RowEnding,
) -> Truth:
    """Since, with the given truth ``beyond`` a row's ``first`` state."""
    sure, _ = _since_known(left.sure, right.sure, span, first, goes_on=beyond == "goes on")
    possible, unbroken = _since_known(
        left.possible, right.possible, span, first, goes_on=beyond == "goes on"
    )
    if beyond == "cut" and (span.high is None or span.low <= span.high):
        state = np.arange(possible.shape[-1])
        reaches = True if span.high is None else state - span.high < first
        possible = possible | (unbroken & reaches)
    return Truth(sure, possible)


def _since_known(
    left: Flags, right: Flags, span: Range, first: NDArray[np.intp], *, goes_on: bool
) -> tuple[Flags, Flags]:
    """Since for known operands, and where ``left`` holds in all states back to the first one."""
    n_states = right.shape[-1]
    state = np.arange(n_states)
    there = state >= first
    latest = np.maximum.accumulate(np.where(right & there, state, -1), axis=1)
    broken = np.maximum.accumulate(np.where(~left & there, state, -1), axis=1)
    unbroken = (broken < 0) & there
    if span.low:
        earlier = np.full_like(latest, -1)
        earlier[:, span.low :] = latest[:, : max(n_states - span.low, 0)]
        latest = earlier
    result = (latest >= 0) & (broken <= latest)
    if span.high is not None:
        result &= latest >= state - span.high
    if goes_on and span.low and (span.high is None or span.low <= span.high):
        # States before the first one count as equal to it.
        like_first = (right & (state == first)).any(axis=1, keepdims=True)
        result = result | (like_first & unbroken & (state - span.low < first))
    return result, unbroken
