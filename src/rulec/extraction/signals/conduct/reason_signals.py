"""The signal of whether anything makes ego brake, stand or drive slowly.

Reasons that are never recorded, such as an animal, a defect or a passenger to let out, cannot be
excluded; visible ones are searched as far ahead as ego might have to consider them.
"""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.braking_causes.map_causes import (
    LOOKS_S,
    MOVES_OFF_S,
    map_reasons,
    road_reasons,
)
from rulec.extraction.signals.conduct.braking_causes.others_around import (
    Others,
    motion_of,
    others_in,
    without_followers,
)
from rulec.extraction.signals.conduct.braking_causes.traffic_causes import (
    COMES_M,
    IN_WAY_M,
    REACH_M,
    crossed,
    led,
    may_be_others,
    may_come,
    met,
)
from rulec.extraction.signals.conduct.lamp_signals import ego_lamps
from rulec.extraction.signals.map.exit_room import waits_for_room
from rulec.extraction.signals.words import word
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import JOINING
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_REACH_S, _GENTLE_MPS2 = 3.0, 4.0
"""A cause to brake is at most this far ahead: the way in ``_REACH_S``, the braking distance at
``_GENTLE_MPS2``, and ``REACH_M``."""

_FARTHEST_M = 1000.0
"""Nobody looks farther ahead (m), however fast a vehicle seems to be."""

_FOLLOWS_S = 3.0
"""Ego may hold up or surprise vehicles at most this far (s) behind."""

_ROAD_M, _HALF, _CALLED_M = 15.0, 0.5, 100.0
_SLOWER = 0.75
"""Below this part of the limit, rules may ask for a reason."""

_SETS_OFF_S = 2.0
"""No vehicle is expected to set off sooner (s) once it may."""

_DRIVES_KMH = 30.0
"""A vehicle that is this fast later on has not broken down, nor is it towed."""


@word("cause_to_brake")
@once
def _cause_to_brake(context: DriveContext) -> Truth:
    """Whether there is a reason to brake, stand or be slow.

    Possible reasons are searched in all states; whether one surely applies, or surely does not,
    only where ego brakes hard, stands or is slow (``_asked``).

    A standing ego may have broken down, unless its hazard lights are known to be off or it later
    drives on at ``_DRIVES_KMH``. It may have had a reason if it stands soon, if its drive ends, if
    a participant is beside it, if it comes up to one beside its lane that is less than half as fast
    and may come into it, if it is before or on a lane that joins others, where it looks for a gap,
    if it has stood for a reason, or since its drive began, up to ``MOVES_OFF_S`` ago, if it brakes
    hard with no vehicle near behind that would be surprised, and if it still seems to brake hard
    when a reason, or somebody who may have been one, is just gone. Where not all traffic is
    recorded, the road counts as known only as far as a participant is recorded ahead.
    """
    reach, spans, stands = _reach(context), context.spans, ~context.ego_moves
    brakes, asked = _asked(context)
    on_map = map_reasons(context, asked, reach)
    caused = on_map.does | led(context, brakes, reach) | waits_for_room(context)
    excuses = on_map.may.copy()
    others = others_in(context, (~excuses | (asked & ~caused)).nonzero()[0])
    in_way, kept_back = may_be_others(context, others, reach)
    comes = np.zeros(context.states, dtype=bool)
    comes[others.states] = in_way
    caused[others.states] |= kept_back & ~stands[others.states]
    freely = on_map.freely[others.states].nonzero()[0]
    if len(freely):
        there = others.part(freely)
        comes[there.states] |= may_come(context, there, reach)
    excuses |= comes
    if asked.any():
        caused |= asked & crossed(context, others, reach)
        waits, thinks = met(context, asked, reach)
        caused |= waits
        excuses |= on_map.freely & thinks
    on_road = (~caused & (asked | ~excuses)).nonzero()[0]
    bends, too_fast = road_reasons(context, on_road, reach)
    excuses[on_road] |= bends
    caused[on_road] |= too_fast
    # The mean still shows hard braking when its reason, such as a lower limit, is just gone
    shown = context.steps_in(context.thresholds.smoothing_s / 2)
    excuses |= brakes & spans.within_last(caused, shown)
    # And it takes ego a moment to see that somebody will not come after all
    seen = shown + context.steps_in(context.thresholds.reaction_s)
    excuses |= brakes & spans.within_last(comes, seen)
    if stands.any():
        caused |= stands & _since(context, caused & stands, _SETS_OFF_S)
    # The rest only adds to ``excuses``: a drive has the same words alone and with others
    if (caused | excuses).all():
        return Truth(caused, caused | excuses)
    others = others.part((~(caused | excuses)[others.states]).nonzero()[0])
    soon = context.steps_in(context.thresholds.preparing_s)
    if stands.any():
        broken_down = stands & ~_drives_on(context, stands)
        excuses |= spans.within(broken_down, soon) & ~(stands & _shows_no_hazard(context))
        excuses |= stands & spans.begins_here
        # A vehicle that is about to reverse has to stand before
        backs = context.ego_extents.along[0] * KMH_PER_MPS <= -context.thresholds.standing_kmh
        excuses |= stands & spans.within(backs, soon)
    excuses |= spans.columns + soon // 2 >= spans.end
    # Ego may want to get in behind a vehicle beside it, or let it in
    excuses[others.states] |= _beside(context, others) | _slow_beside(context, others)
    excuses[others.states] |= _called_near(context, others)
    excuses |= _seeks_a_gap(context)
    least = context.ego.acceleration[0] - context.ego.acceleration_error[0]
    excuses |= (least <= -context.thresholds.braking_hard_mps2) & ~_followed(context)
    if stands.any():
        excuses |= stands & _since(context, stands & (caused | excuses), MOVES_OFF_S)
        # A vehicle that has just stopped may have seen another one that did not come after all
        looks = spans.within_last(~stands, context.steps_in(LOOKS_S))
        excuses |= on_map.freely & stands & looks
    if not _all_are_recorded(context):
        farther = (others.ahead > reach[others.states]) & (others.away <= _ROAD_M)
        excuses[others.states] |= ~farther.any(axis=0)
    return Truth(caused, caused | excuses)


def _since(context: DriveContext, flags: Flags, seconds: float) -> Flags:
    """Mask of states in which ego has not moved since a flagged one, at most ``seconds`` ago."""
    spans = context.spans
    latest = spans.latest(flags)
    recent = (spans.columns - latest) * context.recording.step_s <= seconds
    found: Flags = recent & (latest > spans.latest(context.ego_moves))
    return found


def _asked(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks of states in which ego brakes hard, and in which rules ask for a reason.

    In the latter ego may brake hard within a second, stands, or is slow; without a known limit it
    counts as slow if a vehicle follows it.
    """
    acceleration, hard = context.ego.acceleration[0], -context.thresholds.braking_hard_mps2
    brakes = acceleration - context.ego.acceleration_error[0] <= hard
    limit, speed = context.limit_mps, context.ego.speed[0]
    slow = np.where(np.isfinite(limit), speed < _SLOWER * limit, _followed(context))
    second = context.steps_in(1.0)
    return acceleration <= hard, context.spans.within(brakes, second) | ~context.ego_moves | slow


def _drives_on(context: DriveContext, stands: Flags) -> Flags:
    """Mask of states in which ego stands, and reaches ``_DRIVES_KMH`` later in its drive.

    Not in a drive's first state: why ego stands there is unknown until it could get going.
    """
    spans = context.spans
    drives = context.ego.speed[0] * KMH_PER_MPS >= _DRIVES_KMH
    later = spans.next_state(drives) < spans.end
    drives_on: Flags = stands & later & ~spans.begins_here
    return drives_on


def _beside(context: DriveContext, others: Others) -> Flags:
    """Mask of the others' states with a participant beside ego, near its lane."""
    beside = (others.away > IN_WAY_M) & (others.away <= COMES_M)
    beside &= np.abs(others.ahead) <= REACH_M
    found: Flags = np.logical_or.reduce(beside)
    turns = (found & ~context.ego_moves[others.states]).nonzero()[0]
    if len(turns):
        # If ego stands in a turn, those behind it on its road may appear to be beside it
        there = without_followers(context, others.part(turns))
        near = (there.away > IN_WAY_M) & (there.away <= COMES_M)
        found[turns] = (near & (np.abs(there.ahead) <= REACH_M)).any(axis=0)
    return found


def _called_near(context: DriveContext, others: Others) -> Flags:
    """Mask of the others' states with an emergency vehicle near: ego may make way for it."""
    called = context.surroundings.tracks.of_type("emergency_vehicle")[others.rows]
    near = np.hypot(others.ahead[called], others.left[called]) <= _CALLED_M
    found: Flags = np.logical_or.reduce(near)
    return found


def _slow_beside(context: DriveContext, others: Others) -> Flags:
    """Mask of the others' states with one ahead beside ego's lane, under half as fast as ego."""
    near = (others.ahead > 0) & (others.ahead <= _reach(context)[others.states])
    cells = Cells.at(near & (others.away <= COMES_M))
    rows, columns = cells.rows, cells.columns
    motion = motion_of(context, others.rows[rows], others.states[columns])
    ego_mps = context.ego.speed[0, others.states[columns]]
    slow = motion.goes_along & (motion.along < _HALF * ego_mps)
    return cells.in_columns(slow)


def _seeks_a_gap(context: DriveContext) -> Flags:
    """Mask of states in which ego's lane joins others, there or as far ahead as ego looks."""
    road, seeks = context.road, np.zeros(context.states, dtype=bool)
    joins = [[x is not None and JOINING in x.types for x in row] for row in road.rows]
    for number, row in enumerate(joins):
        for lane in np.flatnonzero(row).tolist():
            begins, ends = road.borders[number], road.borders[number + 1]
            ahead = context.ego_extents.s_max[0] + _reach(context) >= begins
            on_way = ahead & (context.ego_extents.s_min[0] <= ends)
            seeks |= on_way & (context.ego_lane == lane)
    return seeks


def _shows_no_hazard(context: DriveContext) -> Flags:
    shows = [ego.lamps and "hazard_lights" in ego.shows for ego in context.ego.participants]
    if not any(shows):
        return np.zeros(context.states, dtype=bool)
    lit = ego_lamps(context)
    shown = np.array([x is not None and "hazard_lights" not in x for x in lit], dtype=bool)
    no_hazard: Flags = shown & context.spans.spread(np.array(shows, dtype=bool))
    return no_hazard


def _reach(context: DriveContext) -> Floats:
    """How far ahead (m) a driver looks for reasons to brake."""
    speed = context.ego.speed[0]
    reach: Floats = _REACH_S * speed + speed**2 / (2 * _GENTLE_MPS2) + REACH_M
    return np.minimum(reach, _FARTHEST_M)


def _all_are_recorded(context: DriveContext) -> bool:
    return "arrivals" in context.recording.complete


def _followed(context: DriveContext) -> Flags:
    """Mask of states in which a vehicle is behind ego in its lane, near enough to be held up."""
    behind = relations.station(context) == relations.IN_FRONT_OF
    behind &= context.going_along
    behind &= context.in_ego_lane
    cells = Cells.at(behind)
    speed = np.maximum(cells.of(context.extents.along), 0.0)
    return cells.in_columns(cells.of(relations.gap(context)) <= _FOLLOWS_S * speed)
