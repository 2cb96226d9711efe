"""A SUMO net: edges with lanes, connections, and traffic light programmes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers.expat import XMLParserType

import numpy as np

from rulec.scenario.recorded.recording import LONGEST_M, Points, Side
from rulec.scenario.safe_xml import XmlFormat, scan
from rulec.scenario.sumo.xml_element import XmlElement

NET = XmlFormat("a SUMO net", "net", "SUMO's program `netconvert` makes such files")

LANE_WIDTH_M = 3.2
"""SUMO's, where a net says nothing else."""

WIDEST_M = 100.0


@dataclass(frozen=True, slots=True)
class NetEdge:
    """An edge of a net, with its function and type.

    ``function`` is empty for a road; ``type`` is what the map's source calls it.
    """

    id: str
    function: str
    type: str
    start: str
    end: str


@dataclass(frozen=True, slots=True, kw_only=True)
class NetLane:
    """A lane of an edge, with its shape.

    ``index`` counts from the kerb on; ``shape`` is the middle, of a walking area the outline.
    """

    id: str
    edge: NetEdge
    index: int
    shape: Points
    width: float
    speed: float
    allow: str | None
    disallow: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class NetConnection:
    """A connection from a lane to the next one.

    It goes over ``via`` within a junction; ``link`` is its number at its ``light``.
    """

    start: str
    end: str
    via: str
    state: str
    light: str
    link: int


@dataclass(frozen=True, slots=True)
class SignalProgramme:
    """A traffic light's programme, by phase.

    A phase has its duration (s) and a letter for each link. The programme begins at a given time.
    """

    begin: float
    phases: tuple[tuple[float, str], ...]


@dataclass(slots=True)
class SumoNet:
    """The content of a SUMO net.

    A light's programme is None if it reacts to traffic.
    """

    side: Side = "right"
    edges: dict[str, NetEdge] = field(default_factory=dict)
    lanes: dict[str, NetLane] = field(default_factory=dict)
    connections: list[NetConnection] = field(default_factory=list)
    programmes: dict[str, list[SignalProgramme | None]] = field(default_factory=dict)


def read_net(path: Path) -> SumoNet:
    """The net in a file.

    Raises:
        RulecError: R0610 if it is none, R0701 if it cannot be read.
    """
    net = SumoNet()
    edge: list[NetEdge] = []
    phases: list[tuple[float, str]] = []
    light: list[XmlElement] = []

    def finish_light() -> None:
        if light:
            programme = _programme(light.pop(), tuple(phases))
            net.programmes.setdefault(programme[0], []).append(programme[1])
            phases.clear()

    def begin(name: str, attributes: Mapping[str, str], parser: XMLParserType) -> None:
        element = XmlElement(name, attributes, parser, path, NET)
        if name != "phase":
            finish_light()
        if name == "net":
            net.side = "left" if attributes.get("lefthand") in ("true", "1") else "right"
        elif name == "edge":
            edge[:] = [_edge(element)]
            net.edges[edge[0].id] = edge[0]
        elif name == "lane":
            if not edge:
                raise element.wrong("a `lane` is in no `edge`")
            lane = _lane(element, edge[0])
            if lane.id in net.lanes:
                raise element.wrong(f"there are two lanes `{lane.id}`")
            net.lanes[lane.id] = lane
        elif name == "connection":
            net.connections.append(_connection(element))
        elif name == "tlLogic":
            light[:] = [element]
        elif name == "phase" and light:
            phases.append((element.positive("duration"), element.text("state")))

    scan(path, NET, begin)
    finish_light()
    if not net.lanes:
        raise NET.refused(path, "it has no lane")
    return net


def _edge(element: XmlElement) -> NetEdge:
    known = element.attributes
    return NetEdge(
        element.text("id"),
        known.get("function", ""),
        known.get("type", ""),
        known.get("from", ""),
        known.get("to", ""),
    )


def _lane(element: XmlElement, edge: NetEdge) -> NetLane:
    places = []
    for place in element.text("shape").split():
        numbers = [element.as_number("shape", part) for part in place.split(",")]
        if len(numbers) not in (2, 3):
            raise element.wrong("a place in the `shape` of a `lane` has no x and y")
        places.append(numbers[:2])
    if np.ptp(places, axis=0).max() > LONGEST_M:
        raise element.wrong(f"a lane is longer than {LONGEST_M / 1000:g} km")
    width = element.positive("width", LANE_WIDTH_M)
    if width > WIDEST_M:
        raise element.wrong(f"a lane is {width:g} m wide", f"{WIDEST_M:g} m at most")
    return NetLane(
        id=element.text("id"),
        edge=edge,
        index=int(element.number("index")),
        shape=np.array(places, dtype=float),
        width=width,
        speed=element.positive("speed"),
        allow=element.attributes.get("allow"),
        disallow=element.attributes.get("disallow"),
    )


def _connection(element: XmlElement) -> NetConnection:
    start = f"{element.text('from')}_{element.text('fromLane')}"
    end = f"{element.text('to')}_{element.text('toLane')}"
    known = element.attributes
    link = int(element.number("linkIndex", -1.0))
    return NetConnection(
        start=start,
        end=end,
        via=known.get("via", ""),
        state=known.get("state", ""),
        light=known.get("tl", ""),
        link=link,
    )


def _programme(
    element: XmlElement, phases: tuple[tuple[float, str], ...]
) -> tuple[str, SignalProgramme | None]:
    fixed = element.attributes.get("type", "static") == "static"
    begin = element.number("offset", 0.0)
    return element.text("id"), SignalProgramme(begin, phases) if fixed and phases else None
