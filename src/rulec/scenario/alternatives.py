"""Alternative motions of an obstacle, with their probabilities."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from rulec.scenario.scenario_model import Alternative, Motion

_ROUNDING = Fraction(1, 1000)


def weighted(motions: Iterable[Alternative]) -> list[Alternative]:
    """Motions by descending weight, normalised to probabilities, equal ones merged.

    Of equally likely ones the first stays first.
    """
    together: dict[Motion, Fraction] = {}
    for alternative in motions:
        weight = together.get(alternative.motion, Fraction(0))
        together[alternative.motion] = weight + alternative.weight
    whole = sum(together.values(), Fraction(0))
    by_weight = sorted(together.items(), key=lambda item: -item[1])
    return [Alternative(weight / whole, motion) for motion, weight in by_weight]


def is_distribution(total: Fraction) -> bool:
    """True if weights add up to 1 within rounding, as three times 0.333 does."""
    return abs(total - 1) <= _ROUNDING
