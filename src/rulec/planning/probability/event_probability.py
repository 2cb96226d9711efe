"""Exact probability that none of some events happens.

Obstacles do one thing or another, each independently of the others; an event is that several of
them do certain things. No world, that is what all of them do together, is looked at by itself.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction

Event = frozenset[tuple[str, int]]
"""Of these obstacles these predictions come true; the empty event always comes about."""

Weights = Mapping[str, Mapping[int, Fraction]]
"""For each obstacle its predictions and their probabilities, which add up to 1."""


def none_of(events: Collection[Event], weights: Weights) -> Fraction:
    """The probability that no event comes about: exact.

    Events that share no obstacle are independent. Of others one obstacle after the other is fixed,
    which takes time that is exponential only in how far they are entangled.
    """
    return _none_of(frozenset(events), weights, {})


def _none_of(
    events: frozenset[Event], weights: Weights, known: dict[frozenset[Event], Fraction]
) -> Fraction:
    if not events:
        return Fraction(1)
    if frozenset() in events:
        return Fraction(0)
    if events not in known:
        result = Fraction(1)
        for together in _independent(events):
            result *= _entangled(together, weights, known)
        known[events] = result
    return known[events]


def _entangled(
    events: frozenset[Event], weights: Weights, known: dict[frozenset[Event], Fraction]
) -> Fraction:
    counted = Counter(obstacle for event in events for obstacle, _ in event)
    obstacle = min(counted, key=lambda candidate: (-counted[candidate], candidate))
    result = Fraction(0)
    for number, weight in weights[obstacle].items():
        left = frozenset(
            event - {(obstacle, number)}
            for event in events
            if all(name != obstacle or what == number for name, what in event)
        )
        result += weight * _none_of(left, weights, known)
    return result


def _independent(events: frozenset[Event]) -> Iterator[frozenset[Event]]:
    """The events in groups that share no obstacle."""
    left = set(events)
    while left:
        group = {left.pop()}
        about = {obstacle for event in group for obstacle, _ in event}
        while joining := {event for event in left if any(name in about for name, _ in event)}:
            left -= joining
            group |= joining
            about |= {obstacle for event in joining for obstacle, _ in event}
        yield frozenset(group)
