"""Elements of an OpenDRIVE file: roads, lanes, signals, objects, junctions.

Names are the standard's (ASAM OpenDRIVE 1.8). ``s`` (m) is measured along a road's reference line,
``t`` (m) to the left of it. Lanes left of the line have ids above 0, lanes right of it ids below 0,
numbered outward.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeVar

ContactPoint = Literal["start", "end"]
Orientation = Literal["+", "-", "none"]
Shape = Literal["line", "arc", "spiral", "poly3", "paramPoly3"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Geometry:
    """A piece of a reference line that starts at ``x``, ``y`` (m) with ``heading`` (rad).

    ``numbers``: the curvature (1/m) of an arc; the curvatures at the start and end of a spiral; a
    to d of ``poly3``; a to d of u and then of v of ``paramPoly3``, whose parameter goes from 0 to 1
    if ``normalized``.
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
    """A polynomial a + b x + c x² + d x³ that applies from ``start`` (m), where x is 0."""

    start: float
    a: float
    b: float
    c: float
    d: float


@dataclass(frozen=True, slots=True)
class MarkRecord:
    """A road mark from ``start`` (m in the lane section), in the standard's words."""

    start: float
    type: str
    change: str


@dataclass(frozen=True, slots=True)
class Speed:
    """A speed limit (m/s) from ``start`` (m); infinity for no limit, None where it is undefined."""

    start: float
    limit_mps: float | None


@dataclass(frozen=True, slots=True)
class Access:
    """Users who alone may use a lane from ``start`` (m) on if ``allow``, or else may not use it."""

    start: float
    allow: bool
    users: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """A lane of a lane section; the starts of its parts are relative to the start of the section.

    ``borders`` give the position of the outer border where there are no ``widths``. ``direction``
    is the attribute of version 1.8; ``predecessors`` and ``successors`` are the linked lanes.
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
    """The type of a road from ``start`` (m), in the standard's words, and its speed limit."""

    start: float
    type: str
    limit_mps: float | None
    country: str


_Record = TypeVar("_Record", MarkRecord, RoadType, Speed)


def record_at(records: Iterable[_Record], s: float, origin: float = 0.0) -> _Record | None:
    """The record that applies at ``s``, of sorted records whose starts count from ``origin``."""
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


@dataclass(frozen=True, slots=True)
class SignalSpeed:
    """What semantics (since 1.8) say about speeds, in the standard's words.

    ``value_mps`` is None where there is no number, or none in a unit of speed.
    """

    type: str
    value_mps: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadSignal:
    """A signal on a road.

    ``lanes``: ranges of the lanes that it applies to, None if the file gives none; ``value`` is the
    number as written, in ``unit``. ``linked`` are the ids of signals that it names. Its semantics
    have a condition if it ``is_qualified``, and others if it ``has_meaning``. ``board`` are the
    signs on it; what a variable board shows is not in the file.
    """

    id: str
    s: float
    t: float
    orientation: Orientation
    type: str
    subtype: str
    country: str
    dynamic: bool
    value: float | None
    unit: str
    lanes: tuple[tuple[int, int], ...] | None
    linked: tuple[str, ...] = ()
    speeds: tuple[SignalSpeed, ...] = ()
    is_qualified: bool = False
    has_meaning: bool = False
    board: tuple[RoadSignal, ...] = ()
    has_variable_board: bool = False


@dataclass(frozen=True, slots=True)
class SignalReference:
    """A reference to a signal of another road that also applies to this road."""

    id: str
    s: float
    orientation: Orientation
    lanes: tuple[tuple[int, int], ...] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadObject:
    """An object on a road, with its position and outline.

    ``corners``: u and v (m) relative to its position and heading, or s and t if ``on_road``.
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
    """The part of a road between two values of ``s`` (m)."""

    start: float
    end: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MapRoad:
    """A road; ``junction`` is the junction that it leads through, or empty.

    ``has_rule``: whether the file gives the side of traffic for it.
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
        """The link at the start or the end of the road."""
        return self.predecessor if contact == "start" else self.successor


@dataclass(frozen=True, slots=True)
class Connection:
    """A way between roads in a junction, with pairs of linked lanes.

    The first lane of each pair is one of ``incoming``, the second one of ``road`` at its end
    ``contact``.
    """

    incoming: str
    road: str
    contact: ContactPoint
    lanes: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class RoadJunction:
    """A junction; of each pair of roads in ``priorities``, the first has priority."""

    id: str
    connections: tuple[Connection, ...]
    priorities: tuple[tuple[str, str], ...]


@dataclass(slots=True)
class OpenDrive:
    """The content of a file; ``controllers`` map to the ids of the signals that they control.

    ``may_have_rules``: whether roads in the file's version may give the side of traffic.
    ``included`` are files that are named in its place, and not read.
    """

    # Not frozen: it is filled as the file is read
    roads: dict[str, MapRoad]
    junctions: dict[str, RoadJunction]
    controllers: dict[str, tuple[str, ...]]
    may_have_rules: bool = True
    included: list[str] = field(default_factory=list)
