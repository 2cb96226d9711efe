"""Whether a vehicle overtakes ego."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.manoeuvre_signals import (
    on_both_halves,
    oncoming_side,
    sides_beyond_far_edge,
    two_way,
)
from rulec.extraction.signals.ego_lanelets import own_lanelets
from rulec.extraction.signals.map.junction_signals import turn_at
from rulec.extraction.signals.map.roundabout_signals import roundabouts
from rulec.extraction.signals.queues import dense_lines
from rulec.extraction.signals.signal_columns import Caused, ids_by_state
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.lane_sets import is_in
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import RAMPS
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_HALF_M = 4.0
"""A vehicle farther beyond the middle of a road is on none of its lanes, or on the second one."""

_SETS_OFF_MPS2 = 2.0
"""Roughly the acceleration of vehicles that set off."""

_CRAWLS_MPS = 5.5
"""A vehicle this slow that gains speed sets off, although it has not quite stood."""


@word("being_overtaken")
def being_overtaken(context: DriveContext) -> Caused:
    """Whether a vehicle overtakes ego, and which one.

    Unknown where ego may only be slow because it sets off, has had to brake, or has just come here.
    """
    by, open_end = _overtaken(context)
    if not by.any() and not open_end.any():
        return Caused(Truth.known(open_end).unknown_at(open_end), ids_by_state(by, context.ids))
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
    return Caused(
        Truth.known(~dense & overtaken).unknown_at(~surely & np.where(overtaken, moot, open_end)),
        ids_by_state(by, context.ids),
    )


def _was(context: DriveContext, there: Flags) -> Flags:
    """Mask of states in which ego was ``there`` less than ``setting_off_s`` ago."""
    spans, last = context.spans, context.spans.latest(there)
    ago = (spans.columns - last) * context.recording.step_s
    was_there: Flags = (last >= spans.first) & (ago < context.thresholds.setting_off_s)
    return was_there


def _recovers(context: DriveContext) -> Flags:
    """Mask of states in which ego was faster up to ``setting_off_s`` ago: it had to brake.

    Or that long before it began to gain the speed again, as it still does.
    """
    speed, spans = context.ego.speed[0], context.spans
    steps = context.steps_in(context.thresholds.setting_off_s)
    fastest, least = spans.most_of_last(speed, steps), speed + context.tolerances.speed_mps
    recovers: Flags = least < fastest
    gains = _gains_speed(context)
    begins = np.maximum(spans.latest(~gains), spans.first)
    regains: Flags = gains & recovers[begins] & (least < fastest[begins])
    return recovers | regains


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
    return max(context.steps_in(context.thresholds.smoothing_s), 1)


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


def _overtaken(context: DriveContext) -> tuple[Flags, Flags]:
    """Mask of vehicles that overtake ego, and of states in which it is unknown whether one does.

    A vehicle that overtakes ego has its middle on the next lane at the far side, or on the other
    half of the road, is clearly faster, and gets past within ``catching_up_s``. Unknown for one
    that is lost from sight before, that falls back first (one that gives up and tries again
    overtakes only once), or that only reaches into that lane.
    """
    limits, station = context.thresholds, relations.station(context)
    near = relations.RIGHT_OF if context.side == "right" else relations.LEFT_OF
    faster_mps = context.extents.along - context.ego_extents.along
    comes: Flags = (faster_mps * KMH_PER_MPS >= limits.clearly_faster_kmh) & (
        station != relations.BEHIND
    )
    over = _over_the_middle(context)
    comes &= ((relations.lateral(context) == near) & context.going_along) | over
    closing = relations.gap(context) <= faster_mps * limits.passed_s
    cells = Cells.at(comes & (closing | (station == relations.BESIDE)))
    if not len(cells):
        return np.zeros_like(comes), np.zeros(context.states, dtype=bool)
    gets_past, unsure = map(cells.of, _gets_past(context, np.unique(cells.rows), faster_mps, over))
    next_lane, lanes = cells.of(_next_lane(context)), context.existing_lanes.shape[1]
    there = (next_lane >= 0) & (next_lane < lanes)
    reaches = there & is_in(cells.of(context.lanes_within[0]), np.clip(next_lane, 0, lanes - 1))
    inside = reaches & (cells.of(context.extents.lane) == next_lane)
    beyond = cells.of(over) & ~there
    inside, reaches = inside | beyond, reaches | beyond
    open_end = cells.in_columns(reaches & (unsure | (~inside & gets_past)))
    return cells.laid(inside & gets_past), open_end


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
    both_ways = two_way(context).sure
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
    horizon = context.steps_in(context.thresholds.catching_up_s)
    spans, states = context.spans, context.spans.columns
    seen, limits, tracks = (context.relevant | over)[rows], context.thresholds, context.tracks
    past = seen & (relations.station(context)[rows] == relations.BEHIND)
    falls_back = seen & (faster_mps[rows] < -context.tolerances.speed_mps)
    is_past = spans.within(past, horizon)
    at_once = is_past & (spans.next_state(past) <= spans.next_state(falls_back))
    comes_out = on_both_halves(context) | oncoming_side(context).sure
    brakes = (tracks.acceleration + tracks.acceleration_error)[rows] < -limits.disturbing_mps2
    at_once |= spans.within(brakes & over[rows] & comes_out & ~past, horizon) & ~falls_back
    gets_past, unsure = np.zeros((2, *context.relevant.shape), dtype=bool)
    gets_past[rows] = at_once
    is_lost = spans.within(~seen, horizon) | (states + horizon >= spans.end)
    unsure[rows] = ~at_once & (is_past | is_lost)
    return gets_past, unsure
