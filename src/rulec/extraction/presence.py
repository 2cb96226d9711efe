"""The presence of participants in a trace, as objects.

Who comes back after an absence is another object, ``id_2``, as everywhere in rulec: a rule is
judged on one contiguous presence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

import numpy as np

from rulec.extraction.drive_context import DriveContext


@dataclass(frozen=True, slots=True)
class Presence:
    """An object of a trace: a participant's row, first and last column of its presence."""

    name: str
    row: int
    first: int
    last: int


def presences(context: DriveContext) -> Iterator[Presence]:
    """The contiguous presences of all participants; absences up to ``away_s`` are bridged.

    Those in which a participant is not beside the road never are: its extents are not known then.
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
            name = body.id
            if number > 1:
                name = next(free for k in count(2) if (free := f"{body.id}_{k}") not in taken)
                taken.add(name)
            yield Presence(name, row, int(part[0]), int(part[-1]))
