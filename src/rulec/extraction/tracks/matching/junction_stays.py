"""When participants are in which junction, also those that pass through one between two states."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.tracks.tracks import Tracks
from rulec.recordings.polylines import places_in
from rulec.recordings.recording import Participant

_THROUGH_M = 2.0
"""Who drives less far (m) through a junction between two states only touches its edge."""

_FASTEST_MPS = 150.0
"""Who is faster between two states was put elsewhere, as simulators do, and passed nothing."""


class Stay(NamedTuple):
    """A participant's stay in a junction, in columns ``first`` to ``last`` inclusive.

    ``seen``: whether its middle was there in any state. If not, these are the states before it and
    behind it.
    """

    junction: int
    row: int
    first: int
    last: int
    seen: bool


def junction_stays(
    areas: Sequence[shapely.Geometry], tracks: Tracks, step_s: float
) -> Iterator[Stay]:
    """The stays, in the order of the junctions' areas, of all participants that move on wheels."""
    moving = [
        not body.standing and "pedestrian" not in body.object_types for body in tracks.participants
    ]
    drive = tracks.present & np.array(moving, dtype=bool)[:, None]
    rows, columns = drive.nonzero()
    if not areas or not len(rows):
        return
    at, where = places_in(areas, tracks.x[rows, columns], tracks.y[rows, columns])
    before, through = _between_states(areas, tracks, drive, _FASTEST_MPS * step_s)
    for number in np.unique(np.append(where, through)).tolist():
        inside, seen = np.zeros((2, *tracks.present.shape), dtype=bool)
        chosen = at[where == number]
        seen[rows[chosen], columns[chosen]] = True
        inside |= seen
        row, column = (own[through == number] for own in before)
        inside[row, column] = inside[row, column + 1] = True
        for own in inside.any(axis=1).nonzero()[0].tolist():
            for first, last in _stays(inside[own], tracks, own):
                yield Stay(number, own, first, last, bool(seen[own, first : last + 1].any()))


def body_length(body: Participant) -> float:
    """A participant's length (m) in its first state."""
    step = next(iter(body.outlines))
    outline, state = body.outlines[step], body.states.get(step)
    if state is None:
        return float(np.ptp(outline, axis=0).max())
    ahead = outline @ np.array([np.cos(state.heading), np.sin(state.heading)])
    return float(np.ptp(ahead))


def _between_states(
    areas: Sequence[shapely.Geometry], tracks: Tracks, drive: Flags, most_m: float
) -> tuple[tuple[NDArray[intp], NDArray[intp]], NDArray[intp]]:
    """Who passes through an area and is outside it both before and after: row and column before.

    And the numbers of the areas. Nobody drives ``most_m`` in a step, but trains cross a road within
    a step of half a second.
    """
    way = np.hypot(np.diff(tracks.x, axis=1), np.diff(tracks.y, axis=1))
    far = (way > _THROUGH_M) & (way < most_m)
    rows, columns = (far & drive[:, :-1] & drive[:, 1:]).nonzero()
    ends = np.array([[array[rows, columns + k] for array in (tracks.x, tracks.y)] for k in (0, 1)])
    ends = ends.transpose(2, 0, 1)
    steps = shapely.linestrings(ends)
    number, at = shapely.STRtree(steps).query(areas, predicate="intersects")
    own = np.array(areas, dtype=object)[number]
    crossed = shapely.length(shapely.intersection(own, steps[at])) >= _THROUGH_M
    for end in (0, 1):
        crossed &= ~shapely.intersects(own, shapely.points(ends[at, end]))
    return (rows[at[crossed]], columns[at[crossed]]), number[crossed]


def _runs(flags: Flags) -> Iterator[tuple[int, int]]:
    edges = np.diff(np.concatenate(([False], flags, [False])).astype(np.int8)).nonzero()[0]
    yield from ((int(start), int(end) - 1) for start, end in edges.reshape(-1, 2))


def _stays(inside: Flags, tracks: Tracks, row: int) -> Iterator[tuple[int, int]]:
    """The first and last column of each stay of a participant in a junction.

    ``inside`` is the mask of its middle. The middle of a long vehicle cuts corners, and may leave
    the junction there while the body does not: the stay lasts until it has moved by its own length.
    """
    runs = list(_runs(inside))
    length = body_length(tracks.participants[row]) if len(runs) > 1 else 0.0
    first, last = runs[0]
    for begins, ends in runs[1:]:
        away = slice(last, begins + 1)
        way = np.hypot(np.diff(tracks.x[row, away]), np.diff(tracks.y[row, away])).sum()
        if not (tracks.present[row, away].all() and way < length):
            yield first, last
            first = begins
        last = ends
    yield first, last
