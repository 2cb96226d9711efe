"""Alternative motions of an obstacle, with their probabilities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.scenario.scenario_model import Alternative, Motion

_ROUNDING = Fraction(1, 1000)


@dataclass(frozen=True, slots=True)
class Weighted:
    """The likeliest motion with its weight, and the others; the weights add up to 1."""

    motion: Motion
    weight: Fraction = Fraction(1)
    alternatives: tuple[Alternative, ...] = ()


def weighted(motions: Sequence[tuple[Fraction, Motion]]) -> Weighted:
    """Motions in order of their weights, which become probabilities; those that are equal as one.

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
    """Whether weights add up to 1, rounding allowed, as in three times 0.333."""
    return abs(total - 1) <= _ROUNDING
