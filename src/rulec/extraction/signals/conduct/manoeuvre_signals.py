"""Signals of ego's manoeuvres: reversing, setting off, turning round, the side that it is on."""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.conduct.u_turns import swings_round, u_turns
from rulec.extraction.signals.ego_lanelets import beyond_edges, own_lanelets
from rulec.extraction.signals.signal_columns import Measured
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.extraction.tracks.surroundings import BACKS_MPS
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.partly_known.partly_known_values import Truth

_SIDES = ("own_side", "oncoming_side", "wrong_way")

_DERIVED_RAD = 1e-3
"""Headings that never differ by more from the direction of motion were derived from it."""

_ALONG_RAD = np.pi / 4
"""A vehicle at a larger angle to the road does not drive along it."""

_MUCH_RAD = 1.5

_DRIFT_M = 3.0
"""Boxes of standing vehicles drift by less: up to 2.5 m to and fro in Argoverse 2."""


@word("reversing")
def _reversing(context: DriveContext) -> Truth:
    """Whether ego moves against its heading.

    Where headings are derived from places, vehicles are taken to head where their lanes lead: those
    that move that way drive forwards, and for those that move against it this is unknown.
    """
    heading = context.ego.heading[0]
    forward = context.ego.vx[0] * np.cos(heading) + context.ego.vy[0] * np.sin(heading)
    error, least = context.ego.speed_error[0], context.thresholds.standing_kmh / KMH_PER_MPS
    measured = forward < -least
    backs = Truth.known(measured).unknown_at(np.abs(forward + least) < error)
    goes_somewhere = ~_comes_back_nowhere(context, backs.possible, measured)
    backs, measured = backs & goes_somewhere, measured & goes_somewhere
    spans, jumps = context.spans, _jumps(context)
    backs = backs.unknown_at(measured & ~_for_long(context, measured) | jumps)
    if not context.surroundings.states_all_headings:
        against = context.ego_extents.along[0] < -least
        seems = may_back(context) & ~measured
        asked = spans.any(against) & ~jumps & ~spans.any(measured)
        for number, columns in spans.those(asked):
            seems[columns] |= against[columns] & (not _tells_headings(context, number, columns))
        backs = backs.unknown_at(seems)
    return backs


def _comes_back_nowhere(context: DriveContext, possible: Flags, backs: Flags) -> Flags:
    """Mask of runs of ``possible`` over which ego moves against its heading by too little.

    That is by no more than places may be wrong; or, where it is never measured to reverse, by less
    than boxes of standing vehicles drift, however badly its speed is known.
    """
    found, own = np.zeros_like(possible), context.ego
    if not possible.any():
        return found
    spans, heading = context.spans, own.heading[0]
    x, y = (own.x[0], own.y[0])
    moved = [np.where(spans.begins_here, 0.0, at - spans.before(at)) for at in (x, y)]
    ahead = (moved[0] * np.cos(heading) + moved[1] * np.sin(heading)).cumsum()
    for first, end in spans.runs(possible):
        way = ahead[max(first - 1, int(spans.first[first])) : end]
        back = float((np.maximum.accumulate(way) - way).max())
        wrong = np.sqrt(2.0) * context.tolerances.place_m
        found[first:end] = back <= wrong or (back < _DRIFT_M and not backs[first:end].any())
    return found


def _for_long(context: DriveContext, flags: Flags) -> Flags:
    """Mask of runs over which ego moves farther than boxes of standing vehicles drift.

    Not where the file states that it stood meanwhile: then its box drifts, however far.
    """
    spans, found, x, y = context.spans, np.zeros_like(flags), context.ego.x[0], context.ego.y[0]
    if not flags.any():
        return found
    for first, end in spans.runs(flags):
        states = context.ego.participants[int(spans.number[first])].states
        moved = np.hypot(x[end - 1] - x[first], y[end - 1] - y[first])
        steps = context.steps[first:end].tolist()
        stated = np.array([abs(states[step].speed) for step in steps if step in states])
        drives = bool((stated * KMH_PER_MPS >= context.thresholds.standing_kmh).any())
        found[first:end] = drives and moved >= _DRIFT_M
    return found


def _jumps(context: DriveContext) -> Flags:
    """Mask of drives in which a heading turns round at once, as with a misjudged box."""
    spans, heading = context.spans, context.ego.heading[0]
    turned, jumps = heading - spans.before(heading), np.zeros(context.states, dtype=bool)
    # Hardly any turn by this much
    much = (np.abs(turned) > _MUCH_RAD).nonzero()[0]
    jumps[much] = np.abs(np.angle(np.exp(1j * turned[much]))) > np.pi / 2
    return spans.any(jumps)


def _tells_headings(context: DriveContext, number: int, columns: slice) -> bool:
    """Whether ego's headings in a drive are more than the directions in which it moved."""
    own = context.ego
    if context.own.head_as_they_move[own.rows[number]]:
        return False
    x, y, heading = own.x[0, columns], own.y[0, columns], own.heading[0, columns]
    steps = np.hypot(np.diff(x), np.diff(y))
    moved = steps > context.tolerances.place_m
    way = np.arctan2(np.diff(y), np.diff(x))[moved]
    apart = [
        np.abs(np.angle(np.exp(1j * (way - own[moved])))) for own in (heading[:-1], heading[1:])
    ]
    return bool((np.minimum(*apart) > _DERIVED_RAD).any())


@once
def may_back(context: DriveContext) -> Flags:
    """Mask of states in which ego may back in a lane of its own instead of driving on the other's.

    Headings that are the directions of motion cannot tell these apart, unless ego comes from its
    own side without a stop, gets there, or is too fast.
    """
    found, spans = np.zeros(context.states, dtype=bool), context.spans
    if context.wrong_way or context.surroundings.states_all_headings:
        return found
    there = oncoming_side(context)
    if not there.sure.any():
        return found
    speed, moves = context.ego.speed[0], context.ego_moves
    own_side = _along_road(context) & _on_map(context) & ~at_junctions(context) & ~there.possible
    for first, end in spans.runs(moves):
        part, number = slice(first, end), int(spans.number[first])
        slow = there.sure[part].any() and speed[part].max() < BACKS_MPS and not own_side[part].any()
        found[part] = slow and not _tells_headings(context, number, spans.slices[number])
    # A vehicle that moves no other way in a drive may also stand the other way round
    return found | spans.all(found | ~moves) & spans.any(found)


@word("driving_side")
def _driving_side(context: DriveContext) -> Measured:
    if context.wrong_way:
        return Measured(np.full(context.states, _SIDES.index("wrong_way")), texts=_SIDES)
    there = oncoming_side(context)
    doubtful = there.unknown
    if doubtful.any():
        doubtful &= ~_goes_over(context, there)
    return Measured(there.sure.astype(int), doubtful | may_back(context), texts=_SIDES)


def _goes_over(context: DriveContext, there: Truth) -> Flags:
    """Mask of states between one surely on one half of the road and one surely on the other.

    There only the moment is in doubt, unless ego stays near the middle beyond ``passed_s``.
    """
    spans = context.spans
    (own_before, own_after), (before, after) = (
        (spans.latest(side), spans.next_state(side)) for side in (~there.possible, there.sure)
    )
    goes = (own_before > before) & (after < own_after)
    comes = (before > own_before) & (own_after < after)
    least = context.steps_in(context.thresholds.passed_s)
    short = np.minimum(own_after, after) - np.maximum(own_before, before) <= least
    over: Flags = (goes | comes) & short
    return over


def comes_back_over_middle(context: DriveContext) -> Flags:
    """Mask of the first states in which ego is back on its own half of a road.

    Not those in which it turns round, or has driven into a junction.
    """
    back = context.spans.enters(~oncoming_side(context).sure)
    if back.any():
        back &= (_beyond_far_edge(context) <= _loose(context)) & ~swings_round(context)
    return back


@once
def on_both_halves(context: DriveContext) -> Flags:
    """Mask of states in which ego's body is on both sides of the far edge of its lanes."""
    low, high = (rows[0] for rows in sides_beyond_far_edge(context, context.ego_extents))
    least = context.thresholds.touching_m
    on_both: Flags = (low < -least) & (high > least)
    return on_both


def about_the_middle(context: DriveContext) -> Flags:
    """Mask of states in which ego is on the other half, or on both, or may be on the other one.

    Where places are known so badly that a body which is certainly on one half may be wholly on it,
    no state on both halves need lead to those on the other.
    """
    return oncoming_side(context).possible | on_both_halves(context)


def sides_beyond_far_edge(context: DriveContext, bodies: RoadExtents) -> tuple[Floats, Floats]:
    """How far (m) the nearer and the farther side of bodies, by row, are beyond ego's far edge."""
    first, end = context.lane_edges
    if context.side == "right":
        return bodies.from_bound(end)
    right, left = bodies.from_bound(first)
    return -left, -right


@once
def oncoming_side(context: DriveContext) -> Truth:
    """Whether ego drives along the other half of a two-way road.

    That half is beyond the far edge of the lanes of its direction; junctions have none.
    """
    beyond = _beyond_far_edge(context)
    drives = _along_road(context) & ~at_junctions(context) & _on_map(context)
    return drives & two_way(context) & Truth(beyond > _loose(context), beyond > 0)


def two_way(context: DriveContext) -> Truth:
    """Whether ego is on a road with traffic both ways, where the map says it."""
    directions = context.surroundings.directions
    return ~own_lanelets(context).told(lambda lanelet: directions(lanelet.id)[0])


def _loose(context: DriveContext) -> Floats:
    """How far (m) ego's middle may be beyond a bound and still count as on its own side."""
    error: Floats = context.tolerances.place_m + np.abs(context.map_offset_m)
    return np.maximum(context.thresholds.changed_m, error)


def _beyond_far_edge(context: DriveContext) -> Floats:
    """How far (m) ego's middle is beyond the far edge of the lanes that lead its way."""
    right, left = beyond_edges(context)
    return left if context.side == "right" else right


def beyond_near_edge(context: DriveContext) -> Floats:
    """How far (m) ego's middle is beyond the road's edge at its near side."""
    right, left = beyond_edges(context)
    return right if context.side == "right" else left


def _along_road(context: DriveContext) -> Flags:
    drives = context.ego_moves
    along: Flags = drives & (np.abs(context.ego_extents.turned[0]) <= _ALONG_RAD)
    return along


def at_junctions(context: DriveContext) -> Flags:
    """Mask of states in a junction, or so near that ego already or still turns there."""
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    near, reach = np.zeros(context.states, dtype=bool), context.thresholds.side_road_m
    for start, end in context.road.junctions:
        near |= (front >= start - reach) & (rear <= end + reach)
    return near


def _on_map(context: DriveContext) -> Flags:
    middle, borders = context.ego_extents.s[0], context.road.borders
    on_map: Flags = (middle >= borders[0]) & (middle <= borders[-1])
    return on_map


@word("u_turn")
def _u_turn(context: DriveContext) -> Truth:
    return u_turns(context)


@word("joins_road")
def _joins_road(context: DriveContext) -> Truth:
    """Whether ego drives onto the road from where it stood beside it.

    Unknown where ego comes from beside the road at an angle, or is there when first seen, since the
    map may leave out a road; and where it turns round, since its road is not certain yet.
    """
    outside = (beyond_near_edge(context) > _loose(context)) & _on_map(context)
    inside = beyond_near_edge(context) <= 0
    joins, seems = np.zeros((2, context.states), dtype=bool)
    stands = outside & ~context.ego_moves
    reach, spans = context.steps_in(context.thresholds.setting_off_s), context.spans
    comes = (spans.enters(inside).nonzero()[0] - 1).tolist()
    if not comes:
        return Truth.known(joins)
    last_inside, last_stood = spans.latest(inside), spans.latest(stands)
    for state in comes:
        left, stood, first = (
            int(last_inside[state]),
            int(last_stood[state]),
            int(spans.first[state]),
        )
        span = slice(max(stood, left, state - reach, first - 1) + 1, state + 2)
        if outside[span].any() or stood >= first:
            (joins if stood > left and state - stood <= reach else seems)[span] = True
    truth = Truth(joins, joins | seems)
    if joins.any():
        swings = swings_round(context) | u_turns(context).unknown
        truth = truth.unknown_at(joins & context.spans.within(swings, reach, around=True))
    return truth
