"""The road that ego drives along: street-wise coordinates, lanes, and what the map says of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.drives.everyone import Flags, Values
from rulec.scenario.geometry import Box
from rulec.scenario.recorded.crosswalks import crossings
from rulec.scenario.recorded.lanes import Lanes, borders_along, lanes_along
from rulec.scenario.recorded.recording import Lanelet, Recording
from rulec.scenario.recorded.reference_line import ReferenceLine, reference_line
from rulec.scenario.recorded.route import extended
from rulec.scenario.recorded.traffic import View


@dataclass(frozen=True, eq=False, slots=True)
class Road:
    """``lanelets`` lie one behind the other, from ``borders[i]`` to ``borders[i + 1]``.

    ``crossings`` are pedestrian crossings, from where to where along the road.
    """

    lanelets: tuple[Lanelet, ...]
    borders: Values
    line: ReferenceLine
    lanes: Lanes
    crossings: tuple[tuple[float, float], ...]

    def piece(self, s: Values) -> NDArray[intp]:
        """The numbers of the lanelets at places."""
        found = np.searchsorted(self.borders, np.nan_to_num(s), "right") - 1
        return np.clip(found, 0, len(self.lanelets) - 1)

    def lanes_at(self, s: Values) -> Flags:
        """Which lanes there are at places: the last axis is that of the lanes, from the right."""
        at = np.searchsorted(self.lanes.s, np.nan_to_num(s), "right") - 1
        return self.lanes.there[np.clip(at, 0, len(self.lanes.there) - 1)]

    def lane_of(self, d: Values) -> NDArray[intp]:
        """The lanes at straightened offsets; who is beside the road counts to the nearest."""
        straight = self.lanes.straight
        found = np.searchsorted(straight, np.nan_to_num(d), "right") - 1
        return np.clip(found, 0, len(straight) - 2)


def road_along(recording: Recording, way: Sequence[str]) -> Road:
    """The road of a chain of lanelets, and what lies straight on before and after it.

    Raises:
        ValueError: its lanes cannot be laid out along a line.
    """
    whole = extended(recording, way)
    lanelets = tuple(recording.lanelets[number] for number in whole)
    line = reference_line(np.concatenate([one.centre for one in lanelets]))
    borders = borders_along(lanelets, line)
    first = whole.index(way[0])
    middle = float(borders[first] + borders[first + len(way)]) / 2
    lanes = lanes_along(recording, whole, line, middle)
    outline = Box(0.0, line.length, float(lanes.straight[0]), float(lanes.straight[-1]))
    view = View(recording, line, lanes, 0.0, 0.0, outline)
    return Road(lanelets, borders, line, lanes, tuple(one.s for one in crossings(view)))
