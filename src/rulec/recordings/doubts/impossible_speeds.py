"""Stated speeds that no vehicle can have, such as simulators give to newly inserted vehicles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.mending.derived_motion import accelerations_of, along, velocities_of
from rulec.recordings.recording import Participant, Recording
from rulec.recordings.track import Track, TrackStates

_MOST_MPS = 150.0
"""The highest plausible speed: no vehicle on a road drives 540 km/h."""

_BORNE_OUT = 0.5
"""A stated speed is confirmed if the positions show at least this share of it."""

_MOST_PART = 0.5
"""If a larger share of a track's speeds is impossible, their unit is wrong, not single values."""


def without_impossible_speeds(recording: Recording) -> Recording:
    """The recording with impossible speeds replaced by those of positions, and a remark.

    A participant with a single state is left unchanged, since nothing else is known of it.
    """
    bodies: list[Participant] = []
    mended, fastest = 0, 0.0
    for body in recording.participants:
        track = body.states.track if isinstance(body.states, TrackStates) else None
        if track is not None and len(rows := _impossible(track, recording.step_s)):
            mended += len(rows)
            fastest = max(fastest, float(np.abs(track.rows[rows, 3]).max()))
            body = replace(body, states=TrackStates(_mended(track, rows, recording.step_s)))
        bodies.append(body)
    if not mended:
        return recording
    some = "one speed is" if mended == 1 else f"{mended:,} speeds are up to"
    remark = (
        f"{some} {fastest * KMH_PER_MPS:,.0f} km/h, where places say otherwise: "
        "there it is the speeds of places that count"
    )
    return replace(recording, participants=tuple(bodies), remarks=(*recording.remarks, remark))


def _impossible(track: Track, step_s: float) -> NDArray[np.intp]:
    """The rows whose stated speed is impossible and not confirmed by positions."""
    stated = np.abs(track.rows[:, 3])
    rows = np.flatnonzero(stated > _MOST_MPS)
    # Most often there is none
    if not 0 < len(rows) <= _MOST_PART * len(stated):
        return rows[:0]
    moved = np.abs(_by_places(track, step_s))
    return rows[moved[rows] < _BORNE_OUT * stated[rows]]


def _by_places(track: Track, step_s: float) -> NDArray[float64]:
    """Speeds along headings (m/s), from the positions before and after."""
    velocities = velocities_of(track.rows[:, :2], (track.steps * step_s).astype(float64))
    return along(velocities, track.rows[:, 2])


def _mended(track: Track, impossible: NDArray[np.intp], step_s: float) -> Track:
    mended = track.rows.copy()
    mended[impossible, 3] = _by_places(track, step_s)[impossible]
    mended[impossible, 4] = accelerations_of(mended[:, 3], (track.steps * step_s).astype(float64))[
        impossible
    ]
    return replace(track, rows=mended)
