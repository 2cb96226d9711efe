"""For how long others have been ahead in ego's lane, as far as that can be known.

Where the tolerance of places decides who is in the lane, the time began some time in between. Who
came into the lane before anybody saw it needed some time to get where it is now. If it moves
sideways at ``v`` after ``d`` from where it began to be ahead in the lane, and nobody slows down
sideways by more than ``cutting_in_mps2`` (``a``), it took ``(sqrt(v² + 2ad) - v) / a`` at least.
"""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.measured_numbers import LONGEST_S
from rulec.extraction.signals.signal_columns import SignalColumns, rounded, rounded_outward
from rulec.extraction.tracks.tracks import Flags, Floats


def following_signals(context: DriveContext) -> SignalColumns:
    """Times (s) for which ego has been behind others in one lane, with their bounds."""
    _, surely, perhaps = relations.ahead_in_lane(context)
    since, seen = _since(context, surely)
    states, step_s = np.arange(context.states), context.recording.step_s
    before = np.take_along_axis(_before(context), since, axis=1)
    least = (states - since) * step_s + np.where(seen, 0.0, before)
    since, seen = _since(context, perhaps)
    most = np.where(seen, (states - since + 1) * step_s, LONGEST_S)
    least, most = (
        np.where(surely, np.minimum(least, LONGEST_S), 0.0),
        np.where(perhaps, most, 0.0),
    )
    return SignalColumns(
        about={"ahead_for": rounded(least)},
        bounds={"ahead_for": rounded_outward(least, np.maximum(least, most))},
    )


def _since(context: DriveContext, follows: Flags) -> tuple[NDArray[intp], Flags]:
    """The states in which flags last began, and whether one was seen the state before."""
    states, rows = np.arange(context.states), np.arange(len(follows))[:, None]
    since = np.maximum.accumulate(np.where(follows, -1, states), axis=1) + 1
    since = np.minimum(since, context.states - 1)
    return since, (since > 0) & context.relevant[rows, since - 1]


def _before(context: DriveContext) -> Floats:
    """How long (s) others were ahead at least when first seen, by where they were across."""
    limits, own, others = context.thresholds, context.ego_extents, context.extents
    reach, right, left = limits.touching_m, context.ego_lane, context.ego_lane + 1
    low, high = others.from_bound(left)
    from_left = np.maximum(own.from_bound(left)[1] - low, -high) + reach
    inside = np.minimum(-low - reach, from_left)
    low, high = others.from_bound(right)
    from_right = np.maximum(high - own.from_bound(right)[0], low) + reach
    inside = np.minimum(inside, np.minimum(high - reach, from_right))
    way = np.nan_to_num(np.maximum(inside - context.tolerances.place_m, 0.0))
    speed = np.maximum(np.abs(others.across), np.abs(others.across - own.across))
    speed = np.nan_to_num(speed) + np.nan_to_num(context.tracks.speed_error)
    slows = limits.cutting_in_mps2
    time: Floats = (np.sqrt(speed**2 + 2 * slows * way) - speed) / slows
    return time
