"""The track of a rigid body as an array, rows by moment.

A recording of some minutes has a hundred thousand states. Here they take 48 bytes each, and become
objects only when somebody looks at them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.recording import Lamp, Participant, Points, StatedError, TrackState

_CORNERS = np.array([[1, 1], [1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1], [0, 1]]) / 2
"""Corners and middles of the sides of a rectangle of length and width 1."""


def rectangles(
    centres: Points, headings: NDArray[float64], length: float, width: float, shift: float = 0.0
) -> NDArray[float64]:
    """Corners and side middles of a rectangle; the axes are place, point, and x and y.

    ``shift``: how far the centre lies ahead of the rectangle's middle.
    """
    body = _CORNERS * (length, width) - (shift, 0.0)
    cos, sin = np.cos(headings)[:, None], np.sin(headings)[:, None]
    turned = np.stack(
        (body[:, 0] * cos - body[:, 1] * sin, body[:, 0] * sin + body[:, 1] * cos), axis=-1
    )
    return turned + centres[:, None, :]


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """The states of a rigid body by ascending time step.

    Each of the ``rows`` has x, y, heading, speed and acceleration at one of the ``steps``. x and y
    are ``shift`` ahead of the body's middle.
    """

    steps: NDArray[int64]
    rows: NDArray[float64]
    length: float
    width: float
    shift: float = 0.0

    def row_of(self, step: int) -> int:
        """Raises KeyError if it is not there at that step."""
        row = int(np.searchsorted(self.steps, step))
        if row == len(self.steps) or self.steps[row] != step:
            raise KeyError(step)
        return row


@dataclass(frozen=True, slots=True, eq=False)
class TrackStates(Mapping[int, TrackState]):
    """The states of a track by time step, made on demand."""

    track: Track

    def __getitem__(self, step: int) -> TrackState:
        return TrackState(*self.track.rows[self.track.row_of(step)].tolist())

    def __iter__(self) -> Iterator[int]:
        return iter(self.track.steps.tolist())

    def __len__(self) -> int:
        return len(self.track.steps)


@dataclass(frozen=True, slots=True, eq=False)
class TrackOutlines(Mapping[int, Points]):
    """The rectangle on a track by time step, all computed when the first is asked for."""

    track: Track
    _laid_out: list[NDArray[float64]] = field(default_factory=list, repr=False)

    def __getitem__(self, step: int) -> Points:
        row = self.track.row_of(step)
        outline: Points = self.laid_out[row]
        return outline

    @property
    def laid_out(self) -> NDArray[float64]:
        """All of them; the axes are moment, point, and x and y."""
        if not self._laid_out:
            rows = self.track.rows
            sizes = self.track.length, self.track.width, self.track.shift
            self._laid_out.append(rectangles(rows[:, :2], rows[:, 2], *sizes))
        return self._laid_out[0]

    def __iter__(self) -> Iterator[int]:
        return iter(self.track.steps.tolist())

    def __len__(self) -> int:
        return len(self.track.steps)


def outlines_on_track(body: Participant) -> TrackOutlines | None:
    """The outlines of a participant whose states are on the same track; else None."""
    states, outlines = body.states, body.outlines
    if not isinstance(states, TrackStates) or not isinstance(outlines, TrackOutlines):
        return None
    return outlines if states.track is outlines.track else None


def tracked(
    identifier: str,
    kind: str,
    track: Track,
    *,
    standing: bool = False,
    lamps: Mapping[int, frozenset[Lamp]] | None = None,
    shows: frozenset[Lamp] = frozenset(),
    stated_error: StatedError | None = None,
    resumes: int | None = None,
    heads_as_it_moves: bool = False,
) -> Participant:
    """A participant that follows a track."""
    return Participant(
        id=identifier,
        type=kind,
        standing=standing,
        states=TrackStates(track),
        outlines=TrackOutlines(track),
        lamps=lamps or {},
        shows=shows,
        stated_error=stated_error,
        resumes=resumes,
        heads_as_it_moves=heads_as_it_moves,
    )
