"""Exact probability that none of some events happens.

Each obstacle follows one of its predictions, independently of the others; an event is that several
obstacles follow certain predictions. Worlds (a prediction for every obstacle) are not enumerated.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from functools import cache
from math import prod

Event = frozenset[tuple[str, int]]
"""Obstacles with the predictions that have to come true; the empty event always happens."""

Weights = Mapping[str, Mapping[int, Fraction]]
"""For each obstacle its predictions and their probabilities, which add up to 1."""


def none_of(events: Collection[Event], weights: Weights) -> Fraction:
    """The exact probability that no event happens.

    Events that share no obstacle are independent. For the others one obstacle after the other is
    fixed, which takes time exponential only in how much the events overlap.
    """

    @cache
    def none(events: frozenset[Event]) -> Fraction:
        if frozenset() in events:
            return Fraction(0)
        return prod(map(none_entangled, _independent(events)), start=Fraction(1))

    def none_entangled(events: frozenset[Event]) -> Fraction:
        counted = Counter(obstacle for event in events for obstacle, _ in event)
        obstacle = min(counted, key=lambda candidate: (-counted[candidate], candidate))
        result = Fraction(0)
        for number, weight in weights[obstacle].items():
            left = frozenset(
                event - {(obstacle, number)}
                for event in events
                if all(name != obstacle or what == number for name, what in event)
            )
            result += weight * none(left)
        return result

    return none(frozenset(events))


def _independent(events: frozenset[Event]) -> Iterator[frozenset[Event]]:
    left = set(events)
    while left:
        group = {left.pop()}
        about = {obstacle for event in group for obstacle, _ in event}
        while joining := {event for event in left if any(name in about for name, _ in event)}:
            left -= joining
            group |= joining
            about |= {obstacle for event in joining for obstacle, _ in event}
        yield frozenset(group)
