"""Signals of traffic flow around ego: queues, congestion, overtaking.

All of it counts the vehicles that go ego's way on its lanes, ego among them, as queues do.
"""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext, once
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.manoeuvre_signals import oncoming_side
from rulec.extraction.signals.ego_lanelets import own_lanelets, travel_lanes
from rulec.extraction.signals.map.junction_signals import turn_at
from rulec.extraction.signals.map.roundabout_signals import roundabouts
from rulec.extraction.signals.queues import (
    LOOSE,
    MEASURED,
    READINGS,
    STRICT,
    VehiclesAround,
    close_by,
    lanes_that_decide,
    longest_gaps,
    queues_by_lane,
    vehicles_around,
)
from rulec.extraction.signals.signal_columns import SignalColumns, SignalNames, ids_by_state
from rulec.extraction.signals.signal_passes import Passes, signals_by
from rulec.extraction.tracks.road_extents import is_in
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.recordings.recording import JOINING
from rulec.trace.plain_arrays import distinct, medians_hold

_DRIFT_MPS = 0.2
"""Who moves sideways by less keeps its lane."""

TIMES_AS_FAST = 2.0
"""A lane on which several are so many times as fast as slow traffic flows."""

_RAMPS = frozenset({JOINING, "exitRamp"})
"""Types of lanes to join from or to leave by, beside those that go on."""

_SETS_OFF_MPS2 = 2.0
"""Vehicles gain speed about so hard when they set off."""

_JAM_S = 10.0
"""Traffic that has been slow for less may be so where somebody pulls in or turns off."""

_CRAWLS_MPS = 5.5
"""Who is as slow and gains speed sets off, though it has not quite stood."""


def flow_signals(context: DriveContext, names: SignalNames = None) -> SignalColumns:
    """The signals of traffic as a whole, those of the names."""
    return signals_by(_PASSES, context, names)


def _slow_traffic(context: DriveContext) -> SignalColumns:
    """Whether traffic is slow as a whole, and no lane flows beside the others, nor all but ego's.

    Who queues to leave, beside lanes on which traffic flows or nobody is, is in no jam of the road:
    that is on half of its lanes or more. Unknown on no more than half, where one may wait to turn,
    those in junctions left out, and for ego if nobody is ahead of it: it may be what the others
    wait for. Nor is it a jam yet that came up less than ``_JAM_S`` ago.
    """
    around, limits, states = vehicles_around(context), context.thresholds, context.states
    existing = travel_lanes(context)
    shape, several = existing.shape[::-1], existing.sum(axis=1)
    enough = np.bincount(around.state, minlength=states) >= limits.fewest
    crosses = np.zeros(len(around.state), dtype=bool)
    for start, end in context.road.junctions:
        crosses |= (around.s_max > start) & (around.s_min < end)

    def used_by(own: Flags) -> NDArray[intp]:
        on_lanes = np.bincount(around.place[own], minlength=existing.size).reshape(shape) > 0
        used: NDArray[intp] = (on_lanes.T & existing).sum(axis=1)
        return used

    def slow(below_kmh: float) -> tuple[Flags, Flags]:
        own = around.speed * KMH < below_kmh
        called: Flags = enough & (2 * used_by(own) >= several)
        asked = np.flatnonzero(called[around.state])
        if len(asked):
            called &= _is_slow(context, around, asked, below_kmh)
        return called, called & (several > 1) & (2 * used_by(own & ~crosses) <= several)

    (congested, part), (walking, part_walks) = (
        slow(below) for below in (limits.congested_kmh, limits.walking_pace_kmh)
    )
    moot = np.zeros(states, dtype=bool)
    if congested.any():
        moot = np.isinf(_gap_in_lane(context, relations.BEHIND)) | _comes_up(context, congested)
    unknown = congested & (part | moot)
    return SignalColumns(
        {"congested": congested, "CONGESTED": congested, "walking_pace_flow": walking},
        unknown={
            "congested": unknown,
            "CONGESTED": unknown,
            "walking_pace_flow": walking & (part_walks | moot),
        },
    )


def _comes_up(context: DriveContext, slow: Flags) -> Flags:
    """Flags of states up to ``_JAM_S`` after traffic was not slow, as far as that is recorded.

    Where all traffic is, ego was not in any before its drive began.
    """
    spans, before = context.spans, context.spans.latest(~slow)
    ago_s = (spans.columns - before) * context.recording.step_s
    told = (before >= spans.first) | ("light" in context.recording.complete)
    comes_up: Flags = told & (ago_s < _JAM_S)
    return comes_up


def _is_slow(
    context: DriveContext, around: VehiclesAround, asked: NDArray[intp], below_kmh: float
) -> Flags:
    """Flags of states in which traffic is slower than so much, and nowhere so many times as fast.

    By all vehicles in states that are asked about, at places among all. Nobody is on no lane, nor
    one alone where traffic flows freely.
    """
    states, lanes = context.states, context.existing_lanes.shape[1]
    state, speed = around.state[asked], around.speed[asked]

    def are_below(limit_kmh: float, groups: NDArray[intp], speed: Floats, count: int) -> Flags:
        return medians_hold(groups, speed, count, lambda own: own * KMH < limit_kmh)

    fast_kmh, place = TIMES_AS_FAST * below_kmh, around.place[asked]
    few = np.bincount(place, minlength=states * lanes) <= 1
    on_lanes = (few | are_below(fast_kmh, place, speed, len(few))).reshape(lanes, states)
    aside = np.flatnonzero(around.lane[asked] != context.ego_lane[state])
    alone = np.bincount(state[aside], minlength=states) <= 1
    beside = alone | are_below(fast_kmh, state[aside], speed[aside], states)
    slow: Flags = are_below(below_kmh, state, speed, states) & on_lanes.all(axis=0) & beside
    return slow


def _dense_all_lanes(context: DriveContext) -> SignalColumns:
    dense, _, not_told = _dense_lines(context)
    return SignalColumns({"dense_all_lanes": dense}, unknown={"dense_all_lanes": not_told})


def _far_lane_queue(context: DriveContext) -> SignalColumns:
    queues, are_slow = queues_by_lane(context)
    slow = queues & are_slow
    queue, fewer = (_beside(context, slow[reading]) for reading in (MEASURED, STRICT))
    # Whether one farther out is the queue beside ego's lane depends on who is passed
    more = _at_far_side(context, slow[LOOSE])
    return SignalColumns({"far_lane_queue": queue}, unknown={"far_lane_queue": more & ~fewer})


def _own_lane_queue(context: DriveContext) -> SignalColumns:
    """Whether ego is in a slow queue, by its lane; for all that is as wrong as may be, too."""
    queues, are_slow = queues_by_lane(context)
    slow = queues & are_slow
    queue, fewer, more = (
        slow[reading][np.arange(context.states), context.ego_lane] for reading in READINGS
    )
    return SignalColumns({"own_lane_queue": queue}, unknown={"own_lane_queue": more & ~fewer})


def _overtaking(context: DriveContext) -> SignalColumns:
    """Whether ego overtakes, on the oncoming side from where it goes there until it is back.

    Unknown of who goes there behind another and back: it may have given up.
    """
    overtakes, unsure = _overtakes(context)
    there, perhaps = oncoming_side(context)
    if (side := there | perhaps).any():
        overtakes = overtakes | _meanwhile(context, overtakes, side)
        unsure = unsure | _meanwhile(context, unsure | _close_behind(context), side)
    return SignalColumns({"overtaking": overtakes}, unknown={"overtaking": unsure & ~overtakes})


def _meanwhile(context: DriveContext, flags: Flags, during: Flags) -> Flags:
    """Flags of states at most ``catching_up_s`` from a flagged one, ``during`` all between."""
    spans, held = context.spans, flags & during
    horizon = round(context.thresholds.catching_up_s / context.recording.step_s)
    before, after = spans.latest(held), spans.next_state(held)
    earlier = (before > spans.latest(~during)) & (before >= spans.columns - horizon)
    later = (after < spans.next_state(~during)) & (after <= spans.columns + horizon)
    return earlier | later


def _close_behind(context: DriveContext) -> Flags:
    """Flags of states in which ego would be at one in the lanes beside it soon, if that stood."""
    far, _ = _sides(context)
    reach = context.ego_extents.along * context.thresholds.signalling_s
    near = (relations.gap(context) <= reach) & (relations.station(context) == relations.BEHIND)
    near &= (relations.lateral(context) == far) & context.driving_along
    close: Flags = near.any(axis=0)
    return close


def _begins_to_overtake(context: DriveContext) -> SignalColumns:
    """Whether ego overtakes within ``parting_s``, so that it pulls out for that by now.

    Unknown where the drive ends before.
    """
    overtakes, unsure = _overtakes(context)
    horizon = round(context.thresholds.parting_s / context.recording.step_s)
    spans = context.spans
    begins, perhaps = (spans.within(flags, horizon) for flags in (overtakes, overtakes | unsure))
    moves_out = np.abs(context.ego_extents.across[0]) > _DRIFT_MPS
    ends = moves_out & (spans.columns + horizon >= spans.end)
    return SignalColumns(
        {"begins_to_overtake": begins}, unknown={"begins_to_overtake": (perhaps | ends) & ~begins}
    )


def _being_overtaken(context: DriveContext) -> SignalColumns:
    by, open_end = _overtaken(context)
    # Who is about to join gets up speed for it, beside others on the lanes that go on; who leaves
    # may be faster than they, too (StVO § 7a), and many lanes between ramps serve for both
    on_ramp = own_lanelets(context).flags(lambda at: not at.types.isdisjoint(_RAMPS))
    by, open_end = by & ~on_ramp, open_end & ~on_ramp
    overtaken = by.any(axis=0)
    dense, surely, not_told = _dense_lines(context)
    # Lanes that move off beside each other do not overtake, and who has joined gets up speed yet
    joined = _was(context, on_ramp) | _was(context, _comes_round(context))
    moot = _sets_off(context) | _recovers(context) | joined | not_told
    # Where all lanes queue, one that is faster does not overtake (Vienna, Art. 11(6)(a))
    return SignalColumns(
        {"being_overtaken": ~dense & overtaken},
        unknown={"being_overtaken": ~surely & np.where(overtaken, moot, open_end)},
        whom={"being_overtaken": ids_by_state(by, context.ids)},
    )


@once
def _dense_lines(context: DriveContext) -> tuple[Flags, Flags, Flags]:
    """Flags of states with queues on all lanes, surely so, and of those where nobody knows."""
    queues, _ = queues_by_lane(context)
    lanes = travel_lanes(context)
    decides = lanes & (lanes_that_decide(context) | queues)
    all_queue = np.logical_and((queues | ~decides).all(axis=-1), decides.any(axis=-1))
    # What a few lanes are is not told of the others, but where the world of all of them ends
    few = 2 * decides.sum(axis=-1) < lanes.sum(axis=-1)
    whole = "light" in context.recording.complete
    all_queue &= ~(few & whole)
    # Whom nobody is ahead of goes as fast as it likes, unless that one is not recorded any more
    gap, gap_behind = (
        _gap_in_lane(context, side) for side in (relations.BEHIND, relations.IN_FRONT_OF)
    )
    cut_off = all_queue[LOOSE] & np.isinf(gap) & (not whole)
    speed = context.ego_extents.along[0]
    longest = longest_gaps(context, speed, context.ego.speed_error[0])
    dense, surely, perhaps = (
        all_queue[reading] & (gap <= longest[reading]) for reading in READINGS
    )
    # Nor is there a queue where the world ends, whose traffic is all recorded
    nobody_knows = ~decides[MEASURED].any(axis=-1) & (not whole)
    # And who is last behind a queue may be in it or not
    surely &= ~few[MEASURED] & (gap_behind <= longest[LOOSE])
    return dense, surely, (perhaps | dense) & ~surely | cut_off | nobody_knows


def _gap_in_lane(context: DriveContext, station: int) -> Floats:
    """The gap (m) to the next one in ego's lane to whom ego has this station, by state.

    As far as traffic reaches, infinity without any.
    """
    own_lane = context.extents.lane == context.ego_lane
    there = close_by(context) & (relations.station(context) == station) & own_lane
    gap: Floats = np.where(there, relations.gap(context), np.inf).min(axis=0, initial=np.inf)
    return gap


def _was(context: DriveContext, there: Flags) -> Flags:
    """Flags of states in which ego was somewhere up to ``setting_off_s`` ago."""
    spans, last = context.spans, context.spans.latest(there)
    ago = (spans.columns - last) * context.recording.step_s
    was_there: Flags = (last >= spans.first) & (ago < context.thresholds.setting_off_s)
    return was_there


def _recovers(context: DriveContext) -> Flags:
    """Flags of states in which ego was faster up to ``setting_off_s`` ago: it had to brake."""
    speed = context.ego.speed[0]
    steps = round(context.thresholds.setting_off_s / context.recording.step_s)

    def fastest(columns: slice) -> Floats:
        before = np.concatenate((np.full(steps, -np.inf), speed[columns]))
        longest: Floats = np.lib.stride_tricks.sliding_window_view(before, steps + 1).max(axis=1)
        return longest

    recovers: Flags = speed + context.tolerances.speed_mps < context.spans.each(fastest)
    return recovers


def _comes_round(context: DriveContext) -> Flags:
    """Flags of states in which ego's middle is in a junction where it turns, or joins a ring."""
    middle, inside = context.ego_extents.s[0], np.zeros(context.states, dtype=bool)
    rings = [begins for begins, _, at_junction in roundabouts(context) if at_junction]
    for start, end in context.road.junctions:
        if start in rings or turn_at(context, start, end) != "straight_on":
            inside |= (middle >= start) & (middle <= end)
    return inside


def _gains_speed(context: DriveContext) -> Flags:
    """Flags of states in which ego is faster than ``smoothing_s`` before, or than at first."""
    speed, spans = context.ego.speed[0], context.spans
    steps = max(round(context.thresholds.smoothing_s / context.recording.step_s), 1)
    gains: Flags = speed > speed[np.maximum(spans.columns - steps, spans.first)]
    return gains | (spans.columns - spans.first < steps)


def _sets_off(context: DriveContext) -> Flags:
    """Flags of states in which ego has, or may have, set off, and gets up speed yet.

    It stood up to ``setting_off_s`` ago, or was no faster than ``_CRAWLS_MPS`` then or since when
    it has gained speed. Before its drive began it may have stood, if ``_SETS_OFF_MPS2`` has made it
    as fast as it is then; where all traffic is recorded, if that is no faster than one that crawls.
    """
    limits, speed, step_s = context.thresholds, context.ego.speed[0], context.recording.step_s
    spans, stood = context.spans, context.spans.latest(speed <= _CRAWLS_MPS).astype(float)
    at_first = speed[spans.first]
    before = spans.first - np.ceil(at_first / _SETS_OFF_MPS2 / step_s)
    if "light" in context.recording.complete:
        before = np.where(at_first <= _CRAWLS_MPS, before, -np.inf)
    gaining = stood > spans.latest(~_gains_speed(context))
    stood = np.where(stood < spans.first, before, stood)
    sets_off: Flags = gaining | ((spans.columns - stood) * step_s < limits.setting_off_s)
    return sets_off


def _at_far_side(context: DriveContext, lanes: Flags) -> Flags:
    """Whether a lane of those flagged lies at ego's far side, by state."""
    number, own = np.arange(lanes.shape[1]), context.ego_lane[:, None]
    far = number > own if context.side == "right" else number < own
    there: Flags = np.any(lanes & far, axis=1)
    return there


def _beside(context: DriveContext, lanes: Flags) -> Flags:
    lane = context.ego_lane + (1 if context.side == "right" else -1)
    inside = (lane >= 0) & (lane < lanes.shape[1])
    beside: Flags = inside & lanes[np.arange(context.states), np.clip(lane, 0, lanes.shape[1] - 1)]
    return beside


def _overtakes(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of ego overtaking a slower vehicle, and of it perhaps doing so.

    Who overtakes is at the far side, from shortly before it is beside the other until it is just
    past.
    """
    far, _ = _sides(context)
    slower: Flags = context.extents.along < context.ego_extents.along
    slower &= (relations.lateral(context) == far) & context.driving_along
    cells = slower.nonzero()
    beside = relations.station(context)[cells] == relations.BESIDE
    surely, perhaps = (_ahead_and_past(context, cells, tolerances) for tolerances in (0.0, 1.0))
    overtakes, unsure = np.zeros((2, context.states), dtype=bool)
    overtakes[cells[1][surely | beside]] = True
    unsure[cells[1][perhaps]] = True
    return overtakes, unsure


def _overtaken(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of those who overtake ego, and of states after which nobody knows whether one does.

    Who overtakes ego is with its middle on the next lane at the far side, clearly faster, and gets
    past within ``catching_up_s``. Nobody knows of one that is lost from sight before, that falls
    back first (whoever gives up and tries again overtakes but once), or that only reaches into that
    lane.
    """
    limits, station = context.thresholds, relations.station(context)
    _, near = _sides(context)
    faster_mps = context.extents.along - context.ego_extents.along
    comes: Flags = (faster_mps * KMH >= limits.clearly_faster_kmh) & (station != relations.BEHIND)
    comes &= (relations.lateral(context) == near) & context.going_along
    closing = relations.gap(context) <= faster_mps * limits.passed_s
    rows, states = (comes & (closing | (station == relations.BESIDE))).nonzero()
    outcomes = _gets_past(context, distinct(rows), faster_mps)
    gets_past, unsure = (flags[rows, states] for flags in outcomes)
    next_lane, lanes = _next_lane(context)[states], context.existing_lanes.shape[1]
    there = (next_lane >= 0) & (next_lane < lanes)
    reaches = there & is_in(context.lanes_within[0][rows, states], np.clip(next_lane, 0, lanes - 1))
    inside = reaches & (context.extents.lane[rows, states] == next_lane)
    overtaken, open_end = np.zeros_like(comes), np.zeros(context.states, dtype=bool)
    past = inside & gets_past
    overtaken[rows[past], states[past]] = True
    open_end[states[reaches & (unsure | (~inside & gets_past))]] = True
    return overtaken, open_end


def _sides(context: DriveContext) -> tuple[int, int]:
    """Ego's sides of one that it overtakes, and of one that overtakes it."""
    sides = (relations.LEFT_OF, relations.RIGHT_OF)
    return sides if context.side == "right" else sides[::-1]


def _ahead_and_past(
    context: DriveContext, cells: tuple[NDArray[intp], ...], tolerances: float
) -> Flags:
    """Flags of cells in which ego will be beside another soon, or has just been, if it overtakes.

    With so many tolerances of places and speeds added to what is as far as that. The cells are rows
    and states.
    """
    limits, known = context.thresholds, context.tolerances
    station, gap = relations.station(context)[cells], relations.gap(context)[cells]
    own, other = context.ego_extents.along[0, cells[1]], context.extents.along[cells]
    far_ahead = (own - other + 2 * tolerances * known.speed_mps) * limits.catching_up_s
    far_behind = (own + tolerances * known.speed_mps) * limits.passed_s
    reach = np.where(station == relations.BEHIND, far_ahead, far_behind)
    near: Flags = (gap <= reach + tolerances * known.place_m) & (station != relations.BESIDE)
    return near


def _next_lane(context: DriveContext) -> NDArray[intp]:
    """The lane beside ego's at its far side by state; there may be none of that number.

    While ego is on a mark that is the lane that it moves into, and none beyond.
    """
    inside = context.ego_extents.inside[0]
    lanes = np.arange(inside.shape[1])
    used = (inside > context.thresholds.touching_m) | (lanes == context.ego_lane[:, None])
    next_lane: NDArray[intp] = (
        used.argmax(axis=1) + 1
        if context.side == "right"
        else len(lanes) - 2 - used[:, ::-1].argmax(axis=1)
    )
    return next_lane


def _gets_past(
    context: DriveContext, rows: NDArray[intp], faster_mps: Floats
) -> tuple[Flags, Flags]:
    """Flags of participants that are past within ``catching_up_s``, and of those that may be.

    Of these rows, False in all others. They may be if they are lost before, or fall back first:
    slower than ego by more than speeds may be wrong.
    """
    horizon = round(context.thresholds.catching_up_s / context.recording.step_s)
    spans, states = context.spans, context.spans.columns
    seen = context.relevant[rows]
    past = seen & (relations.station(context)[rows] == relations.BEHIND)
    falls_back = seen & (faster_mps[rows] < -context.tolerances.speed_mps)
    is_past = spans.within(past, horizon)
    at_once = is_past & (spans.next_state(past) <= spans.next_state(falls_back))
    gets_past, unsure = np.zeros((2, *context.relevant.shape), dtype=bool)
    gets_past[rows] = at_once
    unsure[rows] = ~at_once & (is_past | (spans.next_state(~seen) <= states + horizon))
    return gets_past, unsure


_PASSES: Passes = {
    ("congested", "CONGESTED", "walking_pace_flow"): _slow_traffic,
    ("dense_all_lanes",): _dense_all_lanes,
    ("far_lane_queue",): _far_lane_queue,
    ("own_lane_queue",): _own_lane_queue,
    ("overtaking",): _overtaking,
    ("begins_to_overtake",): _begins_to_overtake,
    ("being_overtaken",): _being_overtaken,
}
