"""Sample points that represent all numbers, as far as linear comparisons distinguish them.

Comparisons of sums with limits divide the space of a few unknown numbers into cells (an arrangement
of hyperplanes). One point of each cell is computed exactly: for two numbers by cutting a rectangle,
for more by Fourier-Motzkin elimination.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from fractions import Fraction
from itertools import pairwise, product
from math import prod
from typing import NamedTuple

from rulec.logic.formula import Term
from rulec.monitoring.uncertainty.state_letters.completions.planar_cells import (
    PlanarLine,
    points_of_cells,
)
from rulec.witnesses.fourier_motzkin import LinearBound, TooManyBoundsError, solve

MOST_POINTS = 1 << 12
"""If there are more cells, no points are computed."""

MOST_BOUNDS = 1 << 15
"""The most inequalities that elimination may create for the cells of three or more numbers."""

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
    None if there are more than ``MOST_POINTS`` cells, or if finding them takes more than
    ``MOST_BOUNDS``.
    """
    if len(bounds) == 1:
        ((number, interval),) = bounds.items()
        own = [(plane.limit, plane.coefficients[number]) for plane in planes]
        limits = {limit / factor for limit, factor in own if factor}
        on_line = _on_a_line(limits, interval)
        return None if len(on_line) > MOST_POINTS else [{number: point} for point in on_line]
    distinct = {(frozenset(plane.coefficients.items()), plane.limit): plane for plane in planes}
    cutting = [plane for plane in distinct.values() if _cuts(plane, bounds)]
    boxed = {number: interval for number, interval in bounds.items() if interval is not None}
    if len(cutting) <= 1 and len(boxed) == len(bounds):
        return list(_beside(cutting, boxed))
    if len(bounds) == 2:
        return _in_a_plane(bounds, cutting)
    counts = Counter(number for plane in cutting for number, x in plane.coefficients.items() if x)
    shared = {number: interval for number, interval in bounds.items() if counts[number] > 1}
    if len(shared) < len(bounds):
        return _by_shared_numbers(bounds, shared, cutting)
    within = [
        bound
        for number, interval in bounds.items()
        if interval is not None
        for bound in (
            LinearBound({number: Fraction(1)}, interval[1]),
            LinearBound({number: Fraction(-1)}, -interval[0]),
        )
    ]
    points = []
    try:
        for point in _cells(within, cutting, list(bounds), _Work(MOST_BOUNDS)):
            points.append(point)
            if len(points) > MOST_POINTS:
                return None
    except TooManyBoundsError:
        return None
    return points


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


class _Work:
    """Counts the inequalities that elimination makes."""

    def __init__(self, most: int) -> None:
        self._left = most

    def __call__(self, n_bounds: int) -> None:
        self._left -= n_bounds
        if self._left < 0:
            raise TooManyBoundsError


def _in_a_plane(
    bounds: Mapping[Term, _Interval | None], planes: Sequence[LinearPlane]
) -> list[Point] | None:
    first, second = bounds
    none = Fraction(0)
    lines = [
        PlanarLine(coefficients.get(first, none), coefficients.get(second, none), limit)
        for coefficients, limit in planes
    ]
    points = points_of_cells((bounds[first], bounds[second]), lines, MOST_POINTS)
    return None if points is None else [{first: x, second: y} for x, y in points]


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


def _beside(planes: Sequence[LinearPlane], box: Mapping[Term, _Interval]) -> Iterator[Point]:
    """Points of a box on both sides of its only plane and on it; any point if there is no plane."""
    if not planes:
        yield {number: low for number, (low, _) in box.items()}
        return
    (plane,) = planes
    least, most = _corners(plane, box)
    low, high = _sum(plane, least), _sum(plane, most)
    if low < plane.limit:
        yield least
    yield _between(least, most, plane.limit - low, high - low)
    if high > plane.limit:
        yield most


def _on_a_line(limits: Set[Fraction], interval: tuple[Fraction, Fraction] | None) -> list[Fraction]:
    """The limits within the interval, and a number of it on each side of them."""
    if interval is None:
        known = [*limits, *([] if limits else [Fraction(0)])]
        interval = min(known) - 1, max(known) + 1
    low, high = interval
    inner = sorted(x for x in limits if low <= x <= high)
    ends = [low, *inner, high]
    beside = [(first + second) / 2 for first, second in pairwise(ends) if first < second]
    return [*inner, *beside] or [low]


def _cells(
    within: list[LinearBound],
    planes: Sequence[LinearPlane],
    numbers: Sequence[Term],
    work: _Work,
) -> Iterator[Point]:
    point = solve(within, numbers, {}, any_number=True, on_elimination=work)
    if point is None:
        return
    if not planes:
        yield point
        return
    (coefficients, limit), *others = planes
    opposite = {number: -factor for number, factor in coefficients.items()}
    below, above = LinearBound(coefficients, limit), LinearBound(opposite, -limit)
    for side in (
        [LinearBound(coefficients, limit, strict=True)],
        [below, above],
        [LinearBound(opposite, -limit, strict=True)],
    ):
        yield from _cells([*within, *side], others, numbers, work)
