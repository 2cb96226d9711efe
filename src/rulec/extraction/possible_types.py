"""Recordings in which participants of unknown type have one of the types that they may have."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.mending.rows_of_states import rows_of, steps_of
from rulec.recordings.recording import OBSTACLE_TYPES, Participant, Recording

_RIDDEN_OR_DRIVEN = ("vehicle", "bicycle")
_WALKING = "pedestrian"

_FASTEST_WALK_MPS = 7.0
"""Whoever is faster for half of its time does not go on foot."""

_WINDOW_S = 1.0


class _Path(NamedTuple):
    steps: NDArray[int64]
    places: NDArray[float64]


class PossibleTypes:
    """The participants of unknown type in a recording, and for whom it may matter what they are.

    Static obstacles are none of them.
    """

    def __init__(self, recording: Recording) -> None:
        self._recording = recording
        unknown = OBSTACLE_TYPES["unknown"]
        self._paths = {
            body.id: _path_of(body)
            for body in recording.participants
            if body.object_types == unknown and body.states and not body.standing
        }

    def recordings(self) -> Iterator[Recording]:
        """The recording once for each type that those participants may have."""
        for kind in _RIDDEN_OR_DRIVEN:
            yield self._with_types(self._paths, kind)
        walking = {name for name, path in self._paths.items() if self._may_walk(path)}
        if walking:
            yield self._with_types(walking, _WALKING)

    def near(self, egos: Iterable[str], reach_m: float) -> tuple[str, ...]:
        """Those of some egos that have a participant of unknown type near them at some time."""
        wanted = frozenset(egos)
        bodies = self._recording.participants
        return tuple(x.id for x in bodies if x.id in wanted and self.is_near(x, reach_m))

    def is_near(self, body: Participant, reach_m: float) -> bool:
        """Whether a participant of unknown type is near a body at some time."""
        if not self._paths or not body.states:
            return False
        own = _path_of(body)
        for other in self._paths.values():
            _, at, theirs = np.intersect1d(own.steps, other.steps, return_indices=True)
            apart = np.hypot(*(own.places[at] - other.places[theirs]).T)
            if (apart <= reach_m).any():
                return True
        return False

    def _may_walk(self, path: _Path) -> bool:
        every = max(1, round(_WINDOW_S / self._recording.step_s))
        ways = np.diff(path.places[::every], axis=0)
        if not len(ways):
            return True
        times = np.diff(path.steps[::every]) * self._recording.step_s
        return float(np.median(np.hypot(*ways.T) / times)) <= _FASTEST_WALK_MPS

    def _with_types(self, names: Iterable[str], kind: str) -> Recording:
        own = frozenset(names)
        bodies = self._recording.participants
        changed = [replace(body, type=kind) if body.id in own else body for body in bodies]
        return replace(self._recording, participants=tuple(changed))


def _path_of(body: Participant) -> _Path:
    return _Path(steps_of(body), rows_of(body)[:, :2])
