"""Rectangles, circles and polygons in a CommonRoad file, single or in groups.

They describe areas of the road, or the shape of an obstacle relative to its position.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, copysign, pi
from typing import TypeAlias

import numpy as np
import shapely
from shapely import affinity

from rulec.recordings.encodings.tree import Tree
from rulec.recordings.recording import Points

_FEWEST_CORNERS = 3
_SMALLEST_M = 1e-6
"""The smallest length, width or radius of an obstacle's shape."""


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangle around (x, y) whose long side points along ``heading`` (rad).

    ``shift``: how far (m) the position of an obstacle of this shape lies ahead of its middle.
    """

    length: float
    width: float
    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    shift: float = 0.0


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle around (x, y)."""

    radius: float
    x: float = 0.0
    y: float = 0.0


@dataclass(frozen=True, slots=True)
class Polygon:
    """A polygon; its corners are in clockwise order."""

    outline: shapely.Polygon


Part: TypeAlias = Rectangle | Circle | Polygon
Area: TypeAlias = tuple[Part, ...]


_GROUPS = frozenset({"shapeGroup", "absoluteShapeGroup", "shape"})
_SHAPES = ("rectangle", "circle", "polygon", "truckShape")


def read_area(tree: Tree, *, body: bool = False) -> Area:
    """The area of all shapes in an element; an element without a shape is an error.

    Shapes of a ``body`` must have a positive size.
    """
    parts = []
    waiting = tree.children[::-1]
    while waiting:
        child = waiting.pop()
        if child.name in _GROUPS:
            waiting += child.children[::-1]
        else:
            parts.append(_part(child, body))
    if not parts:
        raise tree.wrong(f"the element `{tree.name}` has no shape in it")
    return tuple(parts)


def is_area(tree: Tree) -> bool:
    """Whether an element contains a shape."""
    return any(child.name in _GROUPS or child.name in _SHAPES for child in tree.children)


def _part(tree: Tree, body: bool) -> Part:
    if tree.name == "polygon":
        return _polygon(tree, body)
    if tree.name not in _SHAPES:
        why = f"the element `{tree.name}` is not a known shape"
        raise tree.wrong(why, f"one of {', '.join(_SHAPES)}")
    centre = tree.first("center")
    x, y = (0.0, 0.0) if centre is None else read_point(centre)
    if tree.name == "circle":
        return Circle(_size(tree.child("radius"), _SMALLEST_M), x, y)
    sizes = tree.child("truckDims") if tree.name == "truckShape" else tree
    length, width = (
        _size(sizes.child(name), _SMALLEST_M if body else 0.0) for name in ("length", "width")
    )
    heading, shift = (
        0.0 if child is None else child.number()
        for child in map(tree.first, ("orientation", "originXShift"))
    )
    if abs(shift) > length / 2:
        raise tree.wrong(f"an obstacle's position is {shift:g} m ahead of its middle, outside it")
    return Rectangle(length, width, x, y, heading=turned_once(heading), shift=shift)


def _size(tree: Tree, least: float) -> float:
    size = tree.number()
    if size < least:
        raise tree.wrong(f"`{tree.name}` is {size:g}", f"a number not below {least:g}")
    return size


def _polygon(tree: Tree, body: bool) -> Polygon:
    points = read_points(tree)
    if len(points) < _FEWEST_CORNERS:
        raise tree.wrong(f"a polygon has fewer than {_FEWEST_CORNERS} points")
    polygon = shapely.Polygon(points)
    if body and not polygon.is_valid:
        raise tree.wrong("a polygon crosses itself, or has no area")
    return Polygon(shapely.geometry.polygon.orient(polygon, sign=-1.0))


def read_point(tree: Tree) -> tuple[float, float]:
    """The x and y of a point; its height is ignored."""
    return tree.child("x").number(), tree.child("y").number()


def read_points(tree: Tree) -> Points:
    """The x and y of all points in an element, one row each."""
    return np.array(list(map(read_point, tree.all("point"))), dtype=float).reshape(-1, 2)


def turned_once(heading: float) -> float:
    """An angle (rad), reduced by full turns to between -2π and 2π."""
    turns = ceil(abs(heading) / (2 * pi)) - 1
    return heading - copysign(2 * pi * turns, heading) if turns > 0 else heading


def geometry(area: Area) -> shapely.Geometry:
    """An area as one polygon, or as several."""
    if len(area) == 1:
        return _geometry(area[0])
    parts = shapely.GeometryCollection([_geometry(part) for part in area])
    # This merges overlapping parts and drops those without an area
    together = parts.buffer(0)
    return parts if together.is_empty else together


def _geometry(part: Part) -> shapely.Polygon:
    match part:
        case Rectangle():
            x, y = part.length * 0.5, part.width * 0.5
            front, rear = x - part.shift, -x - part.shift
            around = shapely.Polygon([(rear, -y), (rear, y), (front, y), (front, -y)])
            return _placed(around, part.x, part.y, part.heading)
        case Circle():
            return shapely.Point(part.x, part.y).buffer(part.radius)
        case Polygon():
            return part.outline


def _placed(shape: shapely.Geometry, x: float, y: float, heading: float) -> shapely.Geometry:
    return affinity.translate(affinity.rotate(shape, heading, (0, 0), use_radians=True), x, y)


def corners(shape: shapely.Geometry) -> Points:
    """The corners and the midpoints of the sides of a polygon; of several, those of their hull."""
    hull = shape if shape.geom_type == "Polygon" else shape.convex_hull
    if hull.geom_type != "Polygon":
        return np.array(hull.coords, dtype=float)
    places = np.asarray(hull.exterior.coords, dtype=float)[:, :2]
    middles = (places[1:] + places[:-1]) / 2
    return np.concatenate((places[:-1], middles))


def outline_at(body: Area, x: float, y: float, heading: float) -> Points:
    """The outline of a body of any shape at (x, y), turned by ``heading`` (rad)."""
    match body:
        case (Circle(radius, 0.0, 0.0),):
            return corners(geometry((Circle(radius, x, y),)))
    return corners(_placed(geometry(body), x, y, heading))


def outline_around(body: Area, place: Area, low: float, high: float) -> Points:
    """The outline of a rectangle around everything that a body may cover.

    Its position may be anywhere in ``place``, its heading anything from ``low`` to ``high`` (rad).
    After Althoff and Dolan, *Online verification of automated road vehicles using reachability
    analysis* (2014), section IV.C.
    """
    length, width = _size_around_place(body)
    middle, either_way = low + 0.5 * (high - low), 0.5 * (high - low)
    centre = _centre(place)
    along, across = _extent([_moved(part, -centre.x, -centre.y, -middle) for part in place])
    at_corner = np.arctan(width / length), np.arctan(length / width)
    most_along, most_across = (min(either_way, angle) for angle in at_corner)
    more_along = abs((1.0 - np.cos(most_along)) * length - np.sin(most_along) * width)
    more_across = abs((1.0 - np.cos(most_across)) * width - np.sin(most_across) * length)
    length, width = along + length + float(more_along), across + width + float(more_across)
    return corners(_geometry(Rectangle(length, width, centre.x, centre.y, turned_once(middle))))


def _size_around_place(body: Area) -> tuple[float, float]:
    match body:
        case (Rectangle(length, width, 0.0, 0.0, 0.0, 0.0),):
            return length, width
        case (Circle(radius, 0.0, 0.0),):
            return 2.0 * radius, 2.0 * radius
    # The position of a body need not be in its middle
    west, south, east, north = geometry(body).bounds
    return 2 * max(abs(west), abs(east)), 2 * max(abs(south), abs(north))


def _extent(area: Sequence[Part]) -> tuple[float, float]:
    match area:
        case [Circle(radius)]:
            return 2.0 * radius, 2.0 * radius
    west, south, east, north = geometry(tuple(area)).bounds
    return abs(east - west), abs(north - south)


def _centre(area: Area) -> shapely.Point:
    match area:
        case (Rectangle() | Circle() as part,):
            return shapely.Point(part.x, part.y)
    return geometry(area).centroid


def _moved(part: Part, x: float, y: float, heading: float) -> Part:
    """A part, moved by (x, y) and then turned by ``heading`` (rad) around the origin."""

    def move(shape: shapely.Geometry) -> shapely.Geometry:
        return affinity.rotate(affinity.translate(shape, x, y), heading, (0, 0), use_radians=True)

    match part:
        case Rectangle():
            centre = move(shapely.Point(part.x, part.y))
            own = turned_once(part.heading + heading)
            return Rectangle(part.length, part.width, centre.x, centre.y, own)
        case Circle():
            centre = move(shapely.Point(part.x, part.y))
            return Circle(part.radius, centre.x, centre.y)
        case Polygon():
            return Polygon(move(part.outline))
