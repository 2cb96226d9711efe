"""What ego does when it changes lanes: is it in anybody's way, and does it say so?"""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_signals import steady_lane
from rulec.extraction.signals.signal_columns import SignalColumns, named_values
from rulec.extraction.tracks.tracks import Flags


def lane_change_signals(view: DriveContext) -> SignalColumns:
    """Words about changes of lanes."""
    lane = steady_lane(view, view.road.lanes_at(view.own.s[0]))
    changes = np.append(False, lane[1:] != lane[:-1])
    words = SignalColumns({"lane_change": changes, "lane_is_clear": ~changes | ~_disturbs(view)})
    return words | _indicator(view)


def _indicator(view: DriveContext) -> SignalColumns:
    """Ego's indicator, if the recording has its lamps; both at once are no indication."""
    (ego,) = view.ego.participants
    if not ego.lamps:
        return SignalColumns()
    near, far = (
        ("left_indicator", "right_indicator")
        if view.side == "left"
        else ("right_indicator", "left_indicator")
    )
    steps = [ego.lamps.get(view.first_step + state) for state in range(view.states)]
    lit = np.array([(near in (one or ()), far in (one or ())) for one in steps])
    codes = np.where(lit[:, 0] & ~lit[:, 1], 1, np.where(lit[:, 1] & ~lit[:, 0], 2, 0))
    return SignalColumns(
        {"indicator": named_values(codes, ("no_indicator", "near_indicator", "far_indicator"))},
        unknown={"indicator": np.array([one is None for one in steps])},
    )


def _disturbs(view: DriveContext) -> Flags:
    """Does somebody in ego's lane have to brake for it?

    Who is beside ego has to, and who is behind it if it has to brake harder than is comfortable
    not to run into it, after its reaction time.
    """
    limits = view.thresholds
    station = relations.station(view.own, view.others)
    same = view.touched[..., :] & (np.arange(view.touched.shape[-1]) == view.lane[None, :, None])
    faster = np.maximum(view.others.along - view.own.along, 0.0)
    room = relations.gap(view.own, view.others) - faster * limits.reaction_s
    brakes = faster**2 > 2 * limits.disturbing_mps2 * np.maximum(room, 0.0)
    behind = (station == relations.IN_FRONT_OF) & (brakes | (room < 0))
    beside = station == relations.BESIDE
    found: Flags = (view.with_ego & same.any(axis=-1) & (behind | beside)).any(axis=0)
    return found
