"""Signals of ego's lane changes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.lane_changes.lanes_from_behind import come_into_lane
from rulec.extraction.signals.conduct.lane_changes.squeezing_in import WayIn, squeezed
from rulec.extraction.signals.conduct.lane_changes.turning_round import have_to_brake_for_turn
from rulec.extraction.signals.conduct.leaving_rings import crossed_on_ring
from rulec.extraction.signals.conduct.manoeuvre_signals import (
    beyond_near_edge,
    comes_back_over_middle,
)
from rulec.extraction.signals.conduct.u_turns import swings_round, u_turns
from rulec.extraction.signals.map.junction_signals import lies_askew_in_turn
from rulec.extraction.signals.signal_columns import Caused, ids_by_state
from rulec.extraction.signals.words import word
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.scenario.recorded.route import lanelet_area
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_BACK_S = 0.5
"""Who is back sooner than this (s) may not have changed lanes."""

_JUST_STOOD_S = 1.0
"""A vehicle that stood this recently (s) has not driven over a mark since: it drifted there."""

_FORK_M = 15.0
"""Up to this far behind a fork its lanes overlap, and likewise before two lanes become one."""

_ASTRIDE_S = 1.0
"""Who is across a mark for this long (s) with most of its body may count as having changed."""

_HAIR_M = 0.01


@word("lane_change")
def _lane_change(context: DriveContext) -> Truth:
    """Whether ego has changed lanes; unknown within tolerances, and where ego turns round or off.

    Its body then swings over the lanes of the road that it enters. Unknown, too, where a lane has
    just forked or two become one, since ego may follow either; where ego stands, as its places
    drift; where it is back at once; where its drive begins so near a mark that it may be crossing;
    where it drives astride a mark for a while, more beyond it, and comes back; and where it leaves
    a ring over a lane on which another one goes on.
    """
    changes = _changes(context)
    doubtful = (changes != _changes_from_beside(context)) | _astride(context)
    doubtful |= np.logical_or.reduce(crossed_on_ring(context))
    if changes.any():
        swings = swings_round(context) | u_turns(context).unknown | lies_askew_in_turn(context)
        stands = np.abs(_speed_ahead(context)) * KMH_PER_MPS < context.thresholds.standing_kmh
        doubtful |= _within_tolerance(context, changes) | _there_and_back(context, changes)
        doubtful |= changes & (swings | stands)
        states = (changes & ~doubtful).nonzero()[0]
        own = context.ego_extents.s[0]
        places = (context.road.piece(own[at]).tolist() for at in (states, states - 1))
        for change, piece, before in zip(states.tolist(), *places, strict=True):
            at_once = _at_fork(context, change, piece) or _at_merge(context, change, before)
            doubtful[change] = at_once
    return Truth.known(changes).unknown_at(doubtful)


def _speed_ahead(context: DriveContext) -> Floats:
    """Ego's speed along its heading (m/s), by state: sliding sideways is not driving."""
    own = context.ego_extents
    ahead: Floats = own.along[0] * np.cos(own.turned[0]) + own.across[0] * np.sin(own.turned[0])
    return ahead


def _there_and_back(context: DriveContext, changes: Flags) -> Flags:
    """Mask of changes to a lane and back within ``_JUMP_S``: no vehicle does so, places jump."""
    lane, spans = context.steady_lane, context.spans
    back, states = np.zeros_like(changes), changes.nonzero()[0]
    for first, then in pairwise(states.tolist()):
        returns = spans.number[first] == spans.number[then] and lane[first - 1] == lane[then]
        if returns and (then - first) * context.recording.step_s < _BACK_S:
            back[[first, then]] = True
    return back


def _astride(context: DriveContext) -> Flags:
    """Mask of states in which ego comes a little over a mark, or back after ``_ASTRIDE_S`` there.

    Its middle is beyond the mark by more than its error, yet by less than ``changed_m``.
    """
    lane, steady, spans = context.ego_lane, context.steady_lane, context.spans
    found = np.zeros(context.states, dtype=bool)
    over = (lane != steady).nonzero()[0]
    if not len(over):
        return found
    firsts = ((np.diff(over, prepend=-2) > 1) | spans.begins_here[over]).nonzero()[0]
    beyond = np.abs(context.ego_extents.left_of[0, over, np.maximum(lane, steady)[over]])
    error = context.tolerances.place_m + np.abs(context.map_offset_m)
    surely = beyond > np.broadcast_to(error, found.shape)[over]
    lasts = np.add.reduceat(surely.astype(intp), firsts) * context.recording.step_s >= _ASTRIDE_S
    first, back = over[firsts], over[np.append(firsts[1:], len(over)) - 1] + 1
    within = lasts & (back < spans.end[first])
    first, back = first[within], back[within]
    returns = (lane[back] == steady[back]) & (steady[back] == steady[back - 1])
    found[back[returns]] = True
    found[first[returns & ~spans.begins_here[first]]] = True
    return found


def _at_fork(context: DriveContext, change: int, last: int) -> bool:
    """Whether ego changes between lanes that have forked from one, and may follow one of them.

    The fork is less than ``_FORK_M`` ago, or ego has been on the lane that it changes to ever
    since. ``last`` is the piece of the road that ego is in.
    """
    road, s = context.road, context.ego_extents.s[0]
    before, after = context.steady_lane[change - 1 : change + 1].tolist()
    for piece in range(last, -1, -1):
        one, other = road.rows[piece][before], road.rows[piece][after]
        if one is None or other is None:
            return False
        if set(one.predecessors) & set(other.predecessors):
            begin = float(road.borders[piece])
            return bool(s[change] - begin < _FORK_M) or _has_followed(context, after, begin, change)
    return False


def _at_merge(context: DriveContext, change: int, first: int) -> bool:
    """Whether the lanes that ego changes between become one less than ``_FORK_M`` ahead.

    Or have done so since the state before, in which ego was in the piece ``first`` of the road.
    """
    road, s = context.road, context.ego_extents.s[0]
    before, after = context.steady_lane[change - 1 : change + 1].tolist()
    for piece in range(first, len(road.rows)):
        one, other = road.rows[piece][before], road.rows[piece][after]
        near = float(road.borders[piece + 1]) - s[change] < _FORK_M
        if one is None or other is None or not near:
            return False
        if set(one.successors) & set(other.successors):
            return True
    return False


def _has_followed(context: DriveContext, lane: int, begin_m: float, end: int) -> bool:
    """Whether ego's middle was on a lane's lanelets from a place of the road up to a state."""
    road, own = context.road, slice(int(context.spans.first[end]), end)
    states = own.start + (context.ego_extents.s[0, own] >= begin_m).nonzero()[0]
    points = shapely.points(context.ego.x[0, states], context.ego.y[0, states])
    pieces = road.piece(context.ego_extents.s[0, states])
    for piece in np.unique(pieces).tolist():
        lanelet = road.rows[piece][lane]
        inside = lanelet is not None and shapely.covers(
            lanelet_area(lanelet), points[pieces == piece]
        )
        if not np.all(inside):
            return False
    return True


@word("lane_is_clear")
def _lane_is_clear(context: DriveContext) -> Caused:
    """Whether no vehicle has to brake or make way for ego as it comes into a lane.

    Unknown where the only ones that have to are about to be past, with ego coming in behind them,
    or only reach into its lane from the one beyond. Also where one comes from behind on a lane that
    forks, and it is unknown whether into ego's; if ego stands, or may by its speed, or just stood:
    its places drift across the mark, but nothing stands and changes lanes; and where ego comes into
    the lane only if its drive began as it crossed the mark.
    """
    disturbed = np.zeros(context.relevant.shape, dtype=bool)
    moot, unsure = np.zeros((2, context.states), dtype=bool)
    flagged, ways, is_perhaps = _ways_into_lanes(context)
    if ways:
        states = np.array([way.state for way in ways], dtype=intp)
        brakes = _disturbed(context, states)
        found = brakes.sure
        no_room, maybe_none = squeezed(context, ways)
        in_lane = context.extents.lane[:, states] == context.ego_lane[states]
        in_lane |= found & ~context.in_ego_lane[:, states]
        surely = found & in_lane & ~_pulls_away(context, states) | no_room
        moot[flagged] = ~np.logical_or.reduce(surely)
        # Who is about to be past or only reaches into the lane is not named beside who is in it
        disturbed[:, flagged] = np.where(moot[flagged], found, surely)
        unsure[flagged] = brakes.unknown.any(axis=0) | maybe_none.any(axis=0)
    for_turn = have_to_brake_for_turn(context)
    disturbed |= for_turn.sure
    unsure |= for_turn.unknown.any(axis=0)
    clear: Flags = ~np.logical_or.reduce(disturbed)
    doubtful = unsure
    if not clear.all():
        # Or may stand, by its speed's error
        slowest = context.ego.speed[0] - context.ego.speed_error[0]
        stands = slowest * KMH_PER_MPS < context.thresholds.standing_kmh
        just_stood = context.steps_in(_JUST_STOOD_S)
        stands |= _changes(context) & context.spans.within_last(stands, just_stood)
        only_perhaps = np.zeros_like(clear)
        only_perhaps[flagged[is_perhaps]] = True
        doubtful = np.where(clear, unsure, moot | stands | only_perhaps)
    doubtful |= clear & np.logical_or.reduce(crossed_on_ring(context))
    return Caused(Truth.known(clear).unknown_at(doubtful), ids_by_state(disturbed, context.ids))


def _ways_into_lanes(context: DriveContext) -> tuple[NDArray[intp], list[WayIn], Flags]:
    """The states in which ego comes into another lane, or onto the road, and its ways there.

    It comes onto the road over its near edge, and is there ``changed_m`` farther on; or over its
    far edge, back from the other half. The mask has those on which it only perhaps comes into the
    lane, from its drive's beginning on the mark.
    """
    lane, inside = context.steady_lane, -beyond_near_edge(context)
    changes = _changes(context).nonzero()[0].tolist()
    ways = [_way_between(lane, at) for at in changes]
    there, end = inside >= context.thresholds.changed_m, context.spans.end
    settled = context.spans.next_state(there)
    enters = context.spans.enters(inside >= 0).nonzero()[0]
    flagged = [at for at in enters.tolist() if settled[at] < end[at] and at not in changes]
    to_left = context.side == "right"
    for at in flagged:
        state = int(settled[at])
        ways.append(WayIn(state, int(lane[state]) + (not to_left), to_left=to_left))
    back = comes_back_over_middle(context).nonzero()[0].tolist()
    back = [at for at in back if at not in changes and at not in flagged]
    far = context.lane_edges[to_left]
    ways += [WayIn(at, int(far[at]), to_left=not to_left) for at in back]
    surely = changes + flagged + back
    others = _changes_from_beside(context).nonzero()[0].tolist()
    others = [at for at in others if at not in surely]
    ways += [_way_between(context.steady_lane_from_beside, at) for at in others]
    is_perhaps = np.repeat([False, True], [len(surely), len(others)])
    return np.array(surely + others, dtype=intp), ways, is_perhaps


def _way_between(lanes: NDArray[intp], at: int) -> WayIn:
    """Ego's way into the lane of a state from that of the state before."""
    before, after = int(lanes[at - 1]), int(lanes[at])
    return WayIn(at, max(before, after), to_left=after > before)


def _changes(context: DriveContext) -> Flags:
    """Mask of states in which ego has changed lanes since the state before."""
    return context.spans.changes(context.steady_lane)


def _changes_from_beside(context: DriveContext) -> Flags:
    """``_changes``, assuming that a drive which begins near a mark had just crossed it."""
    return context.spans.changes(context.steady_lane_from_beside)


def _within_tolerance(context: DriveContext, changes: Flags) -> Flags:
    """Mask of changes for which the marks may be so far off that there is no change.

    Before or after it, up to the next change, ego's middle is never farther from the mark.
    """
    lane, left_of = context.steady_lane, context.ego_extents.left_of[0]
    error = context.tolerances.place_m + np.abs(context.map_offset_m)
    least = np.maximum(context.thresholds.changed_m, error)
    unsure, spans = np.zeros_like(changes), context.spans
    for _, columns in spans.those(spans.any(changes)):
        own = (changes[columns].nonzero()[0] + columns.start).tolist()
        borders = [columns.start, *own, columns.stop]
        for begin, at, end in zip(borders[:-2], borders[1:-1], borders[2:], strict=True):
            mark = left_of[begin:end, max(lane[at - 1], lane[at])]
            if lane[at] < lane[at - 1]:
                mark = -mark
            unsure[at] = min(-mark[: at - begin].min(), mark[at - begin :].max()) < least[at]
    return unsure


def _disturbed(context: DriveContext, states: NDArray[intp]) -> Truth:
    """Which vehicles in ego's lane must brake for ego in ``states``.

    A vehicle beside ego must; so must one behind that would have to brake harder than
    ``disturbing_mps2`` after its reaction time to avoid ego, unless it has to brake as hard for one
    in between. Unknown: vehicles whose lane forks in between, so that it is unknown whether they
    come into ego's; and bodies that overlap ego's by half, which are ego's own box seen twice.
    """
    limits = context.thresholds
    station, gap = relations.station(context)[:, states], relations.gap(context)[:, states]
    along, own = context.extents.along[:, states], context.ego_extents.along[:, states]
    faster = np.maximum(along - own, 0.0)
    braking_distance = gap - faster * limits.reaction_s
    too_near = faster**2 > 2 * limits.disturbing_mps2 * np.maximum(braking_distance, 0.0)
    behind = (station == relations.IN_FRONT_OF) & too_near
    behind &= ~_brakes_for_another(context, states, behind)
    brakes = context.going_along[:, states] & (behind | (station == relations.BESIDE))
    cells = Cells.at(brakes)
    comes = come_into_lane(context, cells.rows, states[cells.columns])
    return comes.each(cells.laid).unknown_at(cells.laid(comes.sure) & _lies_in_ego(context, states))


def _lies_in_ego(context: DriveContext, states: NDArray[intp]) -> Flags:
    """Mask of bodies that overlap ego's by half of the smaller one in these states."""
    own, others = context.ego_extents, context.extents
    length, width = (
        np.minimum((high - low)[:, states], (own_high - own_low)[:, states])
        for high, low, own_high, own_low in (
            (others.s_max, others.s_min, own.s_max, own.s_min),
            (others.d_max, others.d_min, own.d_max, own.d_min),
        )
    )
    along, across = (way(context)[:, states] for way in (relations.way_along, relations.way_across))
    flags: Flags = (along < -length / 2) & (across < -width / 2)
    return flags


def _brakes_for_another(context: DriveContext, states: NDArray[intp], behind: Flags) -> Flags:
    """Mask of vehicles behind ego that have to brake as hard for one in between, by ``states``."""
    found = np.zeros_like(behind)
    others, own, reaction_s = context.extents, context.ego_extents, context.thresholds.reaction_s
    for row, number in zip(*(places.tolist() for places in behind.nonzero()), strict=True):
        state = int(states[number])
        speed, front = float(others.along[row, state]), float(others.s_max[row, state])
        between = context.in_ego_lane[:, state] & context.going_along[:, state]
        between &= (others.s_min[:, state] > front) & (others.s_max[:, state] < own.s_min[0, state])
        rears = np.append(others.s_min[between, state], own.s_min[0, state]) - front
        faster = np.maximum(speed - np.append(others.along[between, state], own.along[0, state]), 0)
        left = np.maximum(rears - faster * reaction_s, _HAIR_M)
        hard = faster**2 / left
        found[row, number] = bool((hard[:-1] >= hard[-1]).any())
    return found


def _pulls_away(context: DriveContext, states: NDArray[intp]) -> Flags:
    """Mask of vehicles that reach farther ahead than ego and are past within ``reaction_s``.

    Past means clear of ego if both keep their speeds from these states.
    """
    others, own = context.extents, context.ego_extents
    front, faster = own.s_max[:, states], others.along[:, states] - own.along[:, states]
    left = front - others.s_min[:, states]
    away: Flags = (others.s_max[:, states] > front) & (
        left < faster * context.thresholds.reaction_s
    )
    return away
