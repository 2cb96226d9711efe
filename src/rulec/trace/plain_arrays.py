"""What NumPy has no function for: ranges, medians of groups; memory reuse."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

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


def different_pairs(
    left: NDArray[np.uint64], right: NDArray[np.uint64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The position of one example of each distinct pair, and for each pair its example's number.

    Pairs are compared by a weighted sum; where two differ but have the same sum, each is its own
    example.
    """
    _, examples, which = np.unique(left * ODD + right, return_index=True, return_inverse=True)
    like = examples[which]
    if ((left == left[like]) & (right == right[like])).all():
        return examples, which
    every = np.arange(len(left))
    return every, every


def zero_if_nan(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The finite numbers, with 0 for NaN; NumPy's ``nan_to_num`` takes four times as long."""
    return np.where(np.isnan(values), 0.0, values)


def ranges(
    begins: NDArray[np.intp], lengths: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Ranges of whole numbers, each from its beginning on and of its length, concatenated.

    With where each range begins in the result.
    """
    firsts = lengths.cumsum() - lengths
    return np.arange(int(lengths.sum())) + (begins - firsts).repeat(lengths), firsts


def medians(
    groups: NDArray[np.intp], values: NDArray[np.float64], count: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """The median and the size of each of ``count`` groups; an empty group's median is NaN."""
    sizes = np.bincount(groups, minlength=count)
    ordered = np.append(values[np.lexsort((values, groups))], np.nan)
    begins = sizes.cumsum() - sizes
    low, high = begins + np.maximum(sizes - 1, 0) // 2, begins + sizes // 2
    return np.where(sizes > 0, (ordered[low] + ordered[high]) / 2, np.nan), sizes


def medians_hold(
    groups: NDArray[np.intp],
    values: NDArray[np.float64],
    count: int,
    holds: Callable[[NDArray[np.float64]], NDArray[np.bool_]],
) -> NDArray[np.bool_]:
    """Whether a condition holds for the median of each of ``count`` groups; False if empty."""
    middles, sizes = medians(groups, values, count)
    return holds(middles) & (sizes > 0)
