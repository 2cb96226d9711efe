"""Map features and lights of Waymo's scenarios."""

from __future__ import annotations

from rulec.recordings.encodings.speed_units import MPS_PER_MPH
from rulec.recordings.lane_centres.road_features import (
    BoundaryPart,
    CentreLane,
    LaneSide,
    NeighbourPart,
    Places3d,
    RoadFeatures,
)
from rulec.recordings.recording import LONGEST_M
from rulec.recordings.waymo.waymo_messages import CheckedMessage
from rulec.recordings.waymo.waymo_tables import MARKS

_FEWEST_CORNERS = 3
_MOST_POINTS = 1 << 31


def add_feature(features: RoadFeatures, message: CheckedMessage) -> None:
    """Add a map feature if its kind is used. Raises RulecError R0610."""
    name = str(message.whole("id"))
    if (lane := message.message("lane")) is not None:
        if name in features.lanes:
            raise message.wrong(f"there is a second lane {name}")
        centre = _line(lane)
        features.lanes[name] = CentreLane(
            id=name,
            centre=centre,
            types=frozenset({lane.word("type")} - {"unknown"}),
            limit_mps=_limit(lane),
            follows=tuple(map(str, lane.wholes("entry_lanes"))),
            leads_to=tuple(map(str, lane.wholes("exit_lanes"))),
            left=_side(lane, "left", len(centre)),
            right=_side(lane, "right", len(centre)),
        )
    for kind in ("road_line", "road_edge"):
        if (line := message.message(kind)) is not None:
            points = _line(line)
            if len(points) > 1:
                features.lines[name] = points[:, :2]
    if (sign := message.message("stop_sign")) is not None:
        features.stop_lanes.update(map(str, sign.wholes("lane")))
    if (crosswalk := message.message("crosswalk")) is not None:
        polygon = crosswalk.places("polygon")
        if len(polygon) < _FEWEST_CORNERS:
            raise message.wrong(f"crosswalk {name} has fewer than {_FEWEST_CORNERS} corners")
        features.crosswalks[name] = polygon[:, :2]


def add_lights(features: RoadFeatures, message: CheckedMessage, step: int) -> None:
    """Add the states of the lights observed at a time step. Raises RulecError R0610."""
    for state in message.messages("lane_states"):
        name = str(state.whole("lane"))
        colours = features.lights.setdefault(name, {})
        colour = state.word("state")
        if colour != "unknown":
            colours[step] = colour


def _line(message: CheckedMessage) -> Places3d:
    points = message.places("polyline")
    if len(points) and (points[:, :2].max(axis=0) - points[:, :2].min(axis=0)).max() > LONGEST_M:
        raise message.wrong(f"a line is longer than {LONGEST_M / 1000:g} km")
    return points


def _limit(lane: CheckedMessage) -> float | None:
    """The speed limit (m/s), or None; Waymo writes 0 mph where there is no limit."""
    mph = lane.number("speed_limit_mph") if "speed_limit_mph" in lane.values else 0.0
    return mph * MPS_PER_MPH if mph > 0 else None


def _side(lane: CheckedMessage, side: str, count: int) -> LaneSide:
    boundaries = [
        BoundaryPart(
            *_range(part, "lane_start_index", "lane_end_index", count),
            str(part.whole("boundary_feature_id")),
            MARKS[part.word("boundary_type")],
        )
        for part in lane.messages(f"{side}_boundaries")
    ]
    neighbours = [
        NeighbourPart(
            str(part.whole("feature_id")),
            *_range(part, "self_start_index", "self_end_index", count),
            *_range(part, "neighbor_start_index", "neighbor_end_index", _MOST_POINTS),
        )
        for part in lane.messages(f"{side}_neighbors")
    ]
    return LaneSide(boundaries=tuple(boundaries), neighbours=tuple(neighbours))


def _range(part: CheckedMessage, first: str, last: str, count: int) -> tuple[int, int]:
    """The indices of the first and the last of ``count`` points, in ascending order."""
    start, end = sorted(
        min(max(part.whole(name, 0), 0), max(count - 1, 0)) for name in (first, last)
    )
    return start, end
