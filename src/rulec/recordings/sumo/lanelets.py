"""The lanes of a SUMO net as lanelets.

A lane's borders lie half its width from its centre line. Within a junction, the limit of the road
before it still applies, unless the net allows more: a lower one is the speed of driving the bend.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

import numpy as np

from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.lanes.lanes_along import led_to, reversed_links
from rulec.recordings.polylines import interpolated, parallel_line, without_repeats
from rulec.recordings.recording import (
    BUSES_ONLY,
    CYCLES_TOO,
    STRAIGHT_ON,
    TAXIS_TOO,
    Lanelet,
    LaneMark,
    Light,
    Points,
)
from rulec.recordings.sumo.lane_kinds import lane_kinds
from rulec.recordings.sumo.net import NetConnection, NetEdge, NetLane, SumoNet
from rulec.recordings.sumo.right_of_way import (
    LEVEL_CROSSINGS,
    UNREGULATED,
    nodes_where_ways_meet,
    rights_of_ways,
    signs_of_lanes,
)

_WALKERS = {"pedestrian", "wheelchair"}
_RIDERS = {"bicycle", "scooter"}
_BUSES = {"bus", "coach", "taxi"}
_SERVICES = {"emergency", "authority", "army"}
"""The classes for which a lane is only a shoulder; other vehicles stop there in an emergency."""
_ALL = frozenset(
    {"passenger", "private", "truck", "trailer", "delivery", "motorcycle", "moped", "hov"}
    | {"evehicle", "emergency", "authority", "army", "vip", "custom1", "custom2"}
    | {"tram", "rail", "rail_urban", "rail_electric", "rail_fast", "subway", "ship"}
    | _WALKERS
    | _RIDERS
    | _BUSES
)
_RAILS = {name for name in _ALL if name.startswith("rail")} | {"tram", "subway", "ship"}
_ROUNDED_KMH = 0.02
"""Nets give limits in m/s with two decimals; these are at most this far from whole km/h."""

_GIVES_WAY, _STRAIGHT = "m", "s"
_ARMS = 3
_CLOSEST_M = 0.01


def net_lanelets(net: SumoNet, step_s: float) -> dict[str, Lanelet]:
    """Lane id -> lanelet, for all lanes of a length above 0."""
    shapes = {lane.id: without_repeats(lane.shape, _CLOSEST_M) for lane in net.lanes.values()}
    # In the order of the file, which decides that of predecessors
    there = {key: shape for key, shape in shapes.items() if len(shape) > 1}.keys()
    after = _successors(net.connections, there, set(net.lanes))
    before = reversed_links(after)
    origins = _origins(net, before)
    limits = {
        key: _unrounded(max(road.speed, net.lanes[key].speed)) for key, road in origins.items()
    }
    driven = {key for key in origins if _permitted(net.lanes[key]) - _WALKERS - _RIDERS - _RAILS}
    kinds = lane_kinds(net, driven)
    junctions = _junctions(net)
    ways: dict[str, dict[str, Light]] = defaultdict(dict)
    lights: dict[str, dict[Light, None]] = defaultdict(dict)
    for connection, light in net.lights(step_s):
        lights[connection.start][light] = None
        ways[connection.start][connection.via or connection.end] = light
    rights, signs = rights_of_ways(net), signs_of_lanes(net)
    # Leaves out the later lanes of ways through a junction that have several lanes
    entering = [x for x in net.connections if not x.start.startswith(":")]
    straight = {x.via for x in entering if x.direction == _STRAIGHT}
    links: dict[str, list[NetConnection]] = defaultdict(list)
    entries: dict[str, list[NetConnection]] = defaultdict(list)
    for connection in net.connections:
        links[connection.start].append(connection)
        entries[connection.end].append(connection)

    def onward(lane: NetLane) -> list[Set[str]]:
        ends = links[lane.id] if lane.edge.function == "internal" else []
        return [_permitted(net.lanes[link.end]) for link in ends if link.end in net.lanes]

    lanelets = {}
    for lane in net.lanes.values():
        if lane.id not in there:
            continue
        left, right, centre = _lines(lane, shapes[lane.id])
        own, origin = rights.get(lane.id), origins.get(lane.id, lane)
        junction = junction_of(lane)
        towards_left = 1 if net.side == "right" else -1
        lanelets[lane.id] = Lanelet(
            id=lane.id,
            left=left,
            right=right,
            centre=centre,
            successors=after[lane.id],
            predecessors=tuple(before[lane.id]),
            left_of=_neighbour(lane, towards_left, there),
            right_of=_neighbour(lane, -towards_left, there),
            types=frozenset(
                (
                    *_types(lane, net, junctions, entries[lane.id], onward(lane)),
                    *_place_types(origin.edge, net, lane),
                    *filter(None, [kinds.get(origin.id)]),
                    *([STRAIGHT_ON] if lane.id in straight and junction in junctions else ()),
                )
            ),
            signs=signs.get(lane.id, frozenset()),
            limit_mps=limits.get(lane.id),
            lights=tuple(lights.get(lane.id, ())),
            lights_to=ways.get(lane.id, {}),
            left_mark=_mark(lane, towards_left, there, lane.marks[0]),
            right_mark=_mark(lane, -towards_left, there, lane.marks[1]),
            stop_line=np.stack((left[-1], right[-1])) if links[lane.id] else None,
            junction=junction if junction in junctions else "",
            foes=own.foes if own else None,
            first=own.first if own else None,
        )
    return lanelets


def _lines(lane: NetLane, shape: Points) -> tuple[Points, Points, Points]:
    if lane.edge.function == "walkingarea" and len(shape) > 3:
        # The shape is an outline: its first half is one side, its second half the other
        half = len(shape) // 2
        right, left = shape[:half], shape[half:][::-1]
        count = max(len(right), len(left))
        right, left = _resampled(right, count), _resampled(left, count)
        return left, right, (left + right) / 2
    return parallel_line(shape, lane.width / 2), parallel_line(shape, -lane.width / 2), shape


def _resampled(points: Points, count: int) -> Points:
    at = np.linspace(0, len(points) - 1, count)
    return interpolated(at, np.arange(len(points), dtype=float), points)


def _successors(
    connections: list[NetConnection], there: Set[str], known: set[str]
) -> dict[str, tuple[str, ...]]:
    """Lane -> next lanes, skipping those of length 0."""
    direct: dict[str, list[str]] = defaultdict(list)
    for connection in connections:
        direct[connection.start].append(
            connection.via if connection.via in known else connection.end
        )
    return {key: led_to(direct, key, there.__contains__) for key in there}


def _neighbour(lane: NetLane, step: int, there: Set[str]) -> str | None:
    if lane.edge.function in ("crossing", "walkingarea"):
        return None
    beside_it = f"{lane.edge.id}_{lane.index + step}"
    return beside_it if beside_it in there else None


def _origins(net: SumoNet, before: Mapping[str, Sequence[str]]) -> dict[str, NetLane]:
    """Lane -> the lane of the road that leads to it, for lanes on which vehicles drive."""
    origins = {}
    for lane in net.lanes.values():
        origin, seen = lane, {lane.id}
        while origin.edge.function == "internal":
            earlier = next(
                (start for start in before.get(origin.id, ()) if start not in seen), None
            )
            if earlier is None:
                break
            origin = net.lanes[earlier]
            seen.add(earlier)
        if origin.edge.function == "" and not _permitted(lane) <= _WALKERS:
            origins[lane.id] = origin
    return origins


def _unrounded(limit_mps: float) -> float:
    kmh = limit_mps * KMH_PER_MPS
    return round(kmh) / KMH_PER_MPS if abs(kmh - round(kmh)) <= _ROUNDED_KMH else limit_mps


def _mark(lane: NetLane, step: int, there: Set[str], forbidden: bool) -> LaneMark | None:
    """The mark between two lanes of an edge: solid where changing across it is ``forbidden``."""
    if lane.edge.function or _neighbour(lane, step, there) is None:
        return None
    return "solid" if forbidden else "broken"


def junction_of(lane: NetLane) -> str:
    """The junction that a lane lies in, or empty."""
    return lane.edge.id[1:].rpartition("_")[0] if lane.edge.function == "internal" else ""


def _junctions(net: SumoNet) -> set[str]:
    """The nodes at which roads meet.

    Nets also split edges elsewhere, as where an exit lane begins.
    """
    arms: dict[str, set[str]] = defaultdict(set)
    for lane in net.lanes.values():
        if lane.edge.function == "" and not _permitted(lane) <= _WALKERS:
            arms[lane.edge.start].add(lane.edge.end)
            arms[lane.edge.end].add(lane.edge.start)
    meet = nodes_where_ways_meet(net)
    return {node for node, others in arms.items() if len(others) >= _ARMS and node in meet}


def _is_for_buses(permitted: Set[str]) -> bool:
    """Whether a lane permits buses, coaches or taxis, but no cars or trucks."""
    return bool(permitted & _BUSES) and not permitted & {"passenger", "private", "truck"}


def _types(
    lane: NetLane,
    net: SumoNet,
    junctions: set[str],
    entries: list[NetConnection],
    onward: Iterable[Set[str]],
) -> Iterator[str]:
    """The types of a lane by its purpose and place.

    ``onward``: for a lane within a node, the classes permitted on each lane behind it.
    """
    permitted = _permitted(lane)
    if lane.edge.function == "crossing":
        # A crossing at which pedestrians give way is no crosswalk
        waits = entries and all(entry.state == _GIVES_WAY and not entry.light for entry in entries)
        yield "sidewalk" if waits else "crosswalk"
        if entries and any(entry.light for entry in entries):
            yield "directed"
    elif lane.edge.function == "walkingarea" or (permitted and permitted <= _WALKERS):
        yield "sidewalk"
    elif not permitted & (_ALL - _WALKERS - {"ship"}) or not permitted - _RAILS:
        yield "restricted_area"
        if permitted and permitted <= _RAILS:
            yield "rail"
    elif permitted <= _WALKERS | _RIDERS:
        yield "sidewalk" if permitted & _WALKERS else "bicycleLane"
    elif _is_for_buses(permitted) and all(map(_is_for_buses, onward)):
        yield from ("busLane", BUSES_ONLY)
        if permitted & _RIDERS:
            yield CYCLES_TOO
        if "taxi" in permitted:
            yield TAXIS_TOO
    elif permitted <= _SERVICES:
        yield "shoulder"
    junction = junction_of(lane)
    crosses_rails = junction in net.junctions and net.junctions[junction].type in LEVEL_CROSSINGS
    if crosses_rails:
        yield "level_crossing"
    elif junction in junctions:
        yield "intersection"
        if net.junctions and net.junctions[junction].type in UNREGULATED:
            yield "unregulated"


_URBAN = ("residential", "living_street", "pedestrian")
_ORDINARY = (*_URBAN, "tertiary", "secondary", "unclassified", "service")
"""Roads of other types, such as trunk roads, may be expressways."""
_FAST_KMH = 80.0


def _place_types(road: NetEdge, net: SumoNet, lane: NetLane) -> Iterator[str]:
    """Types for the surroundings of a lane, as far as its road's type and limit show them."""
    if lane.edge.id in net.roundabouts:
        yield "roundabout"
    if "motorway" in road.type:
        yield "highway"
    elif any(word in road.type for word in _ORDINARY):
        yield "ordinary"
    if any(word in road.type for word in _URBAN):
        yield "urban"
    elif lane.edge.function == "" and lane.speed * KMH_PER_MPS > _FAST_KMH:
        yield "rural"
    if lane.edge.parameters.get("tunnel", "no") not in ("no", ""):
        yield "tunnel"


def _permitted(lane: NetLane) -> frozenset[str]:
    if lane.allow is not None:
        return _ALL if lane.allow == "all" else frozenset(lane.allow.split()) & _ALL
    if lane.disallow is not None:
        return frozenset() if lane.disallow == "all" else _ALL - frozenset(lane.disallow.split())
    return _ALL
