"""Steps between states that fit all bounds in seconds of some formulas."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from math import ceil, floor

from rulec.logic.bounds import longest_divisor, operations_of
from rulec.logic.formula import Formula


def steps_near(formulas: Iterable[Formula], step_s: Fraction) -> list[Fraction]:
    """The steps (s) nearest to one, shorter and longer, that divide all bounds in seconds.

    Only those that have a finite decimal; the longer one is missing if there is none. There has to
    be a bound.
    """
    longest = longest_divisor([end for formula in formulas for end in _ends(formula)])
    finer, coarser = ceil(longest / step_s), floor(longest / step_s)
    while not _is_decimal(longest / finer):
        finer += 1
    while coarser and not _is_decimal(longest / coarser):
        coarser -= 1
    return [longest / parts for parts in dict.fromkeys((finer, coarser)) if parts]


def _is_decimal(time: Fraction) -> bool:
    rest = time.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    return rest == 1


def _ends(formula: Formula) -> Iterator[Fraction]:
    """The ends of all bounds in seconds in a formula."""
    for operation in operations_of(formula):
        bound = operation.bound
        if bound is not None and bound.unit == "s":
            yield from (end for end in (bound.low, bound.high) if end is not None)
