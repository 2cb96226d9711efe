"""Numbers that satisfy linear inequalities, exactly: Fourier-Motzkin elimination.

The systems are those of one state of a rule: a handful of numbers and of inequalities.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import floor

from rulec.logic.formula import Term

_MOST_PLACES = 9


@dataclass(frozen=True, slots=True)
class LinearBound:
    """``sum of coefficients * unknowns <= limit``, or ``<`` if ``strict``."""

    coefficients: Mapping[Term, Fraction]
    limit: Fraction
    strict: bool = False


def solve(
    system: Sequence[LinearBound],
    unknowns: Sequence[Term],
    preferred: Mapping[Term, Fraction],
    whole: frozenset[Term] = frozenset(),
) -> dict[Term, Fraction] | None:
    """Numbers with short decimals that satisfy all, or None.

    Args:
        system: the inequalities.
        unknowns: what is sought.
        preferred: the numbers to take where they fit; else short ones near the lower bound.
        whole: the unknowns that are whole numbers; the rest of the system is not searched again if
            the first whole numbers tried leave no room for it.

    Returns:
        A number for each unknown; None if there are none, or none that short decimals write.
    """
    stages: list[tuple[Term, list[LinearBound]]] = []
    rest = list(system)
    for name in unknowns:
        stages.append((name, [one for one in rest if one.coefficients.get(name)]))
        rest = _without(name, rest)
    if any(one.limit < 0 or (one.strict and one.limit == 0) for one in rest):
        return None
    found: dict[Term, Fraction] = {}
    for name, about in reversed(stages):
        value = _choose(name, about, found, preferred.get(name), whole=name in whole)
        if value is None:
            return None
        found[name] = value
    return found


def _without(name: Term, system: Sequence[LinearBound]) -> list[LinearBound]:
    """What the inequalities say about the other unknowns."""
    rest = [one for one in system if not one.coefficients.get(name)]
    above = [one for one in system if one.coefficients.get(name, 0) > 0]
    below = [one for one in system if one.coefficients.get(name, 0) < 0]
    for upper in above:
        for lower in below:
            up, low = upper.coefficients[name], -lower.coefficients[name]
            names = {*upper.coefficients, *lower.coefficients} - {name}
            sums = {
                other: upper.coefficients.get(other, Fraction(0)) / up
                + lower.coefficients.get(other, Fraction(0)) / low
                for other in names
            }
            sums = {other: size for other, size in sums.items() if size}
            limit = upper.limit / up + lower.limit / low
            rest.append(LinearBound(sums, limit, upper.strict or lower.strict))
    return rest


def _choose(
    name: Term,
    about: Sequence[LinearBound],
    found: Mapping[Term, Fraction],
    preferred: Fraction | None,
    *,
    whole: bool,
) -> Fraction | None:
    """A number for one unknown, those that were eliminated after it being known."""
    lows: list[tuple[Fraction, bool]] = []
    highs: list[tuple[Fraction, bool]] = []
    for one in about:
        known = [c * found[other] for other, c in one.coefficients.items() if other != name]
        factor = one.coefficients[name]
        limit = (one.limit - sum(known, Fraction(0))) / factor
        (highs if factor > 0 else lows).append((limit, one.strict))
    ends = [limit for limit, _ in (*lows, *highs)]
    for value in _candidates(preferred, ends, whole=whole):
        above = all(value > limit or (value == limit and not strict) for limit, strict in lows)
        below = all(value < limit or (value == limit and not strict) for limit, strict in highs)
        if above and below:
            return value
    return None


def _candidates(
    preferred: Fraction | None, ends: Sequence[Fraction], *, whole: bool
) -> Iterator[Fraction]:
    """Numbers at and beside the ends of the interval, those with the shortest decimals first."""
    if preferred is not None and (preferred.denominator == 1 or not whole):
        yield preferred
    yield Fraction(0)
    for places in range(1 if whole else _MOST_PLACES):
        scale = 10**places
        for end in ends:
            for n in (0, 1, -1):
                yield Fraction(floor(end * scale) + n, scale)
