"""Functions of arrays that NumPy has, too, but loads its masked arrays for, which takes 14 ms."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

_Number = TypeVar("_Number", bound=np.generic)

_INT16_MAX = np.iinfo(np.int16).max


def distinct(values: NDArray[_Number]) -> NDArray[_Number]:
    """The different numbers in an array, ascending; without NaN."""
    ascending = np.sort(values, axis=None)
    is_new = np.ones(len(ascending), dtype=bool)
    np.not_equal(ascending[1:], ascending[:-1], out=is_new[1:])
    return ascending[is_new]


def median(values: NDArray[Any]) -> float:
    """The median of the numbers in an array, of which there is one at least; NaN if one is."""
    ascending = np.sort(values, axis=None)
    middle = len(ascending) // 2
    if np.isnan(ascending[-1]):
        return float(ascending[-1])
    return float(ascending[(len(ascending) - 1) // 2] + ascending[middle]) / 2


def sorted_in(groups: NDArray[np.intp], values: NDArray[np.float64]) -> NDArray[np.intp]:
    """The order by groups, and by values in each of them; equal ones stay in theirs."""
    order = _sorted_in(groups, values)
    ascending, numbers = values[order], groups[order]
    is_new = np.ones(len(order) + 1, dtype=bool)
    is_new[1:-1] = (ascending[1:] != ascending[:-1]) | (numbers[1:] != numbers[:-1])
    equal = np.flatnonzero(~(is_new[:-1] & is_new[1:]))
    if len(equal):
        own, runs = order[equal], np.cumsum(is_new[:-1])[equal]
        order[equal] = own[np.lexsort((own, runs))]
    return order


def _sorted_in(groups: NDArray[np.intp], values: NDArray[np.float64]) -> NDArray[np.intp]:
    """The same with equal ones in any order."""
    order = np.argsort(values)
    # Small whole numbers are sorted in linear time
    numbers = groups if groups.max(initial=0) > _INT16_MAX else groups.astype(np.int16)
    return order[np.argsort(numbers[order], kind="stable")]


def medians(
    groups: NDArray[np.intp], values: NDArray[np.float64], count: int
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """The median and the size of each of so many groups, NaN of an empty one."""
    sizes = np.bincount(groups, minlength=count)
    ordered = np.append(values[_sorted_in(groups, values)], np.nan)
    begins = np.cumsum(sizes) - sizes
    low, high = begins + np.maximum(sizes - 1, 0) // 2, begins + sizes // 2
    return np.where(sizes > 0, (ordered[low] + ordered[high]) / 2, np.nan), sizes
