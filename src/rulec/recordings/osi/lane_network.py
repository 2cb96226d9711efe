"""The lanes of an ASAM OSI trace as connected lanelets in the direction of traffic."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

from rulec.recordings.osi.lane_messages import Boundary, TraceLane
from rulec.recordings.osi.lane_shapes import LaneShape, lane_shape, way_across
from rulec.recordings.recording import Lanelet, LaneMark, Points

MEET_M = 1.0
"""The largest gap (m) between the end line of a lane and the start line of the next one.

Some lanes that a trace declares connected do not meet at all.
"""

LONGEST_WAY_M = 300.0
"""The longest way (m) across an intersection area."""

_TOGETHER = 0.8
"""Lanes are neighbours if they run side by side for at least this share of each."""

_DOUBLE_M = 0.6
"""Solid lines of two adjacent lanes that are this close (m) are one double line."""

_TYPES: Mapping[str, tuple[str, ...]] = {
    "biking": ("bicycleLane",),
    "sidewalk": ("sidewalk",),
    "parking": ("parking",),
    "stop": ("shoulder",),
    "shoulder": ("shoulder",),
    "border": ("border",),
    "restricted": ("restricted",),
    "exit": ("exitRamp",),
    "offramp": ("exitRamp",),
    "entry": ("accessRamp",),
    "onramp": ("accessRamp",),
}
_KINDS: Mapping[str, tuple[str, ...]] = {
    "intersection": ("intersection",),
    "nondriving": ("restricted_area",),
}
"""Lane types by subtype, and by lane type where the subtype gives none."""

_DRIVEN_ON = frozenset({"intersection", "bicycleLane", "shoulder", "exitRamp", "accessRamp"})


@dataclass(slots=True)
class LaneNetwork:
    """The lanelets of a trace by id, and what was wrong or missing in it, for remarks.

    ``of_lane``: the lanelets of each lane of the trace; an intersection area has many.
    """

    lanelets: dict[str, Lanelet] = field(default_factory=dict)
    of_lane: dict[str, tuple[str, ...]] = field(default_factory=dict)
    shapeless: list[str] = field(default_factory=list)
    undirected: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    across: list[str] = field(default_factory=list)
    apart: list[str] = field(default_factory=list)


def lane_network(lanes: Sequence[TraceLane], boundaries: Mapping[str, Boundary]) -> LaneNetwork:
    """The network of lanelets made of a trace's lanes."""
    network = LaneNetwork()
    middles = {lane.id: lane.centre for lane in lanes if len(lane.centre) > 1}
    known: dict[str, TraceLane] = {}
    shapes: dict[str, LaneShape] = {}
    areas = []
    for lane in lanes:
        shape = lane_shape(lane, boundaries, middles)
        if shape is not None:
            known[lane.id], shapes[lane.id] = _in_traffic(lane, shape)
            if shape.assumed:
                network.assumed.append(lane.id)
            if lane.forward is None and "restricted_area" not in _types(lane):
                network.undirected.append(lane.id)
        elif lane.pairs:
            areas.append(lane)
        else:
            network.shapeless.append(lane.id)
    links = _links(known, shapes, {area.id for area in areas}, network)
    junctions = {}
    for area in areas:
        ways = {f"{area.id}_{start}_{end}": (start, end) for start, end in area.pairs}
        for name, (start, end) in ways.items():
            if start in shapes and end in shapes and _is_near(shapes[start], shapes[end]):
                shapes[name] = way_across(shapes[start], shapes[end])
                known[name] = replace_id(area, name)
                links += [(start, name), (name, end)]
                junctions[name] = area.id
                network.across.append(name)
        network.of_lane[area.id] = tuple(name for name in ways if name in shapes)
    after, before = defaultdict[str, list[str]](list), defaultdict[str, list[str]](list)
    for start, end in dict.fromkeys(links):
        after[start].append(end)
        before[end].append(start)
    for name, lane in known.items():
        shape = shapes[name]
        network.of_lane.setdefault(name, (name,))
        beside = [_beside(name, ids, shapes) for ids in (lane.left_of, lane.right_of)]
        marks = [
            _mark(own, _facing(known, end, left=left), boundaries)
            for own, end, left in (
                (lane.left_bounds, lane.left_of, True),
                (lane.right_bounds, lane.right_of, False),
            )
        ]
        network.lanelets[name] = Lanelet(
            id=name,
            left=shape.left,
            right=shape.right,
            centre=shape.centre,
            successors=tuple(after[name]),
            predecessors=tuple(before[name]),
            left_of=beside[0],
            right_of=beside[1],
            types=_types(lane),
            limit_mps=lane.limit_mps,
            left_mark=marks[0],
            right_mark=marks[1],
            junction=junctions.get(name, ""),
        )
    network.lanelets = _mutual(network.lanelets)
    return network


def replace_id(area: TraceLane, name: str) -> TraceLane:
    """A way across an intersection area, with the area's types but no boundaries or neighbours."""
    nothing: tuple[str, ...] = ()
    return area._replace(
        id=name,
        left_bounds=nothing,
        right_bounds=nothing,
        left_of=nothing,
        right_of=nothing,
    )


def _in_traffic(lane: TraceLane, shape: LaneShape) -> tuple[TraceLane, LaneShape]:
    """A lane and its shape, both reversed if traffic runs against the order of the points."""
    if lane.forward is not False:
        return lane, shape
    turned = lane._replace(
        left_bounds=lane.right_bounds,
        right_bounds=lane.left_bounds,
        left_of=lane.right_of,
        right_of=lane.left_of,
    )
    left, right, centre = shape.right[::-1], shape.left[::-1], shape.centre[::-1]
    return turned, shape._replace(left=left, right=right, centre=centre)


def _is_near(before: LaneShape, after: LaneShape) -> bool:
    return float(np.hypot(*(after.centre[0] - before.centre[-1]))) <= LONGEST_WAY_M


def _types(lane: TraceLane) -> frozenset[str]:
    own = _TYPES.get(lane.subtype, ())
    types = {*own, *(_KINDS["intersection"] if lane.kind == "intersection" else ())}
    if lane.kind == "nondriving" and not types - _DRIVEN_ON - {"restricted"}:
        types |= {"restricted_area"} if "shoulder" not in types else set()
    return frozenset(types) | lane.types


def _links(
    known: Mapping[str, TraceLane],
    shapes: Mapping[str, LaneShape],
    areas: set[str],
    network: LaneNetwork,
) -> list[tuple[str, str]]:
    """The pairs (lane, next lane) of connected lanes.

    The geometry of the ends decides which comes first: some traces call the lane before a lane's
    first point its antecessor, others the lane that traffic comes from.
    """
    links = []
    for name, lane in known.items():
        for other in lane.linked:
            if other in areas:
                continue
            ways = [
                (first, second)
                for first, second in ((name, other), (other, name))
                if other in shapes and _meet(shapes[first], shapes[second])
            ]
            links += ways
            if not ways:
                network.apart.append(f"{name} and {other}")
    return links


def _meet(before: LaneShape, after: LaneShape) -> bool:
    """Whether the first lane ends where the second starts, in the same direction."""
    ahead, onward = before.centre[-1] - before.centre[-2], after.centre[1] - after.centre[0]
    if float(ahead @ onward) <= 0:
        return False
    end = shapely.LineString((before.left[-1], before.right[-1]))
    return bool(
        shapely.distance(end, shapely.LineString((after.left[0], after.right[0]))) <= MEET_M
    )


def _beside(name: str, others: Sequence[str], shapes: Mapping[str, LaneShape]) -> str | None:
    """The candidate that runs beside a lane for most of both lengths and in its direction."""
    own = shapes[name].centre
    shares = {
        other: min(_share(own, shapes[other].centre), _share(shapes[other].centre, own))
        for other in others
        if other in shapes and _direction(own) @ _direction(shapes[other].centre) > 0
    }
    best = max(shares, key=lambda other: shares[other], default=None)
    return best if best is not None and shares[best] >= _TOGETHER else None


def _direction(line: Points) -> Points:
    step: Points = line[-1] - line[0]
    return step


def _share(line: Points, other: Points) -> float:
    """The share of a line that runs beside another one, measured from the other's two ends."""
    string = shapely.LineString(line)
    start, end = shapely.line_locate_point(string, shapely.points(other[[0, -1]]))
    return float((end - start) / max(string.length, 1e-9))


def _mutual(lanelets: dict[str, Lanelet]) -> dict[str, Lanelet]:
    """The lanelets, with neighbour relations kept only if they hold in both directions."""

    def agreed(name: str, other: str | None, side: str) -> str | None:
        known = None if other is None else getattr(lanelets[other], side)
        return other if known in (None, name) else None

    return {
        name: replace(
            lanelet,
            left_of=agreed(name, lanelet.left_of, "right_of"),
            right_of=agreed(name, lanelet.right_of, "left_of"),
        )
        for name, lanelet in lanelets.items()
    }


def _facing(known: Mapping[str, TraceLane], others: Sequence[str], *, left: bool) -> Iterator[str]:
    """The boundaries of adjacent lanes on the side facing this lane, whatever their direction."""
    for other in others:
        if other in known:
            lane = known[other]
            yield from (
                (*lane.right_bounds, *lane.left_bounds)
                if left
                else (
                    *lane.left_bounds,
                    *lane.right_bounds,
                )
            )


def _mark(
    own: Sequence[str], facing: Iterator[str], boundaries: Mapping[str, Boundary]
) -> LaneMark | None:
    """The mark of a lane's side; None if there is none or it changes along the lane.

    A double line is two boundaries, one of each lane.
    """
    marks = {boundaries[x].mark for x in own if x in boundaries}
    mark = marks.pop() if len(marks) == 1 else None
    if mark != "solid":
        return mark
    lines = [shapely.LineString(boundaries[x].line) for x in own if x in boundaries]
    for other in facing:
        if other not in own and other in boundaries and boundaries[other].mark == "solid":
            line = shapely.LineString(boundaries[other].line)
            if any(_runs_along(line, other_line) for other_line in lines):
                return "double_solid"
    return mark


def _runs_along(line: shapely.LineString, other: shapely.LineString) -> bool:
    middle = shapely.line_interpolate_point(line, 0.5, normalized=True)
    return bool(shapely.distance(middle, other) <= _DOUBLE_M)
