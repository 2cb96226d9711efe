"""Conflicts at junctions: who reaches the place where two ways cross or join, and who yields.

A participant is in conflict with ego if ego gets there first although the other would be there
within ``yielding_s`` after ego, or does come within ``held_up_s`` although it would have been there
that soon; and if ego drives into the side of one that is there. A participant that ego lets pass is
not in conflict, unless it runs into ego. One that comes more than ten seconds after ego has got
there and has had to stand there is only perhaps in conflict; likewise one that brakes hard for ego
and then comes later than ``held_up_s``: how long it waits does not show why it braked; and one that
was speeding up as ego drove in, and then brakes: it is not known how soon it would have come.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.bodies import collide, collision, gap_s
from rulec.extraction.signals.map.right_of_way.held_up import (
    BEHIND_S,
    DRIVES_MPS,
    SEES_S,
    EgoThere,
    drives_in,
    held_up,
    slows_down,
)
from rulec.extraction.signals.map.right_of_way.oncoming_priority import SLOWEST_MPS
from rulec.extraction.tracks.at_junctions.junction_passages import Passage

FROM_SIDES = ("conflict_from_left", "conflict_from_right")
ONCOMING = "in_way_of_oncoming"

LONGEST_WAIT_S = 10.0
"""A vehicle that ego has made stop may wait for this long before it goes on."""

_GRAZES_M = 0.15
"""Boxes that overlap by no more do not show that bodies do, since bodies have rounded corners."""

_CLEAR_M = 0.5
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
    own, other = ego.passage, foe.passage
    enters, leaves = _column(ego.enters), _column(ego.leaves)
    comes, passed = _column(foe.enters), _column(foe.leaves)
    if enters is None or (passed is not None and passed <= enters):
        return None
    if comes is not None and comes < enters:
        return _runs_into(context, EgoThere.of(context, own, enters, leaves), other, passed)
    if _is_there_at_first(context, ego) and _is_there_at_first(context, foe):
        # It was not recorded which of the two got there first
        return enters, False
    speed = context.surroundings.passages.tracks.speed[own.row, enters:passed]
    waits = speed.min(initial=np.inf) < SLOWEST_MPS
    there = EgoThere.of(context, own, enters, ego.leaves)
    found = held_up(context, there, other, foe.enters, left_m)
    if found is not None and passed is not None and (leaves is None or passed < leaves):
        return _let_pass(context, own, other, slice(enters, passed), found, waits=waits)
    return found


def _let_pass(
    context: DriveContext,
    own: Passage,
    other: Passage,
    there: slice,
    found: tuple[int, bool],
    *,
    waits: bool,
) -> tuple[int, bool] | None:
    """``in_conflict`` for a vehicle that passed where ways meet while ego was there.

    Ego lets others pass even if it waits a little too far ahead, so that they drive round it, or
    creeps on behind them. It is not sure if they brake, as that may be because of ego. ``found`` is
    what holds if they had not passed.
    """
    if collide(context, own, other, there):
        return (found[0], collide(context, own, other, there, _GRAZES_M)) if waits else found
    present = context.surroundings.passages.tracks.present[other.row].nonzero()[0]
    first = max(int(present[0]), own.first)
    brakes = not waits and slows_down(context, other, first, there.stop) is not False
    return (found[0], False) if brakes else None


def _is_there_at_first(context: DriveContext, passing: Passing) -> bool:
    """Whether a participant is where ways meet in the first state in which it is recorded."""
    present = context.surroundings.passages.tracks.present[passing.passage.row]
    return passing.enters is not None and passing.enters <= int(present.argmax())


def _runs_into(
    context: DriveContext, ego: EgoThere, other: Passage, passed: int | None
) -> tuple[int, bool] | None:
    """``in_conflict`` for a vehicle that got there first, into whose side ego drives.

    If the ways join, ego drives in behind it; if bodies meet nevertheless, it is not sure who ran
    into whom. If ego brakes meanwhile, it may see the vehicle and stop short of it, on lanes that
    are narrower than on the map; if it creeps on behind, it does not touch it. A slow vehicle may
    wait there, unless it came up when ego drove in, or ego runs into it; one that stood before may
    be part of a queue. One behind which ego passes is not in conflict: where ways cross at a slant
    the place is longer than bodies.
    """
    passages = context.surroundings.passages
    own, enters = ego.passage, ego.enters
    ways = passages.way(own), passages.way(other)
    present = passages.tracks.present[other.row].nonzero()[0]
    first = max(int(present[0]), context.first_column)
    until = int(present[-1]) + 1 if passed is None else passed
    there = slice(enters, until)
    hit = collision(context, own, other, there, _GRAZES_M)
    if ways[0].names & ways[1].names or ways[0].exits & ways[1].exits:
        return None if hit is None else (first, False)
    # How fast they are after a collision does not show who drove or waited
    alone = slice(enters, until if hit is None else hit + 1)
    slowest = passages.tracks.speed[[own.row, other.row], alone].min(axis=1, initial=np.inf)
    moved_in = max(drives_in(context, own, enters), int(present[0]))
    sees = slice(max(moved_in - context.steps_in(SEES_S), 0), moved_in + 1)
    came_mps = max(slowest[1], np.fmax.reduce(passages.tracks.speed[other.row, sees]))
    drives_mps = DRIVES_MPS if hit is None else SLOWEST_MPS
    if not (slowest[0] > SLOWEST_MPS and came_mps > drives_mps):
        return None
    if hit is None:
        briefly = (until - enters) * context.recording.step_s <= BEHIND_S
        late_s = gap_s(context, (own.row, other.row), (enters, until))
        behind = late_s >= context.thresholds.yielding_s
        near_m = _CLEAR_M + 2 * context.tolerances.place_m
        if (briefly or behind) and not collide(context, own, other, there, -near_m):
            return None
        if briefly or behind or slowest.min() < DRIVES_MPS:
            return first, False
    moved_mps = max(slowest[1], passages.tracks.speed[other.row, moved_in])
    sure = moved_mps > SLOWEST_MPS and slowest.max() > DRIVES_MPS
    meanwhile = min(until, int(ego.until)) if ego.gone else until
    return first, bool(sure) and slows_down(context, own, enters, meanwhile) is False


def _column(when: float | None) -> int | None:
    """The first column that is not before a time."""
    return None if when is None else ceil(when)
