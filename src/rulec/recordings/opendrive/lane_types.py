"""Types of lanes and roads, and marks between lanes, in the words of lanelets.

A lane's mark is on its outer border; the centre lane's mark lies between both sides of the road.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rulec.recordings.opendrive.content.elements import (
    Lane,
    LaneSection,
    MapRoad,
    MarkRecord,
    record_at,
)
from rulec.recordings.recording import BUSES_ONLY, CYCLES_TOO, TAXIS_TOO, LaneMark

_DRIVING: tuple[str, ...] = ()
LANE_TYPES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **dict.fromkeys(("driving", "bidirectional", "connectingRamp", "HOV"), _DRIVING),
        **dict.fromkeys(("slipLane", "shared"), _DRIVING),
        **dict.fromkeys(("entry", "mwyEntry", "onRamp"), ("accessRamp",)),
        **dict.fromkeys(("exit", "mwyExit", "offRamp"), ("exitRamp",)),
        **dict.fromkeys(("bus", "taxi"), ("busLane",)),
        "biking": ("bicycleLane",),
        **dict.fromkeys(("sidewalk", "walking"), ("sidewalk",)),
        # The standard's `shoulder` is a soft one; a hard shoulder is `stop`
        "stop": ("shoulder",),
        **dict.fromkeys(("shoulder", "border", "curb", "median"), ("border",)),
        "parking": ("parking",),
        **dict.fromkeys(("restricted", "roadWorks"), ("restricted_area",)),
        **dict.fromkeys(("rail", "tram"), ("restricted_area", "rail")),
    }
)
"""The standard's types of lanes -> those of lanelets; ``none`` does not count as a lane."""

NO_LANE = frozenset({"none", ""})
RAMPS = frozenset({"entry", "exit", "mwyEntry", "mwyExit", "onRamp", "offRamp"})
BOTH_WAYS = "bidirectional"

_ROAD_TYPES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "motorway": ("highway",),
        "rural": ("country",),
        "town": ("urban",),
        **dict.fromkeys(
            ("townExpressway", "townCollector", "townArterial", "townPrivate"), ("urban",)
        ),
        **dict.fromkeys(("townLocal", "townPlayStreet"), ("urban",)),
    }
)

_BUSES = frozenset({"bus", "taxi", "publicTransport"})
_RIDERS = frozenset({"bicycle"})
_WALKERS = frozenset({"pedestrian"})


def lane_types(section: LaneSection, lane: Lane, s: float) -> tuple[str, ...]:
    """The types of a lane at ``s``; lanes of unknown types count as beside the carriageway."""
    types = LANE_TYPES.get(lane.type, ("border",))
    allowed = frozenset[str]().union(
        *(x.users for x in lane.access if x.allow and section.start + x.start <= s)
    )
    if types or not allowed:
        return types
    if allowed & _BUSES and allowed <= _BUSES | _RIDERS:
        cycles = (CYCLES_TOO,) if allowed & _RIDERS else ()
        return ("busLane", BUSES_ONLY, *cycles, *((TAXIS_TOO,) if "taxi" in allowed else ()))
    if allowed <= _WALKERS:
        return ("sidewalk",)
    return ("bicycleLane",) if allowed <= _WALKERS | _RIDERS else types


def road_types(road: MapRoad, s: float) -> tuple[str, ...]:
    """The types of a road at ``s``, in the words of lanelets."""
    kind = record_at(road.types, s)
    return () if kind is None else _ROAD_TYPES.get(kind.type, ())


def limit_at(section: LaneSection, lane: Lane, s: float) -> float | None:
    """The limit (m/s) of the lane itself at ``s``; None if it has none of its own."""
    speed = record_at(lane.speeds, s, section.start)
    return None if speed is None else speed.limit_mps


_MARKS: Mapping[str, tuple[LaneMark, LaneMark]] = MappingProxyType(
    {
        "none": ("none", "none"),
        "solid": ("solid", "solid"),
        "broken": ("broken", "broken"),
        "solid solid": ("double_solid", "double_solid"),
        "broken broken": ("broken", "broken"),
        "solid broken": ("solid", "broken"),
        "broken solid": ("broken", "solid"),
    }
)
"""Types of marks as seen from the inner lane (for the centre lane, from its left), and the other.

Kerbs, grass, Botts' dots and the like are missing: they do not show a kind of line.
"""

_CHANGES: Mapping[str, tuple[LaneMark, LaneMark]] = MappingProxyType(
    {"none": ("solid", "solid"), "both": ("broken", "broken")}
)
_OWN_LINES = frozenset({"botts dots", "custom"})
_UNKNOWN = None, None

Marks = tuple["LaneMark | None", "LaneMark | None"]


def marks_of(mark: MarkRecord | None) -> Marks:
    """A mark as seen from the inner lane (for the centre lane, from its left), and from the other.

    For Botts' dots and custom lines, it follows from whether lanes may be changed across them.
    """
    if mark is None:
        return _UNKNOWN
    if mark.type in _OWN_LINES:
        return _CHANGES.get(mark.change, _UNKNOWN)
    return _MARKS.get(mark.type, _UNKNOWN)


def mark_at(section: LaneSection, lane: int, s: float) -> MarkRecord | None:
    """The mark of a lane at ``s``."""
    own = section.lanes.get(lane)
    return None if own is None else record_at(own.marks, s, section.start)


def mark_beside(section: LaneSection, lane: int, s: float, *, left: bool) -> LaneMark | None:
    """The mark on a lane's border at greater ``t`` (``left``) or smaller, as seen from the lane."""
    away = left == (lane > 0)
    if away:
        return marks_of(mark_at(section, lane, s))[0]
    inner = lane - 1 if lane > 0 else lane + 1
    marks = marks_of(mark_at(section, inner, s))
    # The centre lane's marks are ordered from left to right
    return marks[0] if inner == 0 and lane > 0 else marks[1]
