"""Points that stand for all numbers, as far as linear comparisons can tell them apart.

Comparisons of sums with limits cut the space of a few unknown numbers into cells (an arrangement of
hyperplanes). One point of each is found exactly: of two numbers by cutting a rectangle, of more by
Fourier-Motzkin elimination.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from fractions import Fraction
from itertools import pairwise
from typing import NamedTuple

from rulec.logic.formula import Term
from rulec.monitoring.uncertainty.state_letters.completions.planar_cells import (
    PlanarLine,
    points_of_cells,
)
from rulec.witnesses.fourier_motzkin import LinearBound, TooManyBoundsError, solve

MOST_POINTS = 1 << 12
"""Of more cells no points are given."""

MOST_BOUNDS = 1 << 15
"""So many inequalities are made by elimination in all for the cells of three or more numbers."""

Point = dict[Term, Fraction]
_Interval = tuple[Fraction, Fraction]


class LinearPlane(NamedTuple):
    """Where ``sum of coefficient * number`` is ``limit``."""

    coefficients: Mapping[Term, Fraction]
    limit: Fraction


def sample_points(
    bounds: Mapping[Term, tuple[Fraction, Fraction] | None], planes: Sequence[LinearPlane]
) -> list[Point] | None:
    """A point in every cell of an arrangement, its planes being cells of their own.

    ``bounds`` has every number, with the closed interval in which it lies, or None for any. None
    for more than ``MOST_POINTS`` cells, or if finding them takes more than ``MOST_BOUNDS``.
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
    """True unless the sum is on one side of the limit everywhere within the bounds."""
    intervals = [bounds.get(number) for number, factor in plane.coefficients.items() if factor]
    boxed = {number: interval for number, interval in bounds.items() if interval is not None}
    if None in intervals:
        return True
    least, most = (_sum(plane, corner) for corner in _corners(plane, boxed))
    return least <= plane.limit <= most


def _corners(plane: LinearPlane, box: Mapping[Term, _Interval]) -> tuple[Point, Point]:
    """Where in a box the sum is least, and where greatest."""
    falls = {number: plane.coefficients.get(number, 0) < 0 for number in box}
    least = {number: interval[falls[number]] for number, interval in box.items()}
    return least, {number: interval[not falls[number]] for number, interval in box.items()}


def _sum(plane: LinearPlane, point: Point) -> Fraction:
    terms = (factor * point[number] for number, factor in plane.coefficients.items() if factor)
    return sum(terms, Fraction(0))


def _beside(planes: Sequence[LinearPlane], box: Mapping[Term, _Interval]) -> Iterator[Point]:
    """Points of a box on both sides of its only plane and on it, or any if there is none."""
    if not planes:
        yield {number: low for number, (low, _) in box.items()}
        return
    (plane,) = planes
    least, most = _corners(plane, box)
    low, high = _sum(plane, least), _sum(plane, most)
    share = (plane.limit - low) / (high - low) if high > low else Fraction(0)
    if low < plane.limit:
        yield least
    yield {number: least[number] + share * (most[number] - least[number]) for number in box}
    if high > plane.limit:
        yield most


def _on_a_line(limits: Set[Fraction], interval: tuple[Fraction, Fraction] | None) -> list[Fraction]:
    """The limits that the interval holds, and a number on each side of them in it."""
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
