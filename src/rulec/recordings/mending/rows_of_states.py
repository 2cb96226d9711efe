"""States of tracks as rows of numbers, and what turns and moves them."""

from __future__ import annotations

import numpy as np
from numpy import int64
from numpy.typing import NDArray

from rulec.recordings.recording import Participant, Points, TrackState
from rulec.recordings.track import TrackStates


def steps_of(body: Participant) -> NDArray[int64]:
    """The steps of a participant's states, ascending."""
    if isinstance(body.states, TrackStates):
        return body.states.track.steps
    return np.sort(np.fromiter(body.states, dtype=int64, count=len(body.states)))


def row_of(state: TrackState) -> tuple[float, ...]:
    """A state as a row of a track."""
    return state.x, state.y, state.heading, state.speed, state.acceleration


def moved_outline(outline: Points, before: TrackState, now: TrackState) -> Points:
    """An outline as it is when its body has moved on."""
    turned = now.heading - before.heading
    cos, sin = np.cos(turned), np.sin(turned)
    x, y = (outline - (before.x, before.y)).T
    return np.stack((x * cos - y * sin + now.x, x * sin + y * cos + now.y), axis=1)
