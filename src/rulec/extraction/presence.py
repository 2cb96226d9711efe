"""The presence of participants in a trace, as objects.

Who comes back after an absence is another object, ``id_2``, as everywhere in rulec: a rule is
judged on one contiguous presence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rulec.extraction.drive_context import DriveContext


@dataclass(frozen=True, slots=True)
class Presence:
    """A participant's row and the columns of its presence.

    It is an object of a trace; the first and the last column are included.
    """

    name: str
    row: int
    first: int
    last: int


def presences(context: DriveContext) -> Iterator[Presence]:
    """The contiguous presences of all participants; absences up to ``away_s`` are bridged.

    An absence in which a participant is not beside the road is never bridged: there its extents
    are not known.
    """
    longest = round(context.thresholds.away_s / context.recording.step_s)
    participants = context.tracks.participants
    taken = {body.id for body in participants}
    unknown = np.cumsum(np.isnan(context.extents.w), axis=1)
    for row, body in enumerate(participants):
        columns = np.flatnonzero(context.relevant[row])
        gone = unknown[row]
        breaks = [
            k
            for k in range(1, len(columns))
            if columns[k] - columns[k - 1] > longest + 1 or gone[columns[k]] > gone[columns[k - 1]]
        ]
        for number, part in enumerate(np.split(columns, breaks), 1):
            name = body.id if number == 1 else _free_name(body.id, taken)
            yield Presence(name, row, int(part[0]), int(part[-1]))


def _free_name(name: str, taken: set[str]) -> str:
    number = 2
    while f"{name}_{number}" in taken:
        number += 1
    taken.add(f"{name}_{number}")
    return f"{name}_{number}"
