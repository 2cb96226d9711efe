"""Tracks of boxes as participants."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Participant
from rulec.recordings.track import Track, tracked

BRIDGED_S = 0.55
"""The longest gap (s) in a track across which even motion is assumed: half a second.

At 3 m/s² the position is then wrong by at most 0.1 m.
"""

_CAR_LENGTHS_M = 3.4, 6.0
_CAR_WIDTHS_M = 1.4, 2.5


class BoxTrack(NamedTuple):
    """A track of boxes, one row each: centre and velocity (x, y), size (length, width)."""

    steps: NDArray[int64]
    centres: NDArray[float64]
    headings: NDArray[float64]
    velocities: NDArray[float64]
    sizes: NDArray[float64]

    def first(self) -> BoxTrack:
        """The track reduced to its first box."""
        rows = self.centres[:1], self.headings[:1], self.velocities[:1], self.sizes[:1]
        return BoxTrack(self.steps[:1], *rows)


def bridged(boxes: BoxTrack, step_s: float) -> BoxTrack:
    """A track with gaps up to ``BRIDGED_S`` filled: position, heading and speed change evenly."""
    steps = boxes.steps
    short = (np.diff(steps) > 1) & ((np.diff(steps) - 1) * step_s <= BRIDGED_S)
    if not short.any():
        return boxes
    starts = np.flatnonzero(short)
    more = [np.arange(steps[start] + 1, steps[start + 1]) for start in starts.tolist()]
    every = np.union1d(steps, np.concatenate(more))
    measured = np.isin(every, steps)

    def filled(values: NDArray[float64]) -> NDArray[float64]:
        columns = [np.interp(every, steps, column) for column in values.T]
        table: NDArray[float64] = np.column_stack(columns)
        # Measured values are kept exactly
        table[measured] = values
        return table

    headings = wrapped(filled(np.unwrap(boxes.headings)[:, None])[:, 0])
    headings[measured] = boxes.headings
    return BoxTrack(
        every, filled(boxes.centres), headings, filled(boxes.velocities), filled(boxes.sizes)
    )


def gaps_remark(bridged_states: int) -> tuple[str, ...]:
    """The remark of a recording on the states that were filled in."""
    if not bridged_states:
        return ()
    lost = "bodies that are lost for half a second or less are assumed to move evenly meanwhile"
    return (f"{lost}: {bridged_states:,} states",)


def participant(
    name: str, kind: str, boxes: BoxTrack, step_s: float, *, standing: bool = False
) -> Participant:
    """A participant with a rigid body, whose size is the median of its boxes' sizes.

    A ``vehicle`` of a car's size is read as a car.
    """
    length, width = np.median(boxes.sizes, axis=0).tolist()
    if (
        kind == "vehicle"
        and _is_within(length, _CAR_LENGTHS_M)
        and _is_within(width, _CAR_WIDTHS_M)
    ):
        kind = "car"
    along = np.stack((np.cos(boxes.headings), np.sin(boxes.headings)), axis=1)
    speeds = (boxes.velocities * along).sum(axis=1)
    taken_s = np.diff(boxes.steps, prepend=boxes.steps[0] - 1) * step_s
    gained = np.diff(speeds, prepend=speeds[0]) / taken_s
    rows = np.column_stack((boxes.centres, boxes.headings, speeds, gained))
    return tracked(name, kind, Track(boxes.steps, rows, length, width), standing=standing)


def _is_within(value: float, bounds: tuple[float, float]) -> bool:
    low, high = bounds
    return low <= value <= high
