"""Successors of lanes within roads, between roads, and through junctions.

The file links ends of lanes; which lane is the successor follows from their driving directions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from rulec.recordings.lanes.lanes_along import led_to, reversed_links
from rulec.recordings.opendrive.content.elements import (
    Connection,
    ContactPoint,
    MapRoad,
    OpenDrive,
    RoadJunction,
)
from rulec.recordings.opendrive.pieces import LaneKey, Pieces
from rulec.recordings.opendrive.plan_view import place_on
from rulec.recordings.recording import Points

_CONTACTS: tuple[ContactPoint, ...] = ("start", "end")
_Joint = tuple[LaneKey, LaneKey]
"""Two lanes that lead to where they are linked, whether or not traffic does."""


@dataclass(frozen=True, slots=True)
class LaneLinks:
    """The successors and the predecessors of each lane."""

    after: Mapping[LaneKey, tuple[LaneKey, ...]]
    before: Mapping[LaneKey, tuple[LaneKey, ...]]


def lane_links(content: OpenDrive, pieces: Pieces) -> LaneLinks:
    """The links of all lanes; they skip pieces without a length."""
    direct: dict[LaneKey, dict[LaneKey, None]] = defaultdict(dict)
    for first, second in _joints(content, pieces):
        for start, end in ((first, second.back), (second, first.back)):
            if start.is_driven and end.is_driven:
                direct[start][end] = None
    after = {
        # Not itself, as on a road that ends where it begins
        key: tuple([x for x in led_to(direct, key, _is_long) if x != key])
        for key in direct
    }
    before = reversed_links({key: ends for key, ends in after.items() if _is_long(key)})
    return LaneLinks(after, {key: tuple(lanes) for key, lanes in before.items()})


def _is_long(key: LaneKey) -> bool:
    return not key.piece.is_short


def _joints(content: OpenDrive, pieces: Pieces) -> Iterator[_Joint]:
    for road in content.roads.values():
        yield from _within(pieces, road)
        yield from _between_roads(pieces, road)
    for junction in content.junctions.values():
        for connection in junction.connections:
            yield from _through(content, pieces, junction, connection)


def _within(pieces: Pieces, road: MapRoad) -> Iterator[_Joint]:
    for piece, following in pairwise(pieces[road.id]):
        same = piece.section is following.section
        for lane in piece.section.lanes.values():
            for other in (lane.id,) if same else lane.successors:
                yield LaneKey(piece, lane.id, True), LaneKey(following, other, False)
        for lane in () if same else following.section.lanes.values():
            for other in lane.predecessors:
                yield LaneKey(piece, other, True), LaneKey(following, lane.id, False)


def _towards(pieces: Pieces, road: str, contact: ContactPoint, lane: int) -> LaneKey:
    """The lane that leads to an end of its road."""
    return LaneKey(pieces[road][-1 if contact == "end" else 0], lane, contact == "end")


def _between_roads(pieces: Pieces, road: MapRoad) -> Iterator[_Joint]:
    for contact in _CONTACTS:
        link = road.end_at(contact)
        if link is None or link.element != "road" or link.id not in pieces:
            continue
        there: ContactPoint = link.contact or ("end" if contact == "start" else "start")
        piece = pieces[road.id][0 if contact == "start" else -1]
        for lane in piece.section.lanes.values():
            for other in lane.predecessors if contact == "start" else lane.successors:
                own = LaneKey(piece, lane.id, contact == "end")
                yield own, _towards(pieces, link.id, there, other)


def _through(
    content: OpenDrive, pieces: Pieces, junction: RoadJunction, connection: Connection
) -> Iterator[_Joint]:
    incoming, road = map(content.roads.get, (connection.incoming, connection.road))
    if incoming is None or road is None:
        return
    contact = _end_at_junction(junction, connection, incoming, road)
    if contact is None:
        return
    for first, second in connection.lanes:
        yield (
            _towards(pieces, incoming.id, contact, first),
            _towards(pieces, road.id, connection.contact, second),
        )


def _end_at_junction(
    junction: RoadJunction, connection: Connection, incoming: MapRoad, road: MapRoad
) -> ContactPoint | None:
    """The end of the incoming road at which a connection begins; None if it has no such end.

    It is the end that the connecting road is linked with, or else the end that leads to the
    junction; if both ends do, the nearer one.
    """
    link = road.end_at(connection.contact)
    if link is not None and link.element == "road" and link.id == incoming.id and link.contact:
        return link.contact
    ends = []
    for contact in _CONTACTS:
        link = incoming.end_at(contact)
        if link is not None and link.element == "junction" and link.id == junction.id:
            ends.append(contact)
    there = _place(road, connection.contact)
    return min(
        ends, key=lambda end: float(np.hypot(*(_place(incoming, end) - there))), default=None
    )


def _place(road: MapRoad, contact: ContactPoint) -> Points:
    x, y, _ = place_on(road.geometries, 0.0 if contact == "start" else road.length)
    return np.array([x, y])
