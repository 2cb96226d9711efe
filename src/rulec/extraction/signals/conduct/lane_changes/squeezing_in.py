"""Vehicles that ego leaves no room as it changes lanes, by what they do while it moves over."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.lane_changes.lanes_from_behind import comes_from_before
from rulec.extraction.signals.ego_lanelets import own_lanelets
from rulec.extraction.signals.queues import lanes_that_go_on
from rulec.recordings.recording import JOINING
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.plain_arrays import ranges

_NO_ROOM_S, _DRAWS_AWAY_MPS = 0.3, 1.0
"""A vehicle this close (s) behind ego has no room to react, unless ego draws away from it."""

_TOO_CLOSE_S = 1.0
"""A vehicle that brakes for one coming in closer (s) has to: half of what all laws ask for."""

_DRIFT_MPS = 0.2
"""A vehicle with a lower lateral speed keeps its lane."""

_SLOWED_MPS, _ASIDE_M = 0.5, 0.3
"""A vehicle that is slower, or aside of where it was, by more than this has made way."""

_LONGEST_S = 4.0
"""A change of lanes takes at most this long (s)."""


@dataclass(frozen=True, slots=True)
class WayIn:
    """Ego's way into a lane: the line of the road that it crosses, and whether to its left.

    ``state`` is the one in which its middle is clearly beyond the line.
    """

    state: int
    line: int
    to_left: bool


def squeezed(context: DriveContext, ways: Sequence[WayIn]) -> tuple[Flags, Flags]:
    """Masks of vehicles that ego leaves no room on these ways into lanes, and perhaps so.

    They are so near behind ego that they cannot react; or ego would have run into them, had they
    gone on as they did when it began to move over, or been so near, so that they had to make way
    (surely if they were beside it when its body came over the mark and would have met it, or then
    braked harder than ``disturbing_mps2``; perhaps if they let it in, or have a slower vehicle
    ahead); or they would have had to brake that hard, and did before ego was in their lane; or they
    do with ego close ahead, which is not slower itself (perhaps if before its body came over the
    mark). Perhaps, too, where ego's lane ends: there drivers let each other in. Not those behind
    ego that take another way than ego's where their lane forks: they brake for that.
    """
    changes = np.array([way.state for way in ways], dtype=intp)
    begins, reaches = _moves_over(context, ways, changes)
    close = _close_behind(context, changes)
    gave_way, unsure = _gives_way(context, begins, reaches, changes)
    every = unsure | close | gave_way
    rows, numbers = every.nonzero()
    comes = comes_from_before(context, rows, changes[numbers])
    every[rows, numbers] = comes.possible
    sure = (close | gave_way) & every & ~_lane_ends(context, begins)
    sure[rows, numbers] &= comes.sure
    return sure, every & ~sure


def _moves_over(
    context: DriveContext, ways: Sequence[WayIn], changes: NDArray[intp]
) -> tuple[NDArray[intp], NDArray[intp]]:
    """The states from which ego moves over, and from which its body is across the mark, by way."""
    own, spans = context.ego_extents, context.spans
    begins, reaches = changes.copy(), changes.copy()
    longest = context.steps_in(_LONGEST_S)
    for line, to_left in {(way.line, way.to_left) for way in ways}:
        alike = [(way.line, way.to_left) == (line, to_left) for way in ways]
        states, side = changes[alike], 1 if to_left else -1
        stays = spans.latest(side * own.across[0] < _DRIFT_MPS)[np.maximum(states - 1, 0)]
        moves = np.maximum(stays, np.maximum(spans.first[states], states - longest))
        beyond = own.left_of_max[0, :, line] if to_left else -own.left_of_min[0, :, line]
        is_over = spans.next_state(beyond > context.thresholds.touching_m)
        begins[alike], reaches[alike] = moves, np.minimum(is_over[moves], states)
    return begins, reaches


def _close_behind(context: DriveContext, changes: NDArray[intp]) -> Flags:
    """Mask of vehicles behind ego in its new lane that have no room to react, by way."""
    along, own = context.extents.along[:, changes], context.ego_extents.along[0, changes]
    place, speed = context.tolerances.place_m, context.tolerances.speed_mps
    close: Flags = relations.gap(context)[:, changes] + place < _NO_ROOM_S * (along - speed)
    close &= own - along < _DRAWS_AWAY_MPS + speed
    close &= relations.station(context)[:, changes] == relations.IN_FRONT_OF
    close &= context.going_along[:, changes] & context.in_ego_lane[:, changes]
    return close


def _gives_way(
    context: DriveContext, begins: NDArray[intp], reaches: NDArray[intp], changes: NDArray[intp]
) -> tuple[Flags, Flags]:
    """Masks of vehicles that made way for ego between these states, by way, and perhaps did."""
    others, own, place = context.extents, context.ego_extents, context.tolerances.place_m
    lanes, went_s = context.steady_lane[changes], (changes - begins) * context.recording.step_s
    there = context.going_along[:, begins] & context.going_along[:, changes]
    there &= others.lane[:, begins] == lanes
    there &= ~_drifts(context, there, begins, lanes)
    if not there.any():
        return there, there
    # A vehicle that takes another way where the lane forks brakes for that
    rows = there.any(axis=1).nonzero()[0]
    there[rows] &= ~_any_between(
        context, begins, changes, lambda states: context.elsewhere[rows[:, None], states]
    )
    on = others.along[:, begins] * went_s
    low, high = others.s_min[:, begins] + on, others.s_max[:, begins] + on
    would: Flags = np.asarray(
        there & (own.s_min[0, changes] + place < high) & (low < own.s_max[0, changes] - place)
    )
    would_be_close = there & _would_have_no_room(context, begins, changes)
    # Bounds of lanes bend with the road: places across it are those of the road's own line
    right, left = others.d_min[:, begins], others.d_max[:, begins]
    to_left = left + right - own.d_min[0, begins] - own.d_max[0, begins]
    would &= ~(to_left > 0) | (own.d_max[0, changes] > right + place)
    would &= ~(to_left < 0) | (own.d_min[0, changes] < left - place)
    slower = others.along[:, begins] - others.along[:, changes]
    aside = np.abs(others.d_min[:, changes] + others.d_max[:, changes] - right - left)
    makes_way = slower > _SLOWED_MPS + context.tolerances.speed_mps
    would_be_close &= makes_way
    would &= makes_way | (aside / 2 > _ASIDE_M + place)
    beside = relations.station(context)[:, reaches] == relations.BESIDE
    # A vehicle from behind has to see that ego comes
    comes_s = (changes - reaches) * context.recording.step_s
    high = others.s_max[:, reaches] + others.along[:, reaches] * comes_s
    faster = others.along[:, reaches] - own.along[0, changes]
    left = own.s_min[0, changes] - high - faster * context.thresholds.reaction_s
    too_near = faster**2 > 2 * context.thresholds.disturbing_mps2 * np.maximum(left, 0.0)
    too_near &= there & (faster > 0) & (high <= own.s_min[0, changes])
    cut_short = there & _comes_in_close(context, reaches, changes)
    whom = would | would_be_close | too_near | cut_short
    hard = _brake(context, whom, reaches, changes)
    # Who brakes before ego's body comes over the mark may let it in
    whom = there & _comes_in_close(context, begins, changes)
    early = _brake(context, whom, begins, changes)
    at_once = early.sure | (early.possible & makes_way)
    sure = (would & beside) | hard.sure
    for way in sure.any(axis=0).nonzero()[0].tolist():
        sure[:, way] &= ~_held_up(context, int(begins[way]), int(lanes[way]))
    return sure, would | would_be_close | hard.possible | at_once


def _would_have_no_room(
    context: DriveContext, since: NDArray[intp], changes: NDArray[intp]
) -> Flags:
    """Mask of vehicles that would be as ``_close_behind``, or meet ego, had they not braked.

    That is, had they gone on as in the states ``since``; by way.
    """
    along, own = context.extents.along[:, since], context.ego_extents.along[0, changes]
    place, speed = context.tolerances.place_m, context.tolerances.speed_mps
    gap, is_ahead = _gap_had_they_gone_on(context, since, changes)
    close: Flags = gap + place < _NO_ROOM_S * (along - speed)
    close &= ~is_ahead & (own - along < _DRAWS_AWAY_MPS + speed)
    return close


def _gap_had_they_gone_on(
    context: DriveContext, since: NDArray[intp], changes: NDArray[intp]
) -> tuple[Floats, Flags]:
    """How far (m) others' fronts would be behind ego's rear, and whether all of them ahead of it.

    Had they kept their speed of the states ``since``; by way.
    """
    others, own = context.extents, context.ego_extents
    on = others.along[:, since] * ((changes - since) * context.recording.step_s)
    gap: Floats = own.s_min[0, changes] - (others.s_max[:, since] + on)
    is_ahead: Flags = others.s_min[:, since] + on >= own.s_max[0, changes]
    return gap, is_ahead


def _comes_in_close(context: DriveContext, since: NDArray[intp], changes: NDArray[intp]) -> Flags:
    """Mask of vehicles close behind ego in its new lane, by way, unless ego gets slower there.

    As they are, or would be had they kept their speed of the states ``since``: braking opens the
    gap. If ego keeps its speed, they have no reason to brake that ego does not have, too.
    """
    own, along, behind = context.ego_extents.along[0], context.extents.along, context.in_ego_lane
    close = relations.gap(context)[:, changes] < _TOO_CLOSE_S * along[:, changes]
    gap, is_ahead = _gap_had_they_gone_on(context, since, changes)
    close |= (gap < _TOO_CLOSE_S * along[:, since]) & ~is_ahead
    is_behind = relations.station(context)[:, changes] == relations.IN_FRONT_OF
    keeps_on = own[_reacted(context, changes) - 1] > own[since] - _SLOWED_MPS
    flags: Flags = close & is_behind & behind[:, changes] & keeps_on
    return flags


def _reacted(context: DriveContext, changes: NDArray[intp]) -> NDArray[intp]:
    """The states after those in which others have reacted to a change of lanes."""
    reacts = context.steps_in(context.thresholds.reaction_s) + 1
    ends: NDArray[intp] = np.minimum(changes + reacts, context.spans.end[changes])
    return ends


def _drifts(
    context: DriveContext, whom: Flags, states: NDArray[intp], lanes: NDArray[intp]
) -> Flags:
    """Mask of participants in ``whom`` that move sideways within their lane, by way.

    Measured in the lane, since the road's own line may bend from one lane to another; over half of
    ``smoothing_s``, as far as the drive goes back.
    """
    steps = max(context.steps_in(context.thresholds.smoothing_s / 2), 1)
    before = np.maximum(states - steps, context.spans.first[states])
    went_s = (states - before) * context.recording.step_s
    drifts, whole = np.zeros(whom.shape, dtype=bool), context.relevant.shape
    for lane in np.unique(lanes).tolist():
        rows, ways = (whom & (lanes == lane)).nonzero()
        (now,), (then,) = (
            context.extents.cells_from_bounds(Cells.in_shape(whole, rows, at[ways]), lane)
            for at in (states, before)
        )
        moved = np.abs((now[0] + now[1]) - (then[0] + then[1])) / 2
        drifts[rows, ways] = moved > _DRIFT_MPS * went_s[ways] + context.tolerances.place_m
    return drifts


def _brake(
    context: DriveContext, whom: Flags, begins: NDArray[intp], changes: NDArray[intp]
) -> Truth:
    """Which of those in ``whom`` then brake harder than ``disturbing_mps2``.

    By way; also up to ``reaction_s`` later.
    """
    limit, tracks = -context.thresholds.disturbing_mps2, context.tracks
    rows = whom.any(axis=1).nonzero()[0]

    def brake(states: NDArray[intp], sign: int) -> Flags:
        at = rows[:, None], states
        return np.asarray(tracks.acceleration[at] + sign * tracks.acceleration_error[at] < limit)

    found = []
    for sign in (1, -1):
        flags = np.zeros(whom.shape, dtype=bool)
        flags[rows] = _any_between(context, begins, changes, partial(brake, sign=sign))
        found.append(flags & whom)
    return Truth(*found)


def _any_between(
    context: DriveContext,
    begins: NDArray[intp],
    changes: NDArray[intp],
    flags_of: Callable[[NDArray[intp]], Flags],
) -> Flags:
    """For each way, whether flags hold in any of its states until others have reacted to it."""
    if not len(changes):
        return flags_of(changes)
    states, first = ranges(begins, _reacted(context, changes) - begins)
    found: Flags = np.logical_or.reduceat(flags_of(states), first, axis=1)
    return found


def _held_up(context: DriveContext, state: int, lane: int) -> Flags:
    """Mask of vehicles in a lane that reach a slower one ahead within ``catching_up_s``."""
    others = context.extents
    rows = (context.going_along[:, state] & (others.lane[:, state] == lane)).nonzero()[0]
    low, high = others.s_min[rows, state], others.s_max[rows, state]
    along = others.along[rows, state]
    gap, faster = low[None, :] - high[:, None], along[:, None] - along[None, :]
    soon = (gap >= 0) & (gap <= faster * context.thresholds.catching_up_s)
    held = np.zeros(len(context.relevant), dtype=bool)
    held[rows] = soon.any(axis=1)
    return held


def _lane_ends(context: DriveContext, states: NDArray[intp]) -> Flags:
    """Mask of states in which ego's lane ends soon, and does not serve to join a road."""
    joins = own_lanelets(context).flags(lambda lanelet: JOINING in lanelet.types)
    goes_on = lanes_that_go_on(context)[states, context.steady_lane[states]]
    return ~(goes_on | joins[states])
