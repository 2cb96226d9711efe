"""Signals of lane changes: the change itself, whether it disturbs, the indicator."""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_signals import steady_lane
from rulec.extraction.signals.signal_columns import SignalColumns, named_values
from rulec.extraction.tracks.tracks import Flags


def lane_change_signals(context: DriveContext) -> SignalColumns:
    """The signals of ego's lane changes."""
    lane = steady_lane(context, context.road.lanes_at(context.ego_extents.s[0]))
    changes = np.append(False, lane[1:] != lane[:-1])
    clear = ~changes | ~_disturbs(context)
    changing = SignalColumns({"lane_change": changes, "lane_is_clear": clear})
    return changing | _indicator(context)


def _indicator(context: DriveContext) -> SignalColumns:
    """Ego's indicator, if the recording has its lamps.

    Both at once are no indication.
    """
    (ego,) = context.ego.participants
    if not ego.lamps:
        return SignalColumns()
    near, far = (
        ("left_indicator", "right_indicator")
        if context.side == "left"
        else ("right_indicator", "left_indicator")
    )
    steps = [ego.lamps.get(context.first_step + state) for state in range(context.states)]
    lit = np.array([(near in (lamps or ()), far in (lamps or ())) for lamps in steps])
    codes = np.where(lit[:, 0] & ~lit[:, 1], 1, np.where(lit[:, 1] & ~lit[:, 0], 2, 0))
    return SignalColumns(
        {"indicator": named_values(codes, ("no_indicator", "near_indicator", "far_indicator"))},
        unknown={"indicator": np.array([lamps is None for lamps in steps])},
    )


def _disturbs(context: DriveContext) -> Flags:
    """Flags of states in which a vehicle must brake for ego.

    The vehicle is in ego's lane.

    One beside ego has to, and one behind it that would have to brake harder than
    ``disturbing_mps2`` after its reaction time not to run into it.
    """
    limits = context.thresholds
    station = relations.station(context.ego_extents, context.extents)
    lanes = np.arange(context.touched.shape[-1])
    same = context.touched & (lanes == context.ego_lane[None, :, None])
    faster = np.maximum(context.extents.along - context.ego_extents.along, 0.0)
    room = relations.gap(context.ego_extents, context.extents) - faster * limits.reaction_s
    brakes = faster**2 > 2 * limits.disturbing_mps2 * np.maximum(room, 0.0)
    behind = (station == relations.IN_FRONT_OF) & brakes
    beside = station == relations.BESIDE
    disturbs: Flags = (context.going_along & same.any(axis=-1) & (behind | beside)).any(axis=0)
    return disturbs
