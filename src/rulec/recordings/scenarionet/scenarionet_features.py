"""Map features and lights of ScenarioNet's scenarios."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import shapely

from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.encodings.speed_units import MPS_PER_MPH
from rulec.recordings.lane_centres.road_features import (
    BoundaryPart,
    CentreLane,
    LaneSide,
    NeighbourPart,
    RoadFeatures,
)
from rulec.recordings.lanes.lanes_along import lines_that_meet
from rulec.recordings.recording import LONGEST_M, LaneMark
from rulec.recordings.scenarionet.data_sets import DataSet
from rulec.recordings.scenarionet.scenario_dictionary import KeyedValue

JOINED_M = 0.1
"""Lanes without successors in the file lead to lanes that begin this close (m) to their end."""

ASIDE_M = 1.5
"""A successor that begins this far (m) aside of a lane's end is dropped.

It is another lane of the next road, which one reaches by a lane change; MetaDrive's lanes lead to
all lanes of the next road.
"""

_LIKE = np.cos(np.radians(60.0))
_FEWEST_CORNERS = 3
_MOST_INDEX = 1 << 31

_MARKS: Mapping[str, LaneMark | None] = MappingProxyType(
    {
        **dict.fromkeys(
            ("BROKEN_SINGLE_WHITE", "BROKEN_SINGLE_YELLOW", "BROKEN_DOUBLE_YELLOW"), "broken"
        ),
        **dict.fromkeys(("SOLID_SINGLE_WHITE", "SOLID_SINGLE_YELLOW"), "solid"),
        **dict.fromkeys(("SOLID_DOUBLE_WHITE", "SOLID_DOUBLE_YELLOW"), "double_solid"),
    }
)
_LANE_TYPES = {"LANE_FREEWAY": "highway", "LANE_BIKE_LANE": "bicycleLane"}
_COLOURS = {
    **dict.fromkeys(("LANE_STATE_STOP", "LANE_STATE_ARROW_STOP", "TRAFFIC_LIGHT_RED"), "red"),
    **dict.fromkeys(
        ("LANE_STATE_CAUTION", "LANE_STATE_ARROW_CAUTION", "TRAFFIC_LIGHT_YELLOW"), "yellow"
    ),
    **dict.fromkeys(("LANE_STATE_GO", "LANE_STATE_ARROW_GO", "TRAFFIC_LIGHT_GREEN"), "green"),
}


def road_features(scenario: KeyedValue, known: DataSet, steps: Iterable[int]) -> RoadFeatures:
    """A scenario's whole road; ``steps`` are the time steps of its times."""
    features = RoadFeatures()
    has_exits = False
    for name, entry in scenario.child("map_features").items():
        kind = entry.child("type").text()
        if kind.startswith("LANE"):
            has_exits |= "exit_lanes" in entry.value
            features.lanes[name] = _lane(name, kind, entry, known)
        elif kind.startswith(("ROAD_LINE", "ROAD_EDGE")):
            points = _points(entry, "polyline")
            if len(points) > 1:
                features.lines[name] = points[:, :2]
        elif kind == "STOP_SIGN" and known.whole_map:
            features.stop_lanes.update(lane.text() for lane in entry.child("lane").elements())
        elif kind == "CROSSWALK":
            corners = _points(entry, "polygon")[:, :2]
            if len(corners) < _FEWEST_CORNERS:
                raise entry.wrong(f"has fewer than {_FEWEST_CORNERS} corners")
            features.crosswalks[name] = corners
    lanes = _in_line(features.lanes) if has_exits else joined(features.lanes)
    features = replace(features, lanes=lanes)
    _add_lights(features, scenario, list(steps))
    return features


def _points(entry: KeyedValue, key: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    points = entry.child(key).places()
    if len(points) and np.ptp(points[:, :2], axis=0).max() > LONGEST_M:
        raise entry.wrong(f"is longer than {LONGEST_M / 1000:g} km")
    return points


def _lane(name: str, kind: str, entry: KeyedValue, known: DataSet) -> CentreLane:
    # nuScenes' points have their direction in place of a height
    centre = _points(entry, "polyline")
    heights = centre[:, 2] if known.whole_map else np.full(len(centre), np.nan)
    centre = np.column_stack((centre[:, :2], heights))
    mph = entry.get("speed_limit_mph") if known.whole_map else None
    limit = 0.0 if mph is None else _number(mph)
    outline = entry.get("polygon")
    area = None if outline is None else outline.places()[:, :2]
    sides = [
        LaneSide(
            boundaries=_boundaries(entry.get(f"{side}_boundaries"), len(centre), known),
            neighbours=_neighbours(entry.get(f"{side}_neighbor"), len(centre)),
        )
        for side in ("left", "right")
    ]
    return CentreLane(
        id=name,
        centre=centre,
        types=frozenset({_LANE_TYPES[kind]} if kind in _LANE_TYPES else ()),
        limit_mps=limit * MPS_PER_MPH if limit > 0 else None,
        follows=_ids(entry.get("entry_lanes")),
        leads_to=_ids(entry.get("exit_lanes")),
        left=sides[0],
        right=sides[1],
        area=area if area is not None and _is_area(area) else None,
    )


def _number(entry: KeyedValue) -> float:
    """A number, or the first of several."""
    if isinstance(entry.value, list | tuple | np.ndarray):
        return next(iter(entry.column().tolist()), 0.0)
    if not isinstance(entry.value, int | float | np.number) or not abs(entry.value) < LARGEST:
        raise entry.wrong("is no number")
    return float(entry.value)


def _is_area(corners: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> bool:
    return len(corners) >= _FEWEST_CORNERS and float(shapely.Polygon(corners).area) > 0


def _ids(entry: KeyedValue | None) -> tuple[str, ...]:
    return () if entry is None else tuple([value.text() for value in entry.elements()])


def _boundaries(entry: KeyedValue | None, count: int, known: DataSet) -> tuple[BoundaryPart, ...]:
    if entry is None or not known.whole_map:
        return ()
    parts = []
    for part in entry.elements():
        kind = part.get("boundary_type")
        word = "" if kind is None else kind.text().removeprefix("ROAD_LINE_")
        start, end = _range(part, "lane_start_index", "lane_end_index", count)
        line = part.child("boundary_feature_id").text()
        parts.append(BoundaryPart(start, end, line, _MARKS.get(word)))
    return tuple(parts)


def _neighbours(entry: KeyedValue | None, count: int) -> tuple[NeighbourPart, ...]:
    """Neighbours as parts of lanes, as Waymo has them, or as ids of lanes alongside throughout."""
    parts = []
    for part in () if entry is None else entry.elements():
        if not isinstance(part.value, dict):
            parts.append(NeighbourPart(part.text(), 0, max(count - 1, 0), 0, _MOST_INDEX))
            continue
        own = _range(part, "self_start_index", "self_end_index", count)
        other = _range(part, "neighbor_start_index", "neighbor_end_index", _MOST_INDEX)
        parts.append(NeighbourPart(part.child("feature_id").text(), *own, *other))
    return tuple(parts)


def _range(part: KeyedValue, first: str, last: str, count: int) -> tuple[int, int]:
    indices = (part.child(first).whole(), part.child(last).whole())
    start, end = sorted(min(max(index, 0), max(count - 1, 0)) for index in indices)
    return start, end


def joined(lanes: Mapping[str, CentreLane]) -> dict[str, CentreLane]:
    """The lanes with their successors, from where they begin and end."""
    there = [lane for lane in lanes.values() if len(lane.centre) > 1]
    if not there:
        return dict(lanes)
    after: dict[str, list[str]] = {}
    before: dict[str, list[str]] = {}
    lines = [lane.centre[:, :2] for lane in there]
    for own, onward in sorted(lines_that_meet(lines, JOINED_M, _LIKE)):
        after.setdefault(there[own].id, []).append(there[onward].id)
        before.setdefault(there[onward].id, []).append(there[own].id)
    return {
        name: replace(
            lane, leads_to=tuple(after.get(name, ())), follows=tuple(before.get(name, ()))
        )
        for name, lane in lanes.items()
    }


def _in_line(lanes: Mapping[str, CentreLane]) -> dict[str, CentreLane]:
    """The lanes, without successors that begin aside of their end."""

    def aside(before: str, after: str) -> bool:
        ends = [lanes[name] for name in (before, after) if name in lanes]
        if len(ends) < 2 or len(ends[0].centre) < 2 or not len(ends[1].centre):
            return False
        x, y = ends[1].centre[0, :2] - ends[0].centre[-1, :2]
        turned = _heading(ends[0], -2)
        return bool(abs(y * np.cos(turned) - x * np.sin(turned)) > ASIDE_M)

    return {
        name: replace(
            lane,
            leads_to=tuple([follower for follower in lane.leads_to if not aside(name, follower)]),
            follows=tuple([follow for follow in lane.follows if not aside(follow, name)]),
        )
        for name, lane in lanes.items()
    }


def _heading(lane: CentreLane, start: int) -> float:
    x, y = lane.centre[start + 1, :2] - lane.centre[start, :2]
    return float(np.arctan2(y, x))


def _add_lights(features: RoadFeatures, scenario: KeyedValue, steps: list[int]) -> None:
    states = scenario.get("dynamic_map_states")
    for _, entry in [] if states is None else states.items():
        lane = entry.get("lane")
        shown = entry.child("state").get("object_state")
        if lane is None or shown is None:
            continue
        colours = {}
        elements = shown.elements()
        if len(elements) > len(steps):
            raise shown.wrong(f"has {len(elements)} states for {len(steps)} times")
        for step, element in zip(steps, elements, strict=False):
            colour = _COLOURS.get(element.value) if isinstance(element.value, str) else None
            if colour is not None:
                colours[step] = colour
        features.lights[lane.text()] = colours
