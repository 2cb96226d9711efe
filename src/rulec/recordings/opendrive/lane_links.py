"""Successors of lanes within roads, between roads, and through junctions.

The file links ends of lanes; which lane is the successor follows from their driving directions.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rulec.recordings.opendrive.content.elements import (
    Connection,
    ContactPoint,
    MapRoad,
    OpenDrive,
    RoadJunction,
)
from rulec.recordings.opendrive.pieces import RoadPiece, directions
from rulec.recordings.opendrive.plan_view import places_on


class LaneKey(NamedTuple):
    """A lane of a piece of a road, in one of its driving directions."""

    road: str
    piece: int
    lane: int
    forward: bool


class _LaneEnd(NamedTuple):
    road: str
    piece: int
    lane: int
    at_end: bool


@dataclass(frozen=True, slots=True)
class LaneLinks:
    """The successors and the predecessors of each lane."""

    after: Mapping[LaneKey, tuple[LaneKey, ...]]
    before: Mapping[LaneKey, tuple[LaneKey, ...]]


@dataclass(slots=True)
class _Links:
    content: OpenDrive
    pieces: Mapping[str, Sequence[RoadPiece]]
    joints: dict[tuple[_LaneEnd, _LaneEnd], None] = field(default_factory=dict)

    def join(self, first: _LaneEnd, other: _LaneEnd) -> None:
        """Link two ends of lanes, if both lanes exist."""
        both = (first, other)
        if all(end.lane in self.pieces[end.road][end.piece].section.lanes for end in both):
            self.joints[first, other] = None

    def end_of(self, road: str, contact: ContactPoint, lane: int) -> _LaneEnd:
        """The end of a lane at an end of its road."""
        last = len(self.pieces[road]) - 1
        return _LaneEnd(road, last if contact == "end" else 0, lane, contact == "end")


def lane_links(content: OpenDrive, pieces: Mapping[str, Sequence[RoadPiece]]) -> LaneLinks:
    """The links of all lanes; they skip pieces without a length."""
    links = _Links(content, pieces)
    for road in content.roads.values():
        _within(links, road)
        _between_roads(links, road)
    for junction in content.junctions.values():
        for connection in junction.connections:
            _through(links, junction, connection)
    direct: dict[LaneKey, dict[LaneKey, None]] = defaultdict(dict)
    for lane_end, other in links.joints:
        for start, end in (*_ways(links, lane_end, other), *_ways(links, other, lane_end)):
            direct[start][end] = None
    after = {key: tuple(_reached(direct, pieces, key)) for key in direct}
    before: dict[LaneKey, dict[LaneKey, None]] = defaultdict(dict)
    for start, ends in after.items():
        if not pieces[start.road][start.piece].is_short:
            for end in ends:
                before[end][start] = None
    return LaneLinks(after, {key: tuple(lanes) for key, lanes in before.items()})


def _ways(links: _Links, first: _LaneEnd, second: _LaneEnd) -> Iterator[tuple[LaneKey, LaneKey]]:
    """Pairs of a lane driven towards the first end, and a lane driven away from the second."""
    for there in _directions(links, first):
        for onward in _directions(links, second):
            if there == first.at_end and onward != second.at_end:
                yield LaneKey(*first[:3], there), LaneKey(*second[:3], onward)


def _directions(links: _Links, end: _LaneEnd) -> tuple[bool, ...]:
    piece = links.pieces[end.road][end.piece]
    return directions(piece.road, piece.section.lanes[end.lane])


def _reached(
    direct: Mapping[LaneKey, Mapping[LaneKey, None]],
    pieces: Mapping[str, Sequence[RoadPiece]],
    start: LaneKey,
) -> Iterator[LaneKey]:
    waiting, seen = list(direct.get(start, ())), {start}
    while waiting:
        key = waiting.pop(0)
        if key in seen:
            continue
        seen.add(key)
        if pieces[key.road][key.piece].is_short:
            waiting += direct.get(key, ())
        else:
            yield key


def _within(links: _Links, road: MapRoad) -> None:
    for piece, following in pairwise(links.pieces[road.id]):
        for lane in piece.section.lanes.values():
            same = (lane.id,) if piece.section is following.section else lane.successors
            for other in same:
                links.join(
                    _LaneEnd(road.id, piece.number, lane.id, True),
                    _LaneEnd(road.id, following.number, other, False),
                )
        for lane in following.section.lanes.values():
            for other in () if piece.section is following.section else lane.predecessors:
                links.join(
                    _LaneEnd(road.id, piece.number, other, True),
                    _LaneEnd(road.id, following.number, lane.id, False),
                )


def _between_roads(links: _Links, road: MapRoad) -> None:
    contacts: tuple[ContactPoint, ...] = ("start", "end")
    for contact in contacts:
        link = road.end_at(contact)
        if link is None or link.element != "road" or link.id not in links.pieces:
            continue
        there: ContactPoint = link.contact or ("end" if contact == "start" else "start")
        piece = links.pieces[road.id][0 if contact == "start" else -1]
        for lane in piece.section.lanes.values():
            for other in lane.predecessors if contact == "start" else lane.successors:
                own = links.end_of(road.id, contact, lane.id)
                links.join(own, links.end_of(link.id, there, other))


def _through(links: _Links, junction: RoadJunction, connection: Connection) -> None:
    roads = links.content.roads
    if connection.incoming not in roads or connection.road not in roads:
        return
    incoming, road = roads[connection.incoming], roads[connection.road]
    contact = _end_at_junction(junction, connection, incoming, road)
    if contact is not None:
        for first, second in connection.lanes:
            links.join(
                links.end_of(incoming.id, contact, first),
                links.end_of(road.id, connection.contact, second),
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
    contacts: tuple[ContactPoint, ...] = ("start", "end")
    ends = []
    for contact in contacts:
        link = incoming.end_at(contact)
        if link is not None and link.element == "junction" and link.id == junction.id:
            ends.append(contact)
    there = _place(road, connection.contact)
    return min(
        ends, key=lambda end: float(np.hypot(*(_place(incoming, end) - there))), default=None
    )


def _place(road: MapRoad, contact: ContactPoint) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    s = np.array([0.0 if contact == "start" else road.length])
    x, y, _ = places_on(road.geometries, s)
    return np.array([x[0], y[0]])
