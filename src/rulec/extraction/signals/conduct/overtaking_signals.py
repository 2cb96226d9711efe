"""Signals of overtaking: of others by ego, and of ego by others."""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.manoeuvre_signals import (
    on_both_halves,
    oncoming_side,
)
from rulec.extraction.signals.ego_lanelets import (
    CYCLE_LANE,
    map_contents,
    those_on_lanes,
)
from rulec.extraction.signals.settling import fewest_states, without_blips
from rulec.extraction.signals.words import word
from rulec.extraction.traffic_thresholds import LEAST_S
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_DRIFT_MPS = 0.2
"""A vehicle with a lower lateral speed keeps its lane."""


@word("overtaking")
def _overtaking(context: DriveContext) -> Truth:
    """Whether ego overtakes; beyond the road's middle, from its way there until it is back.

    Unknown if ego goes there behind a vehicle and back: it may have given up; and where its drive
    begins there. For a standing vehicle, ego is there only as long as it takes to go round it.
    """
    there = oncoming_side(context).possible
    # Back for so short a time that `driving_side` takes it for noise does not count as back
    least = fewest_states(LEAST_S["driving_side"], context.recording.step_s)
    side = there | without_blips(there, least, context.spans)
    stands = context.standing & side
    overtakes = _overtakes(context, ~stands)
    if side.any():
        side = _with_all_that_joins(context, side, on_both_halves(context))
        goes_round = _overtakes(context, stands & _near_enough_to_go_round(context))
        sought = overtakes.or_possibly(_close_behind(context))
        meanwhile = sought.each(lambda half: _meanwhile(context, half, side))
        overtakes = overtakes | goes_round | meanwhile
        overtakes = overtakes.or_possibly(_may_come_from_passing(context, side))
    return overtakes


def _with_all_that_joins(context: DriveContext, flags: Flags, more: Flags) -> Flags:
    """The flagged states, with those of ``more`` that join a flagged state without a break."""
    spans, either = context.spans, flags | more
    outside = spans.latest(~either), spans.next_state(~either)
    joins: Flags = (spans.latest(flags) > outside[0]) | (spans.next_state(flags) < outside[1])
    return either & joins


def _may_come_from_passing(context: DriveContext, side: Flags) -> Flags:
    """Mask of states beyond the middle where ego's drive begins there: it may have passed somebody.

    For as long as overtaking takes.
    """
    spans = context.spans
    lasts = context.steps_in(context.thresholds.overtaking_s)
    begins_there = side & (spans.latest(~side) < spans.first)
    return begins_there & (spans.columns - spans.first < lasts)


def _near_enough_to_go_round(context: DriveContext) -> Flags:
    """Mask of participants no farther than an obstacle for which ego would go out now."""
    reach = context.ego_extents.along[0] * context.thresholds.parting_s
    near: Flags = relations.gap(context) <= np.maximum(reach, context.thresholds.obstacle_m)
    return near


def _meanwhile(context: DriveContext, flags: Flags, during: Flags) -> Flags:
    """Mask of states within ``catching_up_s`` of a flagged one, with ``during`` true in between."""
    spans, held = context.spans, flags & during
    horizon = context.steps_in(context.thresholds.catching_up_s)
    before, after = spans.latest(held), spans.next_state(held)
    earlier = (before > spans.latest(~during)) & (before >= spans.columns - horizon)
    later = (after < spans.next_state(~during)) & (after <= spans.columns + horizon)
    return earlier | later


def _close_behind(context: DriveContext) -> Flags:
    """Mask of states in which ego would soon reach a vehicle beside its way if that one stood.

    Or one ahead that has gone to ego's side before it: of several, all wait for the first.
    """
    near_side = relations.RIGHT_OF if context.side == "right" else relations.LEFT_OF
    reach = context.ego_extents.along * context.thresholds.signalling_s
    near = (relations.gap(context) <= reach) & (relations.station(context) == relations.BEHIND)
    # A vehicle that has gone to the lanes of the other direction is on none of the road's, and not
    # in sight
    goes_along = np.abs(context.extents.turned) < 1.0
    near &= goes_along & context.tracks.of_type("vehicle")[:, None]
    near &= relations.lateral(context) != near_side
    close: Flags = near.any(axis=0)
    return close


@word("begins_to_overtake")
def _begins_to_overtake(context: DriveContext) -> Truth:
    """Whether ego overtakes within ``parting_s``, so that it is pulling out for that by now.

    Unknown where the drive ends before.
    """
    spans, horizon = context.spans, context.steps_in(context.thresholds.parting_s)
    begins = _overtakes(context, True).each(lambda half: spans.within(half, horizon))
    moves_out = np.abs(context.ego_extents.across[0]) > _DRIFT_MPS
    return begins.or_possibly(moves_out & (spans.columns + horizon >= spans.end))


def _overtakes(context: DriveContext, whom: Flags | bool) -> Truth:
    """Whether ego overtakes a slower vehicle or cycle.

    An overtaking ego is at the far side, from shortly before it is beside the other until it is
    just past. ``whom``: mask of the others by state.
    """
    nowhere = Truth.known(np.zeros(context.states, dtype=bool))
    if not np.any(whom):
        return nowhere
    far = relations.LEFT_OF if context.side == "right" else relations.RIGHT_OF
    slower: Flags = (context.extents.along < context.ego_extents.along) & whom
    slower &= (relations.lateral(context) == far) & (context.driving_along | _ride_along(context))
    cells = Cells.at(slower)
    if not len(cells):
        return nowhere
    beside = cells.of(relations.station(context)) == relations.BESIDE
    near, about = (_ahead_and_past(context, cells, tolerances) for tolerances in (0.0, 1.0))
    overtakes = cells.in_columns(near | beside)
    return Truth(overtakes, overtakes | cells.in_columns(about))


def _ride_along(context: DriveContext) -> Flags:
    """Mask of cycles that go ego's way on its lanes, except on cycle lanes."""
    others, rides = context.extents, context.tracks.of_type("light_rider")
    along = context.in_sight & rides[:, None] & (abs(others.turned) < 1.0) & context.on_lanes
    if CYCLE_LANE in map_contents(context).types:
        along &= ~those_on_lanes(context, CYCLE_LANE, along)
    return along


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
