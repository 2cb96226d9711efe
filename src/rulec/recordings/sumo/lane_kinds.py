"""Kinds of lanes of a SUMO net: continuing, joining, leaving.

A lane continues if every lane of its road leads to one lane of the next road, for the next
kilometre or up to the end of the net: signs and arrows that assign lanes to destinations stand no
earlier. A road of one lane always continues. On a motorway, other lanes may join, leave or end
beside lanes that continue, without assigning these to a destination. Lanes join from links and
leave to links (``_link`` in the road's type). A lane that comes from another road than the lanes
beside it, and ends, is a joining lane whatever the types are.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Set

from rulec.recordings.polylines import line_length
from rulec.recordings.recording import RAMPS
from rulec.recordings.sumo.net import SumoNet

_AHEAD_M = 1000.0
_MOTORWAY, _LINK = "motorway", "_link"
_Lanes = Mapping[str, list[str]]


def lane_kinds(net: SumoNet, drivable: Set[str]) -> dict[str, str]:
    """Lane -> CommonRoad's word for its purpose, for lanes whose purpose the net shows.

    ``drivable``: the lanes on which vehicles drive.
    """
    # Connections for U-turns do not count
    onward: dict[str, list[str]] = defaultdict(list)
    before: dict[str, set[str]] = defaultdict(set)
    back: dict[str, list[str]] = defaultdict(list)
    for connection in net.connections:
        if {connection.start, connection.end} <= drivable:
            own, after = net.lanes[connection.start].edge, net.lanes[connection.end].edge
            if (after.start, after.end) != (own.end, own.start):
                onward[connection.start].append(connection.end)
                back[connection.end].append(connection.start)
                before[after.id].add(own.type)
    edges: dict[str, list[str]] = defaultdict(list)
    for name in drivable:
        if not net.lanes[name].edge.function:
            edges[net.lanes[name].edge.id].append(name)
    kinds: dict[str, str] = {}
    for edge, lanes in edges.items():
        through = len(lanes) == 1 or _goes_on(net, edge, edges, onward)
        motorway = _MOTORWAY in net.edges[edge].type
        joined = any(_LINK in kind for kind in before[edge])
        goes_on = any(onward[lane] for lane in lanes)
        for lane in lanes:
            leads_to = {net.lanes[end].edge.type for end in onward[lane]}
            if _LINK in net.edges[edge].type:
                continue
            if through:
                kinds[lane] = "mainCarriageWay"
            elif leads_to and all(_LINK in kind for kind in leads_to):
                kinds[lane] = "exitRamp"
            elif joined and goes_on and not onward[lane]:
                kinds[lane] = "accessRamp"
            elif goes_on and not onward[lane]:
                kinds.update(dict.fromkeys(_from_joining(net, lane, edges, back), "accessRamp"))
        if motorway and not through and _LINK not in net.edges[edge].type:
            going_on = [lane for lane in lanes if kinds.get(lane) not in RAMPS]
            kinds.update(dict.fromkeys(_that_stay(net, going_on, onward), "mainCarriageWay"))
    return kinds


def _from_joining(net: SumoNet, lane: str, edges: _Lanes, back: _Lanes) -> list[str]:
    """A joining lane and its predecessors back to where it joined its road.

    Empty for other lanes.
    """
    way: list[str] = []
    while lane not in way:
        way.append(lane)
        beside = {start for other in edges[net.lanes[lane].edge.id] for start in back[other]}
        own = {net.lanes[start].edge.id for start in back[lane]}
        others = {net.lanes[start].edge.id for start in beside - set(back[lane])}
        if own and others and own.isdisjoint(others):
            return way
        if len(back[lane]) != 1 or not own <= others:
            break
        (lane,) = back[lane]
    return []


def _that_stay(net: SumoNet, lanes: list[str], onward: _Lanes) -> list[str]:
    """The lanes that continue beside each other, wherever other lanes join, leave or end.

    Empty if they lead to several roads.
    """
    way, seen = 0.0, set[str]()
    now = {lane: lane for lane in lanes}
    while now and way < _AHEAD_M and any(onward.get(lane) for lane in now.values()):
        now = {lane: at for lane, at in now.items() if onward.get(at)}
        following = {net.lanes[end].edge.id for at in now.values() for end in onward[at]}
        if len(following) > 1:
            return []
        if following <= seen:
            break
        seen |= following
        after = _beside_each_other(net, [*now.values()], onward)
        now = {lane: after[at] for lane, at in now.items() if at in after}
        if now:
            way += line_length(net.lanes[next(iter(now.values()))].shape)
    return list(now)


def _beside_each_other(net: SumoNet, lanes: list[str], onward: _Lanes) -> dict[str, str]:
    """Lane -> its own next lane, the farthest from the kerb; empty if one of them has none."""
    target_of: dict[str, str] = {}
    for lane in sorted(lanes, key=lambda name: -net.lanes[name].index):
        after = [end for end in onward.get(lane, []) if end not in target_of.values()]
        if not after:
            return {}
        target_of[lane] = max(after, key=lambda name: net.lanes[name].index)
    return target_of


def _goes_on(net: SumoNet, edge: str, edges: _Lanes, onward: _Lanes) -> bool:
    """Whether all lanes of an edge continue beside each other."""
    way, seen = 0.0, {edge}
    while way < _AHEAD_M and any(onward.get(lane) for lane in edges[edge]):
        each = [onward.get(lane, []) for lane in edges[edge]]
        ends = {end for after in each for end in after}
        if any(len(after) != 1 for after in each) or len(ends) < len(each):
            return False
        if len(following := {net.lanes[end].edge.id for end in ends}) > 1:
            return False
        (edge,) = following
        if edge in seen:
            return True
        seen.add(edge)
        way += line_length(net.lanes[min(ends)].shape)
    return True
