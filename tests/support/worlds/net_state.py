"""A SUMO net as the simulator reads it: lanes, ways through junctions, who yields to whom."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np


@dataclass(slots=True)
class Edge:
    """A road between two junctions, or a part of a junction."""

    start: str
    end: str
    kind: str
    type: str
    lanes: dict[str, "Lane"] = field(default_factory=dict)

    @property
    def length(self):
        return max(lane.length for lane in self.lanes.values())


@dataclass(slots=True)
class Lane:
    """A lane; ``shape`` is its middle, in metres."""

    id: str
    edge: str
    index: int
    speed: float
    length: float
    width: float
    shape: np.ndarray

    def heading_at(self, pos):
        """Its direction (degrees clockwise from north) at a place along it."""
        steps = np.diff(self.shape, axis=0)
        ends = np.hypot(*steps.T).cumsum()
        x, y = steps[min(int(np.searchsorted(ends, pos)), len(steps) - 1)]
        return np.degrees(np.arctan2(x, y))


@dataclass(slots=True, kw_only=True)
class Link:
    """A way over a junction, ``inner`` its lanes there, ``number`` its bit among requests."""

    start: str
    end: str
    inner: tuple[str, ...]
    state: str
    turn: str
    light: str
    light_index: int
    junction: str
    number: int


class NetState:
    """A net by its file; ``yields[junction][i]`` are the links that link i yields to."""

    def __init__(self, file):
        root = ElementTree.parse(file).getroot()
        self.lefthand = root.get("lefthand") in ("true", "1")
        self.edges, self.lanes = {}, {}
        for element in root.iter("edge"):
            self._add_edge(element)
        self.crossings = [
            tuple(element.get("crossingEdges").split())
            for element in root.iter("edge")
            if element.get("function") == "crossing"
        ]
        self.junctions = {one.get("id"): one for one in root.iter("junction")}
        self.yields = {name: _responses(one) for name, one in self.junctions.items()}
        self.foes = {name: _responses(one, "foes") for name, one in self.junctions.items()}
        self.links = self._links([one.attrib for one in root.iter("connection")])

    def _add_edge(self, element):
        key = element.get("id")
        edge = Edge(
            element.get("from", ""),
            element.get("to", ""),
            element.get("function", ""),
            element.get("type", ""),
        )
        self.edges[key] = edge
        for one in element.iter("lane"):
            shape = [tuple(map(float, place.split(",")[:2])) for place in one.get("shape").split()]
            lane = Lane(
                id=one.get("id"),
                edge=key,
                index=int(one.get("index")),
                speed=float(one.get("speed")),
                length=float(one.get("length")),
                width=float(one.get("width", 3.2)),
                shape=np.array(shape),
            )
            edge.lanes[lane.id] = self.lanes[lane.id] = lane

    def _links(self, connections):
        """The ways of vehicles over junctions, by the first lane within."""
        inner_next = {
            f"{one['from']}_{one['fromLane']}": one.get("via")
            for one in connections
            if one["from"].startswith(":")
        }
        links = {}
        for one in connections:
            first = one.get("via")
            if one["from"].startswith(":") or first is None:
                continue
            inner = [first]
            while inner_next.get(inner[-1]):
                inner.append(inner_next[inner[-1]])
            junction = self.edges[one["from"]].end
            links[first] = Link(
                start=f"{one['from']}_{one['fromLane']}",
                end=f"{one['to']}_{one['toLane']}",
                inner=tuple(inner),
                state=one["state"],
                turn=one["dir"],
                light=one.get("tl", ""),
                light_index=int(one.get("linkIndex", -1)),
                junction=junction,
                number=self._number(junction, inner),
            )
        return links

    def _number(self, junction, inner):
        """The link's request: a junction lists the last lane within of each, in their order."""
        lanes = self.junctions[junction].get("intLanes").split()
        found = [lanes.index(lane) for lane in inner if lane in lanes]
        return found[0] if found else -1

    @cached_property
    def entries(self):
        """Edges that come from outside."""
        return [key for key, edge in self.edges.items() if not edge.kind and self._dead(edge.start)]

    @cached_property
    def exits(self):
        return [key for key, edge in self.edges.items() if not edge.kind and self._dead(edge.end)]

    def _dead(self, junction):
        return self.junctions[junction].get("type") == "dead_end"

    def legal_speed(self, lane):
        """The limit on a lane (m/s); within a junction that of the road that leads there."""
        if not lane.startswith(":"):
            return self.lanes[lane].speed
        link = self.link_of.get(lane)
        return self.lanes[link.start].speed if link else self.lanes[lane].speed

    @cached_property
    def link_of(self):
        """Each lane within a junction -> its link."""
        return {lane: link for link in self.links.values() for lane in link.inner}


def _responses(junction, which="response"):
    """SUMO writes bits with link 0 at the right."""
    rows = {}
    for one in junction.iter("request"):
        bits = one.get(which)[::-1]
        rows[int(one.get("index"))] = {k for k, bit in enumerate(bits) if bit == "1"}
    return rows
