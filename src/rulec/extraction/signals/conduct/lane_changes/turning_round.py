"""Vehicles that have to brake for ego as it turns round on the road."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.conduct.u_turns import u_turns
from rulec.extraction.signals.measured_numbers import own_widths
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.partly_known.partly_known_values import Truth

_SLOWED_MPS = 0.5
"""A vehicle that is slower by more afterwards may have had to brake."""


def have_to_brake_for_turn(context: DriveContext) -> Truth:
    """Which vehicles must brake for ego while it turns round; unknown where it may not.

    Ego is across their way, and they would have to brake harder than ``disturbing_mps2`` after
    their reaction time to avoid it. They do brake that hard, or are slower a while later. Vehicles
    that come up behind on the lanes of ego's own way see it slow down and do not count.
    """
    brake, seem_to = np.zeros((2, *context.relevant.shape), dtype=bool)
    turns = u_turns(context)
    states = turns.possible.nonzero()[0]
    if not len(states):
        return Truth.known(brake)
    near = _too_near(context, states)
    near &= context.tracks.of_type("vehicle")[:, None] & ~context.going_along[:, states]
    rows, columns = near.nonzero()
    for row, state in zip(rows.tolist(), states[columns].tolist(), strict=True):
        brakes, slower = _brakes(context, row, state)
        brake[row, state], seem_to[row, state] = brakes, slower
    return Truth(brake & turns.sure, brake | seem_to)


def _too_near(context: DriveContext, states: NDArray[intp]) -> Flags:
    """Mask, by state, of vehicles whose way ego blocks so near ahead that they must brake hard."""
    tracks, own, limits = context.tracks, context.ego, context.thresholds
    heading, speed = tracks.heading[:, states], np.nan_to_num(tracks.speed[:, states])
    dx, dy = own.x[0, states] - tracks.x[:, states], own.y[0, states] - tracks.y[:, states]
    cos, sin = np.cos(heading), np.sin(heading)
    ahead, aside = dx * cos + dy * sin, np.abs(dy * cos - dx * sin)
    length = _lengths(context)
    half, wide = length[0] / 2, own_widths(context)[states] / 2
    turned = own.heading[0, states] - heading
    along = half * np.abs(np.cos(turned)) + wide * np.abs(np.sin(turned))
    across = half * np.abs(np.sin(turned)) + wide * np.abs(np.cos(turned))
    others = context.extents
    widths = (others.d_max - others.d_min)[:, states]
    left = ahead - along - length[1:, None] / 2 - speed * limits.reaction_s
    blocked = (ahead > 0) & (aside < across + widths / 2 - context.tolerances.place_m)
    needs: Flags = speed**2 > 2 * limits.disturbing_mps2 * np.maximum(left, 0.0)
    found: Flags = blocked & needs & (speed * KMH_PER_MPS >= limits.standing_kmh)
    return found


def _lengths(context: DriveContext) -> Floats:
    """The lengths (m) of ego and of the others: their greatest extents along the road."""
    bodies = (context.ego_extents, context.extents)
    rows = [body.s_max - body.s_min for body in bodies]
    lengths: Floats = np.concatenate([np.fmax.reduce(row, axis=1, initial=0.0) for row in rows])
    return lengths


def _brakes(context: DriveContext, row: int, state: int) -> tuple[bool, bool]:
    """Whether a vehicle soon brakes harder than ``disturbing_mps2``, and whether it is slower then.

    Also after ego's drive along this road, which ends where it has turned round.
    """
    tracks, limits = context.surroundings.tracks, context.thresholds
    own, column = int(context.tracks.rows[row]), int(context.columns[state])
    soon, before = (
        context.steps_in(seconds)
        for seconds in (limits.reaction_s + limits.smoothing_s, limits.smoothing_s)
    )
    span = slice(max(column - before, 0), column + soon + 1)
    least = tracks.acceleration[own, span] + tracks.acceleration_error[own, span]
    speeds = tracks.speed[own, span]
    speeds = speeds[~np.isnan(speeds)]
    brakes = bool(np.any(least < -limits.disturbing_mps2))
    slower = bool(speeds.min() < speeds[0] - _SLOWED_MPS - context.tolerances.speed_mps)
    return brakes, slower
