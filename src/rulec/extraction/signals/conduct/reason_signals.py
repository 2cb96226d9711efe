"""Signals of whether anything makes ego brake, stand or drive slowly, and whom it holds up.

Reasons that nobody records, such as an animal, a defect or somebody to let out, cannot be excluded;
those that can be seen are looked for as far ahead as ego might have to think of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext, once
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.lamp_signals import ego_lamps
from rulec.extraction.signals.map.map_signals import next_crossing
from rulec.extraction.signals.map.zone_signals import crossings_lit
from rulec.extraction.signals.measured_numbers import moves
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.signals.signal_passes import SignalPasses
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.recordings.recording import JOINING
from rulec.scenario.recorded.reference_line import turn
from rulec.trace.cells import Cells
from rulec.trace.plain_arrays import distinct, zero_if_nan

_REACH_S, _GENTLE_MPS2, _REACH_M = 3.0, 4.0, 20.0
"""What makes ego brake is no farther ahead than it drives in so long, brakes so hard, and this."""

FOLLOWS_S, _FALLS_BACK_MPS = 3.0, 1.0
"""Who is so far behind by time, or nearer, is held up by ego, unless it is slower by so much."""

_IN_WAY_M, _COMES_M, _ROAD_M, _CROSSES_M = 2.5, 6.0, 15.0, 30.0
"""Sideways: who is in ego's way, may come into it, is on its road, comes on a road across."""

_SIDEWAYS_MPS, _ACROSS_RAD, _BEND_RAD, _EVERY_M = 0.3, np.radians(30.0), np.radians(20.0), 10.0
_SLOWER_KMH, _ALIKE_MPS, _HALF = 1.0, 3.0, 0.5
_FAR_SLOWER, _SLOWER = 0.5, 0.75
"""Parts of the limit: who is slower than the first holds others up, than the second perhaps."""

_MOVES_OFF_S = 5.0
"""Who has waited gets going in so long."""

_DRIVES_KMH = 30.0
"""Who is as fast later on has not broken down, nor is towed."""


def _cause_to_brake(context: DriveContext) -> SignalColumns:
    caused, unknown = _causes(context)
    return SignalColumns({"cause_to_brake": caused}, unknown={"cause_to_brake": unknown})


@once
def _causes(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of states with a reason to brake, stand or be slow, and of those perhaps with one.

    Ego that stands has perhaps broken down, unless its hazard lights are known to be off, or it
    drives on at ``_DRIVES_KMH`` afterwards; one that stands soon, whose drive ends, that is beside
    somebody, or comes up to one beside its lane who is less than half as fast, and may come into
    it, had perhaps something to do; so has one before or on a lane that joins others, where it
    looks for a gap, one that has stood for a reason, or since its drive began, up to
    ``_MOVES_OFF_S`` ago, and one that brakes hard with nobody near behind, whom it would surprise.
    Where not all traffic is recorded it is as far as somebody is recorded ahead.
    """
    caused = _by_map(context)
    others = _others(context, (~caused).nonzero()[0])
    caused[others.states] = _by_others(context, others)
    if caused.all():
        return caused, ~caused
    others = others.part((~caused[others.states]).nonzero()[0])
    caused[others.states] = _by_road(context, others.states)
    others = others.part((~caused[others.states]).nonzero()[0])
    soon = round(context.thresholds.preparing_s / context.recording.step_s)
    spans, stands = context.spans, ~moves(context)
    perhaps = np.zeros(context.states, dtype=bool)
    if stands.any():
        broken_down = stands & ~_drives_on(context, stands)
        perhaps = spans.within(broken_down, soon) & ~(stands & _shows_no_hazard(context))
        perhaps |= stands & spans.begins_here
        # Who is about to back has to stand before
        backs = context.ego_extents.along[0] * KMH <= -context.thresholds.standing_kmh
        perhaps |= stands & spans.within(backs, soon)
    perhaps |= spans.columns + soon // 2 >= spans.end
    # Ego may want to get in behind one beside it, or let it in
    beside = (others.away > _IN_WAY_M) & (others.away <= _COMES_M)
    beside &= np.abs(others.ahead) <= _REACH_M
    perhaps[others.states] |= beside.any(axis=0) | _slow_beside(context, others)
    perhaps |= _seeks_a_gap(context)
    least = context.ego.acceleration[0] - context.ego.acceleration_error[0]
    perhaps |= (least <= -context.thresholds.braking_hard_mps2) & ~_followed(context)
    if stands.any():
        held = spans.latest(stands & (caused | perhaps))
        since_s = (spans.columns - held) * context.recording.step_s
        perhaps |= stands & (held > spans.latest(~stands)) & (since_s <= _MOVES_OFF_S)
    if not _all_are_recorded(context):
        farther = (others.ahead > _reach(context)[others.states]) & (others.away <= _ROAD_M)
        perhaps[others.states] |= ~farther.any(axis=0)
    return caused, perhaps & ~caused


def _drives_on(context: DriveContext, stands: Flags) -> Flags:
    """Flags of states in which ego stands, and drives on in earnest later in its drive.

    Of one that stands when its drive begins nobody knows for what, nor until it has had the time to
    get going.
    """
    spans = context.spans
    drives = context.ego.speed[0] * KMH >= _DRIVES_KMH
    later = spans.next_state(drives) < spans.end
    drives_on: Flags = stands & later & ~spans.begins_here
    return drives_on


def _slow_beside(context: DriveContext, others: _Others) -> Flags:
    """Flags of the others' states with one ahead beside ego's lane, less than half as fast."""
    near = (others.ahead > 0) & (others.ahead <= _reach(context)[others.states])
    cells = Cells.at(near & (others.away <= _COMES_M))
    rows, columns = cells.rows, cells.columns
    motion = _motion(context, others.rows[rows], others.states[columns])
    ego_mps = context.ego.speed[0, others.states[columns]]
    slow = (np.abs(motion.turned) < _ACROSS_RAD) & (motion.along < _HALF * ego_mps)
    found = np.zeros(len(others.states), dtype=bool)
    found[columns[slow]] = True
    return found


def _seeks_a_gap(context: DriveContext) -> Flags:
    """Flags of states in which ego's lane joins others, there or as far ahead as ego looks."""
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
    return reach_at(context.ego.speed[0])


def reach_at(speed: Floats) -> Floats:
    """How far ahead (m) somebody looks for reasons to brake, by speed (m/s)."""
    reach: Floats = _REACH_S * speed + speed**2 / (2 * _GENTLE_MPS2) + _REACH_M
    return reach


def _by_map(context: DriveContext) -> Flags:
    """Flags of states with a junction, crossing or the map's end ahead, or ego far too fast."""
    road, front, reach = context.road, context.ego_extents.s_max[0], _reach(context)
    rear, speed = context.ego_extents.s_min[0], context.ego.speed[0]
    crossing, _ = next_crossing(context)
    caused: Flags = (crossing - front <= reach) & ~_stands_for_nobody(context, crossing)
    inside = np.zeros(context.states, dtype=bool)
    for start, end in road.junctions:
        caused |= (front >= start - reach) & (rear <= end)
        inside |= (rear >= start) & (front <= end)
    # Who is within a junction has no line to wait at, only others to wait for
    everybody = np.ones(len(context.surroundings.tracks.x), dtype=bool)
    caused &= ~_stands_alone(context, inside, everybody)
    # Beyond its map nobody knows the road
    caused |= (front + reach > road.borders[-1]) | (rear < road.borders[0])
    caused |= speed * KMH > context.limit_mps * KMH + _SLOWER_KMH
    return caused


def _stands_for_nobody(context: DriveContext, crossing: Floats) -> Flags:
    """Flags of states in which ego has stood at a zebra crossing while nobody was about.

    Nobody walks or rides near it; where lights may direct who crosses they may be red.
    """
    if _all_are_recorded(context) and np.isfinite(crossing).any():
        lit = crossings_lit(context)
        zebra = np.array([not any(lit.get(start, (True, True))) for start in crossing.tolist()])
        return _stands_alone(context, zebra, context.surroundings.tracks.of_type("vulnerable_user"))
    return np.zeros(context.states, dtype=bool)


def _stands_alone(context: DriveContext, where: Flags, whom: Flags) -> Flags:
    """Flags of states in which ego has stood somewhere for ``_MOVES_OFF_S``, and been alone there.

    None of those of ``whom`` was within ``_CROSSES_M``, but for who has come up behind ego, and
    waits for it. Only where all traffic is recorded.
    """
    spans, alone = context.spans, np.zeros(context.states, dtype=bool)
    states = np.flatnonzero(where & ~moves(context))
    if not len(states) or not _all_are_recorded(context):
        return alone
    others = _others(context, states)
    about = (np.hypot(others.ahead, others.left) <= _CROSSES_M) & whom[others.rows][:, None]
    cells = Cells.at(about & (others.ahead < 0))
    turned = _motion(context, others.rows[cells.rows], states[cells.columns]).turned
    about.ravel()[cells.places[np.abs(turned) < _ACROSS_RAD]] = False
    alone[states] = ~about.any(axis=0)
    steps = round(_MOVES_OFF_S / context.recording.step_s)
    found: Flags = ~spans.within_last(~alone, steps) & (spans.columns - spans.first >= steps)
    return found


def _all_are_recorded(context: DriveContext) -> bool:
    return "arrivals" in context.recording.complete


def _by_road(context: DriveContext, states: NDArray[intp]) -> Flags:
    """Flags of these states with a bend, a lower limit or an end of the lane ahead."""
    road, width, reach = context.road, context.existing_lanes.shape[1], _reach(context)[states]
    front, speed = context.ego_extents.s_max[0, states], context.ego.speed[0, states]
    lanes, turned = context.ego_lane[states], np.radians(context.thresholds.turned_deg)
    before = road.line.headings_at(zero_if_nan(context.ego_extents.s[0, states]))
    # Rows of places ahead, a column for each state
    ahead = np.arange(0.0, float(np.nanmax(reach, initial=0.0)) + _EVERY_M, _EVERY_M)[:, None]
    place = zero_if_nan(front + ahead)
    bends = np.abs(turn(before, road.line.headings_at(place))) > _BEND_RAD
    there = road.lanes.existing_at(place)[:, np.arange(len(states)), lanes]
    codes = road.piece(place) * width + lanes
    different = distinct(codes)
    told = [road.limit_mps(code // width, code % width, turned) for code in different.tolist()]
    known = np.array([np.inf if limit is None else limit for limit in told])
    limits = known[different.searchsorted(codes)]
    lower = (limits < speed) | (limits < context.limit_mps[states])
    found: Flags = ((ahead <= reach) & (bends | ~there | lower)).any(axis=0)
    return found


def _by_others(context: DriveContext, others: _Others) -> Flags:
    """Flags of the others' states with one ahead in ego's way, coming into it, or across it."""
    states, reach = others.states, _reach(context)[others.states]
    near = (others.ahead > -_REACH_M / 4) & (others.ahead <= reach + _REACH_M)
    found: Flags = np.logical_or.reduce(near & (others.away <= _IN_WAY_M))
    cells = Cells.at(near & (others.away <= _CROSSES_M) & ~found)
    rows, columns = cells.rows, cells.columns
    left, away = cells.of(others.left), cells.of(others.away)
    motion = _motion(context, others.rows[rows], states[columns])
    comes = (away <= _COMES_M) & (-motion.sideways * np.sign(left) > _SIDEWAYS_MPS)
    angle = np.abs(motion.turned)
    across = (angle > _ACROSS_RAD) & (angle < np.pi - _ACROSS_RAD)
    # Whom ego may not pass on the near side
    to_far = left * (1 if context.side == "right" else -1)
    speed = context.ego.speed[0, states[columns]]
    slower = (angle < _ACROSS_RAD) & (motion.along < speed + _ALIKE_MPS)
    not_to_pass = slower & (to_far > 0) & (away <= _COMES_M)
    found[columns[comes | (across & motion.moves) | not_to_pass]] = True
    rest = (~found).nonzero()[0]
    at = states[rest]
    in_lane = relations.station(context)[:, at] == relations.BEHIND
    in_lane &= context.relevant[:, at] & context.in_ego_lane[:, at]
    in_lane &= relations.gap(context)[:, at] <= reach[rest]
    found[rest] = in_lane.any(axis=0)
    return found


@dataclass(frozen=True, eq=False, slots=True)
class _Others:
    """Where others are in some ``states``: ahead of ego and left of it (m), by its heading.

    A row for each, whose ``rows`` are those among all of the recording; ``away`` is how far (m)
    they are from ego's line to either side.
    """

    states: NDArray[intp]
    rows: NDArray[intp]
    ahead: Floats
    left: Floats
    away: Floats

    def part(self, chosen: NDArray[intp]) -> _Others:
        """The same in some of the states."""
        ahead, left, away = (own.take(chosen, axis=1) for own in (self.ahead, self.left, self.away))
        return _Others(self.states.take(chosen), self.rows, ahead=ahead, left=left, away=away)


@dataclass(frozen=True, eq=False, slots=True)
class _Motion:
    """How some others move: their speeds ahead of ego and to its left (m/s), by its heading.

    ``turned`` is their heading from its own (rad).
    """

    along: Floats
    sideways: Floats
    turned: Floats
    moves: Flags


def _others(context: DriveContext, states: NDArray[intp]) -> _Others:
    """All others of the recording in some states, also those that are not on ego's road."""
    tracks, own, spans = context.surroundings.tracks, context.ego, context.spans
    columns = context.columns[states]
    rows = tracks.present.take(columns, axis=1).any(axis=1).nonzero()[0]
    x, y = (values[rows].take(columns, axis=1) for values in (tracks.x, tracks.y))
    if context.own is context.surroundings:
        drives = spans.number[states]
        places = rows.searchsorted(own.rows)[drives]
        there = (places < len(rows)).nonzero()[0]
        there = there[rows[places[there]] == own.rows[drives[there]]]
        x[places[there], there] = np.nan
    heading = own.heading[0, states]
    cos, sin = np.cos(heading), np.sin(heading)
    x -= own.x[0, states]
    y -= own.y[0, states]
    left = y * cos - x * sin
    return _Others(states, rows, ahead=x * cos + y * sin, left=left, away=np.abs(left))


def _motion(context: DriveContext, rows: NDArray[intp], states: NDArray[intp]) -> _Motion:
    """How some others move, of rows among all of the recording, in as many states."""
    tracks = context.surroundings.tracks
    at, own = (rows, context.columns[states]), context.ego.heading[0]
    cos, sin, own = np.cos(own)[states], np.sin(own)[states], own[states]
    vx, vy = tracks.vx[at], tracks.vy[at]
    return _Motion(
        along=vx * cos + vy * sin,
        sideways=vy * cos - vx * sin,
        turned=turn(own, tracks.heading[at]),
        moves=np.hypot(vx, vy) * KMH >= context.thresholds.standing_kmh,
    )


def _impedes(context: DriveContext) -> SignalColumns:
    """Whether somebody follows ego, far below the limit for long without a reason.

    Who rides a cycle has one: no law asks for more than its rider's strength. Who gains speed, as
    after a stop, is not slow for good.
    """
    limit, speed = context.limit_mps, context.ego.speed[0]
    told = np.isfinite(limit)
    cycles = context.spans.spread([ego.type == "bicycle" for ego in context.ego.participants])
    followed = _followed(context, _FALLS_BACK_MPS) & ~cycles
    caused, perhaps = _causes(context)
    gains = context.ego.acceleration[0] > context.thresholds.accelerating_mps2
    slow = told & (speed < _FAR_SLOWER * limit) & moves(context)
    far_slower = slow & ~gains & ~caused & ~perhaps
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    runs = context.spans.columns - context.spans.latest(~far_slower)
    impedes = followed & (runs > steps)
    slower = ~told | (speed < _SLOWER * limit)
    return SignalColumns(
        {"impedes_traffic": impedes},
        unknown={"impedes_traffic": followed & slower & ~caused & ~impedes},
    )


def _followed(context: DriveContext, slower_mps: float = np.inf) -> Flags:
    """Flags of states in which somebody is behind ego in its lane, near enough to be held up.

    And no slower than ego by so much: who falls back goes at a speed of its own.
    """
    behind = relations.station(context) == relations.IN_FRONT_OF
    behind &= context.going_along
    behind &= context.in_ego_lane
    cells, followed = Cells.at(behind), np.zeros(context.states, dtype=bool)
    speed = np.maximum(cells.of(context.extents.along), 0.0)
    near = cells.of(relations.gap(context)) <= FOLLOWS_S * speed
    near &= speed > context.ego_extents.along[0, cells.columns] - slower_mps
    followed[cells.columns[near]] = True
    return followed


reason_signals = SignalPasses(
    {
        ("cause_to_brake",): _cause_to_brake,
        ("impedes_traffic",): _impedes,
    }
)
"""The signals of reasons to brake and of holding up others."""
