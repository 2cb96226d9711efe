"""Replacements for slow NumPy functions, some of which load its masked arrays; memory reuse."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

_Number = TypeVar("_Number", bound=np.generic)

_INT16_MAX = np.iinfo(np.int16).max

_MOST_EMPTY = 8
"""Padded rows, and tables of numbers, may be at most this many times the size of their values."""

ODD = np.uint64(0x9E3779B97F4A7C15)
"""A weight without a pattern, from the digits of the golden ratio."""

_MOST_KEPT_BYTES = 31 << 20
"""Just below glibc's greatest threshold."""


@cache
def keep_freed_memory() -> None:
    """Make the C library keep freed memory for later arrays; takes effect once per process.

    On Linux it returns free memory beyond a threshold to the system, and getting it back page by
    page is slow: that took a twelfth of the time of scoring. Freeing one large block, never written
    to, raises the threshold.
    """
    np.empty(_MOST_KEPT_BYTES, dtype=np.uint8)


def distinct(values: NDArray[_Number]) -> NDArray[_Number]:
    """The distinct numbers in an array without NaN, ascending."""
    ascending = values.flatten()
    ascending.sort()
    return ascending[are_new(ascending)]


def different_pairs(
    left: NDArray[np.uint64], right: NDArray[np.uint64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The position of one example of each distinct pair, and for each pair its example's number.

    Pairs are compared by a weighted sum; where two differ but have the same sum, each is its own
    example.
    """
    codes = left * ODD + right
    different = distinct(codes)
    which: NDArray[np.intp] = different.searchsorted(codes)
    every = np.arange(len(codes))
    examples = np.empty(len(different), dtype=np.intp)
    examples[which] = every
    like = examples[which]
    if ((left == left[like]) & (right == right[like])).all():
        return examples, which
    return every, every


def are_new(ascending: NDArray[Any]) -> NDArray[np.bool_]:
    """Mask of the first of each run of equal values in a sorted array."""
    are_new = np.empty(len(ascending), dtype=bool)
    are_new[:1] = True
    np.not_equal(ascending[1:], ascending[:-1], out=are_new[1:])
    return are_new


def zero_if_nan(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The finite numbers, with 0 for NaN; NumPy's ``nan_to_num`` takes four times as long."""
    return np.where(np.isnan(values), 0.0, values)


def begin_runs(ascending: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Mask of where runs of consecutive numbers begin in ascending whole numbers."""
    begin = np.empty(len(ascending), dtype=bool)
    begin[:1] = True
    np.greater(ascending[1:] - ascending[:-1], 1, out=begin[1:])
    return begin


def places_among(values: NDArray[_Number]) -> NDArray[np.intp]:
    """The index of each number of an array among its distinct ones, ascending; without NaN."""
    if values.dtype.kind in "iu" and len(values) and values.min() >= 0:
        # Small whole numbers can be ranked without sorting
        numbers = values.astype(np.intp)
        n_numbers = int(numbers.max()) + 1
        if n_numbers <= _MOST_EMPTY * len(numbers):
            there = np.zeros(n_numbers, dtype=bool)
            there[numbers] = True
            return (there.cumsum() - 1).take(numbers)
    return distinct(values).searchsorted(values)


def median(values: NDArray[Any]) -> float:
    """The median of a non-empty array; NaN if it contains NaN."""
    ascending = np.sort(values, axis=None)
    middle = len(ascending) // 2
    if np.isnan(ascending[-1]):
        return float(ascending[-1])
    return float(ascending[(len(ascending) - 1) // 2] + ascending[middle]) / 2


def most_frequent(values: NDArray[np.integer[Any]]) -> int:
    """The most frequent number in an array; of several, the one that appears first."""
    _, places, counts = np.unique(values, return_inverse=True, return_counts=True)
    return int(values[counts[places].argmax()])


def quantile(values: NDArray[Any], share: float) -> float:
    """The quantile at ``share`` (0 to 1) of a non-empty array; NaN if it contains NaN.

    Interpolated linearly between neighbouring values.
    """
    ascending = np.sort(values, axis=None)
    if np.isnan(ascending[-1]):
        return float(ascending[-1])
    place = share * (len(ascending) - 1)
    below = min(int(place), len(ascending) - 1)
    low, high = ascending[below], ascending[min(below + 1, len(ascending) - 1)]
    return float(low + (high - low) * (place - below))


def ranges(
    begins: NDArray[np.intp], lengths: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Ranges of whole numbers, each from its beginning on and of its length, concatenated.

    With where each range begins in the result.
    """
    firsts = lengths.cumsum() - lengths
    return np.arange(int(lengths.sum())) + (begins - firsts).repeat(lengths), firsts


def in_order(groups: NDArray[np.intp]) -> NDArray[np.intp]:
    """The indices that sort whole numbers in ascending order; equal ones keep their order."""
    # NumPy sorts 16-bit integers in linear time
    numbers = groups if groups.max(initial=0) > _INT16_MAX else groups.astype(np.int16)
    if bool((numbers[1:] >= numbers[:-1]).all()):
        return np.arange(len(groups))
    return numbers.argsort(kind="stable")


def ranks(columns: NDArray[np.float64]) -> NDArray[np.intp]:
    """The place of each number among those of its column, ascending; equal ones keep their order.

    NaN may only follow all numbers of its column, and keeps its place. All columns are compared at
    once, row by row: of a few rows that takes a fifth of the time of NumPy's ``argsort``.
    """
    ranks = np.zeros(columns.shape, dtype=np.int16)
    for row, later in enumerate(columns[1:], 1):
        are_less = later < columns[:row]
        ranks[:row] += are_less
        ranks[row] += row
        ranks[row] -= are_less.sum(axis=0, dtype=np.int16)
    return ranks.astype(np.intp)


def medians(
    groups: NDArray[np.intp], values: NDArray[np.float64], count: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """The median and the size of each of ``count`` groups; an empty group's median is NaN."""
    sizes = np.bincount(groups, minlength=count)
    order, begins, rows = _in_rows(groups, values)
    middles = np.full(count, np.nan)
    if rows is None:
        ordered = values[np.lexsort((values, groups))]
        own = sizes.nonzero()[0]
        low, high = begins + (sizes[own] - 1) // 2, begins + sizes[own] // 2
        middles[own] = (ordered[low] + ordered[high]) / 2
        return middles, sizes
    if len(order):
        rows = np.sort(rows, axis=1)
        own = groups[order[begins]]
        numbers, middle = np.arange(len(own)), sizes[own]
        middles[own] = (rows[numbers, (middle - 1) // 2] + rows[numbers, middle // 2]) / 2
    return middles, sizes


def medians_hold(
    groups: NDArray[np.intp],
    values: NDArray[np.float64],
    count: int,
    holds: Callable[[NDArray[np.float64]], NDArray[np.bool_]],
) -> NDArray[np.bool_]:
    """Whether a condition holds for the median of each of ``count`` groups; False if empty.

    It ``holds`` for all numbers below some limit and no others, so counting usually decides.
    """
    sizes = np.bincount(groups, minlength=count)
    twice = 2 * np.bincount(groups.take(holds(values).nonzero()[0]), minlength=count)
    hold = twice > sizes
    # Where it holds for exactly half of the values, the median lies between the two halves
    halves = (twice == sizes) & (sizes > 0)
    if halves.any():
        own = halves[groups].nonzero()[0]
        hold[halves] = holds(medians(groups[own], values[own], count)[0][halves])
    return hold


def _in_rows(
    groups: NDArray[np.intp], values: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64] | None]:
    """The order by groups, where each group begins in it, and each group's values as a row.

    Rows are padded with NaN, which sorts last. They are None if group sizes differ so much that
    rows would be mostly padding.
    """
    order = in_order(groups)
    is_new = are_new(groups[order])
    begins = is_new.nonzero()[0]
    longest = int(_sizes(begins, len(order)).max(initial=0))
    if longest * len(begins) > _MOST_EMPTY * len(order):
        return order, begins, None
    rows = np.full((len(begins), longest), np.nan)
    row = is_new.cumsum() - 1
    rows[row, np.arange(len(order)) - begins[row]] = values[order]
    return order, begins, rows


def _sizes(begins: NDArray[np.intp], end: int) -> NDArray[np.intp]:
    """The size of each group, from where each begins and the last one ends."""
    sizes = np.empty_like(begins)
    np.subtract(begins[1:], begins[:-1], out=sizes[:-1])
    sizes[-1:] = end - begins[-1:]
    return sizes
