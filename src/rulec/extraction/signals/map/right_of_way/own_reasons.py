"""What else may make a participant slow down before ego's way: then it may not be held up by ego.

Its own way may bend; a sign, a light or the order of the ways may tell it to give way; somebody
else may be ahead in its way. Each is a reason only if it explains the speeds that are driven: a
bend ahead those that are then driven in the bend, a line those from which one can stop there, and
somebody ahead those of one that comes nearer to them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.oncoming_priority import turns_far
from rulec.extraction.tracks.junction_passages import Passage
from rulec.extraction.tracks.junctions import Junction, JunctionWay, approaches
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.recordings.recording import STOP_SIGNS
from rulec.scenario.recorded.reference_line import turn

_GIVES_WAY = STOP_SIGNS | {"YIELD"}

_BENDS_MPS2 = 2.0
"""A vehicle in a bend with this usual lateral acceleration may be slow because of the bend."""

_BRIEFLY_S = 1.0
"""Turns are means over half of this time (s)."""

_AS_SLOW = 0.9
"""Speeds that differ by less are the same: who drives a bend at its speed was slowed by it."""

_PREPARES_MPS2 = 0.5
"""Who would need less than this to stop at a place does not brake for it yet."""

_AT_LINE_M = 1.0
"""A front this far beyond a line is still at it: lines are not where drivers stop."""

_IN_WAY_M = 1.5
"""Somebody whose middle is nearer than this to the way that a vehicle will drive is in its way."""

_AHEAD_S = 6.0
"""Somebody farther ahead by time is no reason to brake yet."""


def slows_for_itself(
    context: DriveContext, rows: tuple[int, int], columns: tuple[int, int], comes: int
) -> bool:
    """Whether the second of two rows, ego's and another one's, may be slow for reasons of its own.

    ``columns``: when it may be slow, from where its speed is not yet due to ego. ``comes``: when it
    gets to the place where ego's way meets its own.
    """
    ego, other = rows
    first, slowest = _slowing(context, other, *columns)
    return (
        _bends(context, other, columns[0], comes)
        or _slows_for_bend(context, other, slowest)
        or _slows_at_line(context, other, first, slowest)
        or _is_behind_another(context, (ego, other), first, slowest)
    )


def _slowing(context: DriveContext, row: int, first: int, last: int) -> tuple[int, int]:
    """When a participant begins to brake between two columns, and when it is slowest."""
    speed = context.surroundings.passages.tracks.speed[row, first : max(last, first) + 1]
    known = np.where(np.isnan(speed), np.inf, speed)
    slowest = int(known.argmin())
    fast = known[: slowest + 1] >= _AS_SLOW * known[: slowest + 1].max()
    return first + int(fast.nonzero()[0][-1]), first + slowest


def _across(context: DriveContext, row: int, first: int, last: int) -> Floats:
    """A participant's lateral acceleration (m/s²) from its turns, in each of some columns."""
    tracks, step_s = context.surroundings.passages.tracks, context.recording.step_s
    steps = max(round(_BRIEFLY_S / 2 / step_s), 1)
    heading = np.unwrap(tracks.heading[row, first : last + steps + 1])
    turns = np.abs(heading[steps:] - heading[:-steps]) / steps / step_s
    across: Floats = turns * tracks.speed[row, first : first + len(turns)]
    return across


def _bends(context: DriveContext, row: int, first: int, last: int) -> bool:
    """Whether a participant drives round a bend fast enough to be slow because of it."""
    return bool((_across(context, row, first, last) >= _BENDS_MPS2).any())


def _slows_for_bend(context: DriveContext, row: int, slowest: int) -> bool:
    """Whether a participant, from when it is slowest, stays so slow until it is in a bend."""
    speed = context.surroundings.passages.tracks.speed[row, slowest:]
    slow = int((~np.append(speed <= speed[0] / _AS_SLOW, False)).argmax())
    return _bends(context, row, slowest, slowest + slow)


def _slows_at_line(context: DriveContext, row: int, first: int, slowest: int) -> bool:
    """Whether a participant that brakes can stop at a line where it may have to give way.

    One that could not stop there any more as it began to brake did not brake for the line, nor did
    one that is slowest beyond it.
    """
    passages = context.surroundings.passages
    travelled, speed = passages.travelled[row], passages.tracks.speed[row, first]
    for passage in passages.of_row.get(row, ()):
        line = travelled[passage.first] - passages.lengths[row] / 2
        left = line - travelled[first]
        if travelled[slowest] > line + _AT_LINE_M or left <= 0:
            continue
        needed = speed**2 / (2 * left)
        in_reach = _PREPARES_MPS2 <= needed <= context.thresholds.braking_mps2
        if in_reach and _may_have_to_wait(context, passage, (first, slowest)):
            return True
    return False


def _may_have_to_wait(context: DriveContext, passage: Passage, columns: tuple[int, int]) -> bool:
    """Whether a sign, a light or the order of the ways may stop a participant at a junction."""
    way, recording = context.surroundings.passages.way(passage), context.recording
    entries = approaches(recording, way)
    if any((entry.signs | entry.untold_signs) & _GIVES_WAY for entry in entries):
        return True
    colours = list(_shown(context, way, columns))
    if any(colour != "green" for colour in colours) or turns_far(context, passage):
        return True
    # Where lights are green they order the ways, and not what the map says without them
    if colours:
        return False
    first = way.lanelets[0].first
    return _lets_near_side_go(context, passage) if first is None else bool(first)


def _lets_near_side_go(context: DriveContext, passage: Passage) -> bool:
    """Whether there may be no sign at a junction, and a road from the near side meets one's own."""
    passages = context.surroundings.passages
    junction: Junction = passages.junctions[passage.junction]
    near = 1.0 if context.side == "right" else -1.0
    own = passages.way(passage)
    return not junction.regulated and any(
        30.0 <= near * np.degrees(turn(own.headings[0], way.headings[0])) <= 135.0
        and junction.meeting(passage.way, number) is not None
        for number, way in enumerate(junction.ways)
    )


def _shown(context: DriveContext, way: JunctionWay, columns: tuple[int, int]) -> Iterator[str]:
    """What the lights at a way's entry show in some columns."""
    lanelets, begin = context.recording.lanelets, context.surroundings.passages.tracks.first
    for entry in (lanelets[name] for name in way.entries if name in lanelets):
        own = entry.lights_to.get(way.lanelets[0].id)
        for light in (own,) if own else entry.lights:
            yield from (light.colour_at(begin + k) for k in range(columns[0], columns[1] + 1))


def _is_behind_another(
    context: DriveContext, rows: tuple[int, int], first: int, slowest: int
) -> bool:
    """Whether somebody else is so near ahead in a participant's way that it has to brake."""
    tracks = context.surroundings.passages.tracks
    others: Flags = np.ones(len(tracks.participants), dtype=bool)
    others[list(rows)] = False
    return any(
        _has_to_brake_for(context, rows[1], (tracks.present[:, column] & others), column)
        for column in range(first, slowest + 1)
    )


def _has_to_brake_for(context: DriveContext, row: int, others: Flags, column: int) -> bool:
    """Whether one of some participants is in a participant's way in a column, and slower."""
    passages = context.surroundings.passages
    tracks, lengths = passages.tracks, passages.lengths
    speed = float(tracks.speed[row, column])
    if (way := _way_ahead(context, row, column)) is None:
        return False
    rows = others.nonzero()[0]
    places = shapely.points(tracks.x[rows, column], tracks.y[rows, column])
    near = shapely.dwithin(places, way, _IN_WAY_M)
    rows, ahead = rows[near], shapely.line_locate_point(way, places[near])
    heading = tracks.heading[row, column]
    along = tracks.vx[rows, column] * np.cos(heading) + tracks.vy[rows, column] * np.sin(heading)
    gaps = ahead - (lengths[rows] + lengths[row]) / 2
    closing = np.maximum(speed - np.maximum(along, 0.0), 0.0)
    needed = closing**2 / (2 * np.maximum(gaps, 0.1))
    return bool(((ahead > 0) & (needed >= _PREPARES_MPS2)).any())


def _way_ahead(context: DriveContext, row: int, column: int) -> shapely.LineString | None:
    """The way that a participant drives from a column on, as far as it would get soon."""
    passages = context.surroundings.passages
    tracks, travelled = passages.tracks, passages.travelled[row]
    reach = travelled[column] + float(tracks.speed[row, column]) * _AHEAD_S
    until = int(np.searchsorted(travelled, reach, side="right"))
    ahead = column + tracks.present[row, column:until].nonzero()[0]
    if len(ahead) < 2:
        return None
    return shapely.LineString(np.column_stack((tracks.x[row, ahead], tracks.y[row, ahead])))
