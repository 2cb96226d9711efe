"""For how long others have been ahead in ego's lane, as far as that can be known.

Who came into the lane before anybody saw it needed some time to get where it is now. If it moves
sideways at ``v`` after ``d`` from where it began to reach into the lane, and nobody slows down
sideways by more than ``cutting_in_mps2`` (``a``), it took ``(sqrt(v² + 2ad) - v) / a`` at least.
"""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.measured_numbers import LONGEST_S
from rulec.extraction.signals.signal_columns import SignalColumns, rounded, rounded_outward
from rulec.extraction.tracks.tracks import Floats


def following_signals(context: DriveContext) -> SignalColumns:
    """Times (s) for which ego has been behind others in one lane, with their bounds."""
    behind = relations.station(context) == relations.BEHIND
    follows = behind & (relations.lateral(context) == relations.SAME_LANE)
    states, rows = np.arange(context.states), np.arange(len(follows))[:, None]
    since = np.maximum.accumulate(np.where(follows, -1, states), axis=1) + 1
    begins = np.minimum(since, context.states - 1)
    seen = (begins > 0) & context.relevant[rows, begins - 1]
    step_s = context.recording.step_s
    elapsed = (states - since) * step_s
    least = np.where(seen, elapsed, elapsed + _before(context)[rows, begins])
    most = np.where(seen, elapsed + step_s, LONGEST_S)
    least, most = np.where(follows, np.minimum(least, LONGEST_S), 0.0), np.where(follows, most, 0.0)
    return SignalColumns(
        about={"ahead_for": rounded(least)},
        bounds={"ahead_for": rounded_outward(least, np.maximum(least, most))},
    )


def _before(context: DriveContext) -> Floats:
    """How long (s) others have been in ego's lane at least, by where they are across it."""
    limits, lane = context.thresholds, context.ego_lane
    right, left = context.road.lanes.straight[lane], context.road.lanes.straight[lane + 1]
    others = context.extents
    inside = np.minimum(others.w_max - right, left - others.w_min) - limits.touching_m
    way = np.nan_to_num(np.maximum(inside - context.tolerances.place_m, 0.0))
    speed = np.nan_to_num(np.abs(others.across)) + np.nan_to_num(context.tracks.speed_error)
    slows = limits.cutting_in_mps2
    time: Floats = (np.sqrt(speed**2 + 2 * slows * way) - speed) / slows
    return time
