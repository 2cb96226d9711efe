"""Junctions through which the way of ego, or of others who may come, is not known."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.computed_once import once, once_a_recording
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.conflicts import drives_in, side_of
from rulec.extraction.signals.map.right_of_way.oncoming_priority import SLOWEST_MPS
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.scenario.recorded.reference_line import turn

_NEVER = np.iinfo(np.intp).max


@once
def strays(context: DriveContext) -> tuple[tuple[int, int, int], ...]:
    """Ego's stays in junctions on none of their ways: the junction, first and last column.

    And where its drive ends as it gets there.
    """
    rows, passages, tracks = context.ego.rows.tolist(), context.own.passages, context.own.tracks
    if not passages.junctions:
        return ()
    steps = [context.steps[own] - tracks.first for own in context.spans.slices]
    found = [
        (junction, first, last)
        for junction, stays in passages.astray.items()
        for row, first, last in stays
        for own, columns in zip(rows, steps, strict=True)
        if row == own and last >= columns[0] and first <= columns[-1]
    ]
    ends = [int(columns[-1]) for columns in steps]
    touched = passages.touched_by([*map(tracks.outline, rows, ends)])
    for row, columns, end, at_end in zip(rows, steps, ends, touched, strict=True):
        driven = {x.junction for x in passages.of_row.get(row, ()) if x.last >= columns[0]}
        found += [(junction, end, end) for junction in at_end if junction not in driven]
    return tuple(found)


def astray(context: DriveContext) -> Flags:
    """Mask of the states of a drive in which ego nears, or is in, a junction on no way of it.

    Whose ways cross its own is not known then. Only at the junctions of ego's road: it may drive
    over others on a bridge.
    """
    found, along = np.zeros(context.states, dtype=bool), context.ego_extents.s[0]
    front = context.ego_extents.s_max[0]
    for _, *stay in strays(context):
        first, last = np.clip(np.array(stay) - context.first_column, 0, context.states - 1)
        low, high = along[first : last + 1].min(), front[first : last + 1].max()
        if any(low < end and start < high for start, end in context.road.junctions):
            near = (along >= low - context.thresholds.approach_m) & (along <= high)
            found |= near & (context.spans.columns <= last)
    return found


def may_meet(context: DriveContext) -> bool:
    """Whether others are near a junction ``held_up_s`` before or after ego is on no way of it."""
    passages, row = context.surroundings.passages, int(context.ego.rows[0])
    tracks, limits = passages.tracks, context.thresholds
    longest = context.steps_in(limits.held_up_s)
    for junction, first, last in strays(context):
        columns = slice(max(first - longest, 0), last + longest + 1)
        there = tracks.present[:, columns] & (np.arange(len(tracks.present)) != row)[:, None]
        places = shapely.points(tracks.x[:, columns][there], tracks.y[:, columns][there])
        if shapely.dwithin(passages.junctions[junction].area, places, limits.approach_m).any():
            return True
    return False


def might_come(context: DriveContext, own: Passage) -> Iterator[tuple[int, str]]:
    """The rows of participants whose way through the junction is unknown, and their sides.

    Those on no way of the map, or whose track ends before the junction, be it that they stop there
    for ego. In a simulation, one that is gone before the end has arrived somewhere.
    """
    passages, shift = context.surroundings.passages, context.first_column
    tracks, step_s = passages.tracks, context.recording.step_s
    through = {x.row for x in passages.through[own.junction]}
    latest = _leaves_at_latest(context, own) + context.thresholds.yielding_s / step_s
    for row, first, last in passages.astray.get(own.junction, ()):
        # The front of a long body gets there long before its middle
        if row != own.row and last >= own.first and passages.front_came(row, first) <= latest:
            through.add(row)
            yield row, side_of(float(np.degrees(turn(own.heading, tracks.heading[row, first]))))
    rows, ends, back = _lost_from_sight(context)
    moved_in, longest = drives_in(context, own, own.last), context.thresholds.held_up_s / step_s
    # A participant with a known way is in the junction on that way, unless it was unseen there
    in_time = (ends >= shift) & (ends <= latest + longest) & (back > own.first)
    for row, end, seen in zip(*(x[in_time].tolist() for x in (rows, ends, back)), strict=True):
        if row == own.row or (row in through and seen == _NEVER):
            continue
        times = own.first, min(latest, seen)
        columns = [column for column in {end, moved_in} if column <= min(end, latest)]
        if any(_would_come(context, own, row, column, times) for column in columns):
            heading = float(tracks.heading[row, end])
            yield row, side_of(float(np.degrees(turn(own.heading, heading))))


def _would_come(
    context: DriveContext, own: Passage, row: int, column: int, times: tuple[float, float]
) -> bool:
    """Whether a participant, at its speed in a column, gets to ego's junction between two times."""
    passages = context.surroundings.passages
    tracks, area = passages.tracks, passages.junctions[own.junction].area
    if not tracks.present[row, column]:
        return False
    x, y = float(tracks.x[row, column]), float(tracks.y[row, column])
    place = shapely.Point(x, y)
    away = float(shapely.distance(area, place))
    speed = max(float(tracks.speed[row, column]), 0.1)
    if not times[0] <= column + away / speed / context.recording.step_s <= times[1]:
        return False
    near = shapely.shortest_line(place, area).coords[-1]
    towards = float(np.arctan2(near[1] - y, near[0] - x))
    return away == 0.0 or abs(turn(towards, float(tracks.heading[row, column]))) < np.pi / 3


@once_a_recording
def _lost_from_sight(context: DriveContext) -> tuple[NDArray[intp], ...]:
    """The rows of all that may go on unseen, their last columns before, and the next ones.

    The next is ``_NEVER`` where tracks have ended.
    """
    tracks = context.surroundings.passages.tracks
    present = tracks.present
    stand = np.array([body.standing for body in tracks.participants], dtype=bool)
    drive = ~stand & ~tracks.of_type("pedestrian")
    rows, ends = (present[:, :-1] & ~present[:, 1:] & drive[:, None]).nonzero()
    last = present.shape[1] - 1
    until_last = (present[:, last] & drive).nonzero()[0]
    columns = np.where(present, np.arange(last + 1), _NEVER)
    after = np.minimum.accumulate(columns[:, ::-1], axis=1)[:, ::-1]
    back = after[rows, ends + 1]
    if "arrivals" in context.recording.complete:
        rows, ends, back = rows[back < _NEVER], ends[back < _NEVER], back[back < _NEVER]
    never = np.full(len(until_last), _NEVER)
    return (
        np.append(rows, until_last),
        np.append(ends, np.full(len(until_last), last)),
        np.append(back, never),
    )


def _leaves_at_latest(context: DriveContext, own: Passage) -> float:
    """The column in which ego leaves a junction; extrapolated if its track ends before."""
    passages = context.surroundings.passages
    tracks = passages.tracks
    column = own.last
    if column + 1 < tracks.present.shape[1] and tracks.present[own.row, column + 1]:
        return column
    line = passages.way(own).line
    end = line.length + float(passages.lengths[own.row]) / 2
    place = shapely.Point(tracks.x[own.row, column], tracks.y[own.row, column])
    left = float(end - line.project(place))
    speed = max(float(tracks.speed[own.row, column]), SLOWEST_MPS)
    return column + left / speed / context.recording.step_s
