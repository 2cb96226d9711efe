"""Recordings with all repairs of tracks, applied once.

Participants of unknown type that drive as only vehicles can are vehicles.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely
from numpy import bool_
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.mending.rows_of_states import rows_of, steps_of, with_mended
from rulec.recordings.mending.short_holes import LONGEST_HOLE_S, without_short_holes
from rulec.recordings.mending.steady_headings import with_steady_headings
from rulec.recordings.mending.track_jumps import without_jumps
from rulec.recordings.mending.wrong_places import without_wrong_places
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import MENDED, OBSTACLE_TYPES, Participant, Recording, is_lane

_FAST_MPS = 14.0
"""Nobody rides so fast on the level: a speed pedelec helps up to 45 km/h (12.5 m/s)."""

_WINDOW_S = 1.0
"""Over two successive windows of this: a position that jumps is fast over one."""

_ALONG = np.radians(30.0)
_BESIDE_M = 2.5
"""Whoever drives along a lane is no farther from its middle line, and moves in its direction."""

_AHEAD_M = 1.0


def with_fast_unknowns(recording: Recording) -> Recording:
    """A recording in which participants of unknown type are vehicles if they drive like one.

    That is along lanes, either way, and faster than anybody walks or rides. Trains run on rails,
    not on lanes.
    """
    lines: list[shapely.LineString] = []

    def known(body: Participant) -> Participant:
        if body.standing or not body.states or body.object_types != OBSTACLE_TYPES["unknown"]:
            return body
        middles = _fast(steps_of(body), rows_of(body)[:, :2], recording.step_s)
        if not len(middles):
            return body
        if not lines:
            lanes = filter(is_lane, recording.lanelets.values())
            lines.extend(shapely.LineString(lane.centre) for lane in lanes)
        return replace(body, type="vehicle") if _along_lanes(middles, lines).any() else body

    return with_mended(recording, known)


def _fast(steps: NDArray[np.int64], places: Floats, step_s: float) -> Floats:
    """Three places in a row, a window apart, wherever the ways between them are long enough."""
    window = max(1, round(_WINDOW_S / step_s))
    if len(steps) <= 2 * window:
        return np.empty((0, 3, 2))
    first, middle, last = (np.arange(len(steps) - 2 * window) + k * window for k in range(3))
    three = places[np.stack((first, middle, last), axis=1)]
    ways = np.hypot(*np.diff(three, axis=1).transpose(2, 0, 1))
    fast = (ways >= _FAST_MPS * window * step_s).all(axis=1)
    fast &= steps[last] - steps[first] == 2 * window
    found: Floats = three[fast]
    return found


def _along_lanes(three: Floats, lines: list[shapely.LineString]) -> NDArray[bool_]:
    """Mask of the places in a row that are all on lanes in whose direction they lie."""
    motion = three[:, 2] - three[:, 0]
    way = np.arctan2(motion[:, 1], motion[:, 0])
    on_lanes: NDArray[bool_] = np.zeros(three.shape[:2], dtype=bool)
    tree = shapely.STRtree(lines)
    own = np.array(lines, dtype=object)
    for place in range(3):
        points = shapely.points(three[:, place])
        at, number = tree.query(points, predicate="dwithin", distance=_BESIDE_M)
        along = shapely.line_locate_point(own[number], points[at])
        ends = [
            shapely.get_coordinates(shapely.line_interpolate_point(own[number], np.maximum(s, 0)))
            for s in (along - _AHEAD_M, along + _AHEAD_M)
        ]
        dx, dy = (ends[1] - ends[0]).T
        # Either way round
        apart: Floats = 2 * (np.arctan2(dy, dx) - way[at])
        off = np.abs(wrapped(apart)) / 2
        on_lanes[at[off < _ALONG], place] = True
    found: NDArray[bool_] = np.logical_and.reduce(on_lanes, axis=1)
    return found


def mended(recording: Recording, longest_hole_s: float = LONGEST_HOLE_S) -> Recording:
    """A recording without wrong places and jumps, and without holes up to this length.

    Headings are steady. Participants of unknown type are vehicles if they drive as only vehicles
    can. It is marked as ``MENDED``, and is not repaired again.
    """
    if MENDED in recording.complete:
        return recording
    placed = without_jumps(without_wrong_places(recording))
    steady = with_steady_headings(with_fast_unknowns(placed))
    repaired = without_short_holes(steady, longest_hole_s)
    return replace(repaired, complete=repaired.complete | {MENDED})
