"""The signal of participants going straight on beside a turning ego, in conflict with it there.

In the frame of ego's direction before the junction, where it has not begun to turn, ego's body is
across the participant's line while it drives over it. They are in conflict if ego gets there first
although the participant, at its speed then, would be there less than ``yielding_s`` after ego has
left, and comes less than ``held_up_s`` after it, as on crossing ways in junctions.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

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
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.recordings.recording import Points
from rulec.trace.partly_known.partly_known_values import Truth

_BEFORE_M = 8.0
_STRAIGHT_RAD = np.radians(30.0)
_CREEPS_MPS = 0.5


@word("turns_in_way_of")
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
            for row, (first, last, known) in _conflicts(context, passage):
                (met if known and passage.sure else unsure)[row, first : last + 1] = True
    return SignalColumns(about={"turns_in_way_of": Truth(met, met | unsure)})


@dataclass(frozen=True, slots=True)
class _Turn:
    """Ego's turn from a column on, in the frame of the place and heading that it came from.

    ``ours``: ego's outline where it came from.
    """

    own: Passage
    begin: int
    origin: tuple[float, float]
    heading: float
    ours: Points


def _conflicts(context: DriveContext, own: Passage) -> Iterator[tuple[int, tuple[int, int, bool]]]:
    """The rows of those whose way ego is in, in which states, and whether that is known."""
    passages, rows = context.surroundings.passages, context.tracks.rows
    tracks, begin = passages.tracks, max(own.first, context.first_column)
    came = _came(context, own, begin)
    origin = float(tracks.x[own.row, came]), float(tracks.y[own.row, came])
    ours = tracks.outline(own.row, came)
    if ours is None:
        return
    turn = _Turn(own, begin, origin, float(tracks.heading[own.row, came]), ours)
    along, _, angles = _in_frame(context, turn, (rows, begin))
    behind = _in_frame(context, turn, (own.row, begin))[0] - along
    half = float(passages.lengths[own.row]) / 2
    beside = tracks.present[rows, begin] & ~tracks.of_type("pedestrian")[rows]
    beside &= (-half <= behind) & (behind <= BEHIND_M)
    beside &= ~(np.abs(angles) > _STRAIGHT_RAD)
    for number in beside.nonzero()[0].tolist():
        found = _conflict(context, turn, int(rows[number]))
        if found is not None:
            yield number, found


def _conflict(context: DriveContext, turn: _Turn, row: int) -> tuple[int, int, bool] | None:
    """The states in which ego is in a participant's way, and whether that is known; or None."""
    passages, shift = context.surroundings.passages, context.first_column
    tracks, step_s = passages.tracks, context.recording.step_s
    place, limits, begin = context.tolerances.place_m, context.thresholds, turn.begin
    # Clear of ego's way before it turned: a vehicle that follows ego is behind it
    theirs = tracks.outline(row, begin)
    if theirs is None:
        return None
    clear = _clear(turn, theirs, np.sign(passages.way(turn.own).turned))
    if not -max(place, LAPS_M) <= clear <= ASIDE_M:
        return None
    along, left, angle = _in_frame(context, turn, row)
    crosses = _crossed(context, turn, float(left[begin]))
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


def _clear(turn: _Turn, theirs: Points, towards: float) -> float:
    """How far (m) a body is clear of ego's, where it came from, on a side: 1 left, -1 right."""
    left = -np.sin(turn.heading), np.cos(turn.heading)
    ours, theirs = (towards * ((body - turn.origin) @ left) for body in (turn.ours, theirs))
    return float(theirs.min() - ours.max())


def _crossed(
    context: DriveContext, turn: _Turn, line: float
) -> tuple[int, int, float, float] | None:
    """The columns in which ego's body is across a line along its old way: from, to, where (m)."""
    tracks, row = context.surroundings.passages.tracks, turn.own.row
    cos, sin = np.cos(turn.heading), np.sin(turn.heading)
    columns, lows, highs = [], [], []
    for column in tracks.present[row, turn.begin :].nonzero()[0] + turn.begin:
        corners = tracks.outline(row, int(column))
        if corners is None:
            continue
        x, y = corners[:, 0] - turn.origin[0], corners[:, 1] - turn.origin[1]
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


def _in_frame(context: DriveContext, turn: _Turn, at: Any) -> tuple[Floats, Floats, Floats]:
    """How far (m) participants are along ego's old way and to its left, and their angle (rad).

    ``at``: their rows, and columns if not all.
    """
    tracks = context.surroundings.passages.tracks
    x, y = tracks.x[at] - turn.origin[0], tracks.y[at] - turn.origin[1]
    cos, sin = np.cos(turn.heading), np.sin(turn.heading)
    angles = np.angle(np.exp(1j * (tracks.heading[at] - turn.heading)))
    return x * cos + y * sin, y * cos - x * sin, angles
