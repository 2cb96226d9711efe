"""Who goes on round a ring beside ego, across whose lane ego leaves it.

Ego does so from a lane farther inside. Laws treat that as a change of lanes or as a turn, so words
of both are unknown where another one is in conflict with ego there, as on crossing ways.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.priority_signals import drive_by_drive, own_passages
from rulec.extraction.signals.map.right_of_way.conflicts import Passing, in_conflict
from rulec.extraction.signals.signal_columns import SignalColumns, column_of
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.trace.partly_known.partly_known_values import Truth

_CROSSED = "crossed"


@once
def crossed_on_ring(context: DriveContext) -> Flags:
    """Mask of participants and the states in which ego may have got in their way, leaving a ring.

    For each one, the state in which ego comes to its way.
    """
    if not context.surroundings.ring(context.side):
        return np.zeros(context.relevant.shape, dtype=bool)
    return column_of(_crossed(context).about[_CROSSED])


@drive_by_drive
def _crossed(context: DriveContext) -> SignalColumns:
    crossed = np.zeros(context.relevant.shape, dtype=bool)
    for passage in own_passages(context):
        for row, column in _in_way_of(context, passage):
            state = min(max(column - context.first_column, 0), context.states - 1)
            crossed[context.tracks.rows == row, state] = True
    return SignalColumns(about={_CROSSED: Truth.known(crossed)})


def _in_way_of(context: DriveContext, own: Passage) -> Iterator[tuple[int, int]]:
    """The rows of those that ego crosses at a junction as it leaves a ring, and when (column)."""
    passages, ring = context.surroundings.passages, context.surroundings.ring(context.side)
    way, junction = passages.way(own), passages.junctions[own.junction]
    if not way.entries & ring or way.exits & ring:
        return
    for other in passages.through[own.junction]:
        its = passages.way(other)
        goes_round = its.entries & ring and its.exits & ring
        if other.row == own.row or not goes_round or its.entries & way.entries:
            continue
        if (met := junction.meeting(own.way, other.way)) is None:
            continue
        ego, foe = passages.occupied(own, met[0]), passages.occupied(other, met[1])
        left_m = passages.left_to(other, met[1][0]) if foe[0] is None else 0.0
        ways = Passing(own, *ego), Passing(other, *foe)
        if ego[0] is not None and in_conflict(context, *ways, left_m):
            yield other.row, int(np.ceil(ego[0]))
