"""Stated speeds that no vehicle has, as a simulator gives to who has just been put on a road."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.recording import Participant, Recording
from rulec.recordings.track import Track, TrackStates

_MOST_MPS = 150.0
"""No vehicle on a road is as fast as 540 km/h."""

_BORNE_OUT = 0.5
"""Places that make such a part of a stated speed bear it out."""

_MOST_PART = 0.5
"""Where more of a track's speeds are impossible, not some of them are wrong, but their unit."""


def without_impossible_speeds(recording: Recording) -> Recording:
    """The recording with the speeds of places where stated ones are impossible, and a remark.

    Nothing else is known of who is there at one moment: it is left as it is.
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
        f"{some} {fastest * 3.6:,.0f} km/h, where places say otherwise: "
        "there it is the speeds of places that count"
    )
    return replace(recording, participants=tuple(bodies), remarks=(*recording.remarks, remark))


def _impossible(track: Track, step_s: float) -> NDArray[np.intp]:
    """The rows whose stated speed no vehicle has, and their places do not show."""
    stated = np.abs(track.rows[:, 3])
    rows = np.flatnonzero(stated > _MOST_MPS)
    # Most often there is none
    if not 0 < len(rows) <= _MOST_PART * len(stated):
        return rows[:0]
    moved = np.abs(_by_places(track, step_s))
    return rows[moved[rows] < _BORNE_OUT * stated[rows]]


def _by_places(track: Track, step_s: float) -> NDArray[float64]:
    """Speeds along headings (m/s) by the places before and after."""
    x, y, heading = track.rows[:, :3].T
    times = track.steps * step_s
    speeds: NDArray[float64] = np.gradient(x, times) * np.cos(heading)
    speeds += np.gradient(y, times) * np.sin(heading)
    return speeds


def _mended(track: Track, impossible: NDArray[np.intp], step_s: float) -> Track:
    mended = track.rows.copy()
    mended[impossible, 3] = _by_places(track, step_s)[impossible]
    mended[impossible, 4] = np.gradient(mended[:, 3], track.steps * step_s)[impossible]
    return replace(track, rows=mended)
