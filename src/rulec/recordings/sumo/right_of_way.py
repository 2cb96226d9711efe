"""Priority at the junctions of a SUMO net, and its signs.

For each way through a junction, a net's ``request`` holds bits for the other ways: those whose
traffic it waits for, and those in conflict with it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rulec.recordings.sumo.net import NetConnection, NetJunction, SumoNet

UNREGULATED = frozenset({"right_before_left", "left_before_right", "unregulated"})
"""Types of junctions without signs or lights."""

LEVEL_CROSSINGS = frozenset({"rail_crossing"})

_STOPS = {"s", "w"}
_GIVES_WAY, _GOES_FIRST = "m", "M"
_Ways = frozenset[str]


@dataclass(frozen=True, slots=True)
class WayRights:
    """The lanes of the ways that conflict with a way, and those of the ways that have priority."""

    foes: _Ways
    first: _Ways


def rights_of_ways(net: SumoNet) -> dict[str, WayRights]:
    """Lane within a junction -> the ways in conflict with its own, and those with priority."""
    onward = {
        connection.start: connection.via
        for connection in net.connections
        if connection.via and connection.start.startswith(":")
    }
    backward = {end: start for start, end in onward.items()}
    rights = {}
    for junction in net.junctions.values():
        if len(junction.ways) == len(junction.foes):
            ways = [_lanes_of(way, onward, backward) for way in junction.ways]
            for number, lanes in enumerate(ways):
                foes = _named(junction.foes[number], ways)
                own = WayRights(foes, _named(junction.first[number], ways))
                rights.update(dict.fromkeys(lanes, own))
    return rights


def nodes_where_ways_meet(net: SumoNet) -> set[str]:
    """The nodes at which ways of different roads cross or join, or whose ways are unknown.

    Ways of one road that split or merge meet no other traffic, and pedestrians cross at crossings.
    """
    roads = {
        connection.via: net.lanes[connection.start].edge.id
        for connection in net.connections
        if connection.via and connection.start in net.lanes
    }
    meet = set()
    for junction in net.junctions.values():
        known = len(junction.ways) == len(junction.foes)
        for way, bits in zip(junction.ways, junction.foes, strict=False):
            foes = {roads.get(foe) for foe in _named(bits, [(x,) for x in junction.ways])}
            if known and way in roads and foes - {None, roads[way]}:
                meet.add(junction.id)
        if not known or not junction.ways:
            meet.add(junction.id)
    nodes = {node for edge in net.edges.values() for node in (edge.start, edge.end)}
    return meet | (nodes - net.junctions.keys())


def _lanes_of(way: str, onward: Mapping[str, str], backward: Mapping[str, str]) -> tuple[str, ...]:
    """All lanes of a way through a junction; a waiting position within it splits the way."""
    lanes = [way]
    while (before := backward.get(lanes[0])) is not None and before not in lanes:
        lanes.insert(0, before)
    while (after := onward.get(lanes[-1])) is not None and after not in lanes:
        lanes.append(after)
    return tuple(lanes)


def _named(bits: str, ways: list[tuple[str, ...]]) -> _Ways:
    # The last bit belongs to the first way
    return frozenset(
        lane for bit, way in zip(reversed(bits), ways, strict=False) if bit == "1" for lane in way
    )


def signs_of_lanes(net: SumoNet) -> dict[str, frozenset[str]]:
    """Lane -> the signs at its end that its links obey, where there is no light.

    A road gives way by sign if none of its links has priority: links that only wait for oncoming
    traffic before turning across it do so without a sign.
    """
    by_edge: dict[str, list[NetConnection]] = defaultdict(list)
    for connection in net.connections:
        if connection.start in net.lanes and not connection.light:
            by_edge[net.lanes[connection.start].edge.id].append(connection)
    signs: dict[str, set[str]] = defaultdict(set)
    for edge, links in by_edge.items():
        junction = net.junctions.get(net.edges[edge].end)
        minor = all(link.state != _GOES_FIRST for link in links)
        for link in links:
            signs[link.start].update(_signs(link, junction, minor=minor))
    for connection in net.connections:
        programmes = [x for x in net.programmes.get(connection.light, ()) if x is not None]
        if any(programme.has_arrow(connection.link) for programme in programmes):
            signs[connection.start].add("GREEN_ARROW")
    return {lane: frozenset(own) for lane, own in signs.items()}


def _signs(link: NetConnection, junction: NetJunction | None, *, minor: bool) -> Iterator[str]:
    if link.state in _STOPS:
        yield "STOP"
    if junction is None or junction.type not in ("priority", "priority_stop"):
        return
    if minor and link.state == _GIVES_WAY:
        yield "YIELD"
    if not minor and any("1" in bits for bits in junction.first):
        yield "PRIORITY"
