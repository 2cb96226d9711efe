"""Signals of overtaking: of others by ego, and of ego by others."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.manoeuvre_signals import (
    on_both_halves,
    oncoming_side,
    sides_beyond_far_edge,
    two_way,
)
from rulec.extraction.signals.ego_lanelets import (
    CYCLE_LANE,
    map_contents,
    own_lanelets,
    those_on_lanes,
)
from rulec.extraction.signals.map.junction_signals import turn_at
from rulec.extraction.signals.map.roundabout_signals import roundabouts
from rulec.extraction.signals.queues import dense_lines
from rulec.extraction.signals.settling import fewest_states, without_blips
from rulec.extraction.signals.signal_columns import SignalColumns, ids_by_state
from rulec.extraction.signals.signal_passes import SignalPasses, once_a_road
from rulec.extraction.tracks.lane_sets import is_in
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.extraction.traffic_thresholds import LEAST_S
from rulec.recordings.recording import RAMPS
from rulec.trace.cells import Cells
from rulec.trace.plain_arrays import distinct

_DRIFT_MPS = 0.2
"""A vehicle with a lower lateral speed keeps its lane."""

_HALF_M = 4.0
"""A vehicle farther beyond the middle of a road is on none of its lanes, or on the second one."""

_SETS_OFF_MPS2 = 2.0
"""Roughly the acceleration of vehicles that set off."""

_CRAWLS_MPS = 5.5
"""A vehicle this slow that gains speed sets off, although it has not quite stood."""


def _overtaking(context: DriveContext) -> SignalColumns:
    """Whether ego overtakes; beyond the road's middle, from its way there until it is back.

    Unknown if ego goes there behind a vehicle and back: it may have given up. For a standing
    vehicle, ego is there only as long as it takes to go round it.
    """
    there, perhaps = oncoming_side(context)
    # Back for so short a time that `driving_side` takes it for noise does not count as back
    least = fewest_states(LEAST_S["driving_side"], context.recording.step_s)
    side = there | perhaps | without_blips(there | perhaps, least, context.spans)
    stands = (context.tracks.speed * KMH < context.thresholds.standing_kmh) & side
    overtakes, unsure = _overtakes(context, ~stands)
    if side.any():
        side = _with_all_that_joins(context, side, on_both_halves(context))
        goes_round, may_go_round = _overtakes(context, stands & _near_enough_to_go_round(context))
        overtakes = overtakes | goes_round | _meanwhile(context, overtakes, side)
        perhaps = _meanwhile(context, unsure | _close_behind(context), side)
        unsure = unsure | may_go_round | perhaps
    return SignalColumns({"overtaking": overtakes}, unknown={"overtaking": unsure & ~overtakes})


def _with_all_that_joins(context: DriveContext, flags: Flags, more: Flags) -> Flags:
    """The flagged states, with those of ``more`` that join a flagged state without a break."""
    spans, either = context.spans, flags | more
    outside = spans.latest(~either), spans.next_state(~either)
    joins: Flags = (spans.latest(flags) > outside[0]) | (spans.next_state(flags) < outside[1])
    return either & joins


def _near_enough_to_go_round(context: DriveContext) -> Flags:
    """Mask of participants no farther than an obstacle for which ego would go out now."""
    reach = context.ego_extents.along[0] * context.thresholds.parting_s
    near: Flags = relations.gap(context) <= np.maximum(reach, context.thresholds.obstacle_m)
    return near


def _meanwhile(context: DriveContext, flags: Flags, during: Flags) -> Flags:
    """Mask of states within ``catching_up_s`` of a flagged one, with ``during`` true in between."""
    spans, held = context.spans, flags & during
    horizon = round(context.thresholds.catching_up_s / context.recording.step_s)
    before, after = spans.latest(held), spans.next_state(held)
    earlier = (before > spans.latest(~during)) & (before >= spans.columns - horizon)
    later = (after < spans.next_state(~during)) & (after <= spans.columns + horizon)
    return earlier | later


def _close_behind(context: DriveContext) -> Flags:
    """Mask of states in which ego would soon reach a vehicle beside its way if that one stood.

    Or one ahead that has gone to ego's side before it: of several, all wait for the first.
    """
    _, near_side = _sides(context)
    reach = context.ego_extents.along * context.thresholds.signalling_s
    near = (relations.gap(context) <= reach) & (relations.station(context) == relations.BEHIND)
    # A vehicle that has gone to the lanes of the other direction is on none of the road's, and not
    # in sight
    goes_along = np.abs(context.extents.turned) < 1.0
    near &= goes_along & context.tracks.of_type("vehicle")[:, None]
    near &= relations.lateral(context) != near_side
    close: Flags = near.any(axis=0)
    return close


def _begins_to_overtake(context: DriveContext) -> SignalColumns:
    """Whether ego overtakes within ``parting_s``, so that it is pulling out for that by now.

    Unknown where the drive ends before.
    """
    overtakes, unsure = _overtakes(context, True)
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
    if not by.any() and not open_end.any():
        nobody = np.zeros(context.states, dtype=bool)
        whom = ids_by_state(by, context.ids)
        return SignalColumns(
            {"being_overtaken": nobody},
            unknown={"being_overtaken": nobody},
            whom={"being_overtaken": whom},
        )
    # A vehicle about to join gains speed beside others on the lanes that go on; one that leaves may
    # be faster than they are, too (StVO § 7a), and many lanes between ramps serve for both
    on_ramp = own_lanelets(context).flags(lambda at: not at.types.isdisjoint(RAMPS))
    by, open_end = by & ~on_ramp, open_end & ~on_ramp
    overtaken = by.any(axis=0)
    dense, surely, not_told = dense_lines(context)
    # Lanes that move off beside each other do not overtake, and a vehicle that has joined still
    # gains speed
    elsewhere = on_ramp | _comes_round(context) | _comes_beside(context)
    joined = _was(context, elsewhere)
    moot = _sets_off(context) | _recovers(context) | _may_recover(context) | joined | not_told
    # Where all lanes queue, a faster vehicle does not overtake (Vienna, Art. 11(6)(a))
    return SignalColumns(
        {"being_overtaken": ~dense & overtaken},
        unknown={"being_overtaken": ~surely & np.where(overtaken, moot, open_end)},
        whom={"being_overtaken": ids_by_state(by, context.ids)},
    )


def _was(context: DriveContext, there: Flags) -> Flags:
    """Mask of states in which ego was ``there`` less than ``setting_off_s`` ago."""
    spans, last = context.spans, context.spans.latest(there)
    ago = (spans.columns - last) * context.recording.step_s
    was_there: Flags = (last >= spans.first) & (ago < context.thresholds.setting_off_s)
    return was_there


def _recovers(context: DriveContext) -> Flags:
    """Mask of states in which ego was faster up to ``setting_off_s`` ago: it had to brake."""
    speed = context.ego.speed[0]
    steps = round(context.thresholds.setting_off_s / context.recording.step_s)
    fastest = context.spans.most_of_last(speed, steps)
    recovers: Flags = speed + context.tolerances.speed_mps < fastest
    return recovers


def _may_recover(context: DriveContext) -> Flags:
    """Mask of states in which ego accelerates within ``setting_off_s`` of being first seen.

    It may have had to brake, or have joined, before. Where all traffic is recorded nobody did.
    """
    spans, own = context.spans, context.ego
    if "arrivals" in context.recording.complete:
        return np.zeros(context.states, dtype=bool)
    seen_s = (spans.columns - spans.first) * context.recording.step_s
    gains = own.acceleration[0] > context.thresholds.accelerating_mps2
    may: Flags = gains & (seen_s < context.thresholds.setting_off_s)
    return may


def _comes_round(context: DriveContext) -> Flags:
    """Mask of states in which ego's middle is in a junction where it turns or joins a ring."""
    middle, inside = context.ego_extents.s[0], np.zeros(context.states, dtype=bool)
    rings = [begins for begins, _, at_junction in roundabouts(context) if at_junction]
    for start, end in context.road.junctions:
        if start in rings or turn_at(context, start, end) != "straight_on":
            inside |= (middle >= start) & (middle <= end)
    return inside


def _comes_beside(context: DriveContext) -> Flags:
    """Mask of states in which ego comes onto a road with more lanes than those that led there."""
    joins = _before_joining(context)
    return joins[context.road.piece(context.ego_extents.s[0])]


@once_a_road
def _before_joining(context: DriveContext) -> Flags:
    """Mask of the pieces of ego's road after which most lanes come from other lanes."""
    joins = np.zeros(len(context.road.rows), dtype=bool)
    for piece, (row, beyond) in enumerate(pairwise(context.road.rows)):
        known = {lanelet.id for lanelet in row if lanelet is not None}
        led = [
            not known.isdisjoint(lanelet.predecessors)
            for lanelet in beyond
            if lanelet is not None and lanelet.predecessors
        ]
        joins[piece] = 2 * sum(led) < len(led)
    return joins


def _gains_speed(context: DriveContext) -> Flags:
    """Mask of states in which ego is faster than ``smoothing_s`` before, or has just begun."""
    speed, spans = context.ego.speed[0], context.spans
    steps = _smoothing_steps(context)
    gains: Flags = speed > speed[np.maximum(spans.columns - steps, spans.first)]
    return gains | (spans.columns - spans.first < steps)


def _smoothing_steps(context: DriveContext) -> int:
    return max(round(context.thresholds.smoothing_s / context.recording.step_s), 1)


def _sets_off(context: DriveContext) -> Flags:
    """Mask of states in which ego has, or may have, set off, and still gains speed.

    It stood up to ``setting_off_s`` ago; or it was no faster than ``_CRAWLS_MPS`` then or since it
    has been gaining speed; or it has gained speed ever since its drive began. Before the drive it
    may have stood if ``_SETS_OFF_MPS2`` would have given it its first speed; where all traffic is
    recorded, only if that is a crawl.
    """
    limits, speed, step_s = context.thresholds, context.ego.speed[0], context.recording.step_s
    spans, stood = context.spans, context.spans.latest(speed <= _CRAWLS_MPS).astype(float)
    at_first = speed[spans.first]
    before = spans.first - np.ceil(at_first / _SETS_OFF_MPS2 / step_s)
    if "arrivals" in context.recording.complete:
        before = np.where(at_first <= _CRAWLS_MPS, before, -np.inf)
    gained_since = spans.latest(~_gains_speed(context))
    # The start of a drive is judged by what follows
    soon = np.minimum(spans.first + _smoothing_steps(context), spans.end - 1)
    later = speed[np.maximum(soon, spans.columns)]
    ever_since = (gained_since < spans.first) & (later > at_first + context.tolerances.speed_mps)
    gaining = (stood > gained_since) | ever_since
    stood = np.where(stood < spans.first, before, stood)
    sets_off: Flags = gaining | ((spans.columns - stood) * step_s < limits.setting_off_s)
    return sets_off


def _overtakes(context: DriveContext, whom: Flags | bool) -> tuple[Flags, Flags]:
    """Masks of ego overtaking a slower vehicle or cycle, and of it perhaps doing so.

    An overtaking ego is at the far side, from shortly before it is beside the other until it is
    just past. ``whom``: mask of the others by state.
    """
    overtakes, unsure = np.zeros((2, context.states), dtype=bool)
    if not np.any(whom):
        return overtakes, unsure
    far, _ = _sides(context)
    slower: Flags = (context.extents.along < context.ego_extents.along) & whom
    slower &= (relations.lateral(context) == far) & (context.driving_along | _ride_along(context))
    cells = Cells.at(slower)
    if not len(cells):
        return overtakes, unsure
    beside = cells.of(relations.station(context)) == relations.BESIDE
    surely, perhaps = (_ahead_and_past(context, cells, tolerances) for tolerances in (0.0, 1.0))
    overtakes[cells.columns[surely | beside]] = True
    unsure[cells.columns[perhaps]] = True
    return overtakes, unsure


def _ride_along(context: DriveContext) -> Flags:
    """Mask of cycles that go ego's way on its lanes, except on cycle lanes."""
    others, rides = context.extents, context.tracks.of_type("light_rider")
    along = context.in_sight & rides[:, None] & (abs(others.turned) < 1.0) & context.on_lanes
    if CYCLE_LANE in map_contents(context).types:
        along &= ~those_on_lanes(context, CYCLE_LANE, along)
    return along


def _overtaken(context: DriveContext) -> tuple[Flags, Flags]:
    """Mask of vehicles that overtake ego, and of states in which it is unknown whether one does.

    A vehicle that overtakes ego has its middle on the next lane at the far side, or on the other
    half of the road, is clearly faster, and gets past within ``catching_up_s``. Unknown for one
    that is lost from sight before, that falls back first (one that gives up and tries again
    overtakes only once), or that only reaches into that lane.
    """
    limits, station = context.thresholds, relations.station(context)
    _, near = _sides(context)
    faster_mps = context.extents.along - context.ego_extents.along
    comes: Flags = (faster_mps * KMH >= limits.clearly_faster_kmh) & (station != relations.BEHIND)
    over = _over_the_middle(context)
    comes &= ((relations.lateral(context) == near) & context.going_along) | over
    closing = relations.gap(context) <= faster_mps * limits.passed_s
    cells = Cells.at(comes & (closing | (station == relations.BESIDE)))
    open_end = np.zeros(context.states, dtype=bool)
    if not len(cells):
        return np.zeros_like(comes), open_end
    gets_past, unsure = map(cells.of, _gets_past(context, distinct(cells.rows), faster_mps, over))
    next_lane, lanes = cells.of(_next_lane(context)), context.existing_lanes.shape[1]
    there = (next_lane >= 0) & (next_lane < lanes)
    reaches = there & is_in(cells.of(context.lanes_within[0]), np.clip(next_lane, 0, lanes - 1))
    inside = reaches & (cells.of(context.extents.lane) == next_lane)
    beyond = cells.of(over) & ~there
    inside, reaches = inside | beyond, reaches | beyond
    open_end[cells.columns[reaches & (unsure | (~inside & gets_past))]] = True
    return cells.laid(inside & gets_past), open_end


def _sides(context: DriveContext) -> tuple[int, int]:
    """Ego's sides of a vehicle that it overtakes, and of one that overtakes it."""
    sides = (relations.LEFT_OF, relations.RIGHT_OF)
    return sides if context.side == "right" else sides[::-1]


def _ahead_and_past(context: DriveContext, cells: Cells, tolerances: float) -> Flags:
    """Mask of cells in which ego, if it overtakes, is soon or has just been beside the other.

    The reach is extended by this many ``tolerances`` of places and speeds.
    """
    limits, known = context.thresholds, context.tolerances
    station, gap = cells.of(relations.station(context)), cells.of(relations.gap(context))
    own, other = cells.of(context.ego_extents.along[0]), cells.of(context.extents.along)
    far_ahead = (own - other + 2 * tolerances * known.speed_mps) * limits.catching_up_s
    far_behind = (own + tolerances * known.speed_mps) * limits.passed_s
    reach = np.where(station == relations.BEHIND, far_ahead, far_behind)
    near: Flags = (gap <= reach + tolerances * known.place_m) & (station != relations.BESIDE)
    return near


def _next_lane(context: DriveContext) -> NDArray[intp]:
    """The number of the lane beside ego's at its far side by state; it may not exist.

    While ego is on a mark, it is the lane that ego moves into, not the one beyond.
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


def _over_the_middle(context: DriveContext) -> Flags:
    """Mask of vehicles with their middle on the other half that have come from ego's lanes."""
    spans, others = context.spans, context.extents
    both_ways, _ = two_way(context)
    low, high = sides_beyond_far_edge(context, others)
    over: Flags = both_ways & (low + high > 0) & (low < _HALF_M) & (abs(others.turned) < 1.0)
    over &= context.tracks.of_type("vehicle")[:, None] & ~context.on_lanes
    over &= relations.gap(context) <= context.thresholds.near_m
    # Hardly any vehicle is there
    rows = over.any(axis=1).nonzero()[0]
    gone, came = np.isnan(others.s[rows]), context.driving_along[rows]
    over[rows] &= spans.latest(gone) < spans.latest(came)
    return over


def _gets_past(
    context: DriveContext, rows: NDArray[intp], faster_mps: Floats, over: Flags
) -> tuple[Flags, Flags]:
    """Masks of participants that get past within ``catching_up_s``, and of those that may.

    Only for ``rows``; False elsewhere. They may if they are lost before, or fall back first: slower
    than ego by more than the error of speeds. A vehicle ``over`` the middle would get past if it
    did not have to brake harder than ``disturbing_mps2`` for ego, which comes there, too.
    """
    horizon = round(context.thresholds.catching_up_s / context.recording.step_s)
    spans, states = context.spans, context.spans.columns
    seen, limits, tracks = (context.relevant | over)[rows], context.thresholds, context.tracks
    past = seen & (relations.station(context)[rows] == relations.BEHIND)
    falls_back = seen & (faster_mps[rows] < -context.tolerances.speed_mps)
    is_past = spans.within(past, horizon)
    at_once = is_past & (spans.next_state(past) <= spans.next_state(falls_back))
    comes_out = on_both_halves(context) | oncoming_side(context)[0]
    brakes = (tracks.acceleration + tracks.acceleration_error)[rows] < -limits.disturbing_mps2
    at_once |= spans.within(brakes & over[rows] & comes_out & ~past, horizon) & ~falls_back
    gets_past, unsure = np.zeros((2, *context.relevant.shape), dtype=bool)
    gets_past[rows] = at_once
    is_lost = spans.within(~seen, horizon) | (states + horizon >= spans.end)
    unsure[rows] = ~at_once & (is_past | is_lost)
    return gets_past, unsure


overtaking_signals = SignalPasses(
    {
        ("overtaking",): _overtaking,
        ("begins_to_overtake",): _begins_to_overtake,
        ("being_overtaken",): _being_overtaken,
    }
)
"""The signals of overtaking."""
