"""Intervals of one number, or of two, that fixed comparisons of sums divide in the same way.

What is possible within such intervals is the same, so it is computed once.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from typing import Generic, Protocol, TypeAlias, TypeVar

from rulec.automata.thresholds import exact
from rulec.monitoring.uncertainty.state_letters.completions.planar_cells import (
    PlanarLine,
    crossing,
)
from rulec.vocabulary.partial_values import Interval

Cut: TypeAlias = "tuple[tuple[Fraction, ...], Fraction]"
"""The factors of the numbers, and the limit that their weighted sum is compared with."""

Found = TypeVar("Found")


class _Kinds(Protocol):
    """The kinds of some intervals."""

    def kind(self, *intervals: Interval) -> Hashable:
        """The kind of these intervals."""


@dataclass(frozen=True, slots=True)
class AlikeIntervals(Generic[Found]):
    """What has been ``found`` for intervals, by their kind."""

    kinds: _Kinds
    found: dict[Hashable, Found] = field(default_factory=dict)

    @staticmethod
    def of(n_numbers: int, cuts: Sequence[Cut]) -> AlikeIntervals[Found]:
        """For the intervals of one number or two that are compared in this way."""
        if n_numbers == 1:
            return AlikeIntervals(_Steps.of(cuts))
        lines = [PlanarLine(first, second, limit) for (first, second), limit in cuts]
        return AlikeIntervals(_Lines.of(lines))


@dataclass(frozen=True, slots=True)
class _Steps:
    """The ``points`` at which comparisons of one number change, ascending."""

    points: Sequence[Fraction]

    @staticmethod
    def of(cuts: Sequence[Cut]) -> _Steps:
        return _Steps(sorted({limit / factor for (factor,), limit in cuts if factor}))

    def kind(self, *intervals: Interval) -> Hashable:
        """Where the interval begins and ends: odd at a point, even between two points."""
        (interval,) = intervals
        return self._place(interval.low), self._place(interval.high)

    def _place(self, number: float) -> int:
        value = exact(number)
        place = bisect_left(self.points, value)
        return 2 * place + (place < len(self.points) and self.points[place] == value)


@dataclass(frozen=True, slots=True)
class _Lines:
    """The lines in the plane of two numbers at which comparisons change, and where two cross.

    A cell between the lines meets a rectangle if it contains one of the rectangle's corners, or if
    one of its own corners, where lines cross, lies in the rectangle, or if an edge of it passes
    through: a line that separates the rectangle's corners does so, with the edge that lies between
    those crossings that are on different sides of the rectangle.
    """

    lines: Sequence[PlanarLine]
    across: Sequence[Fraction]
    up: Sequence[Fraction]

    @staticmethod
    def of(lines: Sequence[PlanarLine]) -> _Lines:
        found = [x for pair in combinations(lines, 2) if (x := crossing(*pair)) is not None]
        return _Lines(lines, *([point[n] for point in found] for n in (0, 1)))

    def kind(self, *intervals: Interval) -> Hashable:
        """On which side of each line the rectangle's corners are, and of each crossing its ends."""
        first, second = [(exact(own.low), exact(own.high)) for own in intervals]
        corners = [(x, y) for x in first for y in second]
        sides = [_side(line.beyond(corner)) for line in self.lines for corner in corners]
        sides += [_side(x - place) for place in self.across for x in first]
        sides += [_side(y - place) for place in self.up for y in second]
        return tuple(sides)


def _side(number: Fraction) -> int:
    """-1 below zero, 0 at zero, 1 above."""
    return (number > 0) - (number < 0)
