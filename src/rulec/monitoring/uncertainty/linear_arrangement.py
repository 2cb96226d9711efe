"""Points that stand for all numbers, as far as linear comparisons can tell them apart.

Comparisons of sums with limits cut the space of a few unknown numbers into cells (an arrangement of
hyperplanes). One point of each is found by Fourier-Motzkin elimination, exactly.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, Literal, NamedTuple

Side = Literal["<", "<=", "="]

MOST_POINTS = 1 << 12
"""Of more cells no points are given."""


class LinearPlane(NamedTuple):
    """Where ``sum of coefficient * number`` is ``limit``."""

    coefficients: Mapping[Any, Fraction]
    limit: Fraction


class _Constraint(NamedTuple):
    coefficients: Mapping[Any, Fraction]
    side: Side
    limit: Fraction


Point = dict[Any, Fraction]


def sample_points(
    bounds: Mapping[Any, tuple[Fraction, Fraction] | None], planes: Sequence[LinearPlane]
) -> list[Point] | None:
    """A point in every cell of an arrangement, its planes being cells of their own.

    ``bounds`` has every number, with the closed interval in which it lies, or None for any. None
    for more than ``MOST_POINTS`` cells.
    """
    numbers = list(bounds)
    within = [
        constraint
        for number, interval in bounds.items()
        if interval is not None
        for constraint in (
            _Constraint({number: Fraction(1)}, "<=", interval[1]),
            _Constraint({number: Fraction(-1)}, "<=", -interval[0]),
        )
    ]
    distinct = list(
        {(tuple(sorted(p.coefficients.items(), key=str)), p.limit): p for p in planes}.values()
    )
    points = []
    for point in _cells(within, distinct, numbers):
        points.append(point)
        if len(points) > MOST_POINTS:
            return None
    return points


def _cells(
    within: list[_Constraint], planes: Sequence[LinearPlane], numbers: Sequence[Any]
) -> Iterator[Point]:
    point = _point_in(within, numbers)
    if point is None:
        return
    if not planes:
        yield point
        return
    (coefficients, limit), *others = planes
    opposite = {number: -factor for number, factor in coefficients.items()}
    for side in (
        _Constraint(coefficients, "<", limit),
        _Constraint(coefficients, "=", limit),
        _Constraint(opposite, "<", -limit),
    ):
        yield from _cells([*within, side], others, numbers)


def _point_in(constraints: Sequence[_Constraint], numbers: Sequence[Any]) -> Point | None:
    """A point that keeps all constraints, or None (Fourier-Motzkin elimination)."""
    if not numbers:
        kept = all(
            limit > 0 if side == "<" else limit >= 0 if side == "<=" else limit == 0
            for _, side, limit in constraints
        )
        return {} if kept else None
    *others, last = numbers
    lower, upper, rest = [], [], []
    for constraint in constraints:
        factor = constraint.coefficients.get(last, Fraction(0))
        if not factor:
            rest.append(constraint)
            continue
        # Solved for the number: at least, or at most, limit - sum of the others.
        solved = _Constraint(
            {n: c / factor for n, c in constraint.coefficients.items() if n != last},
            constraint.side,
            constraint.limit / factor,
        )
        if constraint.side == "=":
            lower.append(solved)
            upper.append(solved)
        else:
            (upper if factor > 0 else lower).append(solved)
    for low in lower:
        for high in upper:
            names = {**low.coefficients, **high.coefficients}
            between = {
                n: high.coefficients.get(n, Fraction(0)) - low.coefficients.get(n, Fraction(0))
                for n in names
            }
            strict = "<" in (low.side, high.side)
            rest.append(_Constraint(between, "<" if strict else "<=", high.limit - low.limit))
    point = _point_in(rest, others)
    if point is None:
        return None
    least = max((_at(bound, point) for bound in lower), default=None)
    most = min((_at(bound, point) for bound in upper), default=None)
    if least is None:
        point[last] = Fraction(0) if most is None else most - 1
    else:
        point[last] = least + 1 if most is None else (least + most) / 2
    return point


def _at(bound: _Constraint, point: Point) -> Fraction:
    return bound.limit - sum(
        (factor * point[number] for number, factor in bound.coefficients.items()), Fraction(0)
    )
