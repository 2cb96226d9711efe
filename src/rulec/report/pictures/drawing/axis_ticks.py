"""Round numbers for an axis."""

from __future__ import annotations

from math import ceil, floor, log10


def ticks(low: float, high: float, at_most: int) -> list[float]:
    """Multiples of 1, 2 or 5 powers of ten within an interval."""
    span = high - low
    power = 10.0 ** floor(log10(span / at_most))
    # The logarithm may be rounded down from a whole number, so that 10 would just not be enough.
    step = next(power * one for one in (1, 2, 5, 10, 20) if span / (power * one) <= at_most)
    return [round(step * n, 9) + 0.0 for n in range(ceil(low / step), floor(high / step) + 1)]
