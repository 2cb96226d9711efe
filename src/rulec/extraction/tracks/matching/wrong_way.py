"""The stretches that vehicles drove against the traffic, where no lane leads their way.

This says something about the driver only where a carriageway is surely one-way: of a road with a
single lane maps often contain only one direction.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.tracks.matching.driven_route import RouteStretch
from rulec.extraction.tracks.tracks import Tracks
from rulec.recordings.recording import Lanelet, Recording, is_lane
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import directions_beside, lanelet_area

LEAST_S, LEAST_M = 1.0, 10.0
"""Driving against the traffic lasts at least this long (s) and leads at least this far (m)."""

_SLOWEST_MPS = 1.0
_AGAINST_RAD = np.radians(135.0)
_GAP_M = 0.3
"""Largest gap (m) between adjacent lanelets of a map."""

_RESERVED = frozenset({"busLane", "bicycleLane", "rail"})
"""Lanes that some traffic may use the other way, by signs that maps do not contain."""


@dataclass(frozen=True, eq=False, slots=True)
class _Against:
    """States, ordered by participant (``rows``), then time, and the lanelets against each."""

    rows: NDArray[intp]
    columns: NDArray[intp]
    lanelets: Sequence[frozenset[str]]


def wrong_way_stretches(
    recording: Recording,
    tracks: Tracks,
    matched: NDArray[intp],
    is_one_way: Callable[[Lanelet], bool],
    may_back: Flags,
) -> dict[int, list[RouteStretch]]:
    """The stretches on which participants drove against all lanes, by row.

    ``matched`` are the numbers of the lanelets that lead a participant's way, by participant and
    column, -1 for none; ``is_one_way`` tests whether a lanelet's carriageway is surely one-way.
    ``may_back``: where a participant may as well have backed, if it did so all the time. The pieces
    of a stretch are in the order of its lanelets, which its states pass in reverse.
    """
    found = _states_against(recording, tracks, matched, is_one_way)
    stretches: dict[int, list[RouteStretch]] = {}
    for row, columns, lanelets in _runs(recording, found):
        x, y = tracks.x[row, columns], tracks.y[row, columns]
        long = (len(columns) - 1) * recording.step_s >= LEAST_S - recording.step_s / 2
        if may_back[row, columns].all():
            continue
        if long and np.hypot(x[-1] - x[0], y[-1] - y[0]) >= LEAST_M:
            stretches.setdefault(row, []).append(_stretch(columns, lanelets))
    return stretches


def _states_against(
    recording: Recording,
    tracks: Tracks,
    matched: NDArray[intp],
    is_one_way: Callable[[Lanelet], bool],
) -> _Against:
    """The states of vehicles that head and move against all lanes at their place."""
    lanes = [x for x in recording.lanelets.values() if is_lane(x) and not x.types & _RESERVED]
    rows, columns = _unmatched(tracks, matched)
    near: dict[int, list[Lanelet]] = {}
    if len(rows) and lanes:
        points = shapely.points(tracks.x[rows, columns], tracks.y[rows, columns])
        tree = shapely.STRtree([lanelet_area(lanelet) for lanelet in lanes])
        states, numbers = tree.query(points, predicate="dwithin", distance=_GAP_M)
        headings = tracks.heading[rows, columns]
        motions = np.arctan2(tracks.vy[rows, columns], tracks.vx[rows, columns])
        against = np.zeros(len(states), dtype=bool)
        order = numbers.argsort(kind="stable")
        begins = np.unique(numbers[order], return_index=True)[1]
        for own in np.split(order, begins[1:]) if len(order) else ():
            at = states[own]
            lanelet = lanes[int(numbers[own[0]])]
            against[own] = _leads_against(lanelet, points[at], headings[at], motions[at])
        for state, number in zip(states[against].tolist(), numbers[against].tolist(), strict=True):
            near.setdefault(state, []).append(lanes[number])
    one_way = _surely(recording, [lanelet for own in near.values() for lanelet in own], is_one_way)
    one_way -= _drawn_the_other_way(recording, rows, near, matched)
    lanelets = {
        state: frozenset(lanelet.id for lanelet in own if lanelet.id in one_way)
        for state, own in sorted(near.items())
    }
    kept = [state for state, own in lanelets.items() if own]
    return _Against(rows[kept], columns[kept], [lanelets[state] for state in kept])


def _unmatched(tracks: Tracks, matched: NDArray[intp]) -> tuple[NDArray[intp], NDArray[intp]]:
    """The states of vehicles that drive where no lane leads their way."""
    drives = np.array(
        ["vehicle" in body.object_types and not body.standing for body in tracks.participants],
        dtype=bool,
    )
    speed = np.hypot(tracks.vx, tracks.vy)
    with np.errstate(invalid="ignore"):
        flags = tracks.present & (matched < 0) & drives[:, None] & (speed >= _SLOWEST_MPS)
    rows, columns = flags.nonzero()
    return rows, columns


def _leads_against(
    lanelet: Lanelet, places: NDArray[np.object_], headings: Floats, motions: Floats
) -> Flags:
    directions = directions_beside(lanelet, places)
    against: Flags = np.abs(turn(directions, headings)) > _AGAINST_RAD
    against &= np.abs(turn(directions, motions)) > _AGAINST_RAD
    return against


def _surely(
    recording: Recording, lanelets: Sequence[Lanelet], is_one_way: Callable[[Lanelet], bool]
) -> set[str]:
    different = {lanelet.id for lanelet in lanelets}
    return {name for name in different if is_one_way(recording.lanelets[name])}


def _drawn_the_other_way(
    recording: Recording,
    rows: NDArray[intp],
    near: dict[int, list[Lanelet]],
    matched: NDArray[intp],
) -> set[str]:
    """The lanelets that several drove against, at least half as many as drove along them."""
    pairs = {(int(rows[state]), x.id) for state, own in near.items() for x in own}
    against = Counter(name for _, name in pairs)
    numbers = {name: number for number, name in enumerate(recording.lanelets)}
    wrong = set()
    for name, count in against.items():
        if count > 1:
            along = np.count_nonzero((matched == numbers[name]).any(axis=1))
            if 2 * count >= along:
                wrong.add(name)
    return wrong


def _runs(recording: Recording, found: _Against) -> Iterator[tuple[int, NDArray[intp], list[str]]]:
    """Runs of consecutive states that pass lanelets end to end in reverse.

    Yields the row of each run, its columns, and the lanelet of each state.
    """
    known = recording.lanelets
    begins: list[bool] = []
    chosen: list[str] = []
    for k, lanelets in enumerate(found.lanelets):
        goes_on = k > 0 and found.rows[k] == found.rows[k - 1]
        goes_on = goes_on and found.columns[k] == found.columns[k - 1] + 1
        before = chosen[-1] if goes_on else None
        onward = [x for x in sorted(lanelets) if before and before in known[x].successors]
        if before in lanelets:
            chosen.append(before)
            begins.append(False)
        else:
            chosen.append((onward or sorted(lanelets))[0])
            begins.append(not onward)
    numbers = np.cumsum(begins).tolist()
    for _, members in groupby(range(len(numbers)), key=numbers.__getitem__):
        first, *_ = own = list(members)
        part = slice(first, first + len(own))
        yield int(found.rows[first]), found.columns[part], chosen[part]


def _stretch(columns: NDArray[intp], lanelets: Sequence[str]) -> RouteStretch:
    passed = [name for name, _ in groupby(lanelets)]
    place = np.cumsum([0, *(a != b for a, b in pairwise(lanelets))])
    return RouteStretch(
        tuple(columns.tolist()),
        tuple(passed[::-1]),
        tuple((len(passed) - 1 - place).tolist()),
        against=True,
    )
