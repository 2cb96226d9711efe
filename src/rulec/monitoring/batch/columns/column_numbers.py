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
"""A coefficient with a column of numbers (floats or integers), or with one number for all states.


"""

_UNIT = 2.0**-52
"""Twice the relative error of a single rounding."""

_TINY = 1e-300
"""An error bound that covers results too small to be normal floats."""


def digits_of(
    ready: ThresholdScale, summands: Sequence[Summand], n_states: int, ignored: Mask = np.False_
) -> Array:
    """The number of thresholds passed in each state; arbitrary where the state is ignored."""
    match ready.read.terms:
        case ((_, ltl.Count()),):
            ((_, counted),) = summands
            return _digits_of_count(ready.read, np.asarray(counted))
    if ready.quantity is None:
        return _digits_of_sum(ready.read, summands, n_states, ignored)
    ((_, numbers),) = summands
    if not isinstance(numbers, np.ndarray):
        return np.full(n_states, ready.digit(numbers), dtype=smallest_unsigned(ready.read.size))
    digits = np.zeros(numbers.shape, dtype=smallest_unsigned(ready.read.size))
    for floor in ready.floors:
        digits += (numbers >= floor).view(np.uint8)
    return digits


Bounds = tuple[Fraction, Array | float, Array | float, Mask | None]
"""A coefficient, its term's least and greatest value, and the mask where these are unknown."""


def numbers_between(ready: ThresholdScale, bounds: Iterable[Bounds], n_states: int) -> Numbers:
    """The numbers, as in ``StackedRead.meanings``, of a sum whose terms have known bounds."""
    lows: list[Summand] = []
    highs: list[Summand] = []
    unknown: Mask | None = None
    same = True
    for factor, low, high, dark in bounds:
        same &= low is high
        least, most = (high, low) if factor.numerator < 0 else (low, high)
        lows.append((factor, least))
        highs.append((factor, most))
        if dark is not None:
            unknown = dark if unknown is None else unknown | dark
    size = ready.read.size
    if unknown is not None and unknown.all():
        return size - 1
    ignored = np.False_ if unknown is None else unknown
    low_digits = digits_of(ready, lows, n_states, ignored)
    high_digits = low_digits if same else digits_of(ready, highs, n_states, ignored)
    dtype = smallest_unsigned(size**2)
    numbers: Array = low_digits.astype(dtype) * dtype.type(size)
    numbers += high_digits.astype(dtype)
    if unknown is not None:
        numbers[unknown] = size - 1
    return numbers


def _digits_of_sum(
    read: NumberRead,
    summands: Sequence[Summand],
    n_states: int,
    ignored: Mask,
) -> Array:
    """For each state the number of the read's thresholds that the sum passes.

    The number is arbitrary where the state is ignored.
    """
    total = np.zeros(n_states)
    size = np.zeros(n_states)
    with np.errstate(all="ignore"):
        for coefficient, numbers in summands:
            part = _nearest(coefficient) * np.asarray(numbers, dtype=np.float64)
            total += part
            size += np.abs(part)
        # Each part: its decimal, its coefficient, the product; then the sums, and the limit.
        error = size * ((len(summands) + 4) * _UNIT) + _TINY
        digits = np.zeros(n_states, dtype=smallest_unsigned(read.size))
        unclear = ~np.isfinite(total + error)
        for threshold in read.thresholds:
            limit = _nearest(threshold.limit)
            away = total - limit
            digits += away > 0
            unclear |= ~(np.abs(away) > error + abs(limit) * _UNIT)
    # The same few numbers are often at a limit
    known: dict[tuple[float, ...], int] = {}
    for state in (unclear & ~ignored).nonzero()[0].tolist():
        own = _numbers_in(summands, state)
        if own not in known:
            known[own] = read.digit(_exactly(summands, own))
        digits[state] = known[own]
    return digits


def _digits_of_count(read: NumberRead, counted: Array) -> Array:
    """The number of the read's thresholds that the number of objects passes in each state."""
    digits = [read.digit(Fraction(n)) for n in range(int(counted.max(initial=0)) + 1)]
    return np.array(digits, dtype=smallest_unsigned(read.size)).take(counted)


def _numbers_in(summands: Sequence[Summand], state: int) -> tuple[float, ...]:
    return tuple(
        numbers[state].item() if isinstance(numbers, np.ndarray) else numbers
        for _, numbers in summands
    )


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


def truth_between(ready: ComparisonSides, parts: Sequence[tuple[Fraction, Number]]) -> Truth:
    """The truth of a comparison whose terms have these coefficients and values."""
    lows = [(factor, part.low if factor > 0 else part.high) for factor, part in parts]
    highs = [(factor, part.high if factor > 0 else part.low) for factor, part in parts]
    low = _side_of(ready.scale, lows)
    if all(lower is upper for (_, lower), (_, upper) in zip(lows, highs, strict=True)):
        return Truth.known(ready.every.diagonal()[low])
    high = _side_of(ready.scale, highs)
    return Truth(ready.every[low, high], ready.some[low, high])


def _side_of(ready: ThresholdScale, summands: list[tuple[Fraction, Array]]) -> Array:
    """For each place the side of the limit that a sum is on."""
    if ready.quantity is not None:
        return digits_of(ready, summands, 0)
    spread = np.broadcast_arrays(*[numbers for _, numbers in summands])
    parts = [(factor, own.ravel()) for (factor, _), own in zip(summands, spread, strict=True)]
    # A sum with an end that is not known has none either
    ignored: Mask = np.logical_or.reduce([~np.isfinite(numbers) for _, numbers in parts])
    return digits_of(ready, parts, parts[0][1].size, ignored).reshape(spread[0].shape)


def alike_places(columns: Iterable[NDArray[Any]], n_places: int) -> NDArray[np.intp]:
    """Numbers from 0 for positions; two are equal where all columns have the same values there."""
    group_of = np.zeros(n_places, dtype=np.intp)
    for column in columns:
        codes = np.unique(column, return_inverse=True)[1]
        codes += group_of * (int(codes.max(initial=0)) + 1)
        group_of = np.unique(codes, return_inverse=True)[1]
    return group_of
