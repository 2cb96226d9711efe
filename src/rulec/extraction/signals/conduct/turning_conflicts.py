"""The signal of participants going straight on beside a turning ego, in conflict with it there.

In the frame of ego's direction before the junction, where it has not begun to turn, ego's body is
across the participant's line while it drives over it. They are in conflict if ego gets there first
although the participant, at its speed then, would be there less than ``yielding_s`` after ego has
left, and comes less than ``held_up_s`` after it, as on crossing ways in junctions.
"""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.conduct.beside_on_rings import (
    ASIDE_M,
    BEHIND_M,
    LAPS_M,
    cut_on_ring,
)
from rulec.extraction.signals.conduct.leaving_rings import crossed_on_ring
from rulec.extraction.signals.map.priority_signals import drive_by_drive, own_passages
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.signals.signal_passes import SignalPasses
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.recordings.recording import Points

_BEFORE_M = 8.0
_STRAIGHT_RAD = np.radians(30.0)
_CREEPS_MPS = 0.5


@drive_by_drive
def _turns_in_way_of(context: DriveContext) -> SignalColumns:
    met: Flags = np.zeros(context.relevant.shape, dtype=bool)
    unsure: Flags = crossed_on_ring(context) | cut_on_ring(context)
    least = np.radians(context.thresholds.turned_deg)
    ring = context.surroundings.ring(context.side)
    for passage in own_passages(context):
        way = context.surroundings.passages.way(passage)
        turned, at_ring = way.turned, (way.entries | way.exits | way.names) & ring
        if least < abs(turned) < np.pi - least and not at_ring:
            for row, whole in enumerate(context.tracks.rows.tolist()):
                found = _conflict(context, passage, whole, np.sign(turned))
                if found is not None:
                    first, last, known = found
                    (met if known and passage.sure else unsure)[row, first : last + 1] = True
    return SignalColumns(about={"turns_in_way_of": met}, unknown={"turns_in_way_of": unsure & ~met})


def _conflict(
    context: DriveContext, own: Passage, row: int, towards: float
) -> tuple[int, int, bool] | None:
    """The states in which ego is in a participant's way, and whether that is known; or None.

    ``towards``: 1 if ego turns left, -1 if right.
    """
    passages, shift = context.surroundings.passages, context.first_column
    tracks, step_s = passages.tracks, context.recording.step_s
    place, limits = context.tolerances.place_m, context.thresholds
    begin = max(own.first, shift)
    if not tracks.present[row, begin] or "pedestrian" in tracks.participants[row].object_types:
        return None
    came = _came(context, own, begin)
    origin = float(tracks.x[own.row, came]), float(tracks.y[own.row, came])
    heading = float(tracks.heading[own.row, came])
    along, left = _in_frame(context, row, origin, heading)
    angle = np.angle(np.exp(1j * (tracks.heading[row] - heading)))
    # Clear of ego's way before it turned: a vehicle that follows ego is behind it
    ours, theirs = tracks.outline(own.row, came), tracks.outline(row, begin)
    if ours is None or theirs is None:
        return None
    clear = _clear((ours, theirs), towards, origin, heading)
    behind = float(_in_frame(context, own.row, origin, heading)[0][begin] - along[begin])
    half = float(passages.lengths[own.row]) / 2
    beside = -max(place, LAPS_M) <= clear <= ASIDE_M and -half <= behind <= BEHIND_M
    if not beside or abs(float(angle[begin])) > _STRAIGHT_RAD:
        return None
    crosses = _crossed(context, own, begin, (*origin, heading), float(left[begin]))
    if crosses is None:
        return None
    enters, leaves, low, high = crosses
    there = tracks.present[row, begin:].nonzero()[0] + begin
    front = along + float(passages.lengths[row]) / 2
    straight = np.abs(angle[there]) <= _STRAIGHT_RAD
    if not straight.all() and not (along[there[~straight][0]] > high):
        return None
    arrived = there[front[there] >= low]
    if len(arrived) and arrived[0] <= enters:
        return None
    speed = float(tracks.speed[row, begin])
    if speed < _CREEPS_MPS:
        return None
    would = begin + max(low - float(front[begin]), 0.0) / speed / step_s
    last = min(leaves - shift, context.states - 1)
    if (would - leaves) * step_s >= limits.yielding_s:
        return None
    known = bool(len(arrived)) and leaves < tracks.present.shape[1] - 1
    if known and (arrived[0] - leaves) * step_s >= limits.held_up_s:
        return None
    return max(enters - shift, 0), last, known and clear > place


def _came(context: DriveContext, own: Passage, begin: int) -> int:
    """The column in which ego was so far before the junction that it did not turn yet."""
    passages = context.surroundings.passages
    way = passages.travelled[own.row]
    there = passages.tracks.present[own.row, : begin + 1].nonzero()[0]
    before = there[way[begin] - way[there] >= _BEFORE_M]
    return int(before[-1] if len(before) else there[0])


def _clear(
    outlines: tuple[Points, Points], towards: float, origin: tuple[float, float], heading: float
) -> float:
    """How far (m) a body is clear of ego, whose outline is the first, on the side it turns to."""
    ours, theirs = (
        towards * ((own - origin) @ (-np.sin(heading), np.cos(heading))) for own in outlines
    )
    return float(theirs.min() - ours.max())


def _crossed(
    context: DriveContext, own: Passage, begin: int, frame: tuple[float, float, float], line: float
) -> tuple[int, int, float, float] | None:
    """The columns from and to which ego's body is across a line along its old way, and where (m).

    ``frame``: x and y of the place that it came from, and its heading there.
    """
    tracks = context.surroundings.passages.tracks
    *origin, heading = frame
    cos, sin = np.cos(heading), np.sin(heading)
    columns, lows, highs = [], [], []
    for column in tracks.present[own.row, begin:].nonzero()[0] + begin:
        corners = tracks.outline(own.row, int(column))
        if corners is None:
            continue
        x, y = corners[:, 0] - origin[0], corners[:, 1] - origin[1]
        along, left = x * cos + y * sin, y * cos - x * sin
        if left.min() <= line <= left.max():
            columns.append(int(column))
            lows.append(float(along.min()))
            highs.append(float(along.max()))
        elif columns:
            break
    if not columns:
        return None
    return columns[0], columns[-1], min(lows), max(highs)


def _in_frame(
    context: DriveContext, row: int, origin: tuple[float, float], heading: float
) -> tuple[Floats, Floats]:
    """How far (m) a participant is along a direction from a place, and to its left, by column."""
    tracks = context.surroundings.passages.tracks
    x, y = tracks.x[row] - origin[0], tracks.y[row] - origin[1]
    cos, sin = np.cos(heading), np.sin(heading)
    return x * cos + y * sin, y * cos - x * sin


turning_conflicts = SignalPasses({"turns_in_way_of": _turns_in_way_of})
"""The signal of conflicts with participants beside a turning ego."""
