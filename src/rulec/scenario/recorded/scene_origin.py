"""Origin of a recorded scene, and the transformation back to the recording's coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rulec.array_types import Floats
from rulec.recordings.recording import Points, Recording
from rulec.scenario.recorded.ego_start import EgoStart
from rulec.scenario.recorded.lane_coordinates import Lanes
from rulec.scenario.recorded.reference_line import ReferenceLine


@dataclass(frozen=True, eq=False, slots=True)
class SceneOrigin:
    """The recording, ego's start in it, and the line and lanes along which the scene is laid out.

    ``ego_s`` is ego's start (m) along the line, ``way`` are the lanelets of its road.
    """

    recording: Recording
    start: EgoStart
    line: ReferenceLine
    lanes: Lanes
    ego_s: float
    way: tuple[str, ...]

    def places(self, s: Floats, d: Floats) -> tuple[Points, Floats]:
        """The recording's places (x, y in m, a row each) of scene coordinates, and road directions.

        Directions (rad) are interpolated along the line's pieces, as for feet.
        """
        line, along = self.line, s + self.ego_s
        piece = np.clip(line.arc.searchsorted(along, "right") - 1, 0, len(line.arc) - 1)
        ahead, part = line.ahead[piece], (along - line.arc[piece]) / line.lengths[piece]
        slope = line.first[piece] + line.change[piece] * part
        # The foot of a place is where the interpolated perpendicular leads through the place
        across = self._across(along, d) / np.hypot(1.0, slope)
        foot = line.start[piece] + ahead * (along - line.arc[piece])[:, None]
        left = np.stack((-ahead[:, 1], ahead[:, 0]), axis=1)
        places = foot + left * across[:, None] - ahead * (across * slope)[:, None]
        return places, np.arctan2(ahead[:, 1], ahead[:, 0]) + np.arctan(slope)

    def _across(self, along: Floats, d: Floats) -> Floats:
        """The offset (m) from the line, to the left, of a scene's straightened ``d``."""
        lanes, straight = self.lanes, self.lanes.straight
        bounds = -lanes.from_bounds(np.column_stack((along, np.zeros(len(along)))))
        lane = np.clip(straight.searchsorted(d, "right") - 1, 0, len(straight) - 2)
        row = np.arange(len(d))
        low, high = bounds[row, lane], bounds[row, lane + 1]
        wide = straight[lane + 1] - straight[lane]
        inside = low + (d - straight[lane]) / wide * (high - low)
        beyond = np.where(d < straight[0], low + d - straight[lane], high + d - straight[lane + 1])
        outside = (d < straight[0]) | (d > straight[-1])
        across: Floats = np.where(outside, beyond, inside)
        return across
