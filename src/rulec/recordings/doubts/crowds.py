"""How many participants are near each other: each is looked at beside each, state by state."""

from __future__ import annotations

import numpy as np

from rulec.diagnostics import SourceLocation
from rulec.recordings.recording import Recording
from rulec.resource_limits import CROWD

_SQUARE_M = 100.0

_FEW_PAIRS = 10_000_000
"""Up to so many pairs of participants, added up over the time steps, take seconds."""

_SOME_STEPS = 16


def refuse_crowd(recording: Recording, file: str) -> None:
    """Refuse more participants at one place than can be there. Raises RulecError R0718."""
    moving = [body for body in recording.participants if body.states and not body.standing]
    there = sum(len(body.states) for body in moving)
    stand = [body for body in recording.participants if body.standing and body.states]
    standing = [next(iter(body.states.values())) for body in stand]
    if (len(moving) + len(standing)) * there <= _FEW_PAIRS:
        return
    busiest = max(moving, key=lambda body: len(body.states)).states
    steps = list(busiest)[:: len(busiest) // _SOME_STEPS + 1]
    others = drivers = 0
    for step in steps:
        states = [body.states[step] for body in moving if step in body.states]
        places = np.array([(state.x, state.y) for state in (*states, *standing)])
        _, square, counts = np.unique(
            np.floor(places / _SQUARE_M), axis=0, return_inverse=True, return_counts=True
        )
        others += int((counts - 1)[square.ravel()][: len(states)].sum())
        drivers += len(states)
    on_average = others // drivers
    if on_average * there > _FEW_PAIRS:
        CROWD.within(on_average, SourceLocation(file))
