"""Exact comparison of sums of columns with thresholds, mostly by floats.

A float stands for the decimal that Python writes for it, which is up to half a unit in the last
place away from the float itself. Sums of floats therefore decide only where they are further from a
threshold than all errors together can be; the few other sums are made of fractions.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import NumberRead
from rulec.automata.thresholds import exact
from rulec.trace.trace_columns import Array

Summand = tuple[Fraction, Array | float]
"""A coefficient, and a column of numbers (floats or whole numbers) or one number for all states."""

_UNIT = 2.0**-52
"""Twice the relative error of one rounding."""

_TINY = 1e-300
"""Far more than what is lost where results are too small to be normal floats."""


def digits_of_sum(
    read: NumberRead, summands: Sequence[Summand], n_states: int
) -> NDArray[np.uint8]:
    """For each state how many of the read's thresholds the sum passes."""
    total = np.zeros(n_states)
    size = np.zeros(n_states)
    with np.errstate(all="ignore"):
        for coefficient, numbers in summands:
            part = _nearest(coefficient) * np.asarray(numbers, dtype=np.float64)
            total += part
            size += np.abs(part)
        # Each part: its decimal, its coefficient, the product; then the sums, and the limit.
        error = size * ((len(summands) + 4) * _UNIT) + _TINY
        digits = np.zeros(n_states, dtype=np.uint8)
        unclear = ~np.isfinite(total + error)
        for threshold in read.thresholds:
            limit = _nearest(threshold.limit)
            away = total - limit
            digits += away > 0
            unclear |= ~(np.abs(away) > error + abs(limit) * _UNIT)
    for state in np.flatnonzero(unclear).tolist():
        digits[state] = read.digit(_exactly(summands, state))
    return digits


def _exactly(summands: Sequence[Summand], state: int) -> Fraction:
    result = Fraction(0)
    for coefficient, numbers in summands:
        number = numbers[state].item() if isinstance(numbers, np.ndarray) else numbers
        result += coefficient * exact(number)
    return result


def _nearest(number: Fraction) -> float:
    """Float nearest to a number; infinity, which decides nothing, on overflow."""
    try:
        return float(number)
    except OverflowError:
        return float("inf")
