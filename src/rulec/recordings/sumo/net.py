"""A SUMO net: edges with lanes, connections, and traffic lights."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import ceil
from pathlib import Path

import numpy as np

from rulec.recordings.encodings.file_format import XmlFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.encodings.xml_tree import scan_trees
from rulec.recordings.recording import LONGEST_M, Light, Points, Side
from rulec.recordings.sumo.fcd_content import is_true

NET = XmlFormat("a SUMO net", "SUMO's program `netconvert` makes such files", root="net")

LANE_WIDTH_M = 3.2
"""SUMO's default, used where a net gives no width."""

WIDEST_M = 100.0

_HAIR = 1e-6
"""So much of a step may times that are multiples of it be off, from their decimals."""

COLOURS: Mapping[str, str] = {
    "r": "red",
    "s": "red",
    "u": "redYellow",
    "y": "yellow",
    "Y": "yellow",
    "g": "green",
    "G": "green",
    "o": "inactive",
    "O": "inactive",
}
"""SUMO's letters -> CommonRoad's words; ``s`` is red with an arrow that permits turning right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NetEdge:
    """An edge; ``function`` is empty for a road, ``type`` is the name in the map's source."""

    id: str
    function: str
    type: str
    start: str
    end: str
    parameters: Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class NetLane:
    """A lane of an edge; ``index`` counts from the kerb.

    ``shape`` is the centre line, or the outline of a walking area.
    """

    id: str
    edge: NetEdge
    index: int
    shape: Points
    width: float
    speed: float
    allow: str | None
    disallow: str | None
    marks: tuple[bool, bool] = (False, False)
    """Whether changing lanes is forbidden to the left, and to the right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NetJunction:
    """A junction: its type, the first lane of each way through it, and the priorities of the ways.

    For each way, ``first`` (ways it waits for) and ``foes`` (ways in conflict with it) hold a
    string of bits, one bit per way, that of the first way last.
    """

    id: str
    type: str
    ways: tuple[str, ...]
    first: tuple[str, ...]
    foes: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class NetConnection:
    """A connection from a lane to the next one, over ``via`` within a junction.

    ``direction`` is SUMO's letter for the turn, ``link`` the connection's number at its ``light``.
    """

    start: str
    end: str
    via: str
    state: str
    direction: str
    light: str
    link: int


@dataclass(frozen=True, slots=True)
class SignalProgramme:
    """A traffic light's programme: phases with a duration (s) and a letter for each link."""

    begin: float
    phases: tuple[tuple[float, str], ...]

    def has_arrow(self, link: int) -> bool:
        """Whether a link may turn at red after a stop."""
        return any(0 <= link < len(letters) and letters[link] == "s" for _, letters in self.phases)

    def light(self, link: int, step_s: float) -> Light | None:
        """The light of a link in time steps; None if the programme has no phase for it.

        A phase has the steps that lie in it, from its begin on.
        """
        phases: list[tuple[str, int]] = []
        begin = _step_from(self.begin, step_s)
        ends, done = self.begin, begin
        for duration, letters in self.phases:
            if not 0 <= link < len(letters):
                return None
            ends += duration
            steps = _step_from(ends, step_s) - done
            done += steps
            colour = COLOURS.get(letters[link], "inactive")
            if phases and phases[-1][0] == colour:
                phases[-1] = colour, phases[-1][1] + steps
            elif steps:
                phases.append((colour, steps))
        return Light(begin, tuple(phases)) if phases else None


def _step_from(time_s: float, step_s: float) -> int:
    """The first step at a time, or after it."""
    return ceil(time_s / step_s - _HAIR)


@dataclass(slots=True)
class SumoNet:
    """The content of a SUMO net; the programme of a light that reacts to traffic is None."""

    side: Side = "right"
    edges: dict[str, NetEdge] = field(default_factory=dict)
    lanes: dict[str, NetLane] = field(default_factory=dict)
    connections: list[NetConnection] = field(default_factory=list)
    junctions: dict[str, NetJunction] = field(default_factory=dict)
    roundabouts: set[str] = field(default_factory=set)
    programmes: dict[str, list[SignalProgramme | None]] = field(default_factory=dict)

    def lights(self, step_s: float) -> Iterator[tuple[NetConnection, Light]]:
        """The connections with a light, and its programme in time steps.

        Lights that react to traffic or have several programmes are left out: their state is
        unknown.
        """
        for connection in self.connections:
            programmes = self.programmes.get(connection.light, [])
            if len(programmes) == 1 and programmes[0] is not None:
                light = programmes[0].light(connection.link, step_s)
                if light is not None:
                    yield connection, light

    def begin_later(self, late_s: float) -> None:
        """Let all programmes begin so much (s) later, for steps that count from another time."""
        for name, programmes in self.programmes.items() if late_s else ():
            self.programmes[name] = [
                programme and replace(programme, begin=programme.begin + late_s)
                for programme in programmes
            ]

    def unknown_lights(self) -> list[str]:
        """The lights whose programme is unknown."""
        return [name for name, known in self.programmes.items() if len(known) > 1 or None in known]


def read_programme(tree: Tree) -> SignalProgramme | None:
    """The programme in an element `tlLogic`; None if it reacts to traffic, or has no phase."""
    tree.filled("id")
    offset, fixed = tree.number("offset", 0.0), tree.attributes.get("type", "static") == "static"
    phases = tuple([(x.positive("duration"), x.filled("state")) for x in tree.all("phase")])
    return SignalProgramme(offset, phases) if fixed and phases else None


def read_net(path: Path) -> SumoNet:
    """The net in a file. Raises RulecError R0610 for another kind, R0701 if it cannot be read."""
    net = SumoNet()

    def root(tree: Tree) -> None:
        net.side = "left" if is_true(tree.get("lefthand")) else "right"

    scan_trees(path, NET, root, lambda tree: _add(net, tree))
    if not net.lanes:
        raise NET.refused(path, "it has no lane")
    return net


def _add(net: SumoNet, tree: Tree) -> None:
    match tree.name:
        case "edge":
            edge = NetEdge(
                id=tree.filled("id"),
                function=tree.get("function"),
                type=tree.get("type"),
                start=tree.get("from"),
                end=tree.get("to"),
                parameters={
                    x.get("key"): x.get("value")
                    for part in (tree, *tree.children)
                    for x in part.all("param")
                },
            )
            net.edges[edge.id] = edge
            for child in tree.all("lane"):
                lane = _lane(child, edge)
                if lane.id in net.lanes:
                    raise child.wrong(f"there are two lanes `{short(lane.id)}`")
                net.lanes[lane.id] = lane
        case "lane":
            raise tree.wrong("a `lane` is in no `edge`")
        case "tlLogic":
            programme = read_programme(tree)
            net.programmes.setdefault(tree.get("id"), []).append(programme)
        case "junction":
            net.junctions[tree.filled("id")] = NetJunction(
                id=tree.get("id"),
                type=tree.get("type"),
                ways=tuple(tree.get("intLanes").split()),
                first=tuple([x.get("response") for x in tree.all("request")]),
                foes=tuple([x.get("foes") for x in tree.all("request")]),
            )
        case "roundabout":
            net.roundabouts.update(tree.get("edges").split())
        case "connection":
            net.connections.append(_connection(tree))


def _lane(element: Tree, edge: NetEdge) -> NetLane:
    places = []
    for place in element.filled("shape").split():
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
        id=element.filled("id"),
        edge=edge,
        index=int(element.number("index")),
        shape=np.array(places, dtype=float),
        width=width,
        speed=element.positive("speed"),
        allow=element.attributes.get("allow"),
        disallow=element.attributes.get("disallow"),
        marks=(
            _forbids(element.attributes.get("changeLeft")),
            _forbids(element.attributes.get("changeRight")),
        ),
    )


def _forbids(changing: str | None) -> bool:
    """Whether the classes that may change lanes exclude passenger cars."""
    return changing is not None and not {"all", "passenger"} & set(changing.split())


def _connection(element: Tree) -> NetConnection:
    return NetConnection(
        start=f"{element.filled('from')}_{element.filled('fromLane')}",
        end=f"{element.filled('to')}_{element.filled('toLane')}",
        via=element.get("via"),
        state=element.get("state"),
        direction=element.get("dir"),
        light=element.get("tl"),
        link=int(element.number("linkIndex", -1.0)),
    )
