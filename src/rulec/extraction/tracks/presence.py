"""When others are there, as objects of a trace.

Who comes back after having been away is another object, ``id_2``, as everywhere in rulec: a rule is
judged on one stretch of presence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rulec.extraction.drive_context import DriveContext


@dataclass(frozen=True, slots=True)
class Presence:
    """An object of a trace: the participant's row, and from which column to which it is there."""

    name: str
    row: int
    first: int
    last: int


def presences(view: DriveContext) -> Iterator[Presence]:
    """The stretches in which somebody is there, brief absences forgotten."""
    most = round(view.thresholds.away_s / view.recording.step_s)
    people = view.people.participants
    taken = {one.id for one in people}
    nowhere = np.cumsum(np.isnan(view.others.w), axis=1)
    for row, one in enumerate(people):
        name = one.id
        columns = np.flatnonzero(view.near[row])
        gone = nowhere[row]
        breaks = [
            k
            for k in range(1, len(columns))
            if columns[k] - columns[k - 1] > most + 1 or gone[columns[k]] > gone[columns[k - 1]]
        ]
        for number, part in enumerate(np.split(columns, breaks), 1):
            called = name if number == 1 else _spare(name, taken)
            yield Presence(called, row, int(part[0]), int(part[-1]))


def _spare(name: str, taken: set[str]) -> str:
    number = 2
    while f"{name}_{number}" in taken:
        number += 1
    taken.add(f"{name}_{number}")
    return f"{name}_{number}"
