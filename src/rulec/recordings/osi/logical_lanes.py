"""Logical lanes of ASAM OSI, from version 3.5: they add to lanes, or replace missing ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rulec.recordings.encodings.wire_format import Fields, WireFile
from rulec.recordings.osi.lane_messages import Boundary, TraceLane, line_of
from rulec.recordings.osi.message_fields import id_of, ids_of, part
from rulec.recordings.osi.signs_and_marks import limit_of

_DRIVING = frozenset(
    {"normal", "exit", "entry", "onramp", "offramp", "connectingramp", "unknown", "other"}
)
_RAILS = frozenset({"rail", "tram"})
_SETTINGS: Mapping[str, str] = {
    "motorway": "highway",
    "rural": "country",
    **dict.fromkeys(("town", "town_arterial", "town_collector", "town_local"), "urban"),
    **dict.fromkeys(("town_expressway", "town_play_street", "town_private"), "urban"),
}
"""Road type -> the setting of a lanelet (town, country or motorway)."""


class LogicalLane(NamedTuple):
    """A logical lane in the form of a lane, and the ids of the lanes that it consists of."""

    lane: TraceLane
    physical: tuple[str, ...]


def logical_lanes(messages: Mapping[str, Fields], file: WireFile) -> list[LogicalLane]:
    """The logical lanes of a trace. Raises RulecError R0610."""
    return [_logical_lane(key, fields, file) for key, fields in messages.items()]


def _logical_lane(key: str, fields: Fields, file: WireFile) -> LogicalLane:
    kind = fields.get("type", "unknown")
    setting = _SETTINGS.get(fields.get("road_type", "unknown"))
    types = set() if setting is None else {setting}
    if kind in _RAILS:
        types |= {"restricted_area", "rail"}
    move = fields.get("move_direction")
    is_crossed = bool(fields.get("overlapping_lane"))
    others = [
        id_of(entry, "other_lane_id")
        for name in ("predecessor_lane", "successor_lane")
        for entry in fields.get(name, ())
    ]
    lane = TraceLane(
        id=key,
        kind="nondriving" if kind not in _DRIVING else "intersection" if is_crossed else "driving",
        subtype=kind,
        centre=np.empty((0, 2)),
        forward={"increasing": True, "both": True, "decreasing": False}.get(move or ""),
        left_bounds=ids_of(fields, "left_boundary_id"),
        right_bounds=ids_of(fields, "right_boundary_id"),
        left_of=_others(fields, "left_adjacent_lane"),
        right_of=_others(fields, "right_adjacent_lane"),
        linked=tuple(dict.fromkeys(x for x in others if x is not None and x != key)),
        limit_mps=_limit(fields, file),
        types=frozenset(types),
    )
    physical = (id_of(x, "physical_lane_id") for x in fields.get("physical_lane_reference", ()))
    return LogicalLane(lane, tuple(dict.fromkeys(filter(None, physical))))


def _others(fields: Fields, name: str) -> tuple[str, ...]:
    ids = (id_of(entry, "other_lane_id") for entry in fields.get(name, ()))
    return tuple(filter(None, ids))


def _limit(fields: Fields, file: WireFile) -> float | None:
    """The lowest speed limit that applies to all traffic (m/s)."""
    limits = [
        limit_of(part(rule, "speed_limit", "speed_limit_value"), file)
        for rule in fields.get("traffic_rule", ())
        if rule.get("traffic_rule_type", "speed_limit") == "speed_limit"
        and not part(rule, "traffic_rule_validity").get("valid_for_type")
    ]
    return min((x for x in limits if x is not None), default=None)


def logical_boundaries(
    messages: Mapping[str, Fields], physical: Mapping[str, Boundary], file: WireFile
) -> dict[str, Boundary]:
    """Boundaries of logical lanes, with the marks that lie on them. Raises RulecError R0610."""
    boundaries = {}
    for key, fields in messages.items():
        points = (part(point, "position") for point in fields.get("boundary_line", ()))
        line = line_of(points, file)
        marks = {physical[x].mark for x in ids_of(fields, "physical_boundary_id") if x in physical}
        if len(line) > 1:
            boundaries[key] = Boundary(line, marks.pop() if len(marks) == 1 else None)
    return boundaries


def with_logical(lanes: Sequence[TraceLane], logical: Sequence[LogicalLane]) -> list[TraceLane]:
    """The lanes, each with the limits and types that all its logical lanes share."""
    of_lane: dict[str, list[TraceLane]] = {}
    for logical_lane in logical:
        for name in logical_lane.physical:
            of_lane.setdefault(name, []).append(logical_lane.lane)
    completed = []
    for lane in lanes:
        own = of_lane.get(lane.id, [])
        limits = {x.limit_mps for x in own}
        types = frozenset.intersection(*(x.types for x in own)) if own else frozenset[str]()
        limit = limits.pop() if len(limits) == 1 else None
        completed.append(lane._replace(limit_mps=limit, types=types))
    return completed


def lanes_by_logical(logical: Sequence[LogicalLane]) -> dict[str, tuple[str, ...]]:
    """Lanes of each logical lane, by its id."""
    return {lane.lane.id: lane.physical for lane in logical}
