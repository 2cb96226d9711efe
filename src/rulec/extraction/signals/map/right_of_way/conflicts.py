"""Conflicts at junctions: who reaches the place where two ways cross or join, and who yields.

A participant is in conflict with ego if ego gets there first although the other would be there
within ``yielding_s`` after ego, or does come within ``held_up_s`` although it would have been there
that soon; and if ego drives into the side of one that is there. A participant that ego lets pass is
not in conflict, unless it runs into ego. One that comes more than ``_LATE_S`` after ego has got
there and has had to stand there is only perhaps in conflict; likewise one that brakes hard for ego
and then comes later than ``held_up_s``: how long it waits does not show why it braked.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import ceil, sqrt
from typing import TypeAlias

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.bodies import collide, gap_s
from rulec.extraction.signals.map.right_of_way.oncoming_priority import SLOWEST_MPS
from rulec.extraction.signals.map.right_of_way.own_reasons import slows_for_itself
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.junction_passages import Passage
from rulec.extraction.tracks.tracks import Flags
from rulec.trace.plain_arrays import zero_if_nan

FROM_SIDES = ("conflict_from_left", "conflict_from_right")
ONCOMING = "in_way_of_oncoming"
ARRIVALS = ("arrived_together", "other_arrived_first", "other_in_junction")

LONGEST_WAIT_S = 10.0
"""A vehicle that ego has made stop may wait for this long before it goes on."""

_DRIVES_MPS = 3.0
"""A vehicle that drives more slowly in a junction may wait there."""

_SLOWED = 0.9
"""A vehicle that keeps more of its speed was not made to brake: speeds vary this much anyway."""

_BRIEFLY_S = 1.0
"""Speeds are means over this time (s): shorter braking does not hold up a vehicle."""

_NEAR = 0.7
"""Who comes within this part of ``yielding_s`` is near, whatever it slows down for."""

_GRAZES_M = 0.15
"""Boxes that overlap by no more do not show that bodies do, since bodies have rounded corners."""

_CLEAR_M = 0.5
"""A body this far (m) from another one, beyond the tolerance of places, is clear of it."""

_BEHIND_S = 0.3
"""A vehicle that reaches a place this short a time before another has left it passes behind it."""

_SEES_S = 2.0
"""This long before ego drives in, others may see that it will, and brake."""

_STRAIGHT_RAD = 0.3
"""A vehicle that turns by less goes straight on."""

_LATE_S = 10.0
"""A vehicle that comes this long after ego reached a place may not have been in sight before."""

_AMPLE_S = 6.0
"""Who drives in this long (s) before another one can come has left it time enough."""

_SPEEDS_UP_MPS2 = 2.0
"""So much faster a vehicle may become after its track has ended."""

Passing: TypeAlias = tuple[Passage, float | None, float | None]
"""A passage, and when (in columns) it enters and leaves the place where ways meet."""


@dataclass(frozen=True, slots=True)
class Encounter:
    """Another participant whose way crosses ego's, and the time in which the two are in conflict.

    In columns of the drive; from ``enters`` on ego is in its way. ``known`` is False if the
    recording ends before it is clear.
    """

    kinds: tuple[str, ...]
    first: int
    enters: int
    last: int
    known: bool
    other: Passage
    together: bool
    comes_first: bool


def first_column(context: DriveContext) -> int:
    """The column of the drive's first state."""
    return int(context.columns[0])


def side_of(angle: float) -> str:
    """The word for a direction (degrees to the left of ego's) of arrival; empty for ego's own."""
    if abs(angle) < 30.0:
        return ""
    return ONCOMING if abs(angle) > 135.0 else FROM_SIDES[0] if angle < 0 else FROM_SIDES[1]


def drives_in(context: DriveContext, own: Passage) -> int:
    """The column in which ego drives in: where it moves off, if it waits within the junction."""
    passages = context.surroundings.passages
    speed = passages.tracks.speed[own.row, own.first : own.last + 1]
    waits = (speed < SLOWEST_MPS).nonzero()[0]
    return own.first + int(waits[-1]) if len(waits) else passages.front_enters(own)


def in_conflict(
    context: DriveContext, ego: Passing, foe: Passing, left_m: float = 0.0
) -> tuple[int, bool] | None:
    """The column from which another vehicle conflicts with ego, and whether surely; or None.

    ``left_m``: how far the other is from the place where ways meet, if its track ends before.
    """
    own, other = ego[0], foe[0]
    (enters, leaves), (comes, passed) = (tuple(map(_column, when[1:])) for when in (ego, foe))
    if enters is None or (passed is not None and passed <= enters):
        return None
    if comes is not None and comes < enters:
        return _runs_into(context, (own, enters), (other, passed))
    if _is_there_at_first(context, own, ego[1]) and _is_there_at_first(context, other, foe[1]):
        # It was not recorded which of the two got there first
        return enters, False
    speed = context.surroundings.passages.tracks.speed[own.row, enters:passed]
    waits = speed.min(initial=np.inf) < SLOWEST_MPS
    held_up = _held_up(context, (own, enters, ego[2]), other, (foe[1], left_m))
    if held_up is not None and passed is not None and (leaves is None or passed < leaves):
        return _let_pass(context, (own, slice(enters, passed)), other, held_up, waits=waits)
    return held_up


def _let_pass(
    context: DriveContext,
    ego: tuple[Passage, slice],
    other: Passage,
    held_up: tuple[int, bool],
    *,
    waits: bool,
) -> tuple[int, bool] | None:
    """``in_conflict`` for a vehicle that passed where ways meet while ego was there.

    Ego lets others pass even if it waits a little too far ahead, so that they drive round it, or
    creeps on behind them. It is not sure if they brake, as that may be because of ego.
    """
    own, there = ego
    if collide(context, own, other, there):
        return (held_up[0], collide(context, own, other, there, _GRAZES_M)) if waits else held_up
    present = context.surroundings.passages.tracks.present[other.row].nonzero()[0]
    first = max(int(present[0]), own.first)
    brakes = not waits and _slows_down(context, other, first, there.stop)
    return (held_up[0], False) if brakes else None


def _is_there_at_first(context: DriveContext, passage: Passage, when: float | None) -> bool:
    """Whether a participant is where ways meet in the first state in which it is recorded."""
    present = context.surroundings.passages.tracks.present[passage.row]
    return when is not None and when <= int(present.argmax())


def _runs_into(
    context: DriveContext, ego: tuple[Passage, int], foe: tuple[Passage, int | None]
) -> tuple[int, bool] | None:
    """``in_conflict`` for a vehicle that got there first, into whose side ego drives.

    If the ways join, ego drives in behind it; if bodies meet nevertheless, it is not sure who ran
    into whom. If ego brakes meanwhile, it may see the vehicle and stop short of it, on lanes that
    are narrower than on the map; if it creeps on behind, it does not touch it. A slow vehicle may
    wait there, unless ego runs into it. One behind which ego passes is not in conflict: where ways
    cross at a slant the place is longer than bodies.
    """
    passages = context.surroundings.passages
    (own, enters), (other, passed) = ego, foe
    ways = passages.way(own), passages.way(other)
    present = passages.tracks.present[other.row].nonzero()[0]
    first = max(int(present[0]), first_column(context))
    until = int(present[-1]) + 1 if passed is None else passed
    if ways[0].names & ways[1].names or ways[0].exits & ways[1].exits:
        meet = collide(context, own, other, slice(enters, until), _GRAZES_M)
        return (first, False) if meet else None
    slowest = passages.tracks.speed[[own.row, other.row], enters:until].min(axis=1, initial=np.inf)
    there = slice(enters, until)
    drive = bool((slowest > (SLOWEST_MPS, _DRIVES_MPS)).all()) or (
        bool((slowest > (_DRIVES_MPS, SLOWEST_MPS)).all())
        and collide(context, own, other, there, _GRAZES_M)
    )
    if not drive:
        return None
    if not collide(context, own, other, there, _GRAZES_M):
        briefly = (until - enters) * context.recording.step_s <= _BEHIND_S
        behind = gap_s(context, (own, other), (enters, until)) >= context.thresholds.yielding_s
        near_m = _CLEAR_M + 2 * context.tolerances.place_m
        if (briefly or behind) and not collide(context, own, other, there, -near_m):
            return None
        if briefly or behind or slowest[0] < _DRIVES_MPS:
            return first, False
    return first, not _slows_down(context, own, enters, until)


def _column(when: float | None) -> int | None:
    """The first column that is not before a time."""
    return None if when is None else ceil(when)


def _held_up(
    context: DriveContext,
    ego: tuple[Passage, int, float | None],
    other: Passage,
    there: tuple[float | None, float],
) -> tuple[int, bool] | None:
    """``in_conflict`` for a vehicle that gets there later than ego, or not before its track ends.

    ``there``: in which column, or how far (m) it still has to go at its end. It is not sure if its
    track ends before, as it may come no sooner than it can, or later.
    """
    passages, (_, enters, leaves) = context.surroundings.passages, ego
    until = passages.tracks.x.shape[1] - 1 if leaves is None else leaves
    present, (at, left_m) = passages.tracks.present[other.row].nonzero()[0], there
    first, end = max(int(present[0]), first_column(context)), int(present[-1])
    if min(enters, end) < first:
        return None
    if at is not None:
        return _held_up_until(context, ego, other, (first, at, until))
    if end < until:
        return first, False
    speed = max(float(zero_if_nan(passages.tracks.speed[other.row, end])), 0.0)
    soonest_s = (sqrt(speed**2 + 2 * _SPEEDS_UP_MPS2 * left_m) - speed) / _SPEEDS_UP_MPS2
    at = end + soonest_s / context.recording.step_s
    found = _held_up_until(context, ego, other, (first, at, until), left_m)
    return found and (found[0], False)


def _held_up_until(
    context: DriveContext,
    ego: tuple[Passage, int, float | None],
    other: Passage,
    times: tuple[int, float, float],
    left_m: float = 0.0,
) -> tuple[int, bool] | None:
    """``in_conflict`` for a vehicle that gets there later than ego.

    ``times``: the first column of the two, when the other gets there, and when ego has left;
    ``left_m``: how far (m) the other still has to go when its track ends.
    """
    limits, step_s = context.thresholds, context.recording.step_s
    passages = context.surroundings.passages
    (own, enters, leaves), (first, at, until) = ego, times
    present = passages.tracks.present[other.row].nonzero()[0]
    last = min(enters, int(present[-1]))
    columns, comes = np.arange(first, last + 1), ceil(at)
    decides = min(max(_decides(context, own, enters) - first, 0), last - first)
    train, late_s = _is_train(context, own, other), (at - until) * step_s
    if late_s < (limits.held_up_s if train else limits.yielding_s):
        drove_on = leaves is not None or _drives_on(context, own, comes)
        drives_in = min(max(passages.front_enters(own), first), last)
        late = (at - enters) * step_s > _LATE_S and _stood(context, own, enters, until)
        late |= _catches_up(context, (own, enters, until), other, at, left_m)
        # The meeting place is wider than the bodies. One that slows down for itself, and whose body
        # does not come that soon, is not disturbed
        own_reason = (
            not (train or late_s < _NEAR * limits.yielding_s)
            and _slows_for_itself(context, ego, other, first + decides, comes)
            and gap_s(context, (own, other), (enters, comes)) >= limits.yielding_s
        )
        waits = _stands(context, other, drives_in) or own_reason
        return first, drove_on and not late and not waits
    travelled = passages.travelled[other.row]
    way = np.interp(at, np.arange(len(travelled)), travelled) + left_m - travelled[columns]
    speed = np.maximum(passages.tracks.speed[other.row, columns], 0.1)
    soon = columns + way / speed / step_s - until < limits.yielding_s / step_s
    # A vehicle that speeds up when ego is already in the junction was not held up by ego's driving
    # in
    waits_longer = late_s >= limits.held_up_s
    if waits_longer or not (soon[decides] and soon[-1]):
        before = max(decides - round(_SEES_S / step_s), 0)
        braked = soon[before] and _brakes_for(
            context, other, (first + before, int(until)), comes, may_turn=not waits_longer
        )
        if not braked:
            return None
        decides = before
    # Nor was one that brakes once ego is gone
    elif not _slows_down(context, other, first + decides, int(until)):
        return None
    own_reason = _slows_for_itself(context, ego, other, first + decides, comes)
    if waits_longer and own_reason:
        return None
    unsure = leaves is None or own_reason or waits_longer
    unsure = unsure or _catches_up(context, (own, enters, until), other, at, left_m)
    return int(columns[soon.argmax()]), not unsure


def _slows_for_itself(
    context: DriveContext,
    ego: tuple[Passage, int, float | None],
    other: Passage,
    first: int,
    comes: int,
) -> bool:
    """Whether a vehicle gets slower, while ego is on its way there, and not only for ego."""
    (own, _, leaves), step_s = ego, context.recording.step_s
    last = comes if leaves is None else int(leaves)
    until = min(last + round(_BRIEFLY_S / step_s), comes)
    return _slows_down(context, other, first, last) and slows_for_itself(
        context, (own.row, other.row), (first, until)
    )


def _is_train(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Whether a train comes to a level crossing: there ego waits as soon as it is near."""
    passages, lanelets = context.surroundings.passages, context.recording.lanelets
    on_crossing = any("level_crossing" in lanelets[x].types for x in passages.way(own).names)
    return on_crossing and passages.way(other).on_rails


def _brakes_for(
    context: DriveContext,
    other: Passage,
    columns: tuple[int, int],
    comes: int,
    *,
    may_turn: bool,
) -> bool:
    """Whether a vehicle brakes harder than ``disturbing_mps2`` then, and not to turn.

    It goes straight on from where it brakes: one that drives onto a ring turns aside and back. Or
    if it ``may_turn``, it comes to a stand, which no turn asks for.
    """
    tracks = context.surroundings.passages.tracks
    begin, end = columns
    there = other.row, slice(begin, end + 1)
    least = -context.thresholds.disturbing_mps2
    hard = (tracks.acceleration[there] + tracks.acceleration_error[there] < least).nonzero()[0]
    if not len(hard):
        return False
    brakes = begin + int(hard[0])
    speed = tracks.speed[other.row, brakes : max(comes, brakes) + 1]
    if may_turn and (speed < SLOWEST_MPS).any():
        return True
    heading = tracks.heading[other.row, brakes : max(comes, brakes) + 1]
    return bool(np.ptp(np.unwrap(heading[~np.isnan(heading)])) < _STRAIGHT_RAD)


def _stood(context: DriveContext, own: Passage, first: int, last: float) -> bool:
    """Whether ego stood between two columns: it may have driven in before those that came then."""
    speed = context.surroundings.passages.tracks.speed[own.row, first : int(last) + 1]
    return bool((speed < SLOWEST_MPS).any())


def _catches_up(
    context: DriveContext,
    ego: tuple[Passage, int, float],
    other: Passage,
    at: float,
    left_m: float,
) -> bool:
    """Whether another one comes so soon after ego only because ego is held up, as in a queue.

    When ego drove in, it could not come for a long time, however it sped up. ``at``: when it does,
    and ``left_m``: how far (m) it still has to go then.
    """
    (own, enters, until), passages = ego, context.surroundings.passages
    speed, comes = passages.tracks.speed[own.row], ceil(at)
    waits = (speed[own.first : enters + 1] < SLOWEST_MPS).nonzero()[0]
    # Where it moves off, if it has waited within the junction
    drives_in = own.first + int(waits[-1]) if len(waits) else passages.front_enters(own)
    is_held_up = bool((speed[enters : int(until) + 1] < _DRIVES_MPS).any())
    if not is_held_up or comes <= drives_in:
        return False
    travelled = passages.travelled[other.row]
    begin = max(drives_in, int(passages.tracks.present[other.row].argmax()))
    way = float(np.interp(at, np.arange(len(travelled)), travelled) + left_m - travelled[begin])
    speeds = passages.tracks.speed[other.row, begin : comes + 1]
    now, fastest = float(speeds[0]), float(np.fmax.reduce(speeds))
    gains_s = (fastest - now) / _SPEEDS_UP_MPS2
    soonest_s = gains_s + max(way - (now + fastest) / 2 * gains_s, 0.0) / max(fastest, SLOWEST_MPS)
    return soonest_s > _AMPLE_S


def _stands(context: DriveContext, other: Passage, column: int) -> bool:
    """Whether a vehicle stands before the junction as ego drives in, maybe because of others."""
    speed = context.surroundings.passages.tracks.speed[other.row, column]
    return bool(speed < SLOWEST_MPS) and column < other.first


def _slows_down(context: DriveContext, other: Passage, first: int, last: int) -> bool:
    """Whether a participant is clearly slower for a while than in ``first``, then or later."""
    passages, step_s = context.surroundings.passages, context.recording.step_s
    steps = max(round(_BRIEFLY_S / step_s), 1)
    travelled = passages.travelled[other.row, first : max(last, first) + steps + 1]
    steps = min(steps, len(travelled) - 1)
    slowest = float((travelled[steps:] - travelled[:-steps]).min()) / steps / step_s
    return slowest < _SLOWED * float(passages.tracks.speed[other.row, first])


def _decides(context: DriveContext, own: Passage, enters: int) -> int:
    """The last column in which ego could wait before driving into the junction, or on in it."""
    speed = context.surroundings.passages.tracks.speed[own.row, own.first : enters + 1]
    waits = (speed < _DRIVES_MPS).nonzero()[0]
    return min(own.first, enters) + (int(waits[-1]) if len(waits) else 0)


def _drives_on(context: DriveContext, own: Passage, comes: int) -> bool:
    """Whether ego, whose track ends there, drove on when the other came, and did not wait."""
    tracks = context.surroundings.passages.tracks
    there = tracks.present[own.row, comes:].nonzero()[0] + comes
    longer = len(there) * context.recording.step_s > _BEHIND_S
    return longer and bool((tracks.speed[own.row, there] > _DRIVES_MPS).all())


def arrivals(
    context: DriveContext, encounters: Iterable[Encounter], strangers: Mapping[str, Flags]
) -> SignalColumns:
    """Whether one in conflict with ego arrived together with it or earlier, or is in the junction.

    Rules ask this of those who come from the sides, in ``encounters`` or maybe as ``strangers``; so
    it is told of those who come towards ego, on a ring or on rails only if nobody does. Of those
    who arrive together, some laws let only one from the right go first: where one comes from there,
    but only one from the left arrived together with ego, it is unknown, as the two would seem one.
    """
    known, perhaps = _by_side(context, encounters)
    beside = [flags for name, flags in strangers.items() if name not in FROM_SIDES]
    perhaps |= np.array([*(strangers[name] for name in FROM_SIDES), np.any(beside, axis=0)])
    nobody_from_side: Flags = ~np.any(known[-1, :2] | perhaps[-1, :2], axis=0)
    known[:-1, 2] &= nobody_from_side
    perhaps[:-1, 2] &= nobody_from_side
    found: Flags = np.any(known, axis=1)
    unknown: Flags = np.any(perhaps, axis=1) & ~found
    right = FROM_SIDES.index("conflict_from_right")
    unknown[0] |= found[0] & known[-1, right] & ~known[0, right]
    return SignalColumns(
        {word: found[number] for number, word in enumerate(ARRIVALS)},
        unknown={word: unknown[number] for number, word in enumerate(ARRIVALS)},
    )


def _by_side(context: DriveContext, encounters: Iterable[Encounter]) -> tuple[Flags, Flags]:
    """Where ``ARRIVALS`` are true of encounters that are known, and of others.

    By word, after which come the encounters themselves; by side, after which come all others; and
    by state.
    """
    met: Flags = np.zeros((2, len(ARRIVALS) + 1, len(FROM_SIDES) + 1, context.states), dtype=bool)
    for one in encounters:
        side = FROM_SIDES.index(one.kinds[0]) if one.kinds[0] in FROM_SIDES else len(FROM_SIDES)
        inside = max(one.first, one.other.first - first_column(context))
        begins = (one.first, one.first, inside, one.first)
        for word, holds in enumerate((one.together, one.comes_first, True, True)):
            met[int(not one.known), word, side, begins[word] : one.last + 1] |= holds
    return met[0], met[1]
