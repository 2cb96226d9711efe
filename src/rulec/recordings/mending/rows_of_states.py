"""States of tracks as rows of numbers, and operations that turn, move and repair them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from operator import is_

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.recording import Participant, Points, Recording, TrackState
from rulec.recordings.track import TrackOutlines, TrackStates, outlines_on_track


def steps_of(body: Participant) -> NDArray[int64]:
    """The steps of a participant's states, ascending."""
    if isinstance(body.states, TrackStates):
        return body.states.track.steps
    return np.sort(np.fromiter(body.states, dtype=int64, count=len(body.states)))


def rows_of(body: Participant) -> NDArray[float64]:
    """These states as rows of a track."""
    if isinstance(body.states, TrackStates):
        return body.states.track.rows
    states = [body.states[step] for step in steps_of(body).tolist()]
    return np.array([(x.x, x.y, x.heading, x.speed, x.acceleration) for x in states])


def with_mended(recording: Recording, mend: Callable[[Participant], Participant]) -> Recording:
    """A recording with each participant repaired; the same object if nothing changes."""
    bodies = tuple([mend(body) for body in recording.participants])
    if all(map(is_, bodies, recording.participants)):
        return recording
    return replace(recording, participants=bodies)


def with_states_at(body: Participant, steps: NDArray[int64]) -> Participant:
    """A participant with only those of its states that are at some steps, ascending."""
    return with_rows(body, steps, rows_of(body)[steps_of(body).searchsorted(steps)])


def with_rows(body: Participant, steps: NDArray[int64], rows: NDArray[float64]) -> Participant:
    """A participant with these rows at ascending steps, with the outlines moved along.

    At a step at which it has no state yet, its outline is that of the step before.
    """
    if (outlines := outlines_on_track(body)) is not None:
        track = replace(outlines.track, steps=steps, rows=rows)
        return replace(body, states=TrackStates(track), outlines=TrackOutlines(track))
    states = {
        step: TrackState(*row) for step, row in zip(steps.tolist(), rows.tolist(), strict=True)
    }
    moved: dict[int, Points] = {}
    known = int(steps[0]) if len(steps) else 0
    for step, state in states.items():
        known = step if step in body.states else known
        before, outline = body.states[known], body.outlines[known]
        moved[step] = outline if state == before else _moved_outline(outline, before, state)
    return replace(body, states=states, outlines=moved)


def _moved_outline(outline: Points, before: TrackState, now: TrackState) -> Points:
    """An outline moved along with its body."""
    turned = now.heading - before.heading
    cos, sin = np.cos(turned), np.sin(turned)
    x, y = (outline - (before.x, before.y)).T
    return np.stack((x * cos - y * sin + now.x, x * sin + y * cos + now.y), axis=1)
