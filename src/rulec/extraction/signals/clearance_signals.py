"""Signals of ego's room: oncoming traffic, obstacles, room to pass others, access."""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.presences import presence_cells
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.manoeuvre_signals import about_the_middle, oncoming_side
from rulec.extraction.signals.ego_lanelets import own_lanelets, travel_lanes
from rulec.extraction.signals.signal_columns import OfObjects
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.lane_sets import is_in
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_BESIDE_M = 0.5
"""Extra width (m) that passing a vehicle needs."""

_BESIDE_WALKERS_M = 1.5
"""Extra width (m) that passing people in the road needs; laws ask for 1 m to 2 m or for enough."""

_ALONG = np.cos(np.pi / 4)
"""Cosine of the largest angle to the road at which a pedestrian walks along it, either way."""


@word("oncoming_clear")
def _oncoming_clear(context: DriveContext) -> Truth:
    """Whether oncoming traffic leaves room to overtake, and where that is unknown.

    It does where ego need not leave the lanes of its direction, in the far one of which it may
    already be. Otherwise no oncoming vehicle may meet ego within ``overtaking_s`` at both current
    speeds, or actually meet it within that time; nor, however much later, while ego is still on its
    way over the other half, or within ``yielding_s`` of that. Unknown where one may brake that
    would have met ego there, or where the drive ends before and ego is so fast that a vehicle may
    come from beyond ``near_m``.
    """
    limits = context.thresholds
    own_lanes = (travel_lanes(context).sum(axis=1) > 1) & ~_beyond_own_lanes(context)
    one_way = own_lanelets(context).flags(
        lambda at: context.surroundings.directions(at.id)[0] is True
    )
    alone: Flags = own_lanes | one_way
    own = np.maximum(context.ego_extents.along[0], 0.0)
    steps = context.steps_in(limits.overtaking_s)
    ends = context.spans.columns + steps >= context.spans.end
    far_enough = 2 * own * limits.overtaking_s <= limits.near_m
    present = presence_cells(context)
    against = present.of(context.extents.along) * KMH_PER_MPS < -limits.standing_kmh
    against &= context.tracks.of_type("vehicle")[present.rows]
    cells = present.part(against.nonzero()[0])
    unseen = ends & ~far_enough
    if not len(cells):
        return Truth(~unseen, np.ones_like(unseen)) | alone
    comes = (np.abs(cells.of(context.extents.turned)) > np.pi / 2) & cells.of(context.relevant)
    cells = cells.part(comes.nonzero()[0])
    columns, station = cells.columns, cells.of(relations.station(context))
    closing: Floats = np.maximum(own[columns] - cells.of(context.extents.along), 0.1)
    left_s = np.where(
        station == relations.BEHIND, cells.of(relations.gap(context)) / closing, np.inf
    )
    met, meets, soon = map(
        cells.in_columns,
        (station == relations.BESIDE, left_s < limits.overtaking_s, left_s < limits.yielding_s),
    )
    meets |= context.spans.within(met, steps) | _meets_beyond_middle(context, met | soon)
    unsure = unseen | _may_brake_for_ego(context, cells)
    return Truth(~meets & ~unsure, ~meets) | alone


def _may_brake_for_ego(context: DriveContext, cells: Cells) -> Flags:
    """Mask of states in which ego is on its way over the other half and may make a vehicle brake.

    One of those in ``cells``, who come, may then brake harder than ``disturbing_mps2``, and at its
    fastest speed in that stretch would meet ego there or within ``yielding_s`` of it.
    """
    limits, tracks, spans = context.thresholds, context.tracks, context.spans
    least = -limits.disturbing_mps2
    hard = cells.of(tracks.acceleration) - cells.of(tracks.acceleration_error) < least
    hard &= cells.of(relations.station(context)) == relations.BEHIND
    braked = np.zeros(context.states, dtype=bool)
    if not hard.any():
        return braked
    there = oncoming_side(context).sure
    away = about_the_middle(context)
    back, since = spans.next_state(~away), spans.latest(~away)
    until_s = (back - np.arange(context.states)) * context.recording.step_s + limits.yielding_s
    cells = cells.part((hard & (spans.latest(there) > since)[cells.columns]).nonzero()[0])
    gaps = cells.of(relations.gap(context))
    for row, column, gap in zip(cells.rows, cells.columns, gaps, strict=True):
        # It may have appeared only meanwhile
        fastest = -np.nanmin(context.extents.along[row, since[column] + 1 : column + 1])
        closing = max(context.ego_extents.along[0, column] + fastest, 0.1)
        braked[column] |= gap / closing < until_s[column]
    flags: Flags = away & (spans.next_state(braked) < back)
    return flags


def _meets_beyond_middle(context: DriveContext, meets: Flags) -> Flags:
    """Mask of states in which ego is on its way over the other half and meets a vehicle there.

    From the start of that stretch, as ego should have seen that it would not be back in time.
    """
    if not meets.any():
        return meets
    there = oncoming_side(context).sure
    away, spans = about_the_middle(context), context.spans
    meets = meets & away & (spans.latest(there) > spans.latest(~away))
    flags: Flags = away & (spans.next_state(meets) < spans.next_state(~away))
    return flags


def _beyond_own_lanes(context: DriveContext) -> Flags:
    """Mask of states in which ego reaches over the far edge of the lanes of its direction."""
    first, end = context.lane_edges
    own, touching = context.ego_extents, context.thresholds.touching_m
    left, right = own.from_bound(end)[1][0], -own.from_bound(first)[0][0]
    beyond: Flags = (left if context.side == "right" else right) > touching
    return beyond


@word("obstructed")
def _obstructed(context: DriveContext) -> Truth:
    """Whether an obstacle in one of ego's lanes leaves no room there, and where that is unknown.

    Obstacles stand ahead, beside ego, or so near behind it that ego may still be on its way back;
    pedestrians who walk along in the lane count, too. Unknown where ego may be on its way round
    one, as ``_on_the_way_round`` says.
    """
    used = context.ego_extents.inside[0] > 0
    used[np.arange(context.states), context.ego_lane] = True
    blocked, on_the_way = np.zeros((2, context.states), dtype=bool)
    cells, needed = _obstacles(context)
    if not len(cells):
        return Truth.known(blocked)
    own = context.ego_extents
    needed += cells.of(own.d_max[0] - own.d_min[0])
    near, sets = _near_obstacle(context, cells), cells.of(context.lanes_within[0])
    for lane in range(used.shape[1]):
        (low, _), (_, high) = context.extents.cells_from_bounds(cells, lane, lane + 1)
        there = is_in(sets, lane) & (np.maximum(low, -high) < needed)
        blocked |= cells.in_columns(there & near & cells.of(used[:, lane]))
        bodies = cells.part(there.nonzero()[0])
        on_the_way |= _on_the_way_round(context, bodies, lane, used[:, lane])
    return Truth(blocked, blocked | on_the_way)


def _obstacles(context: DriveContext) -> tuple[Cells, Floats]:
    """The cells of those that stand, or walk along the road, and the room (m) beside each."""
    present = presence_cells(context)
    stands = present.of(context.standing)
    walks = context.tracks.of_type("pedestrian")[present.rows]
    walks &= np.abs(np.cos(present.of(context.extents.turned))) >= _ALONG
    chosen = ((stands | walks) & present.of(context.relevant)).nonzero()[0]
    return present.part(chosen), np.where(walks[chosen], _BESIDE_WALKERS_M, _BESIDE_M)


def _on_the_way_round(context: DriveContext, obstacles: Cells, lane: int, used: Flags) -> Flags:
    """Mask of states in which ego may be on its way round an obstacle in a lane that it left.

    After it, while ego reaches into that lane: ``used``. Before, beside and after it, while ego is
    in the next lane alone; there only those count that never move or that walk: others may wait in
    a queue, and who drives past a queue goes round nothing.
    """
    limits, own = context.thresholds, context.ego_extents
    step_s = context.recording.step_s
    # In a single step ego may get from behind an obstacle to in front of it
    way = np.abs(obstacles.of(own.along[0])) * step_s
    obstacles = obstacles.part((obstacles.of(relations.gap(context)) <= way).nonzero()[0])
    found = np.zeros(context.states, dtype=bool)
    if not len(obstacles):
        return found
    touched = own.inside[0] > limits.touching_m
    low, high = own.left_of_min[0, :, lane], own.left_of_max[0, :, lane + 1]
    within = touched[:, lane] & (np.maximum(-low, high) <= limits.touching_m)
    next_lanes = [other for other in (lane - 1, lane + 1) if 0 <= other < touched.shape[1]]
    is_next = (touched.sum(axis=1) == 1) & touched[:, next_lanes].any(axis=1)
    steps, spans = round((limits.passed_s + limits.parting_s) / step_s), context.spans
    rows, keeps_place = obstacles.rows, context.stays | context.tracks.of_type("pedestrian")
    for counting, states, ahead in (
        (np.ones(len(rows), dtype=bool), used, False),
        (keeps_place[rows], is_next, True),
    ):
        passed = _passed_from(context, obstacles.in_columns(counting), within, steps)
        near = spans.within_last(passed, steps) & (spans.latest(passed) > spans.latest(within))
        if ahead:
            soon = spans.next_state(passed) < spans.next_state(within)
            near |= soon & spans.within(passed, steps)
        found |= states & near
    return found


def _passed_from(context: DriveContext, passed: Flags, within: Flags, steps: int) -> Flags:
    """Those of the states in which ego has ``passed`` obstacles for which it has left their lane.

    No more than ``steps`` lie between the last state ``within`` that lane, or the drive's start,
    and the first obstacle, nor between two of them. Ego is in that lane before or after them.
    """
    spans = context.spans
    since = within | spans.begins_here
    for_others = ~spans.within_last(passed | since, steps)
    comes, goes = spans.latest(within) >= spans.first, spans.next_state(within) < spans.end
    linked: Flags = spans.latest(for_others) < spans.latest(since)
    return passed & ~within & linked & (comes | goes)


def _near_obstacle(context: DriveContext, cells: Cells) -> Flags:
    """Mask of cells of standing or walking participants that ego goes round now.

    For pedestrians, and for participants that never move, ego goes out earlier; from pedestrians,
    who are passed at full speed, it also needs that long to get back.
    """
    gap, along = cells.of(relations.gap(context)), context.ego_extents.along[0]
    near: Flags = gap <= context.thresholds.obstacle_m
    early = ~near & (gap <= along[cells.columns] * context.thresholds.parting_s)
    near |= early & context.tracks.of_type("pedestrian")[cells.rows]
    early &= cells.of(relations.station(context)) == relations.BEHIND
    early &= cells.of(context.standing)
    rows, never_moves = np.unique(cells.rows[early]), np.zeros(len(context.relevant), dtype=bool)
    never_moves[rows] = context.stays[rows]
    near |= early & never_moves[cells.rows]
    return near


@word("room_on_near_side")
def _room_on_near_side(context: DriveContext) -> OfObjects:
    """Whether participants leave room for ego between them and the road's near edge."""
    first, end = context.lane_edges
    others, right = context.extents, context.side == "right"
    room = others.from_bound(first)[0] if right else -others.from_bound(end)[1]
    width = context.ego_extents.d_max[0] - context.ego_extents.d_min[0] + _BESIDE_M
    return OfObjects(room >= width, context.tracks.of_type("road_user"))


@word("needs_access")
def _needs_access(context: DriveContext) -> Truth:
    """Whether ego turns off within ``access_s``; and where its drive ends too early to know."""
    steps = context.steps_in(context.thresholds.access_s)
    turns = np.zeros(context.states, dtype=bool)
    least = np.radians(context.thresholds.turned_deg)
    own, spans = context.own, context.spans
    for row, columns in zip(context.ego.rows.tolist(), spans.slices, strict=True):
        numbers = context.steps[columns] - own.tracks.first
        for passage in own.passages.of_row.get(row, ()):
            if abs(own.passages.way(passage).turned) > least:
                turns[columns] |= (numbers >= passage.first - steps) & (numbers <= passage.last)
    ends = spans.columns + steps >= spans.end
    return Truth(turns, turns | ends)
