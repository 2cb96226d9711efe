"""Where ego turns round: on its way round, and across the road."""

from __future__ import annotations

from typing import cast

import numpy as np
import shapely

from rulec.array_types import Flags
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import own_lanelets
from rulec.extraction.tracks.tracks import Tracks
from rulec.scenario.recorded.reference_line import turn
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.plain_arrays import zero_if_nan

_ROUND_RAD, _ROUND_M, _JUMP_RAD = np.radians(150.0), 60.0, np.radians(60.0)
"""A turn round is by ``_ROUND_RAD`` within ``_ROUND_M``, and never by ``_JUMP_RAD`` in one step."""

_HAIR_RAD = 1e-6
_ACROSS_RAD, _TURNS_RAD = np.radians(30.0), np.radians(10.0)
_LEAST_M = 2.0


@once
def u_turns(context: DriveContext) -> Truth:
    """Whether ego, turning round on a short way, is across the road.

    From the whole track, since ego is on another road once it has turned round. Not in junctions,
    nor where the road itself turns. Unknown where its track begins or ends meanwhile.
    """
    turns, seems = swings_round(context), _seems_to_turn_round(context)
    if turns.any():
        turns = turns & context.spans.any(turns & _leaves_road(context))
        turns &= ~context.spans.any(_touches_junction(context, turns))
    if seems.any():
        seems &= ~turns
        seems &= ~context.spans.any(_touches_junction(context, seems))
    return Truth(turns, turns | seems)


def _seems_to_turn_round(context: DriveContext) -> Flags:
    """Mask of states in which ego is across its road where its track begins or ends.

    So near to where it was first seen, and turns there, or has turned so far near to where it was
    last seen.
    """
    tracks, columns = context.own.tracks, context.steps - context.own.tracks.first
    turned, seems = np.abs(context.ego_extents.turned[0]), np.zeros(context.states, dtype=bool)
    across = np.minimum(turned, np.pi - turned) >= _ACROSS_RAD
    for row, part in zip(context.ego.rows.tolist(), context.spans.slices, strict=True):
        if not across[part].any():
            continue
        there = tracks.present[row].nonzero()[0]
        x, y, heading = (of[row, there] for of in (tracks.x, tracks.y, tracks.heading))
        way = np.append(0.0, np.hypot(np.diff(x), np.diff(y)).cumsum())
        soon, last = way <= _ROUND_M, int(way.searchsorted(way[-1] - _ROUND_M))
        soon &= np.ptp(np.unwrap(heading[soon])) >= _TURNS_RAD
        since = np.unwrap(heading[last:])
        swung = np.zeros(len(way))
        swung[last:] = np.maximum(
            np.maximum.accumulate(since) - since, since - np.minimum.accumulate(since)
        )
        at = there.searchsorted(columns[part])
        seems[part] = across[part] & (soon[at] | (swung[at] >= _ACROSS_RAD))
    return seems


def _leaves_road(context: DriveContext) -> Flags:
    """Mask of states in which ego is well across its road, or will be in the next one.

    Its drive along this road may end before that one.
    """
    turned, tracks = context.ego_extents.turned[0], context.own.tracks
    leaves: Flags = np.abs(turned) >= 2 * _ACROSS_RAD
    columns = context.steps - tracks.first
    for row, part in zip(context.ego.rows.tolist(), context.spans.slices, strict=True):
        last = part.stop - 1
        heading = tracks.heading[row, columns[last] : columns[last] + 2]
        leaves[last] |= abs(turned[last] + turn(heading[0], heading[-1])) >= 2 * _ACROSS_RAD
    return leaves


def swings_round(context: DriveContext) -> Flags:
    """Mask of states in which ego is on its way round, except along a ring."""
    turns = _turning_round(context)
    if not turns.any():
        return turns
    ring = context.surroundings.ring(context.side)
    return turns & ~own_lanelets(context).flags(lambda lanelet: lanelet.id in ring)


@once
def _turning_round(context: DriveContext) -> Flags:
    """Mask of states in which ego's heading is on its way round."""
    tracks = context.own.tracks
    columns = context.steps - tracks.first
    asked, turning = _may_go_round(context), np.zeros(context.states, dtype=bool)
    for row, part in zip(context.ego.rows.tolist(), context.spans.slices, strict=True):
        if asked[row]:
            turning[part] = _goes_round(tracks, row)[columns[part]]
    return turning


def _may_go_round(context: DriveContext) -> Flags:
    """Mask of tracks whose headings change by enough in all, or that have a gap."""
    known = context.own.computed
    if _may_go_round not in known:
        tracks, present = context.own.tracks, context.own.tracks.present
        steps = np.abs(turn(tracks.heading[:, :-1], tracks.heading[:, 1:]))
        turned = zero_if_nan(steps).sum(axis=1) > _ROUND_RAD - _HAIR_RAD
        known[_may_go_round] = turned | ((present[:, 1:] != present[:, :-1]).sum(axis=1) > 2)
    return cast("Flags", known[_may_go_round])


def _goes_round(tracks: Tracks, row: int) -> Flags:
    """Mask of the columns in which a participant's heading is on its way round."""
    columns = tracks.present[row].nonzero()[0]
    heading = np.unwrap(tracks.heading[row, columns])
    flags = np.zeros(tracks.present.shape[1], dtype=bool)
    if np.ptp(heading) >= _ROUND_RAD and np.abs(np.diff(heading)).max() < _JUMP_RAD:
        x, y = tracks.x[row, columns], tracks.y[row, columns]
        way = np.append(0.0, np.hypot(np.diff(x), np.diff(y)).cumsum())
        last = way.searchsorted(way + _ROUND_M, side="right")
        for first, end in enumerate(last.tolist()):
            turned = np.abs(heading[first:end] - heading[first])
            if turned.max() >= _ROUND_RAD and way[end - 1] - way[first] >= _LEAST_M:
                until = int((turned >= _ROUND_RAD).argmax())
                across = turned[:until] >= _ACROSS_RAD
                flags[columns[first : first + until][across]] = True
    return flags


def _touches_junction(context: DriveContext, states: Flags) -> Flags:
    """Mask of the states among ``states`` in which ego's middle is at a junction."""
    places = shapely.points(context.ego.x[0, states], context.ego.y[0, states])
    touches, reach = np.zeros_like(states), context.thresholds.zone_m
    for junction in context.surroundings.passages.junctions:
        touches[states] |= shapely.dwithin(junction.area, places, reach)
    return touches
