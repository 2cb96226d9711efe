"""The extents of participants along and across a road, in Frenet coordinates.

Rows are participants and columns time steps, as in ``Tracks``; NaN for who is not beside the road.
Frenet coordinates are the arc length ``s`` along a reference line and the offset ``d`` from it (m,
positive to the left); ``w`` is ``d`` between the lanes' straight bounds, so that lanes are numbered
by it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.tracks import Flags, Floats, Tracks
from rulec.scenario.recorded.lane_coordinates import outline_bounds
from rulec.scenario.recorded.reference_line import turn

_BOUNDS = ("s_min", "s_max", "d_min", "d_max", "w_min", "w_max")


_MORE_M = 10.0


@dataclass(frozen=True, eq=False, slots=True)
class EgoPieces:
    """Ego's row, and in which piece of the road it was at some columns.

    ``numbers`` are those of the map's lanelets.
    """

    row: int
    columns: Sequence[int]
    pieces: Sequence[int]
    numbers: Mapping[str, int]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class RoadExtents:
    """The bounds and the motion of participants in coordinates of the road.

    ``turned`` is the heading relative to the road's direction (rad, in [-pi, pi)), ``along`` and
    ``across`` are the velocity along the road and to its left (m/s).
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
        """The middle along the road (m)."""
        return (self.s_min + self.s_max) / 2

    @property
    def w(self) -> Floats:
        """The middle across the road (m, straightened)."""
        return (self.w_min + self.w_max) / 2

    def of(self, row: int) -> RoadExtents:
        """One participant's extents, with an axis of length 1 for it."""
        return self.part(np.array([row]), slice(None))

    def part(self, rows: NDArray[intp], columns: slice) -> RoadExtents:
        """The extents of some participants in a range of steps."""
        return RoadExtents(
            **{field.name: getattr(self, field.name)[rows][:, columns] for field in fields(self)}
        )


def road_extents(
    tracks: Tracks, road: DrivenRoad, expected: tuple[Floats, Floats] | None = None
) -> RoadExtents:
    """The extents of all participants in the coordinates of a road.

    ``expected``: about where along it each is, and how far from there it may be, since a road that
    meets itself passes a place more than once.
    """
    bounds = {name: np.full(tracks.present.shape, np.nan) for name in _BOUNDS}
    located = list(tracks.outlines(repeated=expected is not None))
    if located:
        rows, columns = np.array([(row, column) for row, column, _ in located]).T
        near = expected and (expected[0][rows, columns], expected[1][rows, columns])
        outlines = [outline for _, _, outline in located]
        low, high = outline_bounds(outlines, road.line, road.lanes, near)
        standing = [row for row, body in enumerate(tracks.participants) if body.standing]
        by_bound = np.stack((low, high), axis=2).reshape(-1, len(_BOUNDS)).T
        for bound, values in zip(bounds.values(), by_bound, strict=True):
            bound[rows, columns] = values
            if expected is None:
                bound[standing] = bound[standing][:, :1]
    middle = (bounds["s_min"] + bounds["s_max"]) / 2
    directions = road.line.headings_at(np.nan_to_num(middle))
    cos, sin = np.cos(directions), np.sin(directions)
    return RoadExtents(
        **bounds,
        turned=turn(directions, tracks.heading),
        along=tracks.vx * cos + tracks.vy * sin,
        across=tracks.vy * cos - tracks.vx * sin,
    )


def expected_places(
    tracks: Tracks, road: DrivenRoad, ego: EgoPieces, lanelets: NDArray[intp], reach_m: float
) -> tuple[Floats, Floats]:
    """About where along a road that meets itself participants are, and how far from there at most.

    Ego is in the pieces that it drove, and who drives on the same lanes (``lanelets`` has their
    numbers) is on those nearest to it, the shorter way round; anybody else is within ``reach_m``.
    """
    middles, halves = (road.borders[1:] + road.borders[:-1]) / 2, np.diff(road.borders) / 2
    columns = np.arange(tracks.present.shape[1])
    pieces = np.interp(columns, ego.columns, ego.pieces).astype(intp)
    places = np.stack((tracks.x, tracks.y), axis=-1)
    reach = halves[pieces] + _MORE_M
    ego_s = road.line.coordinates_near(places[ego.row], middles[pieces], reach)[:, 0]
    ego_s = np.where(np.isnan(ego_s), middles[pieces], ego_s)
    around = np.tile(ego_s, (len(places), 1))
    reaches = np.full(around.shape, reach_m)
    least = np.full(around.shape, np.inf)
    for piece, row in enumerate(road.rows):
        own = [ego.numbers[lanelet.id] for lanelet in row if lanelet is not None]
        at = np.nonzero(np.isin(lanelets, own))
        near = np.full(len(at[0]), middles[piece]), np.full(len(at[0]), halves[piece] + _MORE_M)
        s = road.line.coordinates_near(places[at], *near)[:, 0]
        nearer = np.abs(s - ego_s[at[1]]) < least[at]
        at = at[0][nearer], at[1][nearer]
        around[at], reaches[at] = s[nearer], _MORE_M
        least[at] = np.abs(s[nearer] - ego_s[at[1]])
    around[ego.row], reaches[ego.row] = ego_s, _MORE_M
    return around, reaches


def lanes_touched(extents: RoadExtents, road: DrivenRoad, touching_m: float) -> Flags:
    """Flags of lanes (last axis) that bodies reach into by more."""
    right, left = road.lanes.straight[:-1], road.lanes.straight[1:]
    low, high = extents.w_min[..., None], extents.w_max[..., None]
    inside = np.minimum(high, left) - np.maximum(low, right)
    # A narrow body, such as a pedestrian's, is in a lane with most of it
    enough = np.minimum(touching_m, (high - low) / 2)
    return (inside > enough) & road.lanes.existing_at(extents.s)
