"""The extents of participants along and across a road, in Frenet coordinates.

Rows are participants and columns time steps, as in ``Tracks``; NaN for participants that are not
beside the road. Frenet coordinates are the arc length ``s`` along a reference line and the offset
``d`` from it (m, positive to the left). Lanes get wider and narrower, so lateral places are
measured from each of their bounds: a vehicle that reaches some centimetres into a lane that opens
is in it by that much.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy import int8, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.extraction.tracks.tracks import Tracks
from rulec.scenario.recorded.lane_coordinates import outline_bounds
from rulec.scenario.recorded.reference_line import turn
from rulec.trace.cells import Cells
from rulec.trace.laid_out import LaidOut
from rulec.trace.plain_arrays import zero_if_nan

_BOUNDS = ("s_min", "s_max", "d_min", "d_max")

_MORE_M = 10.0


@dataclass(frozen=True, eq=False, slots=True)
class EgoPieces:
    """Ego's row, and the piece of the road that it was in at some columns.

    ``numbers`` are those of the map's lanelets, by id.
    """

    row: int
    columns: Sequence[int]
    pieces: Sequence[int]
    numbers: Mapping[str, int]


@dataclass(frozen=True, eq=False, kw_only=True)
class RoadExtents:
    """The bounds and the motion of participants in coordinates of the road.

    ``left_of_min`` and ``left_of_max`` are how far (m) left of each lane bound (third axis, from
    the right) bodies begin and end; in memory that axis comes first. ``turned`` is the heading
    relative to the road's direction (rad, in [-pi, pi)); ``along`` and ``across`` are the velocity
    along the road and to its left (m/s).
    """

    s_min: Floats
    s_max: Floats
    d_min: Floats
    d_max: Floats
    left_of_min: Floats
    left_of_max: Floats
    turned: Floats
    along: Floats
    across: Floats

    @cached_property
    def s(self) -> Floats:
        """The place of the middle along the road (m)."""
        return (self.s_min + self.s_max) / 2

    @cached_property
    def left_of(self) -> Floats:
        """How far (m) the middle is left of each lane bound."""
        return (self.left_of_min + self.left_of_max) / 2

    @cached_property
    def lane(self) -> NDArray[intp]:
        """The lane of the middle; beside the road, the nearest lane."""
        last = self.left_of_min.shape[-1] - 2
        beyond = self.left_of.transpose(2, 0, 1) >= 0
        lane: NDArray[intp] = np.minimum(np.maximum(beyond.sum(axis=0) - 1, 0), last)
        return lane

    @cached_property
    def lane_steps(self) -> NDArray[int8]:
        """The way of the middle's lane change to the next column: 1 left, -1 right, 0 none."""
        onward = self.lane[:, 1:] - self.lane[:, :-1]
        steps: NDArray[int8] = np.zeros(self.lane.shape, dtype=int8)
        steps[:, :-1] = np.sign(onward)
        return steps

    @cached_property
    def off_middle(self) -> Floats:
        """How far (m) the middle is left of the middle of its lane."""
        at = *np.ogrid[: len(self.lane), : self.lane.shape[1]], self.lane
        beyond = *at[:2], self.lane + 1
        low, high = (
            (bounds[at] + bounds[beyond]) / 2 for bounds in (self.left_of_min, self.left_of_max)
        )
        off: Floats = (low + high) / 2
        return off

    @cached_property
    def breadth(self) -> Floats:
        """How far (m) bodies extend across each lane (last axis)."""
        return self.left_of_max[..., :-1] - self.left_of_min[..., :-1]

    @cached_property
    def inside(self) -> Floats:
        """How far (m) bodies reach into each lane (last axis), negative beside it."""
        into = np.minimum(self.left_of_max[..., :-1], -self.left_of_min[..., 1:])
        widths = self.left_of[..., :-1] - self.left_of[..., 1:]
        return np.minimum(into, np.minimum(self.breadth, widths))

    def from_bound(self, bound: NDArray[intp]) -> tuple[Floats, Floats]:
        """How far (m) left of one lane bound, given by column, bodies begin and end."""
        return _at_bound(self.left_of_min, bound), _at_bound(self.left_of_max, bound)

    def cells_from_bounds(
        self, cells: Cells, *bounds: NDArray[intp] | int
    ) -> list[tuple[Floats, Floats]]:
        """``from_bound`` for some cells only, for each of several bounds."""
        whole, rows, columns = self._places_of(cells)
        own = [bound if isinstance(bound, int) else bound.take(cells.columns) for bound in bounds]
        return [
            (whole.left_of_min[rows, columns, at], whole.left_of_max[rows, columns, at])
            for at in own
        ]

    def _places_of(self, cells: Cells) -> tuple[RoadExtents, NDArray[intp], NDArray[intp]]:
        """Extents and, in their arrays, the rows and columns of cells."""
        return self, cells.rows, cells.columns

    def from_middle(self, lane: NDArray[intp]) -> tuple[Floats, Floats]:
        """How far (m) left of the middle of one lane, given by column, bodies begin and end."""
        (low, high), (low_left, high_left) = self.from_bound(lane), self.from_bound(lane + 1)
        return (low + low_left) / 2, (high + high_left) / 2

    def middle_from(self, bound: NDArray[intp]) -> Floats:
        """How far (m) left of one lane bound, given by column, the middle is."""
        return _at_bound(self.left_of, bound)

    def moved(self, across: Floats) -> RoadExtents:
        """The extents with bodies moved to the left in the lanes by ``across`` (m, by column)."""
        if not across.any():
            return self
        by = across[:, None]
        return replace(self, left_of_min=self.left_of_min + by, left_of_max=self.left_of_max + by)

    def of(self, row: int) -> RoadExtents:
        """One participant's extents, with an axis of length 1 for it."""
        return self.part(np.array([row]), slice(None))

    def part(self, rows: NDArray[intp], columns: slice) -> RoadExtents:
        """The extents of some participants in a range of steps."""
        return self._each(lambda values: values[rows, columns])

    def at(self, rows: NDArray[intp], columns: NDArray[intp]) -> RoadExtents:
        """The extents at cells of the arrays, given by rows and columns of the same shape."""
        return self._each(lambda values: values[rows, columns])

    def _each(self, own: Callable[[NDArray[Any]], NDArray[Any]]) -> RoadExtents:
        found = RoadExtents(**{name: own(getattr(self, name)) for name in _FIELDS})
        # Values already derived for all need not be derived again
        for name in ("s", "lane"):
            if name in self.__dict__:
                found.__dict__[name] = own(self.__dict__[name])
        return found

    def end_to_end(self, laid: LaidOut) -> RoadExtents:
        """The extents of some participants in several ranges of columns, end to end."""
        return _LaidExtents(self, laid)

    def and_one(self, other: RoadExtents, row: int) -> RoadExtents:
        """These extents, followed by one row of ``other`` in the same steps."""
        both = {name: (getattr(self, name), getattr(other, name)) for name in _FIELDS}
        return RoadExtents(**{name: and_row(*values, row) for name, values in both.items()})


_FIELDS = tuple(field.name for field in fields(RoadExtents))


def _derived(name: str) -> cached_property[Any]:
    return cached_property(lambda extents: extents._laid_out(name))


class _LaidExtents(RoadExtents):
    """Extents of a ``whole`` in several ranges, with each array laid out on first use.

    Values derived from single places are derived once, for the whole. Participants without a place
    have the first lane, like absent ones.
    """

    def __init__(self, whole: RoadExtents, laid: LaidOut) -> None:
        self.__dict__.update(_whole=whole, _laid=laid)

    def part(self, rows: NDArray[intp], columns: slice) -> RoadExtents:
        """The extents of some participants in a range of steps."""
        if columns != slice(None):
            return super().part(rows, columns)
        return _LaidExtents(self.__dict__["_whole"], self.__dict__["_laid"].of_rows(rows))

    def _places_of(self, cells: Cells) -> tuple[RoadExtents, NDArray[intp], NDArray[intp]]:
        whole, laid = self.__dict__["_whole"], self.__dict__["_laid"]
        return whole, laid.rows[cells.rows], laid.columns[cells.columns]

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name not in _FIELDS:
            raise AttributeError(name)
        values = self.__dict__[name] = self._laid_out(name)
        return values

    def _laid_out(self, name: str) -> NDArray[Any]:
        found: NDArray[Any] = self.__dict__["_laid"](getattr(self.__dict__["_whole"], name))
        return found

    s, lane, lane_steps, off_middle = map(_derived, ("s", "lane", "lane_steps", "off_middle"))


def and_row(values: NDArray[Any], others: NDArray[Any], row: int) -> NDArray[Any]:
    """All rows, followed by one row of ``others``."""
    return np.concatenate((values, others[row : row + 1]))


def _at_bound(left_of: Floats, bound: NDArray[intp]) -> Floats:
    """The values at one bound (last axis), given by column, or by row and column."""
    rows, columns = left_of.shape[:2]
    values: Floats = left_of[np.arange(rows)[:, None], np.arange(columns), bound]
    return values


def road_extents(
    tracks: Tracks, road: DrivenRoad, expected: tuple[Floats, Floats] | None = None
) -> RoadExtents:
    """The extents of all participants in the coordinates of a road.

    ``expected``: roughly where along the road each participant is, and how far from there it may
    be; needed since a road that meets itself passes a place more than once.
    """
    bounds = np.full((len(_BOUNDS), *tracks.present.shape), np.nan)
    left_of = np.full((2, road.lanes.bounds.shape[1], *tracks.present.shape), np.nan)
    bodies = tracks.bodies if expected is None else tracks.repeated_bodies
    rows, columns = bodies.rows, bodies.columns
    if len(rows):
        near = expected and (expected[0][rows, columns], expected[1][rows, columns])
        ends = outline_bounds(bodies.outlines, road.line, road.lanes.from_bounds, near)
        for which, values in enumerate(ends):
            bounds[which::2, rows, columns] = values[:, :2].T
            left_of[which, :, rows, columns] = values[:, 2:]
        if expected is None:
            standing = [row for row, body in enumerate(tracks.participants) if body.standing]
            bounds[:, standing] = bounds[:, standing, :1]
            left_of[:, :, standing] = left_of[:, :, standing, :1]
    s_min, s_max, d_min, d_max = bounds
    directions, cos, sin = road.line.directions_at(zero_if_nan((s_min + s_max) / 2))
    left_of_min, left_of_max = left_of.transpose(0, 2, 3, 1)
    return RoadExtents(
        s_min=s_min,
        s_max=s_max,
        d_min=d_min,
        d_max=d_max,
        left_of_min=left_of_min,
        left_of_max=left_of_max,
        turned=turn(directions, tracks.heading),
        along=tracks.vx * cos + tracks.vy * sin,
        across=tracks.vy * cos - tracks.vx * sin,
    )


def expected_places(
    tracks: Tracks, road: DrivenRoad, ego: EgoPieces, lanelets: NDArray[intp], reach_m: float
) -> tuple[Floats, Floats]:
    """Rough places along a road that meets itself, and how far (m) from them participants may be.

    Ego is in the pieces that it drove. Participants on the same lanes (``lanelets`` has their
    numbers) are on the pieces nearest to ego, the shorter way round; all others are within
    ``reach_m`` of ego.
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
        at = np.isin(lanelets, own).nonzero()
        near = np.full(len(at[0]), middles[piece]), np.full(len(at[0]), halves[piece] + _MORE_M)
        s = road.line.coordinates_near(places[at], *near)[:, 0]
        nearer = np.abs(s - ego_s[at[1]]) < least[at]
        at = at[0][nearer], at[1][nearer]
        around[at], reaches[at] = s[nearer], _MORE_M
        least[at] = np.abs(s[nearer] - ego_s[at[1]])
    around[ego.row], reaches[ego.row] = ego_s, _MORE_M
    return around, reaches
