"""Signals of priority at junctions: signs, and whose ways cross ego's when.

Ego goes through a junction on a way; others do on theirs. Another participant is in conflict with
ego while both are on their way to where these cross or join (``conflicts``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import wraps
from math import ceil

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import DriveContext, once
from rulec.extraction.signals.ego_lanelets import map_contents
from rulec.extraction.signals.map.right_of_way.conflicts import (
    ARRIVALS,
    FROM_SIDES,
    LONGEST_WAIT_S,
    Encounter,
    arrivals,
    first_column,
    in_conflict,
)
from rulec.extraction.signals.map.right_of_way.oncoming_priority import (
    SLOWEST_MPS,
    gives_way_to,
    is_settled,
    may_have_to_stop,
    turns_far,
)
from rulec.extraction.signals.map.roundabout_signals import without_junction
from rulec.extraction.signals.signal_columns import (
    SignalColumn,
    SignalColumns,
    end_to_end,
    nobody,
)
from rulec.extraction.signals.signal_passes import SignalPasses, once_a_recording
from rulec.extraction.tracks.junction_passages import Passage
from rulec.extraction.tracks.junctions import Junction, approaches, before_joining
from rulec.extraction.tracks.tracks import Flags
from rulec.scenario.recorded.reference_line import turn

_ONCOMING = "in_way_of_oncoming"
_SIDES = (*FROM_SIDES, _ONCOMING)
_RING, _RAIL = "conflict_on_roundabout", "conflict_with_rail"
_CONFLICTS = (*_SIDES, _RING, _RAIL)
_PRIORITY = frozenset({"PRIORITY", "RIGHT_OF_WAY"})
_NEVER = np.iinfo(np.intp).max
_ROADS = ("unregulated_junction", "own_road_ends", "other_road_ends", "on_priority_road")


def drive_by_drive(
    signals_of: Callable[[DriveContext], SignalColumns],
) -> Callable[[DriveContext], SignalColumns]:
    """Make a function for a single drive, or for drives without junctions, work for any drives."""

    @wraps(signals_of)
    def found(context: DriveContext) -> SignalColumns:
        if context.is_one or not (own_passages(context) or _strays(context)):
            return signals_of(context)
        drives = range(context.spans.n_drives)
        return end_to_end([signals_of(context.one(number)) for number in drives])

    return found


@drive_by_drive
def _conflicts(context: DriveContext) -> SignalColumns:
    conflicts, unknown, strangers = (
        {name: np.zeros(context.states, dtype=bool) for name in _CONFLICTS} for _ in range(3)
    )
    whom, encounters = {name: nobody(context.states) for name in _CONFLICTS}, []
    trains = context.surroundings.tracks.of_type("rail_vehicle").any()
    possible = [name for name in _CONFLICTS if trains or name != _RAIL]
    for passage in own_passages(context):
        for met in _encounters(context, passage):
            encounters.append(met)
            for kind in met.kinds:
                from_then = slice(met.enters if kind == _ONCOMING else met.first, met.last + 1)
                (conflicts if met.known else unknown)[kind][from_then] = True
                if met.known:
                    other = context.surroundings.tracks.participants[met.other.row].id
                    for state in range(from_then.start, from_then.stop):
                        whom[kind][state] = (*whom[kind][state], other)
        for side in filter(None, _might_come(context, passage)):
            if side != _ONCOMING or turns_far(context, passage):
                strangers[side][approach(context, passage)] = True
        if not passage.sure:
            for name in possible:
                strangers[name][approach(context, passage)] = True
    if _may_meet(context):
        for name in possible:
            strangers[name] |= astray(context)
    not_told = {x: (unknown[x] | strangers[x]) & ~conflicts[x] for x in _CONFLICTS}
    when = arrivals(context, encounters, strangers)
    not_told[_RING] |= without_junction(context) & ~conflicts[_RING]
    world: dict[str, SignalColumn] = {**conflicts, **when.world}
    return SignalColumns(world, unknown=not_told | dict(when.unknown), whom=whom)


@once
def own_passages(context: DriveContext) -> tuple[Passage, ...]:
    """Ego's passages of junctions during the drive; of several drives, the first that has any."""
    for number in range(context.spans.n_drives):
        if passages := passages_of(context, number):
            return passages
    return ()


def passages_of(context: DriveContext, number: int) -> tuple[Passage, ...]:
    """Ego's passages of junctions during a drive, in the columns of its ``own`` tracks."""
    columns = context.steps[context.spans.slices[number]] - context.own.tracks.first
    passages = context.own.passages.of_row.get(int(context.ego.rows[number]), ())
    return tuple(x for x in passages if x.last >= columns[0] and x.first <= columns[-1])


@once
def _strays(context: DriveContext) -> tuple[tuple[int, int, int], ...]:
    """Ego's stays in junctions on none of their ways: the junction, first and last column."""
    rows, tracks = context.ego.rows.tolist(), context.own.tracks
    steps = [context.steps[own] - tracks.first for own in context.spans.slices]
    return tuple(
        (junction, first, last)
        for junction, found in context.own.passages.astray.items()
        for row, first, last in found
        for own, columns in zip(rows, steps, strict=True)
        if row == own and last >= columns[0] and first <= columns[-1]
    )


def astray(context: DriveContext) -> Flags:
    """Mask of the states of a drive in which ego nears, or is in, a junction on no way of it.

    Whose ways cross its own is not known then. Only at the junctions of ego's road: it may drive
    over others on a bridge.
    """
    found, along = np.zeros(context.states, dtype=bool), context.ego_extents.s[0]
    for _, *stay in _strays(context):
        first, last = np.clip(np.array(stay) - first_column(context), 0, context.states - 1)
        low, high = along[first : last + 1].min(), along[first : last + 1].max()
        if any(low < end and start < high for start, end in context.road.junctions):
            near = (along >= low - context.thresholds.approach_m) & (along <= high)
            found |= near & (context.spans.columns <= last)
    return found


def _may_meet(context: DriveContext) -> bool:
    """Whether others are near a junction while ego is there on none of its ways, or soon after."""
    passages, row = context.surroundings.passages, int(context.ego.rows[0])
    tracks, limits = passages.tracks, context.thresholds
    longest = round(limits.held_up_s / context.recording.step_s)
    for junction, first, last in _strays(context):
        columns = slice(max(first - longest, 0), last + longest + 1)
        there = tracks.present[:, columns] & (np.arange(len(tracks.present)) != row)[:, None]
        places = shapely.points(tracks.x[:, columns][there], tracks.y[:, columns][there])
        if shapely.dwithin(passages.junctions[junction].area, places, limits.approach_m).any():
            return True
    return False


def approach(context: DriveContext, passage: Passage) -> slice:
    """The states from where ego nears the junction until it is through it.

    They begin after ego has entered the junction before, and end before it enters the next one,
    even if a long body is then still in this one: so others are in its way at one junction only.
    """
    shift, passages = first_column(context), context.surroundings.passages
    ways = passages.travelled[passage.row]
    near = ways[passage.first] - ways[shift : passage.first + 1] <= context.thresholds.approach_m
    first = passage.first - shift - int(near.sum()) + 1 if len(near) else 0
    enters = passages.front_enters(passage)
    before = [x.first for x in passages.of_row[passage.row] if x.first < passage.first]
    entered = [min(column + 1, enters) - shift for column in before]
    return slice(max(first, 0, *entered), min(passage.last - shift + 1, _next(context, passage)))


def _next(context: DriveContext, passage: Passage) -> int:
    """The last state before ego's front is in the next junction, or one past all states."""
    passages = context.surroundings.passages
    later = [x for x in passages.of_row[passage.row] if x.first > passage.first]
    enters = [passages.front_enters(x) - first_column(context) for x in later[:1]]
    # The middle of a long body may cut the next one's corner and never be in it
    first, last = (
        int(np.clip(column - first_column(context), 0, context.states - 1))
        for column in (passage.first, passage.last)
    )
    beyond = context.ego_extents.s[0, last]
    starts = [start for start, _ in context.road.junctions if start > beyond]
    there = (context.ego_extents.s_max[0, first:] >= min(starts, default=np.inf)).nonzero()[0]
    enters += [first + int(state) - 1 for state in there[:1]]
    return min(enters, default=context.states)


def _until_out(context: DriveContext, passage: Passage) -> slice:
    """The states of ``approach``, and later ones in which ego's body is still in the junction."""
    span, (rear,) = approach(context, passage), context.ego_extents.s_min
    # Drives may break in a junction
    place = context.ego_extents.s[0, min(max(span.stop, 1), context.states) - 1]
    ends = [high for low, high in context.road.junctions if low <= place <= high]
    if not ends or span.stop >= context.states:
        return span
    out = span.stop + int((np.append(rear[span.stop :], np.inf) >= ends[0]).argmax())
    return slice(span.start, max(span.stop, min(out, _next(context, passage))))


@drive_by_drive
def _roads(context: DriveContext) -> SignalColumns:
    """What the map says about the junction that ego nears or is in."""
    columns = {name: np.zeros(context.states, dtype=bool) for name in _ROADS}
    unregulated, own, others, priority = _ROADS
    unknown = {name: astray(context) for name in _ROADS}
    for passage in own_passages(context):
        junction, span = (
            context.surroundings.passages.junctions[passage.junction],
            _until_out(context, passage),
        )
        columns[unregulated][span] = junction.regulated is False
        for name in _ROADS:
            unknown[name][span] = False
        unknown[unregulated][span] = junction.regulated is None
        columns[own][span], columns[others][span] = _ending_roads(junction, passage)
        entries = approaches(context.recording, context.surroundings.passages.way(passage))
        has_sign = any(entry.signs & _PRIORITY for entry in entries)
        may_have = any(entry.untold_signs & _PRIORITY for entry in entries)
        columns[priority][span], unknown[priority][span] = has_sign, may_have and not has_sign
    if not _tells_priority(context):
        del columns[priority], unknown[priority]
    return SignalColumns(columns, unknown=unknown)


def _tells_priority(context: DriveContext) -> bool:
    signs = map_contents(context).signs
    return "PRIORITY" in context.recording.complete or bool(_PRIORITY & signs)


def _ending_roads(junction: Junction, passage: Passage) -> tuple[bool, bool]:
    """Whether ego's road ends at the junction, and whether the one that it meets there does.

    A road ends if no way goes straight on from it. It meets one that goes on if a way does across.
    """
    own = junction.ways[passage.way]
    others = [
        way
        for way in junction.ways
        if not way.on_rails
        and np.pi / 4 < abs(turn(own.headings[0], way.headings[0])) < 3 * np.pi / 4
    ]
    on = [junction.goes_straight(way) for way in others]
    straight = junction.goes_straight(own)
    return not straight and any(on), straight and bool(on) and not any(on)


def _encounters(context: DriveContext, own: Passage) -> Iterator[Encounter]:
    """Participants that are in ego's way at a junction, or may be."""
    passages, shift = context.surroundings.passages, first_column(context)
    span = approach(context, own)
    waits, latest = (
        own.last + round(seconds / context.recording.step_s)
        for seconds in (LONGEST_WAIT_S, context.thresholds.held_up_s)
    )
    for other in passages.through[own.junction]:
        if other.row == own.row or other.last < span.start + shift:
            continue
        if other.first > waits and passages.front_enters(other) > waits:
            continue
        met = passages.junctions[own.junction].meeting(own.way, other.way)
        if met is None:
            continue
        ego, foe = passages.occupied(own, met[0]), passages.occupied(other, met[1])
        verdict = in_conflict(context, (own, *ego), (other, *foe))
        if verdict is None:
            continue
        begins, known = verdict
        enters, leaves = (None if when is None else ceil(when) for when in ego)
        last = (leaves if leaves is not None else shift + context.states - 1) - shift
        first = max(span.start, begins - shift)
        if not (kinds := _kinds(context, own, other)):
            continue
        ways = passages.way(own), passages.way(other)
        from_side = set(kinds) <= set(_SIDES) - {_ONCOMING}
        settled = from_side and is_settled(context.recording, *ways)
        if settled:
            continue
        lead_s = (own.first - other.first) * context.recording.step_s
        yield Encounter(
            kinds=kinds,
            first=first,
            enters=max((enters or 0) - shift, 0),
            last=min(last, context.states - 1, _next(context, own) - 1),
            known=known
            and own.sure
            and other.sure
            and settled is not None
            and not (_ONCOMING in kinds and may_have_to_stop(context, own, other))
            and not _turned_in_later(context, own, other)
            and _is_seen(passages.tracks.present[other.row], first + shift, latest),
            other=other,
            together=abs(lead_s) <= context.thresholds.together_s,
            comes_first=lead_s > context.thresholds.together_s,
        )


def _turned_in_later(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Whether a vehicle turned into the road to the junction after ego had driven in already.

    Where links are short, it is unknown whether one still before the junction at their other end
    will come.
    """
    passages, drives_in = context.surroundings.passages, _drives_in(context, own)
    least = np.radians(context.thresholds.turned_deg)
    return any(
        drives_in < passages.front_enters(before) < other.first
        and abs(passages.way(before).turned) > least
        for before in passages.of_row[other.row]
        if before.junction != own.junction
    )


def _drives_in(context: DriveContext, own: Passage) -> int:
    """The column in which ego drives in: where it moves off, if it waits within the junction."""
    passages = context.surroundings.passages
    speed = passages.tracks.speed[own.row, own.first : own.last + 1]
    waits = (speed < SLOWEST_MPS).nonzero()[0]
    return own.first + int(waits[-1]) if len(waits) else passages.front_enters(own)


def _is_seen(present: Flags, first: int, last: int) -> bool:
    """Whether a participant's track has no hole between two columns, as far as it extends."""
    there = present[first : last + 1].nonzero()[0]
    return len(there) == 0 or len(there) == there[-1] - there[0] + 1


def _kinds(context: DriveContext, own: Passage, other: Passage) -> tuple[str, ...]:
    passages = context.surroundings.passages
    if "rail_vehicle" in passages.tracks.participants[other.row].object_types:
        return (_RAIL,)
    way = passages.way(other)
    side = _side(float(np.degrees(turn(own.heading, other.heading))))
    if not side or (side == _ONCOMING and not gives_way_to(context, own, other)):
        return ()
    own_way = passages.way(own)
    came_on = way.entries | {lanelet.id for lanelet in before_joining(way, own_way)}
    ring = bool(came_on & context.surroundings.ring(context.side))
    return (side, _RING) if ring else (side,)


def _side(angle: float) -> str:
    """The word for a direction (degrees to the left of ego's) of arrival; empty for ego's own."""
    if abs(angle) < 30.0:
        return ""
    return _SIDES[2] if abs(angle) > 135.0 else _SIDES[0] if angle < 0 else _SIDES[1]


def _might_come(context: DriveContext, own: Passage) -> Iterator[str]:
    """The sides from which participants may come whose way through the junction is unknown.

    Those on no way of the map, or whose track ends before the junction, be it that they stop there
    for ego. In a simulation, one that is gone before the end has arrived somewhere.
    """
    passages, shift = context.surroundings.passages, first_column(context)
    tracks, step_s = passages.tracks, context.recording.step_s
    through = {x.row for x in passages.through[own.junction]}
    latest = _leaves_at_latest(context, own) + context.thresholds.yielding_s / step_s
    for row, first, last in passages.astray.get(own.junction, ()):
        if row != own.row and last >= own.first and first <= latest:
            through.add(row)
            yield _side(float(np.degrees(turn(own.heading, tracks.heading[row, first]))))
    rows, ends, back = _lost_from_sight(context)
    drives_in, longest = _drives_in(context, own), context.thresholds.held_up_s / step_s
    # A participant with a known way is in the junction on that way, unless it was unseen there
    in_time = (ends >= shift) & (ends <= latest + longest) & (back > own.first)
    for row, end, seen in zip(*(x[in_time].tolist() for x in (rows, ends, back)), strict=True):
        if row == own.row or (row in through and seen == _NEVER):
            continue
        times = own.first, min(latest, seen)
        columns = [column for column in {end, drives_in} if column <= min(end, latest)]
        if any(_would_come(context, own, row, column, times) for column in columns):
            yield _side(float(np.degrees(turn(own.heading, float(tracks.heading[row, end])))))


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


priority_signals = SignalPasses(
    {
        _ROADS: _roads,
        (*_CONFLICTS, *ARRIVALS): _conflicts,
    }
)
"""The signals of right of way at junctions."""
