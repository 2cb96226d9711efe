"""Boxes annotated sweep by sweep, combined into participants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy import bool_, float64, int64, intp
from numpy.typing import NDArray

from rulec.recordings.argoverse.city_frame import CityPoses
from rulec.recordings.argoverse.object_types import RIDES
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable
from rulec.recordings.mending.derived_motion import accelerations_of, along, velocities_of
from rulec.recordings.recording import Participant
from rulec.recordings.track import Track, tracked

NANOSECONDS = 1_000_000_000
"""Nanoseconds per second."""

UNITS_PER_SECOND = 100
"""Time steps are rounded to 0.01 s: sweeps are 0.1 s apart to within a millisecond."""

_LARGEST_M = 200.0
_RIDDEN_M = 1.0
"""A rider belongs to a vehicle if the middles of their boxes are at most this far apart (m)."""

_UNEVEN_S = 0.01
"""Tolerance (s): sweeps are 0.1 s apart to within a millisecond."""

_UNSEEN_S, _STAYED_M = 1.0, 0.5
"""A box between two sweeps with lidar points counts as measured within these limits.

The sweeps are at most this time apart (s), or the box moves by at most this far (m) between them.
Speeds, too, are means over a second.
"""


@dataclass(frozen=True, eq=False, slots=True)
class TrackBoxes:
    """The boxes of a track: each box's sweep, its pose in the city, and the size (m)."""

    id: str
    category: str
    sweeps: NDArray[intp]
    poses: CityPoses
    size: tuple[float, float]

    def kept(self, flags: NDArray[bool_]) -> TrackBoxes:
        """The track, reduced to the boxes whose flag is set."""
        rows = np.flatnonzero(flags)
        return replace(self, sweeps=self.sweeps[rows], poses=self.poses.taken(rows))

    def measured(self, points: NDArray[int64], seconds: NDArray[float64]) -> TrackBoxes:
        """The track without guessed boxes: those of a moving object that contain no lidar point."""
        seen = np.flatnonzero(points > 0)
        if len(seen) in (0, len(points)):
            return self if len(seen) else self.kept(points > 0)
        moments, places = seconds[self.sweeps], self.poses.translations[:, :2]
        after = np.searchsorted(seen, np.arange(len(points)))
        before = np.searchsorted(seen, np.arange(len(points)), side="right") - 1
        previous, following = (seen[np.clip(at, 0, len(seen) - 1)] for at in (before, after))
        between = (before >= 0) & (after < len(seen))
        short = between & (moments[following] - moments[previous] <= _UNSEEN_S + _UNEVEN_S)
        stayed = np.all(
            [np.hypot(*(places - places[at]).T) <= _STAYED_M for at in (previous, following)],
            axis=0,
        )
        return self.kept((points > 0) | short | stayed)


def check_sizes(table: ArrowTable, rows: NDArray[int64], sizes: NDArray[float64]) -> None:
    """Raise RulecError for a box of impossible size in the given rows of a table."""
    odd = ((sizes <= 0) | (sizes > _LARGEST_M)).any(axis=1)
    if odd.any():
        at = int(np.argmax(odd))
        length, width = sizes[at]
        raise table.refused(int(rows[at]), f"a box is {length:g} m by {width:g} m")


def with_riders(boxes: Sequence[TrackBoxes]) -> list[TrackBoxes]:
    """The boxes, with rider and ridden vehicle merged into one box that covers both."""
    ridden = {x.id: np.zeros(len(x.sweeps), dtype=bool) for x in boxes}
    sizes = {x.id: x.size for x in boxes}
    for rider in boxes:
        for device in boxes:
            if device.category != RIDES.get(rider.category):
                continue
            _, on, under = np.intersect1d(rider.sweeps, device.sweeps, return_indices=True)
            apart = rider.poses.translations[on, :2] - device.poses.translations[under, :2]
            near = np.hypot(*apart.T) <= _RIDDEN_M
            if near.any():
                ridden[device.id][under[near]] = True
                own, other = sizes[rider.id], device.size
                sizes[rider.id] = max(own[0], other[0]), max(own[1], other[1])
    return [replace(x, size=sizes[x.id]).kept(~ridden[x.id]) for x in boxes]


def participant(
    box: TrackBoxes, kind: str, seconds: NDArray[float64], steps: NDArray[int64]
) -> Participant:
    """The participant of a type; ``seconds`` and ``steps`` are those of all sweeps."""
    places, heading = box.poses.translations[:, :2], box.poses.headings
    moments = seconds[box.sweeps]
    speed = along(velocities_of(places, moments), heading)
    rows = np.column_stack((places, heading, speed, accelerations_of(speed, moments)))
    return tracked(box.id, kind, Track(steps[box.sweeps], rows, *box.size))
