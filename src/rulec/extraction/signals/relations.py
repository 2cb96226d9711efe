"""Relations of ego to others: along and across the road, and distance.

Along the road bodies count: ego is behind a participant until its front is level with the other's
rear. Across the road lanes count, those of the other's body and that of ego's middle, so that a
participant that keeps within a lane is in that lane. For the paper's ``position`` see
``docs/scenarios.md``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy import int8, intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.tracks.lane_sets import LaneSets, lane_sets, lanes_touched
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.scenario.paper_words import LATERALS, PAPER_TABLES, STATIONS
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

if TYPE_CHECKING:
    from rulec.scenario.motion import Facing

Codes = NDArray[int8]
BEHIND, BESIDE, IN_FRONT_OF = int8(0), int8(1), int8(2)
RIGHT_OF, SAME_LANE, LEFT_OF = int8(0), int8(1), int8(2)
assert STATIONS == ("behind", "beside", "in_front_of")
assert LATERALS == ("right_of", "same_lane", "left_of")

_STANDS_MPS = 0.1
_FACING: tuple[Facing, ...] = ("along", "left", "against", "right")


@once
def station(context: DriveContext) -> Codes:
    """Ego behind, beside or in front of others, as indices into ``STATIONS``."""
    return _along(context.ego_extents, context.extents.s_min, context.extents.s_max)


@once
def possible_stations(context: DriveContext) -> tuple[Codes, Codes]:
    """``station`` with others longer, and shorter, at both ends by the tolerance of places."""
    own, ends, place = context.ego_extents, context.extents, context.tolerances.place_m
    longer, shorter = (_along(own, ends.s_min - x, ends.s_max + x) for x in (place, -place))
    return longer, shorter


def _along(ego: RoadExtents, s_min: Floats, s_max: Floats) -> Codes:
    return _coded(ego.s_max <= s_min, ego.s_min >= s_max)


def _coded(least: Flags, most: Flags) -> Codes:
    """Code 0 where ``least`` holds, else 2 where ``most`` holds, else 1."""
    # Byte arithmetic is many times as fast as np.where
    codes: Codes = most.view(int8) + int8(1)
    codes *= (~least).view(int8)
    return codes


@once
def known_places(context: DriveContext) -> Cells:
    """The cells of participants that are beside the road: no relation says anything of the rest."""
    return Cells.at(~np.isnan(context.extents.s_min))


@dataclass(frozen=True, eq=False, slots=True)
class Laterals:
    """On which side of others ego is: as measured, and within the tolerance of places.

    ``codes`` are indices into ``LATERALS``, ``doubtful`` where another may be right.
    """

    codes: Codes
    doubtful: Flags
    same_lane: Truth


def lateral(context: DriveContext) -> Codes:
    """Ego right of others, in their lanes or left of them, as indices into ``LATERALS``.

    A participant on a mark of ego's lane, reaching beyond it, and clear of ego sideways is at its
    side; one no farther in but in the way of ego's body is in the lane.
    """
    return laterals(context).codes


@once
def laterals(context: DriveContext) -> Laterals:
    """``lateral`` within tolerances: others farther in and out, and the map where it may be.

    This covers all that lies in between. A participant ahead in ego's lane but hardly in its way
    may as well be at its side, and so may one where ego's route is not known any more.
    """
    place, offset = context.tolerances.place_m, context.map_offset_m
    cells, beside = known_places(context), _beside_lane(context)
    touched, *both = [cells.of(sets) for sets in context.lanes_within]
    codes = beside.sides(touched, 0.0)
    behind = ((cells.of(station(context)) == BEHIND) & (codes != beside.ego_at)).nonzero()[0]
    at_side = behind[~_in_the_way(context, cells.part(behind), beside.clear.take(behind))]
    doubtful, inside = np.zeros(len(codes), dtype=bool), codes == SAME_LANE
    doubtful[at_side] = True
    # Beyond a fork that it does not reach, ego may take the other road
    doubtful |= cells.of(context.extents.s_min) > cells.of(context.route_known_until)
    surely = inside & ~doubtful
    wavers = beside.wavering(both, place)
    tries = [(wavers, beside.part(wavers), [own.take(wavers) for own in both])]
    if offset.any():
        chosen = _beside_elsewhere(context, offset)
        part, reach = cells.part(chosen), context.thresholds.touching_m
        bodies, least = _left_of_bounds(context, part), (reach + place, reach - place)
        sets = lanes_touched(bodies, part.of(context.lanes_there), least, -part.of(offset))
        tries.append((chosen, _beside_lane_shifted(context, chosen, offset), list(sets)))
    for chosen, lane, both in tries:
        own = codes.take(chosen)
        for way, touched in zip((-1, 1), both, strict=True):
            others = lane.sides(touched, way * place)
            doubtful[chosen] |= others != own
            surely[chosen] &= others == SAME_LANE
            inside[chosen] |= others == SAME_LANE
    return Laterals(
        cells.laid(codes, SAME_LANE),
        cells.laid(doubtful),
        Truth(cells.laid(surely, True), cells.laid(inside, True)),
    )


def _left_of_bounds(context: DriveContext, cells: Cells) -> RoadExtents:
    """How far (m) left of each lane bound bodies begin and end, by cell."""
    bounds = range(context.existing_lanes.shape[1] + 1)
    low, high = np.moveaxis(np.array(context.extents.cells_from_bounds(cells, *bounds)), 0, -1)
    return replace(context.ego_extents, left_of_min=low, left_of_max=high)


def _in_the_way(context: DriveContext, cells: Cells, clear: Floats) -> Flags:
    """Mask of bodies across a quarter of ego's way, or half with their middle in another lane.

    Of the narrower one's width. A vehicle that leaves ego's lane or comes into it, or rides at its
    edge, is not yet, or no longer, driving in front of ego.
    """
    own, others = context.ego_extents, context.extents
    theirs = cells.of(others.d_max) - cells.of(others.d_min)
    narrower = np.minimum(cells.of(own.d_max - own.d_min), theirs)
    both = np.minimum(-clear, narrower)
    part = narrower * np.where(cells.of(others.lane) == cells.of(own.lane), 0.25, 0.5)
    takes: Flags = both > np.maximum(part, context.tolerances.place_m)
    return takes


@once
def ahead_in_lane(context: DriveContext) -> Truth:
    """Which participants are ahead in ego's lane."""
    return laterals(context).same_lane & _is_behind(context)


def measured_ahead(context: DriveContext) -> Flags:
    """Mask of participants that are ahead in ego's lane as measured."""
    ahead: Flags = _is_behind(context) & (laterals(context).codes == SAME_LANE)
    return ahead


def _is_behind(context: DriveContext) -> Flags:
    behind: Flags = station(context) == BEHIND
    return behind


@once
def possibly_ahead(context: DriveContext) -> Cells:
    """The cells of participants that are possibly ahead in ego's lane."""
    return Cells.at(ahead_in_lane(context).possible)


@dataclass(frozen=True, eq=False, slots=True)
class _BesideLane:
    """Others beside ego's lane: how far (m) they reach into it and beyond its bounds, by cell.

    ``low`` and ``high``: how far left of the lane's middle they begin and end; ``into`` and
    ``beyond``: how far they reach over its nearer bound and its farther one. ``middle`` is ego's;
    ``right_of`` and ``left_of`` are the sets of lanes whose right bound is right, and whose left
    bound is left, of ego's middle. ``clear`` is the distance from ego at the side where it is
    larger, ``ego_at`` ego's side there.
    """

    reach: float
    right_of: LaneSets
    left_of: LaneSets
    middle: Floats
    low: Floats
    high: Floats
    into: Floats
    beyond: Floats
    clear: Floats
    ego_at: Codes

    def part(self, chosen: NDArray[intp]) -> _BesideLane:
        """Some of the cells."""
        if len(chosen) == len(self.low):
            return self
        own = {name: getattr(self, name).take(chosen) for name in _BY_CELL}
        return replace(self, **own)

    def sides(self, touched: LaneSets, inward: float) -> Codes:
        """Ego's sides, with others ``inward`` (m) farther in its lane.

        ``touched`` are the sets of lanes that they reach into, by cell.
        """
        reach, sides = self.reach, self.across(touched)
        beside_way = (self.beyond > reach + inward) & (self.clear > reach + inward)
        in_the_way = (self.into > -inward) & (self.clear < inward - reach)
        beside_way &= sides == SAME_LANE
        np.copyto(sides, self.ego_at, where=beside_way)
        np.copyto(sides, SAME_LANE, where=in_the_way)
        return sides

    def across(self, touched: LaneSets) -> Codes:
        """Ego's middle right of others' lanes, in or left of them; of bodies if in no lane."""
        nowhere = touched == 0
        right_of, left_of_all = (touched & self.right_of) == 0, (touched & self.left_of) == 0
        right_of &= ~nowhere | (self.middle <= self.low)
        left_of_all &= ~nowhere | (self.middle >= self.high)
        return _coded(right_of, left_of_all)

    def wavering(self, sets: Sequence[LaneSets], place_m: float) -> NDArray[intp]:
        """The cells whose sides may change with others ``place_m`` (m) farther in and out.

        ``sets`` are the lanes that others then touch; those in between lie between these.
        """
        reach = self.reach
        wavers: Flags = sets[0] != sets[1]
        for values, limit in (
            (self.beyond, reach),
            (self.clear, reach),
            (self.into, 0.0),
            (self.clear, -reach),
        ):
            wavers |= np.abs(values - limit) <= place_m + _HAIR_M
        return wavers.nonzero()[0]


_BY_CELL = tuple(field.name for field in fields(_BesideLane) if field.name != "reach")

_HAIR_M = 1e-6


@once
def _beside_lane(context: DriveContext) -> _BesideLane:
    cells = known_places(context)
    return _beside_lane_shifted(context, np.arange(len(cells)), np.zeros(context.states))


def _beside_lane_shifted(
    context: DriveContext, chosen: NDArray[intp], shift: Floats
) -> _BesideLane:
    """``_beside_lane`` of some known places, with all moved right by ``shift`` (m, by state)."""
    cells = known_places(context)
    if len(chosen) < len(cells):
        cells = cells.part(chosen)
    own, others = context.ego_extents.moved(-shift), context.extents
    # How far left of the two bounds of ego's lane others begin and end
    (low_r, high_r), (low_l, high_l) = others.cells_from_bounds(cells, own.lane[0], own.lane[0] + 1)
    if shift.any():
        by = cells.of(shift)
        low_r, high_r, low_l, high_l = (values - by for values in (low_r, high_r, low_l, high_l))
    own_low, own_high = own.from_middle(own.lane)
    low, high = (low_r + low_l) / 2, (high_r + high_l) / 2
    if shift.any():
        beside = _beside_lane(context)
        clear, ego_at = beside.clear.take(chosen), beside.ego_at.take(chosen)
    else:
        on_left, on_right = low - cells.of(own_high), cells.of(own_low) - high
        clear, ego_at = np.maximum(on_left, on_right), (~(on_left > on_right)).view(int8) * LEFT_OF
    # Bounds ascend to the left: a place right of the first lane is left of no lane's right bound
    return _BesideLane(
        context.thresholds.touching_m,
        right_of=cells.of(lane_sets(own.left_of[..., :-1] > 0)),
        left_of=cells.of(lane_sets(own.left_of[..., 1:] < 0)),
        middle=cells.of((own_low + own_high) / 2),
        low=low,
        high=high,
        into=np.minimum(high_r, -low_l),
        beyond=np.maximum(high_l, -low_r),
        clear=clear,
        ego_at=ego_at,
    )


def _beside_elsewhere(context: DriveContext, offset: Floats) -> NDArray[intp]:
    """The known places whose sides may change if the map is off by ``offset`` (m), by state.

    Not those that stay beside ego's lane, and at its side, while ego stays in it.
    """
    cells, beside, away = known_places(context), _beside_lane(context), np.abs(offset)
    keeps_lane = np.abs(context.ego_extents.left_of[0]).min(axis=1) > away + _HAIR_M
    room = beside.reach + context.tolerances.place_m + cells.of(away) + _HAIR_M
    on_left = beside.low > np.maximum(beside.middle + _HAIR_M, 0.0)
    on_right = beside.high < np.minimum(beside.middle - _HAIR_M, 0.0)
    stays = cells.of(keeps_lane) & (beside.into < -room) & (on_left | on_right)
    return (~stays).nonzero()[0]


@once
def gap(context: DriveContext) -> Floats:
    """The distance (m) along the road between bodies, 0 where they overlap along it."""
    gaps: Floats = np.maximum(way_along(context), 0.0)
    return gaps


@once
def way_along(context: DriveContext) -> Floats:
    """The distance (m) along the road between bodies, negative where they overlap along it."""
    ego, others = context.ego_extents, context.extents
    way: Floats = np.maximum(others.s_min - ego.s_max, ego.s_min - others.s_max)
    return way


@once
def way_across(context: DriveContext) -> Floats:
    """The distance (m) across the road between bodies, negative where they overlap across it."""
    ego, others = context.ego_extents, context.extents
    way: Floats = np.maximum(others.d_min - ego.d_max, ego.d_min - others.d_max)
    return way


@once
def position(context: DriveContext) -> NDArray[np.str_]:
    """The paper's position letters b, f, l and r.

    Pedestrians have a frame of their own. Bodies beside each other in one lane are at each other's
    sides if they overlap across the road by less than along it, and by less than half of the
    narrower one; otherwise their middles decide.
    """
    ego, others = context.ego_extents, context.extents
    walking = context.tracks.of_type("pedestrian").nonzero()[0]
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
    beside, cells = _beside_lane(context), known_places(context)
    row = cells.laid(beside.across(cells.of(touched)), SAME_LANE)
    inside = (row == SAME_LANE) & (column == BESIDE)
    half = np.minimum(ego.d_max - ego.d_min, others.d_max - others.d_min) / 2
    aside = cells.laid(beside.clear, np.nan) > np.maximum(way_along(context), -half)
    at_side = inside & (facing % 2 == 0) & aside
    row, inside = np.where(at_side, cells.laid(beside.ego_at), row), inside & ~at_side
    column = np.where(inside, np.where(ego.s < others.s, BEHIND, IN_FRONT_OF), column)
    tables = np.array([list(PAPER_TABLES[name].decode()) for name in _FACING])
    letters: NDArray[np.str_] = tables[facing, 3 * row + column]
    return letters


def _facing(others: RoadExtents) -> NDArray[intp]:
    """The direction of motion, or the heading at rest, by right angles to the road.

    Indices into ``_FACING``; half-way counts as across the road.
    """
    moves = np.hypot(others.along, others.across) > _STANDS_MPS
    angle = np.where(moves, np.arctan2(others.across, others.along), others.turned)
    angle = np.round(np.degrees(np.nan_to_num(angle)), 6)
    across = np.where(angle > 0, 1, 3)
    return np.where(np.abs(angle) < 45, 0, np.where(np.abs(angle) > 135, 2, across))
