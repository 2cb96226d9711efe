"""Measured numbers with the bounds that follow from their source's tolerances.

Quotients are bounded by those of their parts (interval arithmetic), sums by independent errors.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.presences import presence_cells
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import Bounds, rounded_outward
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.scenario.recorded.reference_line import turn
from rulec.trace.cells import Cells

LONGEST_S = 1000.0
"""The longest headway (s), also used for a standing ego."""

_ALIKE = 0.17
"""Cosine of the largest angle to the road at which a participant still goes roughly ego's way."""

_SURELY_ALIKE_RAD = 1.39
"""An angle surely smaller than that, since computing cosines takes long."""

_CORNER_M = 0.2
"""How far a corner reaches along the road beyond the middle of the front before it matters."""

_STRAIGHT_RAD = 0.1
"""Largest angle to the road behind ego's rear at which ego has not begun to turn."""

_HAIR = 1e-6

_AT_LIMIT_MPS = 0.01
"""Limits are written to a hundredth: a simulated speed this close to a limit equals it."""


@once
def own_speed(context: DriveContext) -> tuple[Floats, Floats]:
    """Ego's speed (m/s), 0 if it stands, and its possible error.

    A simulated driver keeps a limit exactly, except for the rounding of both.
    """
    speed, error = context.ego.speed[0], context.ego.speed_error[0]
    if context.tolerances.stated_mps is None:
        error = error + _braked_since_the_mean(context)
    if (context.tolerances.stated_mps or np.inf) <= _AT_LIMIT_MPS:
        at_limit = np.abs(speed - context.limit_mps) <= _AT_LIMIT_MPS
        speed, error = np.where(at_limit, context.limit_mps, speed), np.where(at_limit, 0.0, error)
    return np.where(context.ego_moves, (speed, error), 0.0)  # type: ignore[return-value]


def _braked_since_the_mean(context: DriveContext) -> Floats:
    """How much slower (m/s) ego may be than its mean speed, where a lower limit has just begun.

    The mean over ``smoothing_s`` includes the time before, in which ego braked for it.
    """
    half = context.thresholds.smoothing_s / 2
    limit, steps = context.limit_mps, context.steps_in(half)
    is_lower = limit < context.spans.most_of_last(limit, steps)
    braking = np.maximum(-context.ego.acceleration[0], 0.0)
    slower: Floats = np.where(is_lower, braking * half / 2, 0.0)
    return slower


@once
def speed_bounds(context: DriveContext) -> Bounds:
    """The bounds of ego's speed (km/h); from 0 if ego may be slow enough to stand."""
    speed, error = own_speed(context)
    differs = _differs_from_mean(context)
    low, high = speed - np.maximum(error, -differs), speed + np.maximum(error, differs)
    may_stand = (low * KMH_PER_MPS < context.thresholds.standing_kmh) & (error > 0)
    may_stand |= _may_have_stood_beside(context, low, high)
    return rounded_outward(np.where(may_stand, 0.0, low * KMH_PER_MPS), high * KMH_PER_MPS)


def _differs_from_mean(context: DriveContext) -> Floats:
    """How much faster (m/s) ego may be for a moment than its mean speed, or slower, if negative.

    The mean over ``smoothing_s`` shows neither a short stop nor a short peak. It is off by no more
    than it is from the middle of those half of that time before and after, if ego slows down and
    then gains speed, or the reverse.
    """
    speed, zero = context.ego.speed[0], np.zeros(context.states)
    if context.tolerances.stated_mps is not None:
        return zero
    steps = ceil(context.thresholds.smoothing_s / 2 / context.recording.step_s - _HAIR)
    columns, spans = context.spans.columns, context.spans
    # At the ends of a drive means are over less time
    inside = (columns - 2 * steps >= spans.first) & (columns + 2 * steps < spans.end)
    inside &= context.ego_moves
    before, after = (np.roll(speed, way) for way in (steps, -steps))
    return np.where(inside, speed - (before + after) / 2, zero)


def _may_have_stood_beside(context: DriveContext, low: Floats, high: Floats) -> Flags:
    """Mask of states between which and the next, or the last, ego may have stood for a moment.

    With its bounds of speed (m/s) it can brake to a stand and set off again in that step, short of
    braking hard. It then moves by no more than half of what it would at the higher speed.
    """
    spans, step_s = context.spans, context.recording.step_s
    most_mps2 = context.thresholds.braking_hard_mps2
    least = np.maximum(low, 0.0)
    may_stand: Flags = least + spans.before(least) <= most_mps2 * step_s
    if not may_stand.any():
        return may_stand
    x, y = context.ego.x[0], context.ego.y[0]
    moved = np.hypot(x - spans.before(x), y - spans.before(y))
    may_stand &= moved <= np.maximum(high, spans.before(high)) * step_s / 2
    may_stand[spans.begins] = False
    either: Flags = may_stand | spans.after(may_stand)
    return either


def headway_bounds(context: DriveContext) -> Bounds:
    """The bounds of headways (s), per presence cell, like all functions below."""
    _, near, far = gaps(context)
    of_ego = presence_cells(context).of
    speed, error = map(of_ego, own_speed(context))
    drives = of_ego(context.ego_moves)
    least = np.where(drives, speed - error, 1.0)
    longest = np.where(least > 0, far / np.maximum(least, _AT_LIMIT_MPS), LONGEST_S)
    shortest = near / np.where(drives, speed + error, 1.0)
    low, high = (
        np.where(drives, np.minimum(seconds, LONGEST_S), LONGEST_S)
        for seconds in (shortest, longest)
    )
    return rounded_outward(low, high)


@once
def gaps(context: DriveContext) -> tuple[Floats, Floats, Floats]:
    """Gaps (m), and their least and greatest possible values."""
    along = presence_cells(context).of(relations.way_along(context))
    place = context.tolerances.place_m
    return np.maximum(along, 0.0), np.maximum(along - place, 0.0), np.maximum(along + place, 0.0)


def difference_bounds(context: DriveContext) -> Bounds:
    """The bounds of speed differences (km/h)."""
    difference, speeds = speed_differences(context)
    cells = presence_cells(context)
    their_error = np.where(speeds == 0, 0.0, cells.of(context.tracks.speed_error))
    wrong = (
        context.tolerances.joint(cells.of(context.ego.speed_error[0]), their_error) * KMH_PER_MPS
    )
    return rounded_outward(difference - wrong, difference + wrong)


@once
def speed_differences(context: DriveContext) -> tuple[Floats, Floats]:
    """By how much (km/h) ego is faster along the road; the others' speeds, 0 if they stand."""
    cells = presence_cells(context)
    speeds = cells.of(context.extents.along) * KMH_PER_MPS
    speeds *= np.abs(speeds) >= context.thresholds.standing_kmh
    difference: Floats = cells.of(context.ego_extents.along[0]) * KMH_PER_MPS - speeds
    return difference, speeds


def safe_distances(context: DriveContext, cells: Cells) -> tuple[Floats, Floats]:
    """The distances (m) that ego needs to stop behind others braking fully, and their errors.

    For some cells. Ego brakes as hard after its reaction time: v t + (v² - u²) / 2a, as in RSS
    (Shalev-Shwartz, Shammah, Shashua 2017). Oncoming participants count as standing; cycles and
    trams brake less.
    """
    limits = context.thresholds
    own, other = _ahead(context, cells)
    rides, on_rails = map(context.tracks.of_type, ("light_rider", "rail_vehicle"))
    braking = np.where(rides, limits.cycle_braking_mps2, limits.braking_mps2)
    braking = np.where(on_rails, limits.rail_braking_mps2, braking)[cells.rows]
    stops = own**2 / (2 * limits.braking_mps2) - other**2 / (2 * braking)
    distance: Floats = limits.reaction_s * own + stops
    error = cells.of(context.ego.speed_error[0])
    of_own = (limits.reaction_s + own / limits.braking_mps2) * error
    of_other = other / braking * cells.of(context.tracks.speed_error)
    return distance, context.tolerances.joint(of_own, of_other)


def _ahead(context: DriveContext, cells: Cells) -> tuple[Floats, Floats]:
    """The speeds (m/s) from which ego and others brake, for some cells.

    A vehicle that turns off brakes on its own way: its whole speed counts while it goes ego's.
    """
    others = np.maximum(cells.of(context.extents.along), 0.0)
    turned = cells.of(context.extents.turned)
    alike = np.abs(turned) < _SURELY_ALIKE_RAD
    rest = (~alike).nonzero()[0]
    alike[rest] = np.cos(turned.take(rest)) > _ALIKE
    alike &= others > 0
    others = np.where(alike, np.maximum(cells.of(context.tracks.speed), others), others)
    return np.maximum(cells.of(context.ego_extents.along[0]), 0.0), others


def own_widths(context: DriveContext) -> Floats:
    """The width (m) of ego's body by state."""
    rows, columns = context.spans.spread(context.ego.rows), context.steps - context.own.tracks.first
    own: Floats = context.own.tracks.widths[rows, columns]
    return own


@once
def own_front(context: DriveContext) -> Floats:
    """The place (m) along the road of the middle of ego's front.

    At most half ego's length from its own middle: where the road turns round just ahead, a corner
    of its body is nearest to a place beyond the bend.
    """
    lengths = context.spans.spread(context.own.passages.lengths[context.ego.rows])
    own = context.ego_extents
    front: Floats = np.minimum(own.s_max[0], own.s[0] + lengths / 2)
    # Where ego has not begun to turn but the road ahead has, the front's middle is located directly
    (far,) = (own.s_max[0] - own.s_min[0] > lengths + _CORNER_M).nonzero()
    behind = context.road.line.headings_at(own.s_min[0, far])
    far = far[np.abs(turn(behind, context.ego.heading[0, far])) < _STRAIGHT_RAD]
    if not len(far):
        return front
    half, heading = lengths[far] / 2, context.ego.heading[0, far]
    middles = np.stack(
        (
            context.ego.x[0, far] + half * np.cos(heading),
            context.ego.y[0, far] + half * np.sin(heading),
        ),
        axis=-1,
    )
    found = context.road.line.coordinates_near(middles, own.s[0, far], lengths[far])[:, 0]
    front[far] = np.fmin(front[far], found)
    return front


def corner_ahead(context: DriveContext) -> Floats:
    """How far (m) a corner of ego's body extends along the road beyond the middle of its front."""
    corner: Floats = own_widths(context) / 2 * np.abs(np.sin(context.ego_extents.turned[0]))
    return corner
