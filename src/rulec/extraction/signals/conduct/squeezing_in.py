"""Whom ego leaves no room as it changes lanes, by what these do while it moves over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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


@dataclass(frozen=True, slots=True)
class WayIn:
    """Ego's way into a lane: over which of the road's lines, and is that to its left?

    ``state`` is the one in which its middle is clearly beyond.
    """

    state: int
    line: int
    to_left: bool


def squeezed(context: DriveContext, ways: Sequence[WayIn]) -> tuple[Flags, Flags]:
    """Flags of those whom ego leaves no room on these ways into lanes, and perhaps so.

    Those so near behind it that they cannot react; those whom it would have run into, had they gone
    on as they did when it began to move over: they had to get out of its way, surely if they were
    beside it when its body came over the mark, or braked harder than ``disturbing_mps2``
    afterwards, and perhaps if they let it in, or have one ahead of them who is slower; and those
    who would have had to brake so hard, and did before ego was in their lane. Perhaps, too, where
    ego's lane ends: there they let each other in.
    """
    sure, perhaps = np.zeros((2, len(context.relevant), len(ways)), dtype=bool)
    for number, way in enumerate(ways):
        begins, reaches = _moves_over(context, way)
        close = _close_behind(context, way.state)
        gave_way, unsure = _gives_way(context, begins, reaches, way.state)
        ends = _lane_ends(context, begins)
        sure[:, number] = (close | gave_way) & (not ends)
        perhaps[:, number] = unsure | close | gave_way
    return sure, perhaps & ~sure


def _moves_over(context: DriveContext, way: WayIn) -> tuple[int, int]:
    """The states from which ego moves to the other lane, and its body is across the mark."""
    own, first = context.ego_extents, int(context.spans.first[way.state])
    first = max(first, way.state - round(_LONGEST_S / context.recording.step_s))
    across = own.across[0, first : way.state] * (1 if way.to_left else -1)
    stays = np.flatnonzero(across < _DRIFT_MPS)
    begins = first + int(stays[-1]) if len(stays) else first
    beyond = own.left_of_max[0] if way.to_left else -own.left_of_min[0]
    over = np.flatnonzero(beyond[begins : way.state, way.line] > context.thresholds.touching_m)
    return begins, begins + int(over[0]) if len(over) else way.state


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
    there &= others.lane[:, begins] == lane
    # Mostly there is nobody
    if not there.any():
        return there, there
    there &= ~_drifts(context, begins, lane)
    # Who takes another way where the lane forks brakes for that
    on_its_way = slice(begins, min(change + _reacts(context), int(context.spans.end[change])))
    there &= ~context.elsewhere[:, on_its_way].any(axis=1)
    on = others.along[:, begins] * went_s
    low, high = others.s_min[:, begins] + on, others.s_max[:, begins] + on
    would: Flags = np.asarray(
        there & (own.s_min[0, change] + place < high) & (low < own.s_max[0, change] - place)
    )
    # Bounds of lanes bend with the road: places across it are those of the road's own line
    right, left = others.d_min[:, begins], others.d_max[:, begins]
    to_left = left + right - own.d_min[0, begins] - own.d_max[0, begins]
    would &= ~(to_left > 0) | (own.d_max[0, change] > right + place)
    would &= ~(to_left < 0) | (own.d_min[0, change] < left - place)
    slower = others.along[:, begins] - others.along[:, change]
    aside = np.abs(others.d_min[:, change] + others.d_max[:, change] - right - left)
    would &= (slower > _SLOWED_MPS + context.tolerances.speed_mps) | (aside / 2 > _ASIDE_M + place)
    hard, may_be_hard = _brakes(context, reaches, change)
    beside = relations.station(context)[:, reaches] == relations.BESIDE
    # Who comes from behind has to see that ego comes
    comes_s = (change - reaches) * context.recording.step_s
    high = others.s_max[:, reaches] + others.along[:, reaches] * comes_s
    faster = others.along[:, reaches] - own.along[0, change]
    left = own.s_min[0, change] - high - faster * context.thresholds.reaction_s
    too_near = faster**2 > 2 * context.thresholds.disturbing_mps2 * np.maximum(left, 0.0)
    too_near &= there & (faster > 0) & (high <= own.s_min[0, change])
    sure = (would & (beside | hard)) | (too_near & hard)
    return sure & ~_held_up(context, begins, lane), would | (too_near & may_be_hard)


def _drifts(context: DriveContext, state: int, lane: int) -> Flags:
    """Flags of those who move sideways in a lane: the road's own line may bend from one to another.

    Over half of ``smoothing_s``, as far as the drive goes back.
    """
    steps = max(round(context.thresholds.smoothing_s / 2 / context.recording.step_s), 1)
    before = max(state - steps, int(context.spans.first[state]))
    middle = context.extents.middle_from(np.full(context.states, lane))
    went_s = (state - before) * context.recording.step_s
    moved = np.abs(middle[:, state] - middle[:, before])
    drifts: Flags = moved > _DRIFT_MPS * went_s + context.tolerances.place_m
    return drifts


def _brakes(context: DriveContext, begins: int, change: int) -> tuple[Flags, Flags]:
    """Flags of those who brake harder than ``disturbing_mps2`` then, and perhaps do.

    Or up to ``reaction_s`` later.
    """
    end = min(change + _reacts(context), int(context.spans.end[change]))
    states, tracks = slice(begins, end), context.tracks
    gained, wrong = tracks.acceleration[:, states], tracks.acceleration_error[:, states]
    limit = -context.thresholds.disturbing_mps2
    hard: Flags = np.asarray((gained + wrong < limit).any(axis=1))
    return hard, np.asarray((gained - wrong < limit).any(axis=1))


def _reacts(context: DriveContext) -> int:
    """So many states from one on others have reacted to it."""
    return round(context.thresholds.reaction_s / context.recording.step_s) + 1


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
