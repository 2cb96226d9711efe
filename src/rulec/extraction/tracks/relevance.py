"""The participants that count for ego: near, on its lanes or beside."""

from __future__ import annotations

import numpy as np

from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_extents import RoadExtents, lanes_touched
from rulec.extraction.tracks.tracks import Flags, Tracks
from rulec.extraction.traffic_thresholds import Thresholds

_ONCOMING_COSINE = -0.7
"""The cosine of the angle to the road from which on a vehicle counts as coming towards ego."""


def relevant_participants(
    ego: int, tracks: Tracks, extents: RoadExtents, road: DrivenRoad, thresholds: Thresholds
) -> Flags:
    """Flags of participants (rows) that count for ego, by step.

    On ego's lanes everything counts that is near; beside them only vulnerable road users, and
    oncoming vehicles that move at some time.
    """
    own = extents.of(ego)
    gap = np.maximum(extents.s_min - own.s_max, own.s_min - extents.s_max)
    on_lanes = lanes_touched(extents, road, thresholds).any(axis=-1)
    straight = road.lanes.straight
    beside = thresholds.beside_road_m
    close = (extents.w_max > straight[0] - beside) & (extents.w_min < straight[-1] + beside)
    vulnerable = tracks.of_type("vulnerable_user")[:, None]
    oncoming = (np.cos(extents.turned) < _ONCOMING_COSINE) & _moves(tracks, thresholds)[:, None]
    counts = (gap <= thresholds.near_m) & (on_lanes | (close & (vulnerable | oncoming)))
    counts[ego] = False
    relevant: Flags = counts & ~np.isnan(own.s_min)
    return relevant


def _moves(tracks: Tracks, thresholds: Thresholds) -> Flags:
    """Flags of participants that move at some time."""
    fastest = np.nan_to_num(tracks.speed).max(axis=1, initial=0.0)
    moves: Flags = fastest * 3.6 >= thresholds.standing_kmh
    return moves
