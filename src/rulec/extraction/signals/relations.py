"""Relations of ego to others: along and across the road, and distance.

Along the road bodies count: ego is behind somebody until its front is level with the other's rear.
Across the road lanes count, those of the other's body and that of ego's middle, so that who keeps
within a lane is in that lane. For the paper's ``position`` see ``docs/scenarios.md``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy import int8, intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import DriveContext, once
from rulec.extraction.signals.signal_passes import once_a_recording
from rulec.extraction.tracks.road_extents import LaneSets, RoadExtents, lane_sets, lanes_touched
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.scenario.paper_words import LATERALS, PAPER_TABLES, STATIONS

if TYPE_CHECKING:
    from rulec.scenario.motion import Facing

Codes = NDArray[int8]
BEHIND, BESIDE, IN_FRONT_OF = int8(0), int8(1), int8(2)
RIGHT_OF, SAME_LANE, LEFT_OF = int8(0), int8(1), int8(2)
assert STATIONS == ("behind", "beside", "in_front_of")
assert LATERALS == ("right_of", "same_lane", "left_of")

_STANDS_MPS = 0.1
_DRIFT_M = 1.5
_FACING: tuple[Facing, ...] = ("along", "left", "against", "right")


@once
def station(context: DriveContext) -> Codes:
    """Ego behind, beside or in front of others, as indices into ``STATIONS``."""
    return _along(context.ego_extents, context.extents.s_min, context.extents.s_max)


@once
def possible_stations(context: DriveContext) -> tuple[Codes, Codes]:
    """The same with others so much longer and shorter at both ends as places may be wrong."""
    ends, place = context.extents, context.tolerances.place_m
    longer, shorter = (
        _along(context.ego_extents, ends.s_min - more, ends.s_max + more)
        for more in (place, -place)
    )
    return longer, shorter


def _along(ego: RoadExtents, s_min: Floats, s_max: Floats) -> Codes:
    return _coded(ego.s_max <= s_min, ego.s_min >= s_max)


def _coded(least: Flags, most: Flags) -> Codes:
    """The least of three codes, the greatest, where that is not so, and else the one between."""
    # Arithmetic of bytes is many times as fast as choosing
    codes: Codes = most.view(int8) + int8(1)
    codes *= (~least).view(int8)
    return codes


@once
def lateral(context: DriveContext) -> Codes:
    """Ego right of others, in their lanes or left of them, as indices into ``LATERALS``.

    Who is on a mark of ego's lane, reaching beyond it, and clear of ego sideways is at its side;
    who is no farther in but in the way of ego's body is in the lane.
    """
    return _lateral(context, _beside_lane(context), 0.0, context.lanes_within[0])


@once
def possible_laterals(context: DriveContext) -> tuple[Codes, ...]:
    """The same as far as places allow: with others further in and out, and the map where it may be.

    What lies between these is among them. Who is ahead in ego's lane, but hardly in its way, may as
    well be at its side.
    """
    place = context.tolerances.place_m
    reach, offset = context.thresholds.touching_m, context.map_offset_m
    maps = [(_beside_lane(context), context.lanes_within[1:])]
    if offset.any():
        least = reach + place, reach - place
        sets = lanes_touched(context.extents, context.lanes_there, least, -offset)
        maps.append((_beside_lane_shifted(context, offset), sets))
    shifted = (
        _lateral(context, beside, way * place, touched)
        for beside, both in maps
        for way, touched in zip((-1, 1), both, strict=True)
    )
    at_side = (station(context) == BEHIND) & ~_in_the_way(context)
    return *shifted, np.where(at_side, _ego_at(context), lateral(context))


def _in_the_way(context: DriveContext) -> Flags:
    """Flags of who takes up ego's way by a quarter of its width, half with its middle elsewhere.

    The width is the narrower one's. Who leaves ego's lane or comes into it, or rides at its edge,
    is not driving in front of ego yet, or any more.
    """
    own, others = context.ego_extents, context.extents
    narrower = np.minimum(own.d_max - own.d_min, others.d_max - others.d_min)
    both = np.minimum(-_clear(context), narrower)
    part = narrower * np.where(others.lane == own.lane, 0.25, 0.5)
    takes: Flags = both > np.maximum(part, context.tolerances.place_m)
    return takes


@once
def _aside(context: DriveContext) -> tuple[Floats, Floats]:
    """How far (m) others are clear of ego on its left and right, from the middle of ego's lane."""
    lane = context.ego_extents.lane
    own_low, own_high = context.ego_extents.from_middle(lane)
    others = _beside_lane(context)
    return others.low - own_high, own_low - others.high


@once
def _clear(context: DriveContext) -> Floats:
    """How far (m) others are clear of ego at the side where it is more."""
    return np.maximum(*_aside(context))


@once
def _ego_at(context: DriveContext) -> Codes:
    """On which side of others ego is."""
    on_left, on_right = _aside(context)
    side: Codes = (~(on_left > on_right)).view(int8) * LEFT_OF
    return side


@once
def ahead_in_lane(context: DriveContext) -> tuple[Flags, Flags, Flags]:
    """Flags of who is ahead in ego's lane: as measured, surely and perhaps."""
    ahead = station(context) == BEHIND
    same = [ahead & (codes == SAME_LANE) for codes in possible_laterals(context)]
    measured: Flags = ahead & (lateral(context) == SAME_LANE)
    return measured, measured & np.logical_and.reduce(same), measured | np.logical_or.reduce(same)


@dataclass(frozen=True, eq=False, slots=True)
class _BesideLane:
    """Where others are beside ego's lane: how far (m) they reach in it and beyond its bounds.

    ``low`` and ``high`` say how far left of its middle they begin and end, ``into`` and ``beyond``
    how far they reach over the nearer bound and the farther one. ``own`` are ego's extents.
    """

    own: RoadExtents
    low: Floats
    high: Floats
    into: Floats
    beyond: Floats


@once
def _beside_lane(context: DriveContext) -> _BesideLane:
    return _beside_lane_shifted(context, np.zeros(context.states))


def _beside_lane_shifted(context: DriveContext, shift: Floats) -> _BesideLane:
    """The same with all so much (m), by state, farther right on the map."""
    own, others = context.ego_extents.moved(-shift), context.extents
    # How far left of the two bounds of ego's lane they begin and end
    (low_r, high_r), (low_l, high_l) = (
        others.from_bound(bound) for bound in (own.lane, own.lane + 1)
    )
    if shift.any():
        low_r, high_r, low_l, high_l = (values - shift for values in (low_r, high_r, low_l, high_l))
    return _BesideLane(
        own=own,
        low=(low_r + low_l) / 2,
        high=(high_r + high_l) / 2,
        into=np.minimum(high_r, -low_l),
        beyond=np.maximum(high_l, -low_r),
    )


def _lateral(context: DriveContext, beside: _BesideLane, inward: float, touched: LaneSets) -> Codes:
    """Sides, with others so much (m) further in ego's lane; these touch the lanes of sets."""
    reach = context.thresholds.touching_m
    clear = _clear(context)
    sides = _across(beside.own, touched, beside.low, beside.high)
    beside_way = (beside.beyond > reach + inward) & (clear > reach + inward)
    in_the_way = (beside.into > -inward) & (clear < inward - reach)
    beside_way &= sides == SAME_LANE
    np.copyto(sides, _ego_at(context), where=beside_way)
    np.copyto(sides, SAME_LANE, where=in_the_way)
    return sides


def _across(own: RoadExtents, lanes: LaneSets, low: Floats, high: Floats) -> Codes:
    """Ego's middle right of others' lanes, in or left of them; without any lane, of them.

    ``low`` and ``high`` say how far (m) left of the middle of ego's lane others begin and end.
    """
    nowhere, middle = lanes == 0, np.add(*own.from_middle(own.lane)) / 2
    # Bounds ascend to the left: who is right of the first lane is left of the right bound of none
    right_of = (lanes & lane_sets(own.left_of[..., :-1] > 0)) == 0
    left_of_all = (lanes & lane_sets(own.left_of[..., 1:] < 0)) == 0
    right_of &= ~nowhere | (middle <= low)
    left_of_all &= ~nowhere | (middle >= high)
    return _coded(right_of, left_of_all)


@once
def gap(context: DriveContext) -> Floats:
    """The distance (m) along the road between bodies, 0 beside each other."""
    return np.maximum(way_along(context), 0.0)


@once
def way_along(context: DriveContext) -> Floats:
    """The same, less than 0 beside each other."""
    ego, others = context.ego_extents, context.extents
    way: Floats = np.maximum(others.s_min - ego.s_max, ego.s_min - others.s_max)
    return way


@once
def lateral_gap(context: DriveContext) -> Floats:
    """The distance (m) across the road between bodies, 0 behind each other."""
    return np.maximum(way_across(context), 0.0)


@once
def way_across(context: DriveContext) -> Floats:
    """The same, less than 0 behind each other."""
    ego, others = context.ego_extents, context.extents
    way: Floats = np.maximum(others.d_min - ego.d_max, ego.d_min - others.d_max)
    return way


@once
def position(context: DriveContext) -> NDArray[np.str_]:
    """The paper's position letters b, f, l and r.

    Pedestrians have a frame of their own. Where bodies are beside each other in one lane they are
    at each other's sides if they overlap across the road by less than along it, and less than half
    of the narrower one; else their middles decide.
    """
    ego, others = context.ego_extents, context.extents
    walking = np.flatnonzero(context.tracks.of_type("pedestrian"))
    s_min, s_max = others.s_min, others.s_max
    facing = np.zeros(s_min.shape, dtype=intp)
    touched = context.lanes_within[0]
    if len(walking):
        facing[walking] = _facing(others.part(walking, slice(None)))
        across = facing % 2 == 1
        touched = np.where(across, touched.dtype.type(0), touched)
        for start, end in context.road.crossings:
            on = across & (s_min < end) & (s_max > start)
            s_min, s_max = (
                np.where(on, np.minimum(s_min, start), s_min),
                np.where(on, np.maximum(s_max, end), s_max),
            )
    column = _along(ego, s_min, s_max)
    beside = _beside_lane(context)
    row = _across(ego, touched, beside.low, beside.high)
    inside = (row == SAME_LANE) & (column == BESIDE)
    half = np.minimum(ego.d_max - ego.d_min, others.d_max - others.d_min) / 2
    aside = _clear(context) > np.maximum(way_along(context), -half)
    at_side = inside & (facing % 2 == 0) & aside
    row, inside = np.where(at_side, _ego_at(context), row), inside & ~at_side
    column = np.where(inside, np.where(ego.s < others.s, BEHIND, IN_FRONT_OF), column)
    tables = np.array([list(PAPER_TABLES[name].decode()) for name in _FACING])
    letters: NDArray[np.str_] = tables[facing, 3 * row + column]
    return letters


def _facing(others: RoadExtents) -> NDArray[intp]:
    """The direction of motion, or heading at rest, by right angles to the road.

    Indices into ``_FACING``; half-way counts as across the road.
    """
    moves = np.hypot(others.along, others.across) > _STANDS_MPS
    angle = np.where(moves, np.arctan2(others.across, others.along), others.turned)
    angle = np.round(np.degrees(np.nan_to_num(angle)), 6)
    across = np.where(angle > 0, 1, 3)
    return np.where(np.abs(angle) < 45, 0, np.where(np.abs(angle) > 135, 2, across))


def stays(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Flags of those of these rows who stand all the time that they are recorded.

    Boxes of one that stands drift by up to ``_DRIFT_M``.
    """
    still: Flags = _who_stays(context)[context.tracks.rows[rows]]
    return still


@once_a_recording
def _who_stays(context: DriveContext) -> Flags:
    """The same flags of everybody."""
    tracks = context.surroundings.tracks
    spreads = [
        np.where(tracks.present, places, -np.inf).max(axis=1, initial=-np.inf)
        - np.where(tracks.present, places, np.inf).min(axis=1, initial=np.inf)
        for places in (tracks.x, tracks.y)
    ]
    still: Flags = np.hypot(spreads[0], spreads[1]) <= _DRIFT_M
    return still
