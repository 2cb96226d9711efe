"""Lines through points, and places in areas."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
import shapely
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.recordings.recording import Points

_SHARPEST = 0.5
"""The largest factor by which a border is displaced at a sharp turn of the line."""

_THIRD_OF_NOISE = 0.6745 * 20**0.5
"""The median size of third differences of normal noise with the standard deviation 1."""

Angle = TypeVar("Angle", float, NDArray[float64])


def wrapped(angle: Angle) -> Angle:
    """An angle, or several (rad), from -π to π."""
    return (angle + np.pi) % (2 * np.pi) - np.pi


def line_length(points: Points) -> float:
    """How long (m) the line through some points is."""
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def arc_lengths(points: Points) -> NDArray[float64]:
    """How far (m) along the line through some points each of them is."""
    return np.append(0.0, np.hypot(*np.diff(points, axis=0).T).cumsum())


def interpolated(at: NDArray[float64], known: NDArray[float64], points: Points) -> Points:
    """The points at some numbers, interpolated between those that are ``known``."""
    return np.stack([np.interp(at, known, column) for column in points.T], axis=1)


def without_repeats(points: Points, closest_m: float) -> Points:
    """The points that are not too close to the one before them."""
    if (np.hypot(*np.diff(points, axis=0).T) > closest_m).all():
        return np.array(points)
    kept = [points[0]]
    for point in points[1:]:
        if np.hypot(*(point - kept[-1])) > closest_m:
            kept.append(point)
    return np.array(kept)


def far_apart(points: Points, least_m: float) -> NDArray[intp]:
    """The indices of the first point, and of each that is so far from the last of them."""
    kept, (x, y) = [0], points[0].tolist()
    for number, (own_x, own_y) in enumerate(points[1:].tolist(), 1):
        if (own_x - x) ** 2 + (own_y - y) ** 2 >= least_m**2:
            kept.append(number)
            x, y = own_x, own_y
    return np.array(kept)


def noise_of(places: Points) -> float:
    """The standard deviation (m) along an axis of noise of places at even times.

    By their third differences, in which driving hardly shows. 0 for fewer than four places.
    """
    return noise_by_thirds(np.diff(places, 3, axis=0))


def noise_by_thirds(thirds: NDArray[float64]) -> float:
    """The standard deviation of noise by third differences (m); 0 if there are none."""
    return float(np.median(np.abs(thirds))) / _THIRD_OF_NOISE if thirds.size else 0.0


def densified(points: Points, every_m: float) -> Points:
    """A polyline with further points, none farther apart than a limit."""
    return densified_lines([points], every_m)[0]


def densified_lines(lines: Sequence[Points], every_m: float) -> tuple[Points, list[int]]:
    """The same for several lines: their points end to end, and how many each has."""
    dense = [
        # GEOS makes a single point of a line without length, and refuses it
        shapely.get_coordinates(shapely.segmentize(shapely.LineString(line), every_m))
        if (line != line[0]).any()
        else line
        for line in lines
    ]
    return np.concatenate(dense), [len(line) for line in dense]


def parallel_line(points: Points, offset: float | NDArray[float64]) -> Points:
    """The parallel of a line of at least two different points, at a distance to the left.

    ``offset`` is that distance: one for the line, or one for each point.
    """
    ahead = np.diff(points, axis=0)
    ahead /= np.hypot(*ahead.T)[:, None]
    across = np.stack((-ahead[:, 1], ahead[:, 0]), axis=1)
    before = np.concatenate((across[:1], across))
    after = np.concatenate((across, across[-1:]))
    # Both pieces' parallels meet on the line that halves the angle between them
    stretch = np.maximum(1.0 + (before * after).sum(axis=1), _SHARPEST)
    line: Points = points + np.reshape(offset, (-1, 1)) * (before + after) / stretch[:, None]
    return line


def paired(line: Points, other: Points) -> tuple[Points, Points]:
    """Two lines side by side, each with a point for every point of either.

    The points of both are at equal shares of their lengths.
    """
    parts = [shares_along(line), shares_along(other)]
    at = np.unique(np.concatenate(parts))
    at = at[np.append(True, np.diff(at) > _ONE)]
    # The ends are both's, however close a point is
    at[0], at[-1] = 0.0, 1.0
    return interpolated(at, parts[0], line), interpolated(at, parts[1], other)


def ends_apart(line: Points, other: Points) -> float:
    """The sum of the distances between the starts and between the ends of two lines."""
    return float(np.hypot(*(line[[0, -1]] - other[[0, -1]]).T).sum())


_ONE = 1e-9
"""Points closer than this share of the length coincide."""


def shares_along(points: Points) -> NDArray[float64]:
    """The distance of each point along the line, as a share of its length."""
    ways = arc_lengths(points)
    parts: NDArray[float64] = ways / ways[-1]
    return parts


class Crossing(NamedTuple):
    """Where two lines of several cross, by their indices, and how far (m) along each that is."""

    first: int
    second: int
    first_along: float
    second_along: float


def crossings(lines: Sequence[Points], least_rad: float) -> Iterator[Crossing]:
    """The pairs of lines that cross, at an angle above ``least_rad``, which is below a right one.

    Ways that meet at a smaller angle run into each other, as where lanes join or part.
    """
    strings = [shapely.LineString(line) for line in lines]
    for pair in shapely.STRtree(strings).query(strings, predicate="crosses").T.tolist():
        first, second = pair
        if first < second:
            meeting = shapely.intersection(strings[first], strings[second])
            place = shapely.point_on_surface(meeting)
            along = [float(strings[number].project(place)) for number in pair]
            turns = [_direction(lines[number], at) for number, at in zip(pair, along, strict=True)]
            if abs(np.arctan(np.tan(turns[0] - turns[1]))) > least_rad:
                yield Crossing(first, second, *along)


def _direction(line: Points, along: float) -> float:
    """The direction (rad) of a line at a place along it (m)."""
    piece = int(arc_lengths(line)[1:-1].searchsorted(along, "right"))
    x, y = (line[piece + 1] - line[piece]).tolist()
    return float(np.arctan2(y, x))


def places_in(
    areas: Sequence[shapely.Geometry], x: NDArray[float64], y: NDArray[float64]
) -> tuple[NDArray[intp], NDArray[intp]]:
    """The places within areas, as pairs of the numbers of both."""
    points, own = shapely.points(x, y), np.array(areas, dtype=object)
    places, numbers = shapely.STRtree(own).query(points)
    # A tree prepares what it is asked about, the places; that takes ten times as long.
    shapely.prepare(own)
    inside = shapely.intersects(own[numbers], points[places])
    return places[inside], numbers[inside]
