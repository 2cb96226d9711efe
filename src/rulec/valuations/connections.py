"""What depends on each other, since it has members in common."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from typing import TypeVar

Member = TypeVar("Member")


def connected(sets: Sequence[Set[Member]]) -> list[tuple[frozenset[Member], list[int]]]:
    """The unions of sets that share members, directly or through others.

    Each has the places of its sets, in ascending order.
    """
    unions: list[tuple[frozenset[Member], list[int]]] = []
    for place, own in enumerate(sets):
        touched = [other for other in unions if not own.isdisjoint(other[0])]
        unions = [other for other in unions if own.isdisjoint(other[0])]
        places = sorted([place, *[n for _, others in touched for n in others]])
        unions.append((frozenset(own).union(*[union for union, _ in touched]), places))
    return unions


def reached(start: Iterable[Member], sets: Sequence[Set[Member]]) -> list[int]:
    """The places of the sets that share members with a start, directly or through others."""
    known = set(start)
    waiting = dict(enumerate(sets))
    while met := [place for place, own in waiting.items() if not own.isdisjoint(known)]:
        for place in met:
            known |= waiting.pop(place)
    return sorted(set(range(len(sets))) - waiting.keys())
