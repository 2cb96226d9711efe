"""Elements of an OpenDRIVE file: roads, lanes, signals, objects, junctions.

Names are the standard's (ASAM OpenDRIVE 1.8). ``s`` (m) is along a road's reference line, ``t`` (m)
to its left; lanes left of it have ids above 0, those right of it below 0, numbered outward.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, TypeVar

ContactPoint = Literal["start", "end"]
Orientation = Literal["+", "-", "none"]
Shape = Literal["line", "arc", "spiral", "poly3", "paramPoly3"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Geometry:
    """A piece of a reference line, from its start at ``x``, ``y`` (m), ``heading`` (rad).

    ``numbers``: of an arc its curvature (1/m), of a spiral those of its start and end, of ``poly3``
    a to d, of ``paramPoly3`` those of u and then of v. ``normalized``: these go from 0 to 1.
    """

    s: float
    x: float
    y: float
    heading: float
    length: float
    shape: Shape
    numbers: tuple[float, ...] = ()
    normalized: bool = False


@dataclass(frozen=True, slots=True)
class Cubic:
    """A polynomial that holds from ``start`` (m) on: a + b x + c x² + d x³, x from there."""

    start: float
    a: float
    b: float
    c: float
    d: float


@dataclass(frozen=True, slots=True)
class MarkRecord:
    """A mark from a place in the lane section on, in the standard's words."""

    start: float
    type: str
    change: str


@dataclass(frozen=True, slots=True)
class Speed:
    """A limit (m/s) from a place on, infinity for none, None where it is undefined."""

    start: float
    limit_mps: float | None


@dataclass(frozen=True, slots=True)
class Access:
    """Who may use a lane from a place on: only some (``allow``), or all but some."""

    start: float
    allow: bool
    users: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """A lane of a lane section; places of its parts are counted from where that begins.

    ``borders`` instead of ``widths`` say where its outer border is. ``direction`` is the standard's
    attribute of 1.8, ``predecessors`` and ``successors`` the lanes that it is linked with.
    """

    id: int
    type: str
    direction: str
    widths: tuple[Cubic, ...]
    borders: tuple[Cubic, ...]
    marks: tuple[MarkRecord, ...]
    speeds: tuple[Speed, ...]
    access: tuple[Access, ...]
    predecessors: tuple[int, ...]
    successors: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class LaneSection:
    """A stretch of a road from ``start`` to ``end`` (m) with the same lanes, by id."""

    start: float
    end: float
    lanes: Mapping[int, Lane]


@dataclass(frozen=True, slots=True)
class RoadType:
    """What a road is from a place on, in the standard's words, and its limit."""

    start: float
    type: str
    limit_mps: float | None
    country: str


_Record = TypeVar("_Record", MarkRecord, RoadType, Speed)


def record_at(records: Iterable[_Record], s: float, origin: float = 0.0) -> _Record | None:
    """What holds at a place of records in their order, whose starts count from ``origin``."""
    latest: _Record | None = None
    for record in records:
        if origin + record.start <= s:
            latest = record
    return latest


@dataclass(frozen=True, slots=True)
class RoadLink:
    """What a road is linked with at one of its ends."""

    element: str
    id: str
    contact: ContactPoint | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadSignal:
    """A signal on a road, or a reference to one.

    ``lanes``: ranges of the lanes that it holds for, None if the file does not say; ``limit_mps``
    its value as a speed, ``value`` as it is written.
    """

    id: str
    s: float
    orientation: Orientation
    type: str
    subtype: str
    country: str
    dynamic: bool
    value: float | None
    unit: str
    lanes: tuple[tuple[int, int], ...] | None


@dataclass(frozen=True, slots=True)
class SignalReference:
    """A signal of another road that holds on this one, too."""

    id: str
    s: float
    orientation: Orientation
    lanes: tuple[tuple[int, int], ...] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadObject:
    """A thing on a road, its place, and its outline.

    ``corners``: u and v (m) from its place in its own direction, or s and t if ``on_road``.
    """

    id: str
    type: str
    subtype: str
    name: str
    s: float
    t: float
    heading: float
    orientation: Orientation
    length: float
    width: float
    corners: tuple[tuple[float, float], ...]
    on_road: bool


@dataclass(frozen=True, slots=True)
class RoadStretch:
    """From where to where (``s``) something is."""

    start: float
    end: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MapRoad:
    """A road; ``junction`` is the one that it leads through, or empty.

    ``has_rule``: does the file say on which side traffic keeps there?
    """

    id: str
    length: float
    junction: str
    left_hand: bool
    has_rule: bool
    line: int
    predecessor: RoadLink | None
    successor: RoadLink | None
    types: tuple[RoadType, ...]
    geometries: tuple[Geometry, ...]
    offsets: tuple[Cubic, ...]
    sections: tuple[LaneSection, ...]
    signals: tuple[RoadSignal, ...]
    references: tuple[SignalReference, ...]
    objects: tuple[RoadObject, ...]
    tunnels: tuple[RoadStretch, ...]

    def end_at(self, contact: ContactPoint) -> RoadLink | None:
        """What it is linked with at an end."""
        return self.predecessor if contact == "start" else self.successor


@dataclass(frozen=True, slots=True)
class Connection:
    """A way between roads in a junction, with pairs of lanes.

    ``incoming`` has the first of each pair; the second is one of ``road``, at its end ``contact``.
    """

    incoming: str
    road: str
    contact: ContactPoint
    lanes: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class RoadJunction:
    """A junction; ``priorities`` are pairs of roads, the first of which goes first."""

    id: str
    connections: tuple[Connection, ...]
    priorities: tuple[tuple[str, str], ...]


@dataclass(slots=True)
class OpenDrive:
    """The content of a file; ``controllers`` have the ids of the signals that they control.

    ``may_have_rules``: roads of its version may say on which side traffic keeps.
    """

    # Not frozen: it is filled as the file is read
    roads: dict[str, MapRoad]
    junctions: dict[str, RoadJunction]
    controllers: dict[str, tuple[str, ...]]
    may_have_rules: bool = True
