"""Conflicts at junctions: whether ego takes the way of one that comes to where their ways meet.

Ego takes another one's way, though it is first where their ways meet, if the other's body is where
ego's was less than ``yielding_s`` later; if the other gets to the place that soon after ego has
left it, and got slower; or if it gets there within ``held_up_s``, would have been there that soon
at the speed it had when it saw ego drive in, and braked harder than ``disturbing_mps2`` although
nothing but ego told it to. Ego does not if the other comes later and has not become slower, or
could not have come that soon; nor if it passes clear of ego, as fast as before. Between the two it
is unknown: who brakes gently may do so for a bend, a sign or somebody else.

The time between two bodies is the post-encroachment time (SAE J2944). Others see that ego will
drive in ``reaction_s`` before it does.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
import shapely

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.bodies import gap_s
from rulec.extraction.signals.map.right_of_way.oncoming_priority import SLOWEST_MPS
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.extraction.tracks.at_junctions.junctions import entry_lights
from rulec.recordings.recording import GIVE_WAY_SIGNS, LIMIT_SIGN, STOP_SIGNS
from rulec.trace.plain_arrays import zero_if_nan

FROM_SIDES = ("conflict_from_left", "conflict_from_right")
ONCOMING = "in_way_of_oncoming"

LONGEST_WAIT_S = 10.0
"""A vehicle that ego has made stop may wait for this long before it goes on."""

DRIVES_MPS = 3.0
"""A vehicle that drives more slowly in a junction may wait there."""

_SLOWED = 0.9
"""A vehicle that keeps more of its speed was not made to brake: speeds vary this much anyway."""

_BRIEFLY_S = 1.0
"""Speeds are means over this time (s): shorter braking does not hold up a vehicle."""

_SPEEDS_UP_MPS2 = 2.0
"""So much faster a vehicle may become."""

_STRAIGHT_RAD = 0.3
"""A vehicle that turns by less goes straight on."""

_AHEAD_S = 6.0
"""One does not brake yet for what it gets to later than this after ego has left."""

_IN_WAY_M = 1.5
"""Somebody whose middle is nearer than this to the way that a vehicle will drive is in its way."""

_AMPLE_S = 6.0
"""Who drives in this long (s) before another one can come has left it time enough."""

_GRAZES_M = 0.15
"""Boxes that overlap by no more do not show that bodies do, since bodies have rounded corners."""

_CLEAR_M = 0.4
"""A body this far (m) from another one, beyond the tolerance of places, is clear of it."""


@dataclass(frozen=True, slots=True)
class Passing:
    """A passage, and when (in columns) it enters and leaves the place where ways meet."""

    passage: Passage
    enters: float | None
    leaves: float | None


@dataclass(frozen=True, slots=True)
class Encounter:
    """Another participant whose way crosses ego's, and the time in which the two are in conflict.

    In columns of the drive; from ``enters`` on ego is in its way. ``known`` is False if the
    recording ends before it is clear, and ``together`` and ``comes_first`` None if they are not.
    """

    kinds: tuple[str, ...]
    first: int
    enters: int
    last: int
    known: bool
    other: Passage
    together: bool | None
    comes_first: bool | None


def side_of(angle: float) -> str:
    """The word for a direction (degrees to the left of ego's) of arrival; empty for ego's own."""
    if abs(angle) < 30.0:
        return ""
    return ONCOMING if abs(angle) > 135.0 else FROM_SIDES[0] if angle < 0 else FROM_SIDES[1]


def in_conflict(
    context: DriveContext, ego: Passing, foe: Passing, left_m: float = 0.0
) -> tuple[int, bool] | None:
    """The column from which another vehicle conflicts with ego, and whether surely; or None.

    ``left_m``: how far the other is from the place where ways meet, if its track ends before.
    """
    present = context.surroundings.passages.tracks.present
    if ego.enters is None or (foe.leaves is not None and ceil(foe.leaves) <= ceil(ego.enters)):
        return None
    shown = [present[one.passage.row].nonzero()[0] for one in (ego, foe)]
    first, end = max(int(shown[1][0]), context.first_column), int(shown[1][-1])
    if min(ceil(ego.enters), end) < first:
        return None
    if foe.enters is not None and ego.enters <= shown[0][0] and foe.enters <= shown[1][0]:
        # It was not recorded which of the two got there first
        return ceil(ego.enters), False
    if foe.enters is not None and ceil(foe.enters) < ceil(ego.enters):
        takes = _takes_side(context, ego, foe)
    else:
        takes = _takes_way(context, ego, foe, left_m)
    return None if takes is False else (first, takes is True)


def _takes_way(context: DriveContext, ego: Passing, foe: Passing, left_m: float) -> bool | None:
    """Whether ego takes the way of one that gets there later, or after its track's end."""
    passages, limits = context.surroundings.passages, context.thresholds
    own, other, tracks = ego.passage, foe.passage, passages.tracks
    speed, travelled = tracks.speed[other.row], passages.travelled[other.row]
    shown, step_s = tracks.present[other.row].nonzero()[0], context.recording.step_s
    until, (sees, moved_in) = _until(context, ego), _sees(context, ego, other)
    mps, at_end_mps = (max(float(zero_if_nan(speed[k])), 0.1) for k in (sees, shown[-1]))
    comes, ends_m = foe.enters, 0.0
    if comes is None:
        comes = shown[-1] + _arrives_s(at_end_mps, _SPEEDS_UP_MPS2, left_m) / step_s
        ends_m = left_m
    way_m = float(np.interp(comes, np.arange(len(travelled)), travelled) - travelled[sees]) + ends_m
    gains = np.fmax.reduce(tracks.acceleration[other.row, sees : moved_in + 1], initial=0.0)
    soonest_s = _arrives_s(mps, min(float(gains), _SPEEDS_UP_MPS2), way_m)
    # Who stands in a queue there may have driven in long before the other one was near
    slowest = np.fmin.reduce(tracks.speed[own.row, ceil(ego.enters or 0) : int(until) + 1])
    knows = foe.enters is not None and not (slowest < DRIVES_MPS and soonest_s > _AMPLE_S)
    train, late_s = is_train(context, own, other.row), (comes - until) * step_s
    within_s = limits.held_up_s if train else limits.yielding_s
    by_s = (until - sees) * step_s + within_s
    slower = slows_down(context, other, sees, int(until))
    if late_s >= within_s:
        if slower is False or soonest_s > by_s:
            return False
        soon, columns = way_m / mps < by_s, slice(sees, int(until) + 1)
        held_up = soon and _brakes_for_nobody_else(context, ego, foe, columns)
        if late_s >= limits.held_up_s:
            return None if held_up else False
        return (knows and held_up) or None
    if not train and _is_near(context, ego, foe, _CLEAR_M, comes) is False:
        stands = np.fmin.reduce(speed[sees : ceil(comes) + 1]) < SLOWEST_MPS
        # Nobody saw where ego was before its track began
        came = (ego.enters or 0) > tracks.present[own.row].argmax()
        if slower is False and came and not stands and not _join(context, own, other):
            return False
    passed = foe.leaves is not None and foe.leaves < until
    if passed and not _is_near(context, ego, foe, 0.0, comes):
        # It drove round ego, or ego crept on behind it
        clear = _is_near(context, ego, foe, -_GRAZES_M, comes) is False
        return False if slower is False and clear else None
    waits = speed[moved_in] < SLOWEST_MPS and moved_in < other.first
    takes = _is_near(context, ego, foe, -_GRAZES_M, comes) or (
        (train or slower) and (ego.leaves is not None or _drives_on(context, own, ceil(comes)))
    )
    return bool(knows and takes and not waits) or None


def _takes_side(context: DriveContext, ego: Passing, foe: Passing) -> bool | None:
    """Whether ego takes the way of one that gets there earlier, and drives into its side.

    It is not known where ways join, as either may have run into the other, and if one of the two
    may wait there for the other.
    """
    speed, own, other = context.surroundings.passages.tracks.speed, ego.passage, foe.passage
    passed = ceil(_until(context, foe))
    if _is_near(context, ego, foe, _CLEAR_M, passed) is False:
        return False
    sees, moved_in = _sees(context, ego, other)
    came_mps = np.fmax.reduce(speed[other.row, sees : moved_in + 1])
    drives_mps = np.fmin.reduce(speed[own.row, moved_in : passed + 1])
    if came_mps < SLOWEST_MPS:
        return False
    drive = drives_mps > SLOWEST_MPS and speed[other.row, moved_in] > SLOWEST_MPS
    brakes = slows_down(context, own, ceil(ego.enters or 0), int(_until(context, ego)))
    if not drive or brakes is not False or _join(context, own, other):
        return None
    return _is_near(context, ego, foe, -_GRAZES_M, passed) or None


def _brakes_for_nobody_else(
    context: DriveContext, ego: Passing, foe: Passing, columns: slice
) -> bool:
    """Whether one brakes harder than is comfortable, and nothing but ego tells it to.

    Its way bends nowhere soon, no sign and no light stops it, no lower limit begins, nobody is
    slower ahead of it, and nobody else meets its way.
    """
    passages, other = context.surroundings.passages, foe.passage
    tracks, way, there = passages.tracks, passages.way(other), (other.row, columns)
    hardest = tracks.acceleration[there] + tracks.acceleration_error[there]
    if not (hardest < -context.thresholds.disturbing_mps2).any():
        return False
    lanelets = context.recording.lanelets
    beyond = [lanelets[name] for name in way.names | way.exits if name in lanelets]
    slow_mps = _SLOWED * tracks.speed[other.row, columns.start]
    ahead = slice(columns.start, columns.stop + context.steps_in(_AHEAD_S))
    seen = ahead.start + tracks.present[other.row, ahead].nonzero()[0]
    shown = range(tracks.first + columns.start, tracks.first + columns.stop)
    junction, rows = passages.junctions[other.junction], (ego.passage.row, other.row)
    path = shapely.LineString(np.column_stack([x[other.row, seen] for x in (tracks.x, tracks.y)]))
    slower = np.fmin.reduce(tracks.speed[:, columns], axis=1) < slow_mps
    slower &= tracks.present[:, columns.start]
    slower[list(rows)] = False
    places = shapely.points(tracks.x[slower, columns.start], tracks.y[slower, columns.start])
    return not (
        np.ptp(np.unwrap(tracks.heading[other.row, seen])) >= _STRAIGHT_RAD
        or any(entry.signs & (GIVE_WAY_SIGNS | STOP_SIGNS) for entry in way.approaches)
        or any(
            light.colour_at(column) != "green"
            for _, lights in entry_lights(way)
            for light in lights
            for column in shown
        )
        or any(LIMIT_SIGN in x.untold_signs or (x.limit_mps or np.inf) < slow_mps for x in beyond)
        or shapely.dwithin(places, path, _IN_WAY_M).any()
        or any(
            x.first < columns.stop and x.last >= columns.start and x.row not in rows
            for x in passages.through[other.junction]
            if x.way == other.way or junction.meeting(other.way, x.way) is not None
        )
    )


def _until(context: DriveContext, passing: Passing) -> float:
    """When (in columns) one has left the place where ways meet, or all tracks end."""
    end = context.surroundings.passages.tracks.x.shape[1] - 1
    return end if passing.leaves is None else passing.leaves


def _is_near(
    context: DriveContext, ego: Passing, foe: Passing, margin_m: float, until: float
) -> bool | None:
    """Whether the other's body is less than ``yielding_s`` later where ego's was.

    Ego's body is larger by a margin. None within the tolerance of places.
    """
    rows, times = (ego.passage.row, foe.passage.row), (ceil(ego.enters or 0), ceil(until))
    place_m, within_s = context.tolerances.place_m, context.thresholds.yielding_s
    if gap_s(context, rows, times, margin_m - place_m) < within_s:
        return True
    return (
        None
        if place_m and gap_s(context, rows, times, margin_m + 2 * place_m) < within_s
        else False
    )


def _join(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Whether two ways do not cross, but lead into one road."""
    ways = [context.surroundings.passages.way(passage) for passage in (own, other)]
    return bool(ways[0].names & ways[1].names or ways[0].exits & ways[1].exits)


def _arrives_s(mps: float, gains_mps2: float, way_m: float) -> float:
    """How long (s) one takes for a way at a speed that grows so much."""
    way_m = max(way_m, 0.0)
    return 2 * way_m / (mps + sqrt(mps**2 + 2 * gains_mps2 * way_m))


def is_train(context: DriveContext, own: Passage, row: int) -> bool:
    """Whether one is a train at a level crossing: there ego waits as soon as it is near."""
    passages, lanelets = context.surroundings.passages, context.recording.lanelets
    on_crossing = any("level_crossing" in lanelets[x].types for x in passages.way(own).names)
    # Its track may be a lane that buses share
    body = passages.tracks.participants[row]
    return on_crossing and "rail_vehicle" in body.object_types


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
    fastest = np.maximum.accumulate(np.append(passages.tracks.speed[other.row, first], means))
    if (means < _SLOWED * fastest[:-1]).any():
        return True
    return False if len(travelled) == end - first else None


def drives_in(context: DriveContext, own: Passage, last: int) -> int:
    """The column in which ego drives in: where it moves off, if it waits there until ``last``."""
    passages = context.surroundings.passages
    waits = (passages.tracks.speed[own.row, own.first : last + 1] < SLOWEST_MPS).nonzero()[0]
    return own.first + int(waits[-1]) if len(waits) else passages.front_enters[own]


def _sees(context: DriveContext, ego: Passing, other: Passage) -> tuple[int, int]:
    """When the other sees that ego will drive into the junction, or on in it, and when ego does.

    While the other is recorded.
    """
    passages, enters = context.surroundings.passages, ceil(ego.enters or 0)
    begin = min(passages.front_enters[ego.passage], enters)
    waits = (passages.tracks.speed[ego.passage.row, begin : enters + 1] < DRIVES_MPS).nonzero()[0]
    shown = passages.tracks.present[other.row].nonzero()[0]
    moved_in = begin + (int(waits[-1]) if len(waits) else 0)
    moved_in = min(max(moved_in, int(shown[0])), int(shown[-1]))
    return max(moved_in - context.steps_in(context.thresholds.reaction_s), int(shown[0])), moved_in


def _drives_on(context: DriveContext, own: Passage, comes: int) -> bool:
    """Whether ego, whose track ends there, drove on when the other came, and did not wait."""
    tracks = context.surroundings.passages.tracks
    there = tracks.present[own.row, comes:].nonzero()[0] + comes
    return len(there) > 1 and bool((tracks.speed[own.row, there] > DRIVES_MPS).all())
