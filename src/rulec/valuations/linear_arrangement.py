"""Sample points that represent all numbers, as far as linear comparisons distinguish them.

Comparisons of sums with limits divide the space of a few unknown numbers into cells (an arrangement
of hyperplanes). One point of each cell is computed exactly.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from fractions import Fraction
from itertools import pairwise, product
from math import prod
from typing import NamedTuple

from rulec.logic.formula import Term
from rulec.valuations.polyhedral_cells import points_of_cells

MOST_POINTS = 1 << 12
"""If there are more cells, no points are computed."""

Point = dict[Term, Fraction]
_Interval = tuple[Fraction, Fraction]


class LinearPlane(NamedTuple):
    """The points where ``sum of coefficient * number`` equals ``limit``."""

    coefficients: Mapping[Term, Fraction]
    limit: Fraction


def sample_points(
    bounds: Mapping[Term, tuple[Fraction, Fraction] | None], planes: Sequence[LinearPlane]
) -> list[Point] | None:
    """A point in every cell of an arrangement; the planes themselves are cells, too.

    ``bounds`` has for every number the closed interval in which it lies, or None for any number.
    None if there are more than ``MOST_POINTS`` cells, or if these have very many corners.
    """
    if len(bounds) == 1:
        ((number, interval),) = bounds.items()
        own = [(plane.limit, plane.coefficients[number]) for plane in planes]
        limits = {limit / factor for limit, factor in own if factor}
        on_line = points_on_line(limits, interval)
        return None if len(on_line) > MOST_POINTS else [{number: point} for point in on_line]
    distinct = {(frozenset(plane.coefficients.items()), plane.limit): plane for plane in planes}
    cutting = [plane for plane in distinct.values() if _cuts(plane, bounds)]
    counts = Counter(number for plane in cutting for number, x in plane.coefficients.items() if x)
    shared = {number: interval for number, interval in bounds.items() if counts[number] > 1}
    if len(shared) < len(bounds):
        return _by_shared_numbers(bounds, shared, cutting)
    none = Fraction(0)
    rows = [[*[x.get(number, none) for number in bounds], limit] for x, limit in cutting]
    points = points_of_cells(list(bounds.values()), rows, MOST_POINTS)
    return None if points is None else [dict(zip(bounds, x, strict=True)) for x in points]


def _by_shared_numbers(
    bounds: Mapping[Term, _Interval | None],
    shared: Mapping[Term, _Interval | None],
    planes: Sequence[LinearPlane],
) -> list[Point] | None:
    """Sample points if some numbers occur in one plane only.

    Once the ``shared`` numbers are chosen, each plane's own numbers alone decide on which side it
    is, within the range of their sum; the limits of that range are planes of the shared numbers.
    """
    own = [_OwnNumbers.of(plane, bounds, shared) for plane in planes]
    among = [plane for one in own for plane in one.turns()]
    known = sample_points(shared, among) if shared else [{}]
    if known is None:
        return None
    free = {number: _any_of(interval) for number, interval in bounds.items()}
    found: dict[tuple[int, ...], Point] = {}
    for point in known:
        sides = [one.sides(point) for one in own]
        if prod(map(len, sides)) > MOST_POINTS:
            return None
        for chosen in product(*sides):
            signs = tuple([sign for sign, _ in chosen])
            if signs not in found:
                found[signs] = free | point
                for _, numbers in chosen:
                    found[signs].update(numbers)
        if len(found) > MOST_POINTS:
            return None
    return list(found.values())


class _OwnNumbers(NamedTuple):
    """A plane with numbers of its own: ``least`` and ``most`` are where their sum is extreme.

    If the sum is unbounded there is no ``most``, and ``least`` has all numbers but one.
    """

    shared: LinearPlane
    own: LinearPlane
    least: Point
    most: Point | None

    @classmethod
    def of(
        cls,
        plane: LinearPlane,
        bounds: Mapping[Term, _Interval | None],
        shared: Mapping[Term, _Interval | None],
    ) -> _OwnNumbers:
        """Split a plane into numbers that other planes share and its own."""
        apart: tuple[Point, Point] = {}, {}
        for number, factor in plane.coefficients.items():
            if factor:
                apart[number not in shared][number] = factor
        within = [(number, bounds[number]) for number in apart[1]]
        parts = LinearPlane(apart[0], plane.limit), LinearPlane(apart[1], Fraction(0))
        endless = next((number for number, interval in within if interval is None), None)
        if endless is None:
            box = {number: interval for number, interval in within if interval is not None}
            return cls(*parts, *_corners(parts[1], box))
        rest = {n: _any_of(interval) for n, interval in within if n != endless}
        return cls(*parts, rest, None)

    def turns(self) -> Iterator[LinearPlane]:
        """The planes of shared numbers beyond which one side is empty."""
        coefficients, limit = self.shared
        if coefficients and self.most is not None:
            ends = {_sum(self.own, end) for end in (self.least, self.most)}
            yield from (LinearPlane(coefficients, limit - end) for end in sorted(ends))

    def sides(self, point: Point) -> list[tuple[int, Point]]:
        """For each side that the plane may be on: the side, and own numbers that put it there."""
        left = self.shared.limit - _sum(self.shared, point)
        if self.most is None:
            for number, chosen in self.least.items():
                left -= self.own.coefficients[number] * chosen
            (endless,) = self.own.coefficients.keys() - self.least.keys()
            factor = self.own.coefficients[endless]
            return [(side, {**self.least, endless: (left + side) / factor}) for side in (-1, 0, 1)]
        low, high = _sum(self.own, self.least), _sum(self.own, self.most)
        found = [(-1, self.least)] if low < left else []
        if low <= left <= high:
            found.append((0, _between(self.least, self.most, left - low, high - low)))
        return [*found, (1, self.most)] if high > left else found


def _any_of(interval: _Interval | None) -> Fraction:
    return Fraction(0) if interval is None else interval[0]


def _between(least: Point, most: Point, way: Fraction, whole: Fraction) -> Point:
    """A point on the way from one point to another."""
    share = way / whole if whole else Fraction(0)
    return {number: low + share * (most[number] - low) for number, low in least.items()}


def _cuts(plane: LinearPlane, bounds: Mapping[Term, _Interval | None]) -> bool:
    """Whether the sum reaches the limit somewhere within the bounds."""
    intervals = [bounds.get(number) for number, factor in plane.coefficients.items() if factor]
    boxed = {number: interval for number, interval in bounds.items() if interval is not None}
    if None in intervals:
        return True
    least, most = (_sum(plane, corner) for corner in _corners(plane, boxed))
    return least <= plane.limit <= most


def _corners(plane: LinearPlane, box: Mapping[Term, _Interval]) -> tuple[Point, Point]:
    """The corners of a box where the sum is least and greatest."""
    falls = {number: plane.coefficients.get(number, 0) < 0 for number in box}
    least = {number: interval[falls[number]] for number, interval in box.items()}
    return least, {number: interval[not falls[number]] for number, interval in box.items()}


def _sum(plane: LinearPlane, point: Point) -> Fraction:
    terms = (factor * point[number] for number, factor in plane.coefficients.items() if factor)
    return sum(terms, Fraction(0))


def points_on_line(
    limits: Set[Fraction], interval: tuple[Fraction, Fraction] | None
) -> list[Fraction]:
    """The limits within the interval, and a number of it on each side of them."""
    if interval is None:
        known = [*limits, *([] if limits else [Fraction(0)])]
        interval = min(known) - 1, max(known) + 1
    low, high = interval
    inner = sorted(x for x in limits if low <= x <= high)
    ends = [low, *inner, high]
    beside = [(first + second) / 2 for first, second in pairwise(ends) if first < second]
    return [*inner, *beside] or [low]
