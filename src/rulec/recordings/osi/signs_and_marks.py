"""Traffic signs, stop lines and pedestrian crossings of an ASAM OSI trace, put on its lanelets."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import shapely

from rulec.recordings.commonroad.traffic_signs import LIMITS, effect_name
from rulec.recordings.encodings.speed_units import SPEED_UNITS
from rulec.recordings.encodings.wire_format import Fields, WireFile
from rulec.recordings.osi.message_fields import assigned_lanes, number, part, places
from rulec.recordings.polylines import arc_lengths
from rulec.recordings.recording import LIMIT_SIGN, Lanelet, Points
from rulec.recordings.road_map import crosswalk

_NAMES: Mapping[str, str] = {
    "give_way": "YIELD",
    "stop": "STOP",
    "priority_to_opposite_direction": "PRIORITY_OPPOSITE_DIRECTION",
    "priority_over_opposite_direction": "PRIORITY_OVER_ONCOMING",
    "right_of_way_next_intersection": "RIGHT_OF_WAY",
    "right_of_way_begin": "PRIORITY",
    "roundabout": "ROUNDABOUT",
    "bus_lane": "BUS_LANE",
    "bus_lane_begin": "BUS_LANE",
    "speed_limit_begin": "MAX_SPEED",
    "speed_limit_zone_begin": "MAX_SPEED_ZONE_START",
    "overtaking_ban_begin": "NO_OVERTAKING_START",
    "overtaking_ban_for_trucks_begin": "NO_OVERTAKING_TRUCKS_START",
    "traffic_light_green_arrow": "GREEN_ARROW",
}
"""OSI sign type -> name in recordings; other signs do not concern driving, or end something."""

_PAINTED = frozenset({"painted_traffic_sign", "symbolic_traffic_sign"})
_CROSSING = "crossing_"
_NARROWEST_M = 0.5
_Lanes = Mapping[str, Sequence[str]]


def limit_of(value: Fields, file: WireFile) -> float | None:
    """A speed limit (m/s); None if its unit is unknown. Raises RulecError R0610."""
    unit = SPEED_UNITS.get(value.get("value_unit", "unknown"))
    limit = number(value, "value", file)
    return limit * unit if unit is not None and limit > 0 else None


def with_signs(
    lanelets: Mapping[str, Lanelet],
    signs: Mapping[str, Fields],
    of_lane: _Lanes,
    changing: Container[str],
    file: WireFile,
) -> dict[str, Lanelet]:
    """The lanelets with the signs, by their ids, that are assigned to their lanes.

    A sign with a supplementary sign applies only to some hours, places or vehicles, and of those
    that are ``changing`` it is not known when they show what: they may apply, or not.
    """
    signed = dict(lanelets)
    for key, fields in signs.items():
        sign = part(fields, "main_sign", "classification")
        name = _NAMES.get(sign.get("type", "unknown"))
        if name is None or (sign.get("is_out_of_service") and key not in changing):
            continue
        limit = limit_of(part(sign, "value"), file) if name in LIMITS else None
        is_sure = key not in changing and not _is_qualified(fields)
        for own in _lanelets_of(sign, of_lane):
            signed[own] = _with_sign(signed[own], name, limit, is_sure=is_sure)
    return signed


def _with_sign(own: Lanelet, name: str, limit_mps: float | None, *, is_sure: bool) -> Lanelet:
    """A lanelet with one more sign, which surely applies or may; its limit may be unreadable."""
    untold = own.untold_signs
    if not is_sure or (name in LIMITS and limit_mps is None and own.limit_mps is None):
        untold |= {effect_name(name)}
    limits = [x for x in (own.limit_mps, limit_mps if is_sure else None) if x is not None]
    return replace(
        own,
        signs=own.signs | {name} if is_sure else own.signs,
        untold_signs=untold,
        limit_mps=None if LIMIT_SIGN in untold else min(limits, default=None),
    )


def _is_qualified(fields: Fields) -> bool:
    below = fields.get("supplementary_sign", ())
    return any(part(x, "classification").get("type", "other") != "no_sign" for x in below)


def _lanelets_of(sign: Fields, of_lane: _Lanes) -> Iterator[str]:
    for lane in assigned_lanes(sign):
        yield from of_lane.get(lane, ())


def with_stop_lines(
    lanelets: Mapping[str, Lanelet], marks: Iterable[Fields], of_lane: _Lanes, file: WireFile
) -> dict[str, Lanelet]:
    """The lanelets with the stop lines on their lanes: road markings of the sign type for stop."""
    lined = dict(lanelets)
    for fields in marks:
        mark = part(fields, "classification")
        if not _is_mark_of(mark, "stop"):
            continue
        place = places([part(fields, "base", "position")], file)
        for key in _lanelets_of(mark, of_lane):
            lined[key] = replace(lined[key], stop_line=_across(lined[key], place))
    return lined


def _is_mark_of(mark: Fields, sign: str) -> bool:
    painted = mark.get("type") in _PAINTED and mark.get("traffic_main_sign_type") == sign
    return painted and not mark.get("is_out_of_service")


def _across(lanelet: Lanelet, place: Points) -> Points:
    """The end points of the line across a lanelet at a place."""
    reached = arc_lengths(lanelet.centre)
    along = shapely.line_locate_point(shapely.LineString(lanelet.centre), shapely.points(place))
    ends = [
        [np.interp(along, reached, axis)[0] for axis in bound.T]
        for bound in (lanelet.left, lanelet.right)
    ]
    return np.array(ends, dtype=float)


def with_crossings(
    lanelets: Mapping[str, Lanelet], marks: Mapping[str, Fields], of_lane: _Lanes, file: WireFile
) -> dict[str, Lanelet]:
    """The lanelets, plus one for each painted pedestrian crossing."""
    crossed = dict(lanelets)
    for key, fields in marks.items():
        mark = part(fields, "classification")
        outline = _ground_outline(part(fields, "base"), file)
        if not _is_mark_of(mark, "zebra_crossing") or outline is None:
            continue
        lanes = [lanelets[x] for x in _lanelets_of(mark, of_lane)]
        crossed[_CROSSING + key] = _crossing(_CROSSING + key, outline, lanes)
    return crossed


def _ground_outline(base: Fields, file: WireFile) -> Points | None:
    """The corners of the smallest box around an object seen from above; None without area.

    A mark stands upright in its own coordinates; its orientation lays it on the ground.
    """
    size, turned = part(base, "dimension"), part(base, "orientation")
    half = [abs(number(size, name, file)) / 2 for name in ("length", "width", "height")]
    roll, pitch, yaw = (number(turned, name, file) for name in ("roll", "pitch", "yaw"))
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
    about_x = np.array(
        [(1, 0, 0), (0, np.cos(roll), -np.sin(roll)), (0, np.sin(roll), np.cos(roll))]
    )
    about_y = np.array(
        [(np.cos(pitch), 0, np.sin(pitch)), (0, 1, 0), (-np.sin(pitch), 0, np.cos(pitch))]
    )
    about_z = np.array([(np.cos(yaw), -np.sin(yaw), 0), (np.sin(yaw), np.cos(yaw), 0), (0, 0, 1)])
    corners = (signs * half) @ (about_z @ about_y @ about_x).T
    ground = corners[:, :2] + places([part(base, "position")], file)
    with np.errstate(all="ignore"):
        # An object without area has no box and is left out
        box = shapely.minimum_rotated_rectangle(shapely.multipoints(ground))
    if not isinstance(box, shapely.Polygon) or shapely.minimum_clearance(box) < _NARROWEST_M:
        return None
    outline: Points = shapely.get_coordinates(box)[:4]
    return outline


def _crossing(key: str, outline: Points, lanes: Sequence[Lanelet]) -> Lanelet:
    """A crossing: one walks across its lanes or, if these are unknown, along its longer side."""
    ahead = outline[1] - outline[0]
    if lanes:
        along = lanes[0].centre[-1] - lanes[0].centre[0]
        unit = along / max(float(np.hypot(*along)), 1e-9)
        other = outline[2] - outline[1]
        is_across = abs(ahead @ unit) / np.hypot(*ahead) <= abs(other @ unit) / np.hypot(*other)
    else:
        is_across = bool(np.hypot(*ahead) >= np.hypot(*(outline[2] - outline[1])))
    first, second, third, fourth = outline if is_across else np.roll(outline, -1, axis=0)
    right, left = np.stack((first, second)), np.stack((fourth, third))
    return crosswalk(key, left, right)
