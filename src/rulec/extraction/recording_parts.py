"""Parts of a long recording: successive drives, with the participants present meanwhile.

Arrays of participants by time steps grow with the square of a recording's length. A part has the
whole tracks of all participants that are present while one of its egos is, or so shortly before or
after that they might still matter to ego. It also keeps what is known of the whole recording.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from itertools import islice
from math import comb, sqrt

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Participant, Recording, StatedError, WholeRecording
from rulec.recordings.track import TrackOutlines, TrackStates
from rulec.value_display import short_repr

MOST_CELLS = 3 << 17
"""About the most cells (participants × steps) of a part, unless one drive takes nearly as many."""

MOST_TIMES_ALONE = 2
"""In that case, up to this many times the cells of one of its drives alone. In a crowd nearly all
participants are present for each other's drives; small parts would process the same ones again."""

_ORDERS = ((0.2, 3), (0.5, 5))
"""Pairs (s, order): up to this step, differences of this order hardly show motion.

Within 0.2 s vehicles do not change their acceleration; over half a second they change it smoothly.
"""

_TRACKS, _STATES, ENOUGH_DIFFERENCES = 32, 128, 20
"""To estimate noise: most tracks, most states of each, and fewest differences."""

MOVES_M = 0.3
"""A participant that moved farther (m) over the differences' steps is not held in place."""

OF_MEDIAN = 1.4826
"""The standard deviation of normal errors, divided by the median of their absolute values."""

_DRIVERS = frozenset({"vehicle", "light_rider"})


@dataclass(frozen=True, slots=True)
class RecordingPart:
    """Some ``egos``, and the ``recording`` reduced to participants present while they are."""

    __repr__ = short_repr

    egos: tuple[str, ...]
    recording: Recording


def egos_of(recording: Recording) -> tuple[str, ...]:
    """The participants that move and steer, in the order of the file."""
    return tuple(
        body.id
        for body in recording.participants
        if body.outlines and not body.standing and _DRIVERS.intersection(body.object_types)
    )


def recording_parts(
    recording: Recording, egos: Sequence[str], thresholds: Thresholds
) -> tuple[RecordingPart, ...]:
    """A recording in parts of about ``MOST_CELLS``, in the order of ``egos``; often just one."""
    bodies = [body for body in recording.participants if body.outlines]
    first, last = _first_and_last(recording)
    if len(bodies) * (last - first + 1) <= MOST_CELLS:
        return (RecordingPart(tuple(egos), recording),)
    whole = whole_recording(recording)
    always = whole.first, whole.last
    spans = np.array([always if body.standing else span_of(body) for body in bodies], dtype=intp)
    farthest = _farthest_steps(thresholds, recording.step_s)
    attendance = _Attendance(spans[:, 0], spans[:, 1], farthest)
    rows = {body.id: row for row, body in enumerate(bodies)}
    parts: list[RecordingPart] = []
    waiting: list[str] = []
    low, high = always[::-1]
    limit = MOST_CELLS

    def close() -> None:
        there = attendance.rows_during(low, high).tolist()
        around = replace(recording, participants=tuple(bodies[k] for k in there), whole=whole)
        parts.append(RecordingPart(tuple(waiting), around))

    for ego in egos:
        begins, ends = spans[rows[ego]].tolist()
        wider = min(low, begins), max(high, ends)
        own_limit = MOST_TIMES_ALONE * attendance.cells_during(begins, ends)
        if waiting and attendance.cells_during(*wider) > max(limit, own_limit):
            close()
            waiting.clear()
            wider, limit = (begins, ends), MOST_CELLS
        low, high = wider
        limit = max(limit, own_limit)
        waiting.append(ego)
    if waiting:
        close()
    return tuple(parts)


def _farthest_steps(thresholds: Thresholds, step_s: float) -> int:
    """How many steps from a drive participants may matter: the sum of all waiting times."""
    names = [field.name for field in fields(thresholds) if field.name.endswith("_s")]
    return int(sum(getattr(thresholds, name) for name in names) / step_s) + 1


class _Attendance:
    """The participants present during some steps, and the size of the arrays of their tracks."""

    def __init__(self, first: NDArray[intp], last: NDArray[intp], farthest: int) -> None:
        self._first, self._last, self._farthest = first, last, farthest
        self._firsts, self._lasts = np.sort(first), np.sort(last)
        # First step of any track that lasts until a step or longer, and last step of any that has
        # begun
        by_last, by_first = last.argsort(), first.argsort()
        self._earliest = np.minimum.accumulate(first[by_last][::-1])[::-1]
        self._latest = np.maximum.accumulate(last[by_first])

    def rows_during(self, low: int, high: int) -> NDArray[intp]:
        """The rows of all participants present during some steps, or shortly before or after."""
        low, high = low - self._farthest, high + self._farthest
        return ((self._first <= high) & (self._last >= low)).nonzero()[0]

    def cells_during(self, low: int, high: int) -> int:
        """How many cells (participants × steps) the tracks take."""
        low, high = low - self._farthest, high + self._farthest
        gone, come = self._lasts.searchsorted(low), self._firsts.searchsorted(high, "right")
        steps = self._latest[come - 1] - self._earliest[gone] + 1
        return int((come - gone) * steps)


def whole_recording(recording: Recording) -> WholeRecording:
    """Facts about a whole recording; for a part, about the recording that it is from."""
    if recording.whole is not None:
        return recording.whole
    spans = [span_of(body) for body in _moving(recording)]
    first = min((begins for begins, _ in spans), default=0)
    stated = [body.stated_error for body in recording.participants if body.stated_error]
    noise_m, noise_rad = _noise(recording)
    return WholeRecording(
        first=first,
        last=max((ends for _, ends in spans), default=0),
        stated_error=_in_the_middle(stated) if stated else None,
        noise_m=noise_m,
        noise_rad=noise_rad,
        arrivals=any(
            begins > first
            for body, (begins, _) in zip(_moving(recording), spans, strict=True)
            if "vehicle" in body.object_types
        ),
        shows=frozenset().union(*(body.shows for body in recording.participants)),
        ids=recording.ids,
    )


def _noise(recording: Recording) -> tuple[float, float]:
    """The standard deviations of places (m) along or across their ways, and of headings (rad).

    Estimated from differences of an order at which motion hardly shows. For normal errors their
    standard deviation is that of the errors times the root of the sum of squared binomials, which
    is itself a binomial. Takes the median over some vehicles while they move, so that a few abrupt
    motions do not count. 0 where states are so far apart that all differences show motion, or
    differences are too few. Independent of the axes of the file.
    """
    order = order_of_differences(recording.step_s)
    if order is None:
        return 0.0, 0.0
    bodies = [body for body in _moving(recording) if "vehicle" in body.object_types]
    sizes = [_differences(body, order) for body in bodies[:: len(bodies) // _TRACKS + 1]]
    every = np.concatenate([np.empty((0, 3)), *sizes])
    if len(every) < ENOUGH_DIFFERENCES:
        return 0.0, 0.0
    along, across, turned = (
        float(np.median(own)) * OF_MEDIAN / sqrt(comb(2 * order, order)) for own in every.T
    )
    return max(along, across), turned


def order_of_differences(step_s: float) -> int | None:
    """The order of differences that hardly show motion; None where states are too far apart."""
    return next((order for longest_s, order in _ORDERS if step_s <= longest_s + 1e-9), None)


def _differences(body: Participant, order: int) -> NDArray[np.float64]:
    """The absolute differences of a participant's first places along and across, and headings."""
    steps, poses = _first_poses(body)
    way = (poses[order:] - poses[:-order])[:, :2]
    length = np.hypot(*way.T)
    counts = (steps[order:] - steps[:-order] == order) & (length > MOVES_M)
    poses = poses[1:] - poses[:-1]
    poses[:, 2] = wrapped(poses[:, 2])
    for _ in range(order - 1):
        poses = poses[1:] - poses[:-1]
    (x, y, turned), (dx, dy) = poses[counts].T, way[counts].T / length[counts]
    found = np.array((x * dx + y * dy, y * dx - x * dy, turned))
    sizes: NDArray[np.float64] = np.abs(found.T)
    return sizes


def _first_poses(body: Participant) -> tuple[NDArray[intp], NDArray[np.float64]]:
    """A participant's first steps, and its place (m) and heading (rad) in each, a row per step."""
    if isinstance(body.states, TrackStates):
        track = body.states.track
        return track.steps[:_STATES], track.rows[:_STATES, :3]
    steps = [*islice(body.states, _STATES)]
    states = (body.states[step] for step in steps)
    poses = np.array([(state.x, state.y, state.heading) for state in states]).reshape(-1, 3)
    return np.array(steps, dtype=intp), poses


def _in_the_middle(stated: Iterable[StatedError]) -> StatedError:
    return StatedError(*np.median(list(stated), axis=0).tolist())


def _first_and_last(recording: Recording) -> tuple[int, int]:
    """The first and last time step of a recording; for a part, of the recording that it is from."""
    whole = recording.whole
    return _span_of_all(recording) if whole is None else (whole.first, whole.last)


def _span_of_all(recording: Recording) -> tuple[int, int]:
    spans = [span_of(body) for body in _moving(recording)]
    first = min((begins for begins, _ in spans), default=0)
    return first, max((ends for _, ends in spans), default=0)


def looked_at(recording: Recording) -> tuple[int, int]:
    """The first and last time step of a recording's arrays.

    Those of a part have one more step on each side, if the recording has: a participant present in
    the last step of a part may go on, unlike in the last step of a recording.
    """
    first, last = _span_of_all(recording)
    if recording.whole is None:
        return first, last
    return max(recording.whole.first, first - 1), min(recording.whole.last, last + 1)


def span_of(body: Participant) -> tuple[int, int]:
    """The first and last time step of a participant that has some place."""
    if isinstance(body.outlines, TrackOutlines):
        steps = body.outlines.track.steps
        return int(steps[0]), int(steps[-1])
    return min(body.outlines), max(body.outlines)


def _moving(recording: Recording) -> Iterable[Participant]:
    """The participants that have some place and are not static."""
    return (body for body in recording.participants if body.outlines and not body.standing)
