"""The tracks of all participants as arrays: places, headings, velocities.

Rows are participants, in the order of the file; columns are time steps, from ``first`` on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy import bool_, float64
from numpy.typing import NDArray

from rulec.extraction.traffic_thresholds import Thresholds
from rulec.scenario.recorded.obstacle_types import OBSTACLE_TYPES
from rulec.scenario.recorded.recording import Participant, Points, Recording

Floats: TypeAlias = NDArray[float64]
Flags: TypeAlias = NDArray[bool_]

_ARRAYS = ("present", "x", "y", "heading", "vx", "vy", "speed", "acceleration")


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Tracks:
    """Arrays of participants by steps, NaN where one is not present.

    ``x`` and ``y`` are centres (m), ``heading`` is in rad. Velocities (m/s) and accelerations
    (m/s²) are differences of places, since what files say of speeds may not agree with them.
    """

    participants: tuple[Participant, ...]
    first: int
    present: Flags
    x: Floats
    y: Floats
    heading: Floats
    vx: Floats
    vy: Floats
    speed: Floats
    acceleration: Floats

    def outlines(self) -> Iterator[tuple[int, int, Points]]:
        """Row, column and outline of all participants.

        Participants that stand for good have one outline.
        """
        for row, body in enumerate(self.participants):
            if body.standing:
                yield row, 0, next(iter(body.outlines.values()))
                continue
            for column in np.flatnonzero(self.present[row]).tolist():
                yield row, column, body.outlines[self.first + column]

    def part(self, rows: NDArray[np.intp], columns: slice) -> Tracks:
        """The tracks of some participants in a range of steps."""
        return replace(
            self,
            participants=tuple(self.participants[row] for row in rows),
            first=self.first + columns.start,
            **{name: getattr(self, name)[rows][:, columns] for name in _ARRAYS},
        )

    def of_type(self, name: str) -> Flags:
        """Flags of participants of an object type or its subtypes."""
        types = [OBSTACLE_TYPES.get(x.type, OBSTACLE_TYPES["unknown"]) for x in self.participants]
        return np.array([name in own for own in types], dtype=bool)


def tracks_of(recording: Recording, thresholds: Thresholds) -> Tracks:
    """The tracks of the participants of a recording that occupy something.

    Velocities are central differences over ``smoothing_s``, one-sided where a track begins or ends.
    """
    bodies = tuple(body for body in recording.participants if body.outlines)
    steps = [step for body in bodies if not body.standing for step in body.outlines]
    first, last = min(steps, default=0), max(steps, default=0)
    shape = len(bodies), last - first + 1
    x, y, heading, stated = (np.full(shape, np.nan) for _ in range(4))
    for row, body in enumerate(bodies):
        poses = _poses(body)
        if body.standing:
            x[row], y[row], heading[row], stated[row] = next(iter(poses.values()))
            continue
        at = np.fromiter(poses, dtype=int, count=len(poses)) - first
        x[row, at], y[row, at], heading[row, at], stated[row, at] = np.array([*poses.values()]).T
    present = ~np.isnan(x)
    reach = max(1, round(thresholds.smoothing_s / 2 / recording.step_s))
    duration, before, after = _windows(present, reach)
    rows = np.arange(shape[0])[:, None]
    seconds = np.where(duration > 0, duration, np.nan) * recording.step_s
    vx = (x[rows, after] - x[rows, before]) / seconds
    vy = (y[rows, after] - y[rows, before]) / seconds
    # A single moment has no displacement: there the stated speed counts
    single = present & (duration == 0)
    vx = np.where(single, stated * np.cos(heading), vx)
    vy = np.where(single, stated * np.sin(heading), vy)
    speed = np.hypot(vx, vy)
    gained = (speed[rows, after] - speed[rows, before]) / seconds
    return Tracks(
        participants=bodies,
        first=first,
        present=present,
        x=x,
        y=y,
        heading=heading,
        vx=vx,
        vy=vy,
        speed=speed,
        acceleration=np.where(present, np.nan_to_num(gained), np.nan),
    )


def _poses(body: Participant) -> dict[int, tuple[float, float, float, float]]:
    """Centre, heading and stated speed by step."""
    poses = {}
    for step, outline in body.outlines.items():
        state = body.states.get(step)
        if state is None:
            x, y = outline.mean(axis=0).tolist()
            poses[step] = x, y, 0.0, 0.0
        else:
            poses[step] = state.x, state.y, state.heading, state.speed
    return poses


def _windows(present: Flags, reach: int) -> tuple[NDArray[np.intp], ...]:
    """The lengths, firsts and lasts of unbroken windows around moments.

    Lengths are in steps.
    """
    columns = np.arange(present.shape[1])
    absent = np.where(present, -1, columns)
    since = np.maximum.accumulate(absent, axis=1) + 1
    absent = np.where(present, len(columns), columns)
    until = np.minimum.accumulate(absent[:, ::-1], axis=1)[:, ::-1] - 1
    before = np.where(present, np.maximum(columns - reach, since), columns)
    after = np.where(present, np.minimum(columns + reach, until), columns)
    return after - before, before, after
