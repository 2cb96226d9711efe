"""Alternative motions of an obstacle, with their probabilities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.scenario.scenario_model import Alternative, Motion

_ROUNDING = Fraction(1, 1000)


@dataclass(frozen=True, slots=True)
class Weighted:
    """The likeliest motion with its weight, and the other motions.

    The weights add up to 1.
    """

    motion: Motion
    weight: Fraction = Fraction(1)
    alternatives: tuple[Alternative, ...] = ()


def weighted(motions: Sequence[tuple[Fraction, Motion]]) -> Weighted:
    """Motions by descending weight, normalised to probabilities, equal ones merged.

    Of equally likely ones the first stays first.
    """
    together: dict[Motion, Fraction] = {}
    for weight, motion in motions:
        together[motion] = together.get(motion, Fraction(0)) + weight
    whole = sum(together.values(), Fraction(0))
    (first, likeliest), *rest = sorted(together.items(), key=lambda item: -item[1])
    return Weighted(
        first,
        likeliest / whole,
        tuple(Alternative(weight / whole, motion) for motion, weight in rest),
    )


def is_distribution(total: Fraction) -> bool:
    """True if weights add up to 1 within rounding.

    Three times 0.333 does.
    """
    return abs(total - 1) <= _ROUNDING
