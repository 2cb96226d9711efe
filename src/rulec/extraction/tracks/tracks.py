"""Everyone in a recording as arrays: who is where when, how fast, and headed where.

Rows are participants, in the order of the file; columns are time steps, from ``first`` on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy import bool_, float64
from numpy.typing import NDArray

from rulec.extraction.selection.traffic_thresholds import Thresholds
from rulec.scenario.recorded.obstacle_types import OBSTACLE_TYPES
from rulec.scenario.recorded.recording import Participant, Points, Recording

Floats: TypeAlias = NDArray[float64]
Flags: TypeAlias = NDArray[bool_]


@dataclass(frozen=True, eq=False, slots=True)
class Tracks:
    """NaN where somebody is not there. Velocities (m/s) and accelerations are from displacement."""

    participants: tuple[Participant, ...]
    first: int
    there: Flags
    x: Floats
    y: Floats
    heading: Floats
    vx: Floats
    vy: Floats
    speed: Floats
    acceleration: Floats

    @property
    def steps(self) -> int:
        """How many time steps there are."""
        return int(self.there.shape[1])

    def outlines(self) -> Iterator[tuple[int, int, Points]]:
        """Row, column and outline of everybody at every time; of who stands for good, once."""
        for row, one in enumerate(self.participants):
            if one.standing:
                yield row, 0, next(iter(one.outlines.values()))
                continue
            for column in np.flatnonzero(self.there[row]).tolist():
                yield row, column, one.outlines[self.first + column]

    def part(self, rows: NDArray[np.intp], columns: slice) -> Tracks:
        """Some of them, for some time."""
        names = ("there", "x", "y", "heading", "vx", "vy", "speed", "acceleration")
        return replace(
            self,
            participants=tuple(self.participants[row] for row in rows),
            first=self.first + columns.start,
            **{name: getattr(self, name)[rows][:, columns] for name in names},
        )

    def of_kind(self, word: str) -> Flags:
        """Whose type is this one, or one of its subtypes?"""
        kinds = [
            OBSTACLE_TYPES.get(one.type, OBSTACLE_TYPES["unknown"]) for one in self.participants
        ]
        return np.array([word in words for words in kinds], dtype=bool)


def tracks_of(recording: Recording, thresholds: Thresholds) -> Tracks:
    """The participants of a recording that occupy something, with what follows from positions."""
    people = tuple(one for one in recording.participants if one.outlines)
    steps = [step for one in people if not one.standing for step in one.outlines]
    first, last = min(steps, default=0), max(steps, default=0)
    shape = len(people), last - first + 1
    x, y, heading = (np.full(shape, np.nan) for _ in range(3))
    said = np.full(shape, np.nan)
    for row, one in enumerate(people):
        places = _places(one)
        if one.standing:
            x[row], y[row], heading[row], said[row] = next(iter(places.values()))
            continue
        at = np.fromiter(places, dtype=int, count=len(places)) - first
        x[row, at], y[row, at], heading[row, at], said[row, at] = np.array([*places.values()]).T
    there = ~np.isnan(x)
    reach = max(1, round(thresholds.smoothing_s / 2 / recording.step_s))
    duration, before, after = _around(there, reach)
    lines = np.arange(shape[0])[:, None]
    seconds = np.where(duration > 0, duration, np.nan) * recording.step_s
    vx = (x[lines, after] - x[lines, before]) / seconds
    vy = (y[lines, after] - y[lines, before]) / seconds
    once = there & (duration == 0)
    vx, vy = np.where(once, said * np.cos(heading), vx), np.where(once, said * np.sin(heading), vy)
    speed = np.hypot(vx, vy)
    gained = (speed[lines, after] - speed[lines, before]) / seconds
    acceleration = np.where(there, np.nan_to_num(gained), np.nan)
    return Tracks(people, first, there, x, y, heading, vx, vy, speed, acceleration)


def _places(one: Participant) -> dict[int, tuple[float, float, float, float]]:
    """Step -> centre, heading and the speed that is written down."""
    found = {}
    for step, outline in one.outlines.items():
        state = one.states.get(step)
        if state is None:
            x, y = outline.mean(axis=0).tolist()
            found[step] = x, y, 0.0, 0.0
        else:
            found[step] = state.x, state.y, state.heading, state.speed
    return found


def _around(there: Flags, reach: int) -> tuple[NDArray[np.intp], ...]:
    """How many steps lie between two moments around each, without a break, and these moments."""
    columns = np.arange(there.shape[1])
    gone = np.where(there, -1, columns)
    since = np.maximum.accumulate(gone, axis=1) + 1
    gone = np.where(there, len(columns), columns)
    until = np.minimum.accumulate(gone[:, ::-1], axis=1)[:, ::-1] - 1
    before = np.where(there, np.maximum(columns - reach, since), columns)
    after = np.where(there, np.minimum(columns + reach, until), columns)
    return after - before, before, after
