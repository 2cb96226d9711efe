"""Whether one that gets later than ego to where their ways meet is held up there by ego."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.bodies import gap_s
from rulec.extraction.signals.map.right_of_way.oncoming_priority import SLOWEST_MPS
from rulec.extraction.signals.map.right_of_way.own_reasons import slows_for_itself
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.trace.plain_arrays import zero_if_nan

DRIVES_MPS = 3.0
"""A vehicle that drives more slowly in a junction may wait there."""

BEHIND_S = 0.3
"""A vehicle that reaches a place this short a time before another has left it passes behind it."""

_SLOWED = 0.9
"""A vehicle that keeps more of its speed was not made to brake: speeds vary this much anyway."""

_BRIEFLY_S = 1.0
"""Speeds are means over this time (s): shorter braking does not hold up a vehicle."""

_NEAR = 0.7
"""Who comes within this part of ``yielding_s`` is near, whatever it slows down for."""

SEES_S = 2.0
"""This long before ego drives in, others may see that it will, and brake."""

_STRAIGHT_RAD = 0.3
"""A vehicle that turns by less goes straight on."""

_LATE_S = 10.0
"""A vehicle that comes this long after ego reached a place may not have been in sight before."""

_AMPLE_S = 6.0
"""Who drives in this long (s) before another one can come has left it time enough."""

_SPEEDS_UP_MPS2 = 2.0
"""So much faster a vehicle may become, such as after its track has ended."""

_BRAKED = 0.7
"""A vehicle that was speeding up and keeps less of its speed brakes: who only rolls keeps more."""

_GAINS_MPS2 = 0.5
"""Whose speed changes by less than this keeps it."""


@dataclass(frozen=True, slots=True)
class EgoThere:
    """Ego's passage, and when (in columns) it is at the place where its way meets another one.

    ``until`` it has left, or its track ends there; then it is not ``gone``.
    """

    passage: Passage
    enters: int
    until: float
    gone: bool

    @staticmethod
    def of(context: DriveContext, passage: Passage, enters: int, leaves: float | None) -> EgoThere:
        """Ego from when it enters the place to when it leaves it; None if its track ends there."""
        end = context.surroundings.passages.tracks.x.shape[1] - 1
        return EgoThere(passage, enters, end if leaves is None else leaves, leaves is not None)


def held_up(
    context: DriveContext, ego: EgoThere, other: Passage, at: float | None, left_m: float
) -> tuple[int, bool] | None:
    """``conflicts.in_conflict`` for one that gets there later than ego, or after its track's end.

    ``at``: in which column, or ``left_m``: how far (m) it still has to go at its end. It is not
    sure if its track ends before, as it may come no sooner than it can, or later.
    """
    tracks = context.surroundings.passages.tracks
    present = tracks.present[other.row].nonzero()[0]
    first, end = max(int(present[0]), context.first_column), int(present[-1])
    if min(ego.enters, end) < first:
        return None
    if at is not None:
        return _held_up_until(context, ego, other, at)
    if end < ego.until:
        return first, False
    speed = max(float(zero_if_nan(tracks.speed[other.row, end])), 0.0)
    at = end + _soonest_s(speed, _SPEEDS_UP_MPS2, left_m) / context.recording.step_s
    found = _held_up_until(context, ego, other, at, left_m)
    return found and (found[0], False)


def _held_up_until(
    context: DriveContext, ego: EgoThere, other: Passage, at: float, left_m: float = 0.0
) -> tuple[int, bool] | None:
    """``held_up`` for a vehicle of which it is known when it gets there.

    ``left_m``: how far (m) the other still has to go when its track ends.
    """
    limits, step_s = context.thresholds, context.recording.step_s
    passages = context.surroundings.passages
    own, enters, until = ego.passage, ego.enters, ego.until
    present = passages.tracks.present[other.row].nonzero()[0]
    first, last = max(int(present[0]), context.first_column), min(enters, int(present[-1]))
    columns, comes = np.arange(first, last + 1), ceil(at)
    decides = min(max(_decides(context, own, enters) - first, 0), last - first)
    train, late_s = is_train(context, own, other.row), (at - until) * step_s
    if late_s < (limits.held_up_s if train else limits.yielding_s):
        drove_on = ego.gone or _drives_on(context, own, comes)
        moved_in = min(max(passages.front_enters[own], first), last)
        late = (at - enters) * step_s > _LATE_S and _stood(context, own, enters, until)
        late |= _catches_up(context, ego, other, at, left_m)
        # The meeting place is wider than the bodies, and where ways join it is longer. One that
        # drives on, or slows down for itself, and whose body does not come that soon, is not
        # disturbed
        undisturbed = (
            not train
            and (
                _keeps_driving(context, other, first + decides, comes)
                or (
                    late_s >= _NEAR * limits.yielding_s
                    and _slows_for_itself(context, ego, other, first + decides, comes)
                )
            )
            and gap_s(context, (own.row, other.row), (enters, comes)) >= limits.yielding_s
        )
        waits = _stands(context, other, moved_in) or undisturbed
        return first, drove_on and not late and not waits
    travelled = passages.travelled[other.row]
    place = float(np.interp(at, np.arange(len(travelled)), travelled)) + left_m
    speed = np.maximum(passages.tracks.speed[other.row, columns], 0.1)
    arrives = columns + (place - travelled[columns]) / speed / step_s
    soon = arrives - until < limits.yielding_s / step_s
    # A vehicle that speeds up when ego is already in the junction was not held up by ego's driving
    # in
    waits_longer = late_s >= limits.held_up_s
    before = max(decides - round(SEES_S / step_s), 0)
    seen = slice(first + before, first + decides + 1)
    braked: bool | None
    if waits_longer or not (soon[decides] and soon[-1]):
        braked = bool(soon[before]) and _brakes_for(
            context, other, slice(first + before, int(until) + 1), comes, may_turn=not waits_longer
        )
        decides = before
    else:
        # Nor was one that brakes once ego is gone
        braked = slows_down(context, other, first + decides, int(until))
    if braked is False:
        return _stops_again(context, ego, other, seen, comes=comes, place=place)
    own_reason = _slows_for_itself(context, ego, other, first + decides, comes)
    if waits_longer and own_reason:
        return None
    unsure = not ego.gone or own_reason or waits_longer or braked is None
    unsure = unsure or _catches_up(context, ego, other, at, left_m)
    return int(columns[soon.argmax()]), not unsure


def _stops_again(
    context: DriveContext, ego: EgoThere, other: Passage, seen: slice, *, comes: int, place: float
) -> tuple[int, bool] | None:
    """``held_up`` for one that was speeding up as ego drove in, and then brakes.

    It would have come sooner than its speed tells; how much sooner is not known. ``seen``: when it
    may have seen that ego drives in; ``comes``: when it comes, and ``place``: where that is (m).
    """
    tracks, step_s = context.surroundings.passages.tracks, context.recording.step_s
    by = ego.until + context.thresholds.yielding_s / step_s
    gains = tracks.acceleration[other.row, seen] >= _GAINS_MPS2
    speeds_up = (seen.start + int(k) for k in gains.nonzero()[0])
    soon = next((k for k in speeds_up if _comes_by(context, other, k, place) < by), None)
    if soon is None:
        return None
    last = min(int(ego.until), int(tracks.present[other.row].nonzero()[0][-1]))
    speed = zero_if_nan(tracks.speed[other.row, soon : last + 1])
    fastest = np.maximum.accumulate(speed)
    slowed = ((fastest > SLOWEST_MPS) & (speed < _BRAKED * fastest)).nonzero()[0]
    there = slice(soon, last + 1)
    if not len(slowed) and not _brakes_for(context, other, there, comes, may_turn=False):
        return None
    brakes = soon + int(speed[: slowed[0] if len(slowed) else None].argmax())
    waits_longer = (comes - ego.until) * step_s >= context.thresholds.held_up_s
    if waits_longer and _slows_for_itself(context, ego, other, brakes, comes):
        return None
    return soon, False


def _comes_by(context: DriveContext, other: Passage, column: int, place: float) -> float:
    """When (in columns) one would be at a place (m) that goes on speeding up as about then."""
    passages, step_s = context.surroundings.passages, context.recording.step_s
    tracks, about = passages.tracks, round(_BRIEFLY_S / step_s)
    then = tracks.acceleration[other.row, max(column - about, 0) : column + about + 1]
    gains = min(float(np.fmax.reduce(zero_if_nan(then))), _SPEEDS_UP_MPS2)
    speed = float(zero_if_nan(tracks.speed[other.row, column]))
    left_m = max(place - float(passages.travelled[other.row, column]), 0.0)
    return column + _soonest_s(speed, gains, left_m) / step_s


def _soonest_s(speed: float, gains: float, left_m: float) -> float:
    """How long (s) one takes for a way that speeds up by so much (m/s²)."""
    return (sqrt(speed**2 + 2 * gains * left_m) - speed) / gains


def _slows_for_itself(
    context: DriveContext, ego: EgoThere, other: Passage, first: int, comes: int
) -> bool:
    """Whether a vehicle gets slower, while ego is on its way there, and not only for ego."""
    last = int(ego.until) if ego.gone else comes
    until = min(last + context.steps_in(_BRIEFLY_S), comes)
    rows = ego.passage.row, other.row
    slows = slows_down(context, other, first, last)
    return bool(slows) and slows_for_itself(context, rows, first, until)


def is_train(context: DriveContext, own: Passage, row: int) -> bool:
    """Whether one is a train at a level crossing: there ego waits as soon as it is near."""
    passages, lanelets = context.surroundings.passages, context.recording.lanelets
    on_crossing = any("level_crossing" in lanelets[x].types for x in passages.way(own).names)
    # Its track may be a lane that buses share
    body = passages.tracks.participants[row]
    return on_crossing and "rail_vehicle" in body.object_types


def _brakes_for(
    context: DriveContext, other: Passage, columns: slice, comes: int, *, may_turn: bool
) -> bool:
    """Whether a vehicle brakes harder than ``disturbing_mps2`` then, and not to turn.

    It goes straight on from where it brakes: one that drives onto a ring turns aside and back. Or
    if it ``may_turn``, it comes to a stand, which no turn asks for.
    """
    tracks = context.surroundings.passages.tracks
    there = other.row, columns
    least = -context.thresholds.disturbing_mps2
    hard = (tracks.acceleration[there] + tracks.acceleration_error[there] < least).nonzero()[0]
    if not len(hard):
        return False
    brakes = columns.start + int(hard[0])
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
    context: DriveContext, ego: EgoThere, other: Passage, at: float, left_m: float
) -> bool:
    """Whether another one comes so soon after ego only because ego is held up, as in a queue.

    When ego drove in, it could not come for a long time, however it sped up. ``at``: when it does,
    and ``left_m``: how far (m) it still has to go then.
    """
    passages = context.surroundings.passages
    speed, comes = passages.tracks.speed[ego.passage.row], ceil(at)
    moved_in = drives_in(context, ego.passage, ego.enters)
    is_held_up = bool((speed[ego.enters : int(ego.until) + 1] < DRIVES_MPS).any())
    if not is_held_up or comes <= moved_in:
        return False
    travelled = passages.travelled[other.row]
    begin = max(moved_in, int(passages.tracks.present[other.row].argmax()))
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


def slows_down(context: DriveContext, other: Passage, first: int, last: int) -> bool | None:
    """Whether a participant is clearly slower for a while than in ``first``, then or later.

    None if it is not until its track ends, and that is too soon to tell.
    """
    passages, step_s = context.surroundings.passages, context.recording.step_s
    steps = max(round(_BRIEFLY_S / step_s), 1)
    end = max(last, first) + steps + 1
    there = passages.tracks.present[other.row, first:end]
    travelled = passages.travelled[other.row, first:end][np.logical_and.accumulate(there)]
    means = (travelled[steps:] - travelled[:-steps]) / steps / step_s
    if (means < _SLOWED * passages.tracks.speed[other.row, first]).any():
        return True
    return False if len(travelled) == end - first else None


def _keeps_driving(context: DriveContext, other: Passage, first: int, last: int) -> bool:
    """Whether a vehicle drives between two columns, and does not get slower meanwhile."""
    speed = context.surroundings.passages.tracks.speed[other.row, first : last + 1]
    drives = bool(np.fmin.reduce(speed) > DRIVES_MPS)
    return drives and not slows_down(context, other, first, last)


def drives_in(context: DriveContext, own: Passage, last: int) -> int:
    """The column in which ego drives in: where it moves off, if it waits there until ``last``."""
    passages = context.surroundings.passages
    waits = (passages.tracks.speed[own.row, own.first : last + 1] < SLOWEST_MPS).nonzero()[0]
    return own.first + int(waits[-1]) if len(waits) else passages.front_enters[own]


def _decides(context: DriveContext, own: Passage, enters: int) -> int:
    """The last column in which ego could wait before driving into the junction, or on in it."""
    speed = context.surroundings.passages.tracks.speed[own.row, own.first : enters + 1]
    waits = (speed < DRIVES_MPS).nonzero()[0]
    return min(own.first, enters) + (int(waits[-1]) if len(waits) else 0)


def _drives_on(context: DriveContext, own: Passage, comes: int) -> bool:
    """Whether ego, whose track ends there, drove on when the other came, and did not wait."""
    tracks = context.surroundings.passages.tracks
    there = tracks.present[own.row, comes:].nonzero()[0] + comes
    longer = len(there) * context.recording.step_s > BEHIND_S
    return longer and bool((tracks.speed[own.row, there] > DRIVES_MPS).all())
