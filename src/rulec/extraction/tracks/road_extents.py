"""Where everybody is along and across a road.

Rows are participants and columns time steps, as in ``everyone``; NaN where somebody is nowhere near
the road. ``d`` is in metres, ``w`` between the lanes' straight bounds, so that lanes have numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.tracks import Floats, Tracks
from rulec.scenario.recorded.outline_bounds import outline_bounds


@dataclass(frozen=True, eq=False, slots=True)
class RoadExtents:
    """The bounds of what everybody occupies, and the middle of these.

    ``turned`` is the heading as seen from the road's direction (radians), ``along`` and ``across``
    the velocity along the road and to its left (m/s).
    """

    s_min: Floats
    s_max: Floats
    d_min: Floats
    d_max: Floats
    w_min: Floats
    w_max: Floats
    turned: Floats
    along: Floats
    across: Floats

    @property
    def s(self) -> Floats:
        """The middle along the road."""
        return (self.s_min + self.s_max) / 2

    @property
    def w(self) -> Floats:
        """The middle across the road."""
        return (self.w_min + self.w_max) / 2

    def of(self, row: int) -> RoadExtents:
        """One participant's, with an axis of length 1 for it."""
        return RoadExtents(*(getattr(self, field.name)[row : row + 1] for field in fields(self)))


def road_extents(people: Tracks, road: DrivenRoad) -> RoadExtents:
    """Everybody, in the coordinates of a road."""
    shape = people.there.shape
    bounds = [np.full(shape, np.nan) for _ in range(6)]
    known = list(people.outlines())
    if known:
        low, high = outline_bounds([outline for _, _, outline in known], road.line, road.lanes)
        rows, columns = np.array([(row, column) for row, column, _ in known]).T
        for axis in range(3):
            bounds[2 * axis][rows, columns] = low[:, axis]
            bounds[2 * axis + 1][rows, columns] = high[:, axis]
        standing = [row for row, one in enumerate(people.participants) if one.standing]
        for bound in bounds:
            bound[standing] = bound[standing][:, :1]
    directions = _directions(road, (bounds[0] + bounds[1]) / 2)
    cos, sin = np.cos(directions), np.sin(directions)
    s_min, s_max, d_min, d_max, w_min, w_max = bounds
    return RoadExtents(
        s_min,
        s_max,
        d_min,
        d_max,
        w_min,
        w_max,
        (people.heading - directions + np.pi) % (2 * np.pi) - np.pi,
        people.vx * cos + people.vy * sin,
        people.vy * cos - people.vx * sin,
    )


def _directions(road: DrivenRoad, s: Floats) -> Floats:
    line = road.line
    piece = np.searchsorted(line.arc, np.nan_to_num(s), "right") - 1
    ahead = line.ahead[np.clip(piece, 0, len(line.arc) - 1)]
    directions: Floats = np.arctan2(ahead[..., 1], ahead[..., 0])
    return directions
