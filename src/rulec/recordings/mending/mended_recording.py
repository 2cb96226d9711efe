"""Recordings with all repairs of tracks, applied once.

Participants of unknown type that drive as only vehicles can are vehicles.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import shapely
from numpy import bool_, float64, int64, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.mending.rows_of_states import rows_of, steps_of, with_mended, with_rows
from rulec.recordings.mending.short_holes import LONGEST_HOLE_S, without_short_holes
from rulec.recordings.mending.track_jumps import without_jumps
from rulec.recordings.mending.wrong_places import without_wrong_places
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import MENDED, OBSTACLE_TYPES, Participant, Recording, is_lane
from rulec.recordings.track import outlines_on_track

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


_LEAST_RADIUS_M = 2.0
_LEAST_TURN = np.radians(30.0)
"""Smaller turns may be noise of a box that is otherwise right."""

_ROUND = np.radians(135.0)
_SOON_S = 0.5
"""Between states farther apart a vehicle may turn unseen."""

_BRIEF_S = 1.0
"""A box that is reversed for longer may be right, and the others wrong."""

_STANDS_M = 0.25
"""A vehicle that moves less within ``_SOON_S`` stands or creeps."""

_SLOW_M = 1.5
"""One that moves less within ``_SOON_S`` is so slow that noise of places turns its heading."""

_HAIR = 1e-6

_DRIVERS = frozenset({"vehicle", "light_rider"})


def with_steady_headings(recording: Recording) -> Recording:
    """A recording whose vehicles and cycles turn no faster than they can.

    A heading that is reversed for less than ``_BRIEF_S`` is turned back. Spinning headings of a
    standing vehicle are replaced by those before and after.
    """
    return with_mended(recording, lambda body: _steadied(body, recording.step_s))


def _steadied(body: Participant, step_s: float) -> Participant:
    if body.standing or len(body.states) < 3 or not _DRIVERS.intersection(body.object_types):
        return body
    if outlines_on_track(body) is None and body.states.keys() != body.outlines.keys():
        return body
    steps, rows = steps_of(body), rows_of(body)
    times: Floats = (steps * step_s).astype(float64)
    heading = _steady(times, rows[:, :2], rows[:, 2])
    if heading is None:
        return body
    steady = rows.copy()
    steady[:, 2] = heading
    return with_rows(body, steps, steady)


def _steady(times: Floats, places: Floats, heading: Floats) -> Floats | None:
    """The corrected headings; None if all are right."""
    apart = np.diff(times)
    ways = np.hypot(*np.diff(places, axis=0).T)
    if not _spins(apart, ways, heading).any():
        return None
    steadied = _turned_back(times, places, heading, apart)
    spins = _spins(apart, ways, steadied)
    if spins.any():
        steadied = _of_before_and_after(times, places, steadied, spins)
    return None if np.array_equal(steadied, heading) else steadied


def _spins(apart: Floats, ways: Floats, heading: Floats) -> NDArray[bool_]:
    """Mask of states, except the last, after which the heading turns impossibly fast."""
    turned = np.abs(wrapped(np.diff(heading)))
    spins: NDArray[bool_] = turned > np.maximum(_LEAST_TURN, ways / _LEAST_RADIUS_M)
    return spins & (apart <= _SOON_S)


def _turned_back(times: Floats, places: Floats, heading: Floats, apart: Floats) -> Floats:
    """The headings, with those turned back that are reversed for less than ``_BRIEF_S``.

    At a track's ends this applies only next to others that last longer and lead forwards at least
    as far.
    """
    turned: Floats = heading.copy()
    whole = len(heading)
    flips = (np.abs(wrapped(np.diff(heading))) > _ROUND) & (apart <= _SOON_S)
    parts = list(pairwise([0, *(flips.nonzero()[0] + 1).tolist(), whole]))
    for number, (begin, end) in enumerate(parts):
        if times[min(end, whole - 1)] - times[begin] >= _BRIEF_S or len(parts) == 1:
            continue
        if begin > 0 and end < whole:
            wrong = abs(wrapped(turned[begin : begin + 1] - turned[begin - 1])[0]) > _ROUND
        else:
            beside = parts[1] if begin == 0 else parts[number - 1]
            wrong = end - begin < beside[1] - beside[0] and (
                _forwards(places, heading, (begin, end)) <= _forwards(places, heading, beside)
            )
        if wrong:
            turned[begin:end] = wrapped(turned[begin:end] + np.pi)
    return turned


def _forwards(places: Floats, heading: Floats, part: tuple[int, int]) -> float:
    """How far (m) a vehicle drives forwards by its headings; negative if backwards."""
    begin, end = part
    x, y = np.diff(places[begin:end], axis=0).T
    own = heading[begin : end - 1]
    return float((x * np.cos(own) + y * np.sin(own)).sum())


def _of_before_and_after(
    times: Floats, places: Floats, heading: Floats, spins: NDArray[bool_]
) -> Floats:
    """The headings, with spinning ones of a standing vehicle replaced by those before and after.

    Before and after are where it has moved so far that its heading does not spin any more. It turns
    only while it moves.
    """
    stands = _moves_less(times, places, _STANDS_M)
    spinning = np.append(spins, False) | np.append(False, spins)
    slow = stands | (spinning & _moves_less(times, places, _SLOW_M))
    steadied: Floats = heading.copy()
    for begin, end in _runs(_without_gaps(times, slow)):
        # One that turns once, and stays so, may have been put right there
        if not any(spins[first : last - 1].sum() > 1 for first, last in _runs(stands, begin, end)):
            continue
        before = _mean(heading, times, slice(0, begin), float(times[begin]))
        after = _mean(heading, times, slice(end, None), float(times[end - 1]))
        first = after if before is None else before
        last = before if after is None else after
        if first is None or last is None:
            continue
        moves = ~stands[begin:end]
        share = np.linspace(0.0, 1.0, end - begin)
        if moves.any():
            share = moves.cumsum() / moves.sum()
        steadied[begin:end] = wrapped(first + share * wrapped(np.array([last - first])))
    return steadied


def _runs(flags: NDArray[bool_], begin: int = 0, end: int | None = None) -> list[tuple[int, int]]:
    """The first state of each run of flags in a part of the states, and the one after its last."""
    edges = np.diff(flags[begin:end].astype(int64), prepend=0, append=0)
    firsts, lasts = ((way * edges > 0).nonzero()[0] + begin for way in (1, -1))
    return list(zip(firsts.tolist(), lasts.tolist(), strict=True))


def _without_gaps(times: Floats, flags: NDArray[bool_]) -> NDArray[bool_]:
    """The flags, also set between those at most ``_SOON_S`` apart."""
    whole: NDArray[bool_] = flags.copy()
    places = flags.nonzero()[0]
    for before, after in pairwise(places.tolist()):
        if after > before + 1 and times[after] - times[before] <= _SOON_S + _HAIR:
            whole[before:after] = True
    return whole


def _moves_less(times: Floats, places: Floats, most_m: float) -> NDArray[bool_]:
    """Mask of states before or after which a vehicle moves no farther within half a second."""
    first, last = (times.searchsorted(times + way) for way in (-_SOON_S - _HAIR, _SOON_S - _HAIR))
    stands = np.zeros(len(times), dtype=bool)
    for other, known in (
        (first, times - times[0]),
        (np.minimum(last, len(times) - 1), times[-1] - times),
    ):
        away = np.hypot(*(places[other] - places).T)
        stands |= (away <= most_m) & (known >= _SOON_S - _HAIR)
    return stands


def _mean(heading: Floats, times: Floats, part: slice, at: float) -> float | None:
    """The mean heading of a part's states within ``_BRIEF_S`` of a time."""
    near: NDArray[intp] = (np.abs(times[part] - at) <= _BRIEF_S + _HAIR).nonzero()[0]
    if not len(near):
        return None
    own = heading[part][near]
    return float(np.arctan2(np.sin(own).sum(), np.cos(own).sum()))
