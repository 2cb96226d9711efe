"""Exact solutions of linear inequalities by Fourier-Motzkin elimination.

Unknowns are eliminated one after the other, then given numbers in the opposite order, each between
the bounds that the numbers chosen before leave. The systems are those of one state of a rule: a
handful of unknowns and inequalities.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
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
    whole: Set[Term] = frozenset(),
    near_bounds: Set[Term] = frozenset(),
) -> dict[Term, Fraction] | None:
    """Solve a system by numbers with short decimals; None if there are none.

    The last of the ``unknowns`` is given its number first: the ``preferred`` one where it fits,
    else zero (for unknowns in ``near_bounds`` zero is not preferred) or a number near a bound. If
    the first numbers tried for ``whole`` unknowns leave no solution, the search is not repeated.
    """
    stages: list[tuple[Term, list[LinearBound]]] = []
    rest = list(system)
    for unknown in unknowns:
        stages.append((unknown, [bound for bound in rest if bound.coefficients.get(unknown)]))
        rest = _eliminate(unknown, rest)
    if any(bound.limit < 0 or (bound.strict and bound.limit == 0) for bound in rest):
        return None
    solution: dict[Term, Fraction] = {}
    for unknown, bounds in reversed(stages):
        # Lower bounds first, as the numbers near them are tried first.
        limits = sorted(
            [
                (bound.coefficients[unknown], _remaining_limit(bound, solution), bound.strict)
                for bound in bounds
            ],
            key=lambda limit: limit[0] > 0,
        )
        candidates = _candidates(
            preferred.get(unknown),
            [rest / factor for factor, rest, _ in limits],
            whole=unknown in whole,
            zero_first=unknown not in near_bounds,
        )
        for number in candidates:
            if all(
                factor * number < rest or (factor * number == rest and not strict)
                for factor, rest, strict in limits
            ):
                solution[unknown] = number
                break
        else:
            return None
    return solution


def _remaining_limit(bound: LinearBound, solution: Mapping[Term, Fraction]) -> Fraction:
    """The part of a limit that remains after subtracting the unknowns with a number."""
    left = bound.limit
    for name, factor in bound.coefficients.items():
        if name in solution:
            left -= factor * solution[name]
    return left


def _eliminate(unknown: Term, system: Sequence[LinearBound]) -> list[LinearBound]:
    """The inequalities for the other unknowns that the system implies."""
    rest = [bound for bound in system if not bound.coefficients.get(unknown)]
    above = [bound for bound in system if bound.coefficients.get(unknown, 0) > 0]
    below = [bound for bound in system if bound.coefficients.get(unknown, 0) < 0]
    for upper, lower in product(_per_one(unknown, above), _per_one(unknown, below)):
        sums = dict(upper.coefficients)
        for name, factor in lower.coefficients.items():
            sums[name] = sums[name] + factor if name in sums else factor
        sums = {name: factor for name, factor in sums.items() if factor}
        rest.append(LinearBound(sums, upper.limit + lower.limit, upper.strict or lower.strict))
    return rest


def _per_one(unknown: Term, bounds: Sequence[LinearBound]) -> list[LinearBound]:
    """The same inequalities, scaled so that this unknown's coefficient is 1 or -1."""
    scaled = []
    for bound in bounds:
        own = abs(bound.coefficients[unknown])
        if own != 1:
            factors = {name: factor / own for name, factor in bound.coefficients.items()}
            bound = LinearBound(factors, bound.limit / own, bound.strict)
        scaled.append(bound)
    return scaled


def _candidates(
    preferred: Fraction | None, ends: Sequence[Fraction], *, whole: bool, zero_first: bool
) -> Iterator[Fraction]:
    """Numbers at and near the interval's ends, shortest decimals first."""
    if preferred is not None and (preferred.denominator == 1 or not whole):
        yield preferred
    if zero_first or not ends:
        yield Fraction(0)
    for places in range(1 if whole else _MOST_PLACES):
        scale = 10**places
        for end in ends:
            for n in (0, 1, -1):
                yield Fraction(floor(end * scale) + n, scale)
