"""Pedestrian crossings: where crosswalk lanelets meet ego's road."""

from __future__ import annotations

import numpy as np

from rulec.scenario.recorded.reference_line import densified
from rulec.scenario.recorded.traffic_obstacles import TrafficView
from rulec.scenario.scenario_model import Stretch

_NARROWEST_M = 0.1
_EVERY_M = 0.5


def road_crossings(view: TrafficView) -> tuple[Stretch, ...]:
    """The stretches of the road that crosswalks take up.

    Each reaches across the whole road.
    """
    stretches = []
    road = view.road
    for lanelet in view.recording.lanelets.values():
        if "crosswalk" not in lanelet.types:
            continue
        outline = np.concatenate((lanelet.right, lanelet.left[::-1], lanelet.right[:1]))
        places = view.lanes.straightened(view.line.coordinates(densified(outline, _EVERY_M)))
        on_road = places[(places[:, 1] > road.d_min) & (places[:, 1] < road.d_max), 0] - view.ego_s
        if len(on_road):
            low, high = max(float(on_road.min()), road.s_min), min(float(on_road.max()), road.s_max)
            if high - low >= _NARROWEST_M:
                stretches.append(Stretch("crossing", (low, high)))
    return tuple(stretches)
