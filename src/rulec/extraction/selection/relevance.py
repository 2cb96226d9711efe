"""Who is there for ego: on its lanes or beside them, and not too far away."""

from __future__ import annotations

import numpy as np

from rulec.extraction.selection.traffic_thresholds import Thresholds
from rulec.extraction.signals.relations import lanes_touched
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.extraction.tracks.tracks import Flags, Tracks

_AGAINST = -0.7
"""The cosine of the angle from which on somebody comes towards ego."""


def relevant_participants(
    ego: int, people: Tracks, all_placed: RoadExtents, road: DrivenRoad, thresholds: Thresholds
) -> Flags:
    """Who is there for ego when."""
    own = all_placed.of(ego)
    gap = np.maximum(all_placed.s_min - own.s_max, own.s_min - all_placed.s_max)
    on_lanes = lanes_touched(all_placed, road, thresholds).any(axis=-1)
    straight = road.lanes.straight
    beside = thresholds.beside_road_m
    close = (all_placed.w_max > straight[0] - beside) & (all_placed.w_min < straight[-1] + beside)
    walks = people.of_kind("vulnerable_user")[:, None]
    comes = (np.cos(all_placed.turned) < _AGAINST) & _drives(people, thresholds)[:, None]
    found = (gap <= thresholds.near_m) & (on_lanes | (close & (walks | comes)))
    found[ego] = False
    known: Flags = found & ~np.isnan(own.s_min)
    return known


def _drives(people: Tracks, thresholds: Thresholds) -> Flags:
    """Who moves at some time?"""
    fastest = np.nan_to_num(people.speed).max(axis=1, initial=0.0)
    moves: Flags = fastest * 3.6 >= thresholds.standing_kmh
    return moves
