"""Numbers that rules read as digits: how many thresholds they pass, for many states at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.automata.thresholds import ThresholdScale, exact, scale
from rulec.logic import formula as ltl
from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import Numbers
from rulec.trace.partly_known.partly_known_values import (
    Number,
    Truth,
)
from rulec.trace.trace_columns import Array, smallest_unsigned

Mask = NDArray[np.bool_] | np.bool_

Summand = tuple[Fraction, Array | float]
"""A coefficient with a column of numbers (floats or integers), or with one number for all."""

Summands = Sequence[tuple[Fraction, Number]]
"""Coefficients with numbers that are known between two ends."""

_UNIT = 2.0**-52
"""Twice the relative error of a single rounding."""

_TINY = 1e-300
"""An error bound that covers results too small to be normal floats."""


def digits_of(ready: ThresholdScale, summands: Sequence[Summand]) -> Array:
    """The number of thresholds passed at each place; arbitrary where a sum is not finite."""
    match ready.read.terms:
        case ((_, ltl.Count()),):
            ((_, counted),) = summands
            return _digits_of_count(ready.read, np.asarray(counted))
    if ready.quantity is None:
        return _digits_of_sum(ready.read, summands)
    numbers = np.asarray(summands[0][1])
    digits = np.zeros(numbers.shape, dtype=smallest_unsigned(ready.read.size))
    for floor in ready.floors:
        digits += (numbers >= floor).view(np.uint8)
    return digits


def digits_between(ready: ThresholdScale, summands: Summands) -> tuple[Array, Array]:
    """The least and the greatest digit of a sum; the same array if it is known."""
    lows = [(factor, own.low if factor > 0 else own.high) for factor, own in summands]
    low = digits_of(ready, lows)
    if all(own.low is own.high for _, own in summands):
        return low, low
    highs = [(factor, own.high if factor > 0 else own.low) for factor, own in summands]
    return low, digits_of(ready, highs)


def numbers_between(ready: ThresholdScale, summands: Summands) -> Numbers:
    """The numbers, as in ``StackedRead.meanings``, of a sum; one number if all are equal."""
    low, high = digits_between(ready, summands)
    size = ready.read.size
    dtype = smallest_unsigned(size**2)
    numbers: Array
    if low is high:
        numbers = low.astype(dtype) * dtype.type(size + 1)
    else:
        numbers = low.astype(dtype) * dtype.type(size) + high.astype(dtype)
    return numbers if numbers.ndim else int(numbers)


def _digits_of_sum(read: NumberRead, summands: Sequence[Summand]) -> Array:
    """For each place the number of the read's thresholds that the sum passes."""
    spread = np.broadcast_arrays(*[numbers for _, numbers in summands])
    parts = [(factor, own.ravel()) for (factor, _), own in zip(summands, spread, strict=True)]
    total = np.zeros(spread[0].size)
    size, is_finite = np.zeros(len(total)), np.ones(len(total), dtype=bool)
    with np.errstate(all="ignore"):
        for coefficient, numbers in parts:
            part = _nearest(coefficient) * np.asarray(numbers, dtype=np.float64)
            total += part
            size += np.abs(part)
            is_finite &= np.isfinite(numbers)
        # Each part: its decimal, its coefficient, the product; then the sums, and the limit.
        error = size * ((len(parts) + 4) * _UNIT) + _TINY
        digits = np.zeros(len(total), dtype=smallest_unsigned(read.size))
        unclear = ~np.isfinite(total + error)
        for threshold in read.thresholds:
            limit = _nearest(threshold.limit)
            away = total - limit
            digits += away > 0
            unclear |= ~(np.abs(away) > error + abs(limit) * _UNIT)
    # The same few numbers are often at a limit; a sum with an end that is not known has none
    known: dict[tuple[float, ...], int] = {}
    for place in (unclear & is_finite).nonzero()[0].tolist():
        own = tuple([numbers[place].item() for _, numbers in parts])
        if own not in known:
            known[own] = read.digit(_exactly(summands, own))
        digits[place] = known[own]
    return digits.reshape(spread[0].shape)


def _digits_of_count(read: NumberRead, counted: Array) -> Array:
    """The number of the read's thresholds that the number of objects passes in each state."""
    digits = [read.digit(Fraction(n)) for n in range(int(counted.max(initial=0)) + 1)]
    return np.array(digits, dtype=smallest_unsigned(read.size)).take(counted)


def _exactly(summands: Sequence[Summand], numbers: Sequence[float]) -> Fraction:
    pairs = zip(summands, numbers, strict=True)
    return sum((coefficient * exact(own) for (coefficient, _), own in pairs), Fraction(0))


def _nearest(number: Fraction) -> float:
    """The float nearest to a number; infinity, which decides nothing, on overflow."""
    try:
        return float(number)
    except OverflowError:
        return float("inf")


_SIDES = {"<": (0,), "<=": (0, 1), "=": (1,), "!=": (0, 2), ">=": (1, 2), ">": (2,)}
"""The sides of the limit on which a comparison holds: 0 below it, 1 at it, 2 above it."""


@dataclass(frozen=True, slots=True, eq=False)
class ComparisonSides:
    """A comparison, with its limit as thresholds and its outcome for each pair of sides.

    ``every`` and ``some`` (3 x 3, lowest by highest side that the number may be on) say whether the
    comparison holds on all sides between the two, and on some.
    """

    scale: ThresholdScale
    every: NDArray[np.bool_]
    some: NDArray[np.bool_]


@lru_cache(maxsize=1 << 8)
def comparison_sides(
    terms: tuple[tuple[Fraction, ltl.Term], ...], relation: ltl.Relation, limit: Fraction
) -> ComparisonSides:
    """The sides for the comparison of these terms with a limit."""
    thresholds = tuple(Threshold(limit, inclusive) for inclusive in (True, False))
    holds = np.isin(np.arange(3), _SIDES[relation])
    pairs = [[holds[low : high + 1] for high in range(3)] for low in range(3)]
    return ComparisonSides(
        scale(NumberRead(terms, thresholds)),
        np.array([[sides.all() for sides in row] for row in pairs]),
        np.array([[sides.any() for sides in row] for row in pairs]),
    )


def truth_between(ready: ComparisonSides, summands: Summands) -> Truth:
    """The truth of a comparison whose terms have these coefficients and values."""
    low, high = digits_between(ready.scale, summands)
    if low is high:
        return Truth.known(ready.every.diagonal()[low])
    return Truth(ready.every[low, high], ready.some[low, high])


def alike_places(columns: Iterable[NDArray[Any]], n_places: int) -> NDArray[np.intp]:
    """Numbers from 0 for positions; two are equal where all columns have the same values there."""
    group_of = np.zeros(n_places, dtype=np.intp)
    for column in columns:
        codes = np.unique(column, return_inverse=True)[1]
        codes += group_of * (int(codes.max(initial=0)) + 1)
        group_of = np.unique(codes, return_inverse=True)[1]
    return group_of
