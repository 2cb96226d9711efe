"""Boxes that are annotated sweep by sweep, as the participants that they are around."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy import bool_, float64, int64, intp
from numpy.typing import NDArray

from rulec.recordings.argoverse.city_frame import CityPoses
from rulec.recordings.argoverse.sweep_grid import rates
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable
from rulec.recordings.recording import Participant
from rulec.recordings.track import Track, tracked

_LARGEST_M = 200.0
_RIDDEN_M = 1.0
"""A rider's box is on what it rides if their middles are no farther apart."""

_UNEVEN_S = 0.01
"""Sweeps are a tenth of a second apart to within a millisecond."""

_UNSEEN_S, _STAYED_M = 1.0, 0.5
"""Between two sweeps with points a box is where it is drawn, if they are no farther apart in time,
or the box does not move from one to the other. Speeds are means over a second, too."""


@dataclass(frozen=True, eq=False, slots=True)
class TrackBoxes:
    """The boxes of a track: the sweep of each, their poses in the city, and its size (m)."""

    id: str
    category: str
    sweeps: NDArray[intp]
    poses: CityPoses
    size: tuple[float, float]

    def kept(self, flags: NDArray[bool_]) -> TrackBoxes:
        """Its boxes in some sweeps only."""
        rows = np.flatnonzero(flags)
        return replace(self, sweeps=self.sweeps[rows], poses=self.poses.taken(rows))

    def measured(self, points: NDArray[int64], seconds: NDArray[float64]) -> TrackBoxes:
        """Without the boxes that were only guessed: no point is in them, and they move.

        ``points`` are how many are in each of its boxes, ``seconds`` the moments of all sweeps.
        """
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
    """Refuse a box, of those in some rows of a table, that nobody is in."""
    odd = ((sizes <= 0) | (sizes > _LARGEST_M)).any(axis=1)
    if odd.any():
        at = int(np.argmax(odd))
        length, width = sizes[at]
        raise table.refused(int(rows[at]), f"a box is {length:g} m by {width:g} m")


def with_riders(boxes: Sequence[TrackBoxes], rides: Mapping[str, str]) -> list[TrackBoxes]:
    """Boxes of which one stands for a rider and what it rides: as large as both, where it rides.

    ``rides``: the category of riders -> that of what they ride.
    """
    ridden = {x.id: np.zeros(len(x.sweeps), dtype=bool) for x in boxes}
    sizes = {x.id: x.size for x in boxes}
    for rider in boxes:
        for device in boxes:
            if device.category != rides.get(rider.category):
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
    x, y = box.poses.translations[:, :2].T
    heading, moments = box.poses.headings, seconds[box.sweeps]
    speed = rates(x, moments) * np.cos(heading) + rates(y, moments) * np.sin(heading)
    rows = np.column_stack((x, y, heading, speed, rates(speed, moments)))
    return tracked(box.id, kind, Track(steps[box.sweeps], rows, *box.size))
