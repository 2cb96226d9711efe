"""Points on a road's reference line, by the standard's formulas.

The curvature of a spiral is linear in its length. Its heading is therefore a quadratic polynomial,
and its points are Fresnel integrals. These are computed by Gauss-Legendre quadrature, with 8 nodes
for each part that turns by at most half a radian, far more precisely than a millimetre.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rulec.array_types import Floats
from rulec.recordings.opendrive.content.elements import Cubic, Geometry

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_TURNED_IN_PIECE = 0.5
_EVERY_M = 0.5
_MOST_PIECES = 20_000
_ROUNDS = 3


class Places(NamedTuple):
    """Points (m) with the direction (rad) of the line at each of them."""

    x: Floats
    y: Floats
    heading: Floats


def places_on(geometries: Sequence[Geometry], s: Floats) -> Places:
    """The points of a reference line at ascending values of ``s``.

    Each piece is used up to the start of the next one, which the file gives as well.
    """
    starts = np.array([piece.s for piece in geometries])
    of_piece = np.clip(np.searchsorted(starts, s, side="right") - 1, 0, len(starts) - 1)
    result = Places(*(np.empty(len(s)) for _ in range(3)))
    for number in np.unique(of_piece).tolist():
        rows = of_piece == number
        piece = geometries[number]
        u, v, turned = _in_own_frame(piece, np.maximum(s[rows] - piece.s, 0.0))
        cos, sin = np.cos(piece.heading), np.sin(piece.heading)
        result.x[rows] = piece.x + u * cos - v * sin
        result.y[rows] = piece.y + u * sin + v * cos
        result.heading[rows] = piece.heading + turned
    return result


def place_on(geometries: Sequence[Geometry], s: float) -> tuple[float, float, float]:
    """The point (m) and the direction (rad) of a reference line at ``s``."""
    x, y, heading = (float(values[0]) for values in places_on(geometries, np.array([s])))
    return x, y, heading


def _in_own_frame(piece: Geometry, way: Floats) -> tuple[Floats, Floats, Floats]:
    """Points and directions at ``way`` (m) in a piece that starts at 0, 0 along the first axis."""
    match piece.shape:
        case "line":
            return way, np.zeros(len(way)), np.zeros(len(way))
        case "arc":
            return _arc(piece.numbers[0], way)
        case "spiral":
            return _spiral(piece, way)
        case "poly3":
            u = _at_way(np.array([0.0, 1.0, 0.0, 0.0]), np.array(piece.numbers), way, None)
            return _parametric(np.array([0.0, 1.0, 0.0, 0.0]), np.array(piece.numbers), u)
        case "paramPoly3":
            first, second = np.array(piece.numbers[:4]), np.array(piece.numbers[4:])
            # A normalized p grows in proportion to the length of the curve
            p = _at_way(first, second, way, piece.length) if piece.normalized else way
            return _parametric(first, second, p)


def _arc(curvature: float, way: Floats) -> tuple[Floats, Floats, Floats]:
    half = curvature * way / 2
    # The chord has the direction of the arc's middle; np.sinc multiplies by pi
    chord = way * np.sinc(half / np.pi)
    return chord * np.cos(half), chord * np.sin(half), 2 * half


def _spiral(piece: Geometry, way: Floats) -> tuple[Floats, Floats, Floats]:
    start, end = piece.numbers
    sharper = (end - start) / piece.length if piece.length else 0.0
    reached = np.append(0.0, way)
    steepest = max(abs(start), abs(start + sharper * float(reached.max())), abs(end))
    longest = _TURNED_IN_PIECE / steepest if steepest else np.inf
    most = float(reached.max()) / _MOST_PIECES
    if most > longest:
        longest = most
    # Split the way between points into parts that turn little
    ends = np.unique(np.concatenate((reached, _grid(float(reached.max()), longest))))
    width = np.diff(ends) / 2
    at = ends[:-1, None] + width[:, None] * (1 + _NODES)
    heading = start * at + sharper * at**2 / 2
    u, v = (
        np.append(0.0, np.cumsum(width * (turn(heading) @ _WEIGHTS))) for turn in (np.cos, np.sin)
    )
    rows = np.searchsorted(ends, way)
    return u[rows], v[rows], start * way + sharper * way**2 / 2


def _grid(end: float, step: float) -> Floats:
    count = int(np.ceil(end / step)) if np.isfinite(step) else 1
    return np.linspace(0.0, end, max(count, 1) + 1)


def _parametric(first: Floats, second: Floats, p: Floats) -> tuple[Floats, Floats, Floats]:
    u, v = _value(first, p), _value(second, p)
    return u, v, np.arctan2(_slope(second, p), _slope(first, p))


def _at_way(first: Floats, second: Floats, way: Floats, whole: float | None) -> Floats:
    """The parameter of a curve at a distance ``way`` along it.

    ``whole``: the length of the curve whose parameter goes from 0 to 1; if None, the parameter is
    the first coordinate, which is at most the distance.
    """
    longest = float(way.max(initial=0.0))
    most = longest if whole is None else 1.0
    extent = longest if whole is None else whole
    count = int(np.clip(np.ceil(extent / _EVERY_M), 64, _MOST_PIECES))
    p = np.linspace(0.0, most, count + 1)
    width = most / count / 2
    at = p[:-1, None] + width * (1 + _NODES)
    speed = np.hypot(_slope(first, at), _slope(second, at))
    reached = np.append(0.0, np.cumsum(width * (speed @ _WEIGHTS)))
    scale = 1.0
    if whole is not None:
        # An error in the stated length is spread evenly over the curve
        scale = reached[-1] / whole if whole else 0.0
        beyond = way > whole
    else:
        beyond = np.zeros(len(way), dtype=bool)
    wanted = np.minimum(way * scale, reached[-1])
    parameter = np.interp(wanted, reached, p)
    for _ in range(_ROUNDS):
        # Newton's method, with lengths from the start of the part that contains the parameter
        row = np.clip(np.searchsorted(reached, wanted, side="right") - 1, 0, count - 1)
        half = (parameter - p[row]) / 2
        inside = p[row][:, None] + half[:, None] * (1 + _NODES)
        length = reached[row] + half * (
            np.hypot(_slope(first, inside), _slope(second, inside)) @ _WEIGHTS
        )
        here = np.hypot(_slope(first, parameter), _slope(second, parameter))
        parameter = np.clip(parameter + (wanted - length) / np.maximum(here, 1e-9), 0.0, most)
    return np.where(beyond, 1.0, parameter)


def _value(numbers: Floats, p: Floats) -> Floats:
    a, b, c, d = numbers.tolist()
    result: Floats = a + p * (b + p * (c + p * d))
    return result


def _slope(numbers: Floats, p: Floats) -> Floats:
    _, b, c, d = numbers.tolist()
    result: Floats = b + p * (2 * c + p * 3 * d)
    return result


def cubics_at(cubics: Sequence[Cubic], s: Floats) -> Floats:
    """The values of polynomials, each used from its start; 0 before the first start."""
    if not cubics:
        return np.zeros(len(s))
    starts = np.array([cubic.start for cubic in cubics])
    table = np.array([(cubic.a, cubic.b, cubic.c, cubic.d) for cubic in cubics])
    row = np.searchsorted(starts, s, side="right") - 1
    a, b, c, d = table[np.maximum(row, 0)].T
    way = s - starts[np.maximum(row, 0)]
    value: Floats = np.where(row < 0, 0.0, a + way * (b + way * (c + way * d)))
    return value
