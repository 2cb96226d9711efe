"""What traffic may make ego brake, stand or be slow, and what surely does.

A vehicle ahead in ego's lane makes it slow; it makes it brake hard only if ego would run into it,
and stand only if it is near. A participant that gets first to where ways cross makes ego wait.
"""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.braking_causes.others_around import (
    CROSSES_M,
    Others,
    motion_of,
)
from rulec.extraction.signals.map.priority_signals import approach, own_passages, passages_of
from rulec.trace.cells import Cells

IN_WAY_M, COMES_M = 2.5, 6.0
"""Lateral distances within which a participant is in ego's way, and may come into it."""

REACH_M = 20.0
"""A participant this near ahead counts even for a standing ego."""

_SEEN_M, _WALKS_M = 60.0, 30.0
"""Lateral distances at which ego may consider participants that come to a junction, or walk."""

_SIDEWAYS_MPS, _ALIKE_MPS = 0.3, 3.0
_HOLDS_UP_M, _BRAKES_MPS2, _LEAST_MPS2, _NEAR_S, _REACTS_S = 10.0, 1.0, 0.5, 1.0, 2.0
"""A vehicle ahead within ``_HOLDS_UP_M`` makes ego stand; one that brakes this hard, or makes ego
do so, or is this near by time, makes it brake, up to ``_REACTS_S`` before or after."""

_WAITS_S, _THINKS_OF_S = 5.0, 8.0
"""How long before a participant reaches where ways meet ego may wait for it, and consider it."""


def led(context: DriveContext, brakes: Flags, reach: Floats) -> Flags:
    """Mask of states in which a vehicle ahead in ego's lane makes it brake, stand or be slow."""
    ahead = relations.station(context) == relations.BEHIND
    ahead &= context.relevant & context.in_ego_lane & (relations.gap(context) <= reach)
    cells, spans = Cells.at(ahead), context.spans
    if not len(cells):
        return np.zeros(context.states, dtype=bool)
    gap, theirs = cells.of(relations.gap(context)), np.maximum(cells.of(context.extents.along), 0.0)
    own, soon = context.ego.speed[0], context.steps_in(_REACTS_S)
    slow = theirs < cells.of(own) + _ALIKE_MPS
    held = (gap <= _HOLDS_UP_M) & slow
    came = cells.of(spans.most_of_last(own, soon))
    hard = (
        _closes(came - theirs, gap)
        | (cells.of(context.tracks.acceleration) <= -_BRAKES_MPS2) & slow
    )
    hard |= gap <= _NEAR_S * cells.of(own)
    by_speed = np.where(cells.of(context.ego_moves), slow, held)
    for_braking = spans.within(cells.in_columns(hard), soon, around=True)
    return np.where(brakes, for_braking, cells.in_columns(by_speed))


def may_be_others(context: DriveContext, others: Others, reach: Floats) -> tuple[Flags, Flags]:
    """Mask of the others' states with a participant ahead in ego's way, coming into it, or across.

    And of those with one on the far side that ego may not pass, and would pass without braking.
    """
    states, reach = others.states, reach[others.states]
    near = (others.ahead > -REACH_M / 4) & (others.ahead <= reach + REACH_M)
    found: Flags = np.logical_or.reduce(near & (others.away <= IN_WAY_M))
    cells = Cells.at(near & (others.away <= CROSSES_M) & ~found)
    rows, columns = cells.rows, cells.columns
    left, away = cells.of(others.left), cells.of(others.away)
    motion = motion_of(context, others.rows[rows], states[columns])
    comes = (away <= COMES_M) & (-motion.sideways * np.sign(left) > _SIDEWAYS_MPS)
    # Vehicles that ego may not pass on their near side
    to_far = left * (1 if context.side == "right" else -1)
    speed = context.ego.speed[0, states[columns]]
    slower = motion.goes_along & (motion.along < speed + _ALIKE_MPS)
    not_to_pass = slower & (to_far > 0) & (away <= COMES_M)
    found |= cells.in_columns(comes | (motion.goes_across & motion.moves) | not_to_pass)
    soon = context.steps_in(_REACTS_S)
    came = context.spans.most_of_last(context.ego.speed[0], soon)[states[columns]]
    gap = cells.of(others.ahead)
    closes = _closes(came - motion.along, gap)
    kept_back = cells.in_columns(not_to_pass & (gap > 0) & closes)
    rest = (~found).nonzero()[0]
    at = states[rest]
    in_lane = relations.station(context)[:, at] == relations.BEHIND
    in_lane &= context.relevant[:, at] & context.in_ego_lane[:, at]
    in_lane &= relations.gap(context)[:, at] <= reach[rest]
    found[rest] = in_lane.any(axis=0)
    return found, kept_back


def _closes(faster: Floats, gap: Floats) -> Flags:
    """Mask of those that ego, ``faster`` than them, runs into if it brakes by ``_LEAST_MPS2``."""
    closes: Flags = np.maximum(faster, 0.0) ** 2 / 2 >= _LEAST_MPS2 * np.maximum(gap, 1.0)
    return closes


def may_come(context: DriveContext, others: Others, reach: Floats) -> Flags:
    """Mask of the others' states with one near that may come to a junction or a crossing.

    It drives across towards ego's line, or is a pedestrian or cyclist near it.
    """
    states = others.states
    near = (others.ahead > -REACH_M / 4) & (others.ahead <= reach[states] + REACH_M)
    users = context.surroundings.tracks.of_type("vulnerable_user")[others.rows]
    found: Flags = np.logical_or.reduce(near & (others.away <= _WALKS_M) & users[:, None])
    cells = Cells.at(near & (others.away <= _SEEN_M) & ~found)
    motion = motion_of(context, others.rows[cells.rows], states[cells.columns])
    comes = motion.goes_across & motion.moves
    comes &= motion.sideways * cells.of(others.left) < 0
    return found | cells.in_columns(comes)


def crossed(context: DriveContext, others: Others, reach: Floats) -> Flags:
    """Mask of states in which a participant moves across ego's way, or is about to."""
    states = others.states
    near = (others.ahead > 0) & (others.ahead <= reach[states])
    cells = Cells.at(near & (others.away <= IN_WAY_M))
    motion = motion_of(context, others.rows[cells.rows], states[cells.columns])
    there = np.zeros(context.states, dtype=bool)
    there[states] = cells.in_columns(motion.goes_across & motion.moves)
    return context.spans.within(there, context.steps_in(_WAITS_S))


def met(context: DriveContext, asked: Flags, reach: Floats) -> tuple[Flags, Flags]:
    """Masks of states in which a vehicle makes ego wait where ways meet in a junction, or may."""
    waits, thinks = np.zeros((2, context.states), dtype=bool)
    if not context.own.passages.of_row:
        return waits, thinks
    for number, columns in context.spans.those(context.spans.any(asked)):
        if passages_of(context, number):
            waits[columns], thinks[columns] = _met_alone(context.one(number), reach[columns])
    return waits & asked, thinks & asked


def _met_alone(context: DriveContext, reach: Floats) -> tuple[Flags, Flags]:
    """``met`` for a single drive."""
    passages, first = context.surroundings.passages, context.first_column
    waits_for, thinks_of = (context.steps_in(seconds) for seconds in (_WAITS_S, _THINKS_OF_S))
    waits, thinks = np.zeros((2, context.states), dtype=bool)
    for own in own_passages(context):
        stop = approach(context, own).stop
        travelled = passages.travelled[own.row]
        near = travelled[own.first] - travelled[context.columns] <= reach
        start = int(near.argmax())
        for other in passages.through[own.junction]:
            elsewhen = other.last - first < start or other.first - first - thinks_of > stop
            if other.row == own.row or elsewhen:
                continue
            meeting = passages.junctions[own.junction].meeting(own.way, other.way)
            if meeting is None:
                continue
            enters, _ = passages.occupied(own, meeting[0])
            comes, leaves = passages.occupied(other, meeting[1])
            begin = (other.last if comes is None else int(comes)) - first
            end = max(min(stop, context.states if leaves is None else int(leaves) - first + 1), 0)
            thinks[max(begin - thinks_of, 0) : end] |= near[max(begin - thinks_of, 0) : end]
            if comes is not None and (enters is None or comes < enters):
                waits[max(begin - waits_for, 0) : end] |= near[max(begin - waits_for, 0) : end]
    return waits, thinks
