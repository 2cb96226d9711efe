"""Whom ego leaves no room as it changes lanes, by what these do while it moves over."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_lanelets import own_lanelets
from rulec.extraction.signals.queues import lanes_that_go_on
from rulec.extraction.tracks.tracks import Flags
from rulec.recordings.recording import JOINING

_NO_ROOM_S, _DRAWS_AWAY_MPS = 0.3, 1.0
"""One so near behind ego has no room to react in, unless ego draws away from it."""

_DRIFT_MPS = 0.2
"""Who moves sideways by less keeps its lane."""

_SLOWED_MPS, _ASIDE_M = 0.5, 0.3
"""Who is slower by more, or so far aside of where it was, has got out of the way."""

_LONGEST_S = 4.0
"""Who changes lanes has moved over for so long at most."""


def squeezed(context: DriveContext, changes: NDArray[intp]) -> tuple[Flags, Flags]:
    """Flags of those whom ego leaves no room in these states of its changes, and perhaps so.

    Those so near behind it that they cannot react; and those whom it would have run into, had they
    gone on as they did when it began to move over: they had to get out of its way, surely if they
    were beside it when its body came over the mark, or braked harder than ``disturbing_mps2``
    afterwards, and perhaps if they let it in, or have one ahead of them who is slower. Perhaps,
    too, where ego's lane ends: there they let each other in.
    """
    sure, perhaps = np.zeros((2, len(context.relevant), len(changes)), dtype=bool)
    for number, change in enumerate(changes.tolist()):
        begins, reaches = _moves_over(context, change)
        close = _close_behind(context, change)
        gave_way, unsure = _gives_way(context, begins, reaches, change)
        ends = _lane_ends(context, begins)
        sure[:, number] = (close | gave_way) & (not ends)
        perhaps[:, number] = unsure | close | gave_way
    return sure, perhaps & ~sure


def _moves_over(context: DriveContext, change: int) -> tuple[int, int]:
    """The states from which ego moves to the other lane, and its body is across the mark."""
    lane, own = context.steady_lane, context.ego_extents
    first = int(context.spans.first[change])
    first = max(first, change - round(_LONGEST_S / context.recording.step_s))
    to_left = lane[change] > lane[change - 1]
    mark = max(lane[change - 1], lane[change])
    across = own.across[0, first:change] * (1 if to_left else -1)
    stays = np.flatnonzero(across < _DRIFT_MPS)
    begins = first + int(stays[-1]) if len(stays) else first
    beyond = own.left_of_max[0] if to_left else -own.left_of_min[0]
    over = np.flatnonzero(beyond[begins:change, mark] > context.thresholds.touching_m)
    return begins, begins + int(over[0]) if len(over) else change


def _close_behind(context: DriveContext, change: int) -> Flags:
    """Flags of those behind ego in its new lane who have no room to react."""
    along, own = context.extents.along[:, change], context.ego_extents.along[0, change]
    place, speed = context.tolerances.place_m, context.tolerances.speed_mps
    close: Flags = relations.gap(context)[:, change] + place < _NO_ROOM_S * (along - speed)
    close &= own - along < _DRAWS_AWAY_MPS + speed
    close &= relations.station(context)[:, change] == relations.IN_FRONT_OF
    close &= context.going_along[:, change] & context.in_ego_lane[:, change]
    return close


def _gives_way(
    context: DriveContext, begins: int, reaches: int, change: int
) -> tuple[Flags, Flags]:
    """Flags of those who got out of ego's way between these states, and of those perhaps."""
    others, own, place = context.extents, context.ego_extents, context.tolerances.place_m
    lane, went_s = context.steady_lane[change], (change - begins) * context.recording.step_s
    there = context.going_along[:, begins] & context.going_along[:, change]
    there &= (others.lane[:, begins] == lane) & (np.abs(others.across[:, begins]) < _DRIFT_MPS)
    on = others.along[:, begins] * went_s
    low, high = others.s_min[:, begins] + on, others.s_max[:, begins] + on
    would: Flags = (
        there & (own.s_min[0, change] + place < high) & (low < own.s_max[0, change] - place)
    )
    for side in (1, -1):
        # Bounds of lanes bend with the road: places across it are those of the road's own line
        nearer, farther = (own.d_max, others.d_min) if side > 0 else (-own.d_min, -others.d_max)
        apart = side * (others.d_min + others.d_max - own.d_min - own.d_max)[:, begins] > 0
        would &= ~apart | (nearer[0, change] > farther[:, begins] + place)
    slower = others.along[:, begins] - others.along[:, change]
    aside = np.abs(
        (others.d_min + others.d_max)[:, change] - (others.d_min + others.d_max)[:, begins]
    )
    would &= (slower > _SLOWED_MPS + context.tolerances.speed_mps) | (aside / 2 > _ASIDE_M + place)
    brakes = _brakes(context, reaches, change)
    beside = relations.station(context)[:, reaches] == relations.BESIDE
    return would & (beside | brakes) & ~_held_up(context, begins, lane), would


def _brakes(context: DriveContext, begins: int, change: int) -> Flags:
    """Flags of those who brake harder than ``disturbing_mps2`` in some of these states."""
    states, tracks = slice(begins, change + 1), context.tracks
    least = tracks.acceleration[:, states] + tracks.acceleration_error[:, states]
    brakes: Flags = (least < -context.thresholds.disturbing_mps2).any(axis=1)
    return brakes


def _held_up(context: DriveContext, state: int, lane: int) -> Flags:
    """Flags of those behind a slower one in a lane whom they get to within ``catching_up_s``."""
    others = context.extents
    rows = np.flatnonzero(context.going_along[:, state] & (others.lane[:, state] == lane))
    low, high = others.s_min[rows, state], others.s_max[rows, state]
    along = others.along[rows, state]
    gap, faster = low[None, :] - high[:, None], along[:, None] - along[None, :]
    soon = (gap >= 0) & (gap <= faster * context.thresholds.catching_up_s)
    held = np.zeros(len(context.relevant), dtype=bool)
    held[rows] = soon.any(axis=1)
    return held


def _lane_ends(context: DriveContext, state: int) -> bool:
    """True if the lane that ego leaves ends soon, and is none by which one joins a road."""
    lanelets = own_lanelets(context)
    lanelet = lanelets.lanelets[lanelets.number[state]]
    goes_on = lanes_that_go_on(context)[state, context.steady_lane[state]]
    return not goes_on and JOINING not in lanelet.types
