"""Signals of the room that ego has: oncoming traffic, obstacles, ways past others, access."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.presences import presence_cells
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.manoeuvre_signals import on_both_halves, oncoming_side
from rulec.extraction.signals.ego_lanelets import own_lanelets, travel_lanes
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.signals.signal_passes import SignalPasses
from rulec.extraction.tracks.lane_sets import is_in
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.trace.cells import Cells
from rulec.trace.plain_arrays import distinct

_BESIDE_M = 0.5
"""A vehicle needs so much more room than it is wide."""

_BESIDE_WALKERS_M = 1.5
"""So much more it needs past people in the road: laws ask for 1 m to 2 m, or for enough."""

_ALONG = np.cos(np.pi / 4)
"""Who walks at no more than that angle to the road walks along it, either way."""


def _for_overtaking(context: DriveContext) -> SignalColumns:
    clear, unknown = _oncoming_clear(context)
    return SignalColumns({"oncoming_clear": clear}, unknown={"oncoming_clear": unknown})


def _in_own_lanes(context: DriveContext) -> SignalColumns:
    return SignalColumns({"obstructed": _obstructed(context)})


def _for_access(context: DriveContext) -> SignalColumns:
    access, open_end = _needs_access(context)
    return SignalColumns({"needs_access": access}, unknown={"needs_access": open_end})


def _on_near_side(context: DriveContext) -> SignalColumns:
    return SignalColumns(
        about={"room_on_near_side": _room_on_near_side(context)},
        only={"room_on_near_side": context.tracks.of_type("road_user")},
    )


def _oncoming_clear(context: DriveContext) -> tuple[Flags, Flags]:
    """Does what comes towards ego leave room to overtake, and where is that unknown?

    It does where ego need not leave the lanes of its direction, on the far one of which it may be
    already. Else nobody that comes would meet ego within ``overtaking_s``, as fast as both are, nor
    does meet it; nor, however much later, while it is still on its way over the other half, or
    within ``yielding_s`` of that. Where the drive ends before, and ego is so fast that somebody may
    come from beyond ``near_m``, it is unknown.
    """
    limits = context.thresholds
    own_lanes = (travel_lanes(context).sum(axis=1) > 1) & ~_beyond_own_lanes(context)
    one_way = own_lanelets(context).flags(lambda at: context.surroundings.directions(at)[0] is True)
    alone = own_lanes | one_way
    own = np.maximum(context.ego_extents.along[0], 0.0)
    steps = round(limits.overtaking_s / context.recording.step_s)
    ends = context.spans.columns + steps >= context.spans.end
    far_enough = 2 * own * limits.overtaking_s <= limits.near_m
    present = presence_cells(context)
    against = present.of(context.extents.along) * KMH < -limits.standing_kmh
    against &= context.tracks.of_type("vehicle")[present.rows]
    cells = present.part(against.nonzero()[0])
    if not len(cells):
        return np.ones(context.states, dtype=bool), ends & ~alone & ~far_enough
    comes = (np.abs(cells.of(context.extents.turned)) > np.pi / 2) & cells.of(context.relevant)
    cells = cells.part(comes.nonzero()[0])
    columns, station = cells.columns, cells.of(relations.station(context))
    closing: Floats = np.maximum(own[columns] - cells.of(context.extents.along), 0.1)
    left_s = np.where(
        station == relations.BEHIND, cells.of(relations.gap(context)) / closing, np.inf
    )
    met, meets, soon = np.zeros((3, context.states), dtype=bool)
    met[columns[station == relations.BESIDE]] = True
    meets[columns[left_s < limits.overtaking_s]] = True
    soon[columns[left_s < limits.yielding_s]] = True
    meets |= context.spans.within(met, steps) | _meets_beyond_middle(context, met | soon)
    return alone | ~meets, ~alone & ~meets & ends & ~far_enough


def _meets_beyond_middle(context: DriveContext, meets: Flags) -> Flags:
    """Flags of states in which ego is on its way over the other half, on which it meets another.

    From when it begins to be there, as it should have seen that it would not be back in time.
    """
    if not meets.any():
        return meets
    there, _ = oncoming_side(context)
    away, spans = there | on_both_halves(context), context.spans
    meets = meets & away & (spans.latest(there) > spans.latest(~away))
    flags: Flags = away & (spans.next_state(meets) < spans.next_state(~away))
    return flags


def _beyond_own_lanes(context: DriveContext) -> Flags:
    """Flags of states in which ego reaches over the far edge of the lanes of its direction."""
    first, end = _edges(context)
    own, touching = context.ego_extents, context.thresholds.touching_m
    left, right = own.from_bound(end)[1][0], -own.from_bound(first)[0][0]
    beyond: Flags = (left if context.side == "right" else right) > touching
    return beyond


def _edges(context: DriveContext) -> tuple[NDArray[intp], NDArray[intp]]:
    """The first and the last bound of the lanes beside ego, by state."""
    there = context.existing_lanes
    return there.argmax(axis=1), there.shape[1] - there[:, ::-1].argmax(axis=1)


def _obstructed(context: DriveContext) -> Flags:
    """Flags of states in which what stands in a lane that ego is in leaves no room within it.

    Ahead, beside ego, or so near behind it that ego may still be on its way back. So do people who
    walk along in it.
    """
    own = context.ego_extents
    width = own.d_max[0] - own.d_min[0]
    used = own.inside[0] > 0
    used[np.arange(context.states), context.ego_lane] = True
    blocked, present = np.zeros(context.states, dtype=bool), presence_cells(context)
    stands = present.of(context.tracks.speed) * KMH < context.thresholds.standing_kmh
    walking = context.tracks.of_type("pedestrian")
    maybe = present.part((stands | walking[present.rows]).nonzero()[0])
    if not len(maybe):
        return blocked
    maybe = maybe.part(_near_obstacle(context, maybe).nonzero()[0])
    if not len(maybe):
        return blocked
    stands = maybe.of(context.tracks.speed) * KMH < context.thresholds.standing_kmh
    walks = walking[maybe.rows]
    walks &= np.abs(np.cos(maybe.of(context.extents.turned))) >= _ALONG
    needed = np.where(walks, _BESIDE_WALKERS_M, _BESIDE_M)
    chosen = ((stands | walks) & maybe.of(context.relevant)).nonzero()[0]
    cells, needed = maybe.part(chosen), needed[chosen]
    sets, columns = cells.of(context.lanes_within[0]), cells.columns
    for lane in range(used.shape[1]):
        there = (is_in(sets, lane) & used[columns, lane]).nonzero()[0]
        if not len(there):
            continue
        part, bound = cells.part(there), np.full(context.states, lane)
        low, _ = context.extents.cells_from_bound(part, bound)
        _, high = context.extents.cells_from_bound(part, bound + 1)
        room = width[part.columns] + needed[there]
        blocked[part.columns[np.maximum(low, -high) < room]] = True
    return blocked


def _near_obstacle(context: DriveContext, cells: Cells) -> Flags:
    """Flags of cells of who stands or walks, whom ego goes round now.

    For one that never moves it goes out earlier.
    """
    gap, along = cells.of(relations.gap(context)), context.ego_extents.along[0]
    near: Flags = gap <= context.thresholds.obstacle_m
    reach = along[cells.columns] * context.thresholds.parting_s
    early = ~near & (gap <= reach) & (cells.of(relations.station(context)) == relations.BEHIND)
    walks = context.tracks.of_type("pedestrian")[cells.rows]
    near |= early & walks
    early &= cells.of(context.tracks.speed) * KMH < context.thresholds.standing_kmh
    rows, never_moves = distinct(cells.rows[early]), np.zeros(len(context.relevant), dtype=bool)
    never_moves[rows] = relations.stays(context, rows)
    near |= early & never_moves[cells.rows]
    return near


def _room_on_near_side(context: DriveContext) -> Flags:
    """Flags of participants that leave room for ego between them and the near edge of the road."""
    first, end = _edges(context)
    others, right = context.extents, context.side == "right"
    room = others.from_bound(first)[0] if right else -others.from_bound(end)[1]
    width = context.ego_extents.d_max[0] - context.ego_extents.d_min[0] + _BESIDE_M
    enough: Flags = room >= width
    return enough


def _needs_access(context: DriveContext) -> tuple[Flags, Flags]:
    """Does ego turn off within ``access_s``, and where is that unknown as its drive ends before?"""
    steps = round(context.thresholds.access_s / context.recording.step_s)
    turns = np.zeros(context.states, dtype=bool)
    least = np.radians(context.thresholds.turned_deg)
    own, spans = context.own, context.spans
    for row, columns in zip(context.ego.rows.tolist(), spans.slices, strict=True):
        numbers = context.steps[columns] - own.tracks.first
        for passage in own.passages.of_row.get(row, ()):
            if abs(own.passages.way(passage).turned) > least:
                turns[columns] |= (numbers >= passage.first - steps) & (numbers <= passage.last)
    ends = spans.columns + steps >= spans.end
    return turns, ends & ~turns


clearance_signals = SignalPasses(
    {
        ("oncoming_clear",): _for_overtaking,
        ("obstructed",): _in_own_lanes,
        ("needs_access",): _for_access,
        ("room_on_near_side",): _on_near_side,
    }
)
"""The signals of what leaves ego room to go on, to overtake, and to pass."""
