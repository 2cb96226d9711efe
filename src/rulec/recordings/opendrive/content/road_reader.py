"""Reads a road from its element in an OpenDRIVE file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise
from math import pi
from operator import attrgetter
from typing import Any, TypeVar

from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.opendrive.content.elements import (
    Access,
    Cubic,
    Geometry,
    Lane,
    LaneSection,
    MapRoad,
    MarkRecord,
    RoadLink,
    RoadStretch,
    RoadType,
    Shape,
)
from rulec.recordings.opendrive.content.furniture_reader import read_objects, read_signals
from rulec.recordings.opendrive.content.tree_values import (
    contact_point,
    cubic,
    lane_number,
    length,
    name,
    speed,
    text,
)

LONGEST_ROAD_M = 1_000_000.0
_MOST_TURNED = 200 * pi
"""The most that a piece of a reference line turns (rad), helical ramps included."""

_HAIR_M = 0.01

_Record = TypeVar("_Record")


def read_road(tree: Tree) -> MapRoad:
    """The road in an element. Raises RulecError R0610."""
    road_length = length(tree, "length")
    if road_length > LONGEST_ROAD_M:
        raise tree.wrong(f"a road is longer than {LONGEST_ROAD_M / 1000:,.0f} km")
    junction = text(tree, "junction")
    link, lanes = tree.first("link"), tree.child("lanes")
    ends = (None, None) if link is None else map(link.first, ("predecessor", "successor"))
    predecessor, successor = (None if end is None else _link(end) for end in ends)
    rule = text(tree, "rule")
    if rule not in ("", "RHT", "LHT"):
        raise tree.wrong(f"`rule` of a `road` is `{short(rule)}`", "`RHT` or `LHT`")
    signals, references = read_signals(tree)
    objects = tree.first("objects")
    return MapRoad(
        id=name(tree),
        length=road_length,
        junction="" if junction in ("", "-1") else name(tree, "junction"),
        left_hand=rule == "LHT",
        has_rule=rule != "",
        line=tree.place,
        predecessor=predecessor,
        successor=successor,
        types=_by_start(map(_type, tree.all("type"))),
        geometries=_geometries(tree.child("planView")),
        offsets=_cubics(lanes, "laneOffset", "s"),
        sections=tuple(_sections(lanes, road_length)),
        signals=signals,
        references=references,
        objects=read_objects(tree),
        tunnels=() if objects is None else tuple(map(_stretch, objects.all("tunnel"))),
    )


def _link(tree: Tree) -> RoadLink | None:
    # A missing link means none, as does an id of -1
    kind, other = text(tree, "elementType"), text(tree, "elementId")
    if kind not in ("road", "junction") or not other:
        return None
    return RoadLink(kind, name(tree, "elementId"), contact_point(tree))


def _type(tree: Tree) -> RoadType:
    limit = tree.first("speed")
    most = None if limit is None else speed(limit, None).limit_mps
    return RoadType(length(tree, "s", 0.0), text(tree, "type"), most, text(tree, "country"))


def _stretch(tree: Tree) -> RoadStretch:
    start = length(tree, "s")
    return RoadStretch(start, start + length(tree, "length"))


def _by_start(records: Iterable[_Record]) -> tuple[_Record, ...]:
    return tuple(sorted(records, key=attrgetter("start")))


def _cubics(tree: Tree, kind: str, key: str) -> tuple[Cubic, ...]:
    return _by_start(cubic(x, key) for x in tree.all(kind))


def _geometries(tree: Tree) -> tuple[Geometry, ...]:
    geometries = sorted(map(_geometry, tree.all("geometry")), key=lambda piece: piece.s)
    # Of two that start at the same s, the first has no length
    kept = [a for a, b in pairwise(geometries) if b.s > a.s] + geometries[-1:]
    if not kept:
        raise tree.wrong("a road has no `geometry`")
    return tuple(kept)


_SHAPES: dict[Shape, tuple[str, ...]] = {
    "line": (),
    "arc": ("curvature",),
    "spiral": ("curvStart", "curvEnd"),
    "poly3": ("a", "b", "c", "d"),
    "paramPoly3": ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"),
}


def _geometry(tree: Tree) -> Geometry:
    s, x, y, heading = length(tree, "s"), *(tree.number(key) for key in ("x", "y", "hdg"))
    whole = length(tree, "length")
    for shape, keys in _SHAPES.items():
        child = tree.first(shape)
        if child is None:
            continue
        numbers = tuple([child.number(key) for key in keys])
        curved = max(map(abs, numbers), default=0.0) if shape in ("arc", "spiral") else 0.0
        if curved * whole > _MOST_TURNED:
            raise child.wrong(f"a road turns round {curved * whole / 2 / pi:,.0f} times")
        # The standard's default is normalized
        normalized = shape == "paramPoly3" and text(child, "pRange") != "arcLength"
        return Geometry(
            s=s,
            x=x,
            y=y,
            heading=heading,
            length=whole,
            shape=shape,
            numbers=numbers,
            normalized=normalized,
        )
    raise tree.wrong("a `geometry` has no known shape", f"one of {', '.join(_SHAPES)}")


def _sections(lanes: Tree, road_length: float) -> Iterator[LaneSection]:
    trees = sorted(lanes.all("laneSection"), key=lambda tree: length(tree, "s"))
    if not trees:
        raise lanes.wrong("a road has no `laneSection`")
    starts = [length(tree, "s") for tree in trees]
    if starts[-1] > road_length + _HAIR_M:
        raise trees[-1].wrong(f"a lane section begins at {starts[-1]:g} m, beyond the road's end")
    rows: list[dict[int, Lane]] = []
    for number_, tree in enumerate(trees):
        row = _lanes(tree)
        if rows and text(tree, "singleSide") == "true":
            _carry_over(rows[-1], row, starts[number_] - starts[number_ - 1])
        rows.append(row)
    for start, end, row in zip(starts, [*starts[1:], road_length], rows, strict=True):
        yield LaneSection(start, max(start, end), row)


def _lanes(section: Tree) -> dict[int, Lane]:
    lanes: dict[int, Lane] = {}
    for side in ("left", "center", "right"):
        for tree in [lane for part in section.all(side) for lane in part.all("lane")]:
            lane = _lane(tree)
            # With left-hand traffic, SUMO's netconvert puts lanes -1 among those of `left`
            if (lane.id == 0) != (side == "center"):
                raise tree.wrong(f"a lane {lane.id} is among those of `{side}`")
            if lane.id in lanes:
                raise tree.wrong(f"there are two lanes {lane.id} in a lane section")
            lanes[lane.id] = lane
    return lanes


def _carry_over(before: dict[int, Lane], row: dict[int, Lane], way: float) -> None:
    """Continue the lanes of ``before`` on each side for which the next section gives no lane."""
    for side in (1, -1):
        if any(lane * side > 0 for lane in row):
            continue
        for lane in [lane for lane in before.values() if lane.id * side > 0]:
            moved: dict[str, Any] = {
                name: tuple([replace(x, start=x.start - way) for x in getattr(lane, name)])
                for name in ("widths", "borders", "marks", "speeds", "access")
            }
            row[lane.id] = replace(lane, predecessors=(lane.id,), **moved)
            before[lane.id] = replace(lane, successors=(lane.id,))


def _lane(tree: Tree) -> Lane:
    link = tree.first("link")
    predecessors, successors = (
        () if link is None else tuple([lane_number(end) for end in link.all(word)])
        for word in ("predecessor", "successor")
    )
    return Lane(
        id=lane_number(tree),
        type=text(tree, "type"),
        direction=text(tree, "direction"),
        widths=_cubics(tree, "width", "sOffset"),
        borders=_cubics(tree, "border", "sOffset"),
        marks=_by_start(map(_mark, tree.all("roadMark"))),
        speeds=_by_start(speed(x, "sOffset") for x in tree.all("speed")),
        access=tuple([_access(x) for x in tree.all("access")]),
        predecessors=predecessors,
        successors=successors,
    )


def _mark(tree: Tree) -> MarkRecord:
    return MarkRecord(length(tree, "sOffset", 0.0), text(tree, "type"), text(tree, "laneChange"))


def _access(tree: Tree) -> Access:
    """The permissions in an element: one attribute before version 1.8, child elements since."""
    users = {text(tree, "restriction"), *(text(x, "type") for x in tree.all("restriction"))}
    allows = text(tree, "rule") == "allow"
    return Access(length(tree, "sOffset", 0.0), allows, frozenset(users - {""}))
