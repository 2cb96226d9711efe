"""Signals of priority at junctions: signs, and whose ways cross ego's when.

Ego goes through a junction on a way; others do on theirs. Another participant is in conflict with
ego while both are on their way to where these cross or join (``conflicts``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import wraps
from math import ceil

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import map_contents
from rulec.extraction.signals.map.right_of_way.arrivals import (
    ARRIVALS,
    arrivals,
    order_of_arrival,
)
from rulec.extraction.signals.map.right_of_way.conflicts import (
    FROM_SIDES,
    LONGEST_WAIT_S,
    ONCOMING,
    Encounter,
    Passing,
    drives_in,
    in_conflict,
    is_train,
    side_of,
)
from rulec.extraction.signals.map.right_of_way.oncoming_priority import (
    gives_way_to,
    is_settled,
    may_have_to_stop,
    turns_far,
)
from rulec.extraction.signals.map.right_of_way.unknown_ways import (
    astray,
    may_meet,
    might_come,
    strays,
)
from rulec.extraction.signals.map.roundabout_signals import without_junction
from rulec.extraction.signals.signal_columns import (
    SignalColumns,
    end_to_end,
    nobody,
)
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.extraction.tracks.at_junctions.junctions import before_joining
from rulec.scenario.recorded.reference_line import turn
from rulec.trace.partly_known.partly_known_values import Truth

_SIDES = (*FROM_SIDES, ONCOMING)
_RING, _RAIL = "conflict_on_roundabout", "conflict_with_rail"
_RAIL_FROM_SIDE = "conflict_with_rail_from_side"
_CONFLICTS = (*_SIDES, _RING, _RAIL, _RAIL_FROM_SIDE)
_PRIORITY = frozenset({"PRIORITY", "RIGHT_OF_WAY"})
_ROADS = ("unregulated_junction", "own_road_ends", "other_road_ends", "on_priority_road")


def drive_by_drive(
    signals_of: Callable[[DriveContext], SignalColumns],
) -> Callable[[DriveContext], SignalColumns]:
    """Make a function for a single drive, or for drives without junctions, work for any drives."""

    @wraps(signals_of)
    def found(context: DriveContext) -> SignalColumns:
        if context.is_one or not (own_passages(context) or strays(context)):
            return signals_of(context)
        drives = range(context.spans.n_drives)
        return end_to_end([signals_of(context.one(number)) for number in drives])

    return found


@word(*_CONFLICTS, *ARRIVALS)
@drive_by_drive
def _conflicts(context: DriveContext) -> SignalColumns:
    conflicts, unsure, strangers = (
        {name: np.zeros(context.states, dtype=bool) for name in _CONFLICTS} for _ in range(3)
    )
    whom, encounters = {name: nobody(context.states) for name in _CONFLICTS}, []
    trains = context.surroundings.tracks.of_type("rail_vehicle").any()
    possible = [x for x in _CONFLICTS if trains or x not in (_RAIL, _RAIL_FROM_SIDE)]
    for passage in own_passages(context):
        for met in _encounters(context, passage):
            encounters.append(met)
            for kind in met.kinds:
                from_then = slice(met.enters if kind == ONCOMING else met.first, met.last + 1)
                (conflicts if met.known else unsure)[kind][from_then] = True
                if met.known:
                    other = context.surroundings.tracks.participants[met.other.row].id
                    for state in range(from_then.start, from_then.stop):
                        whom[kind][state] = (*whom[kind][state], other)
        for row, side in might_come(context, passage):
            for kind in _possible_conflicts(context, passage, row, side):
                strangers[kind][approach(context, passage)] = True
        if not passage.sure:
            for name in possible:
                strangers[name][approach(context, passage)] = True
    if may_meet(context):
        for name in possible:
            strangers[name] |= astray(context)
    when = arrivals(context, encounters, strangers)
    strangers[_RING] |= without_junction(context)
    told = {x: Truth(own, own | unsure[x] | strangers[x]) for x, own in conflicts.items()}
    return SignalColumns({**told, **when}, whom=whom)


def _possible_conflicts(context: DriveContext, own: Passage, row: int, side: str) -> Iterator[str]:
    """The conflicts that there may be with a participant whose way through a junction is unknown.

    ``side``: where it may come from. Who does not turn crosses no way of those that drive along it.
    """
    along = side in ("", ONCOMING)
    if _is_on_rails(context, row):
        least = np.radians(context.thresholds.turned_deg)
        turned = context.surroundings.passages.way(own).turned
        yield from () if along and abs(turned) < least else (_RAIL,)
        if is_train(context, own, row):
            return
        yield from () if along else (_RAIL_FROM_SIDE,)
    if not along or (side == ONCOMING and turns_far(context, own)):
        yield side
    way, ring = context.surroundings.passages.way(own), context.surroundings.ring(context.side)
    if side and way.exits & ring and not way.entries & ring:
        yield _RING


def _is_on_rails(context: DriveContext, row: int) -> bool:
    return "rail_vehicle" in context.surroundings.passages.tracks.participants[row].object_types


@once
def own_passages(context: DriveContext) -> tuple[Passage, ...]:
    """Ego's passages of junctions during the drive; of several drives, the first that has any."""
    if not context.own.passages.of_row:
        return ()
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
def approach(context: DriveContext, passage: Passage) -> slice:
    """The states from where ego nears the junction until it is through it.

    They begin after ego has entered the junction before, and end before it enters the next one,
    even if a long body is then still in this one: so others are in its way at one junction only.
    """
    shift, passages = context.first_column, context.surroundings.passages
    ways = passages.travelled[passage.row]
    near = ways[passage.first] - ways[shift : passage.first + 1] <= context.thresholds.approach_m
    first = passage.first - shift - int(near.sum()) + 1 if len(near) else 0
    enters = passages.front_enters[passage]
    before = [x.first for x in passages.of_row[passage.row] if x.first < passage.first]
    entered = [min(column + 1, enters) - shift for column in before]
    return slice(max(first, 0, *entered), min(passage.last - shift + 1, _next(context, passage)))


@once
def _next(context: DriveContext, passage: Passage) -> int:
    """The last state before ego's front is in the next junction, or one past all states."""
    passages = context.surroundings.passages
    later = [x for x in passages.of_row[passage.row] if x.first > passage.first]
    enters = [passages.front_enters[x] - context.first_column for x in later[:1]]
    # The middle of a long body may cut the next one's corner and never be in it
    first, last = (
        min(max(column - context.first_column, 0), context.states - 1)
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


@word(*_ROADS)
@drive_by_drive
def _roads(context: DriveContext) -> SignalColumns:
    """What the map says about the junction that ego nears or is in."""
    told = _ROADS if _tells_priority(context) else _ROADS[:-1]
    sure = {name: np.zeros(context.states, dtype=bool) for name in told}
    possible = {name: astray(context).copy() for name in told}
    for passage in own_passages(context):
        junction = context.surroundings.passages.junctions[passage.junction]
        span, way = _until_out(context, passage), junction.ways[passage.way]
        has_sign = any(entry.signs & _PRIORITY for entry in way.approaches)
        untold = any(entry.untold_signs & _PRIORITY for entry in way.approaches)
        own, others = junction.ending_roads[passage.way]
        halves = (
            (junction.regulated is False, junction.regulated is not True),
            *((own, own), (others, others), (has_sign, has_sign or untold)),
        )
        for name, (is_sure, is_possible) in zip(told, halves, strict=False):
            sure[name][span], possible[name][span] = is_sure, is_possible
    return SignalColumns({name: Truth(sure[name], possible[name]) for name in told})


def _tells_priority(context: DriveContext) -> bool:
    signs = map_contents(context).signs
    return "PRIORITY" in context.recording.complete or bool(_PRIORITY & signs)


def _encounters(context: DriveContext, own: Passage) -> Iterator[Encounter]:
    """Participants that are in ego's way at a junction, or may be."""
    passages, shift = context.surroundings.passages, context.first_column
    span = approach(context, own)
    waits, latest = (
        own.last + context.steps_in(seconds)
        for seconds in (LONGEST_WAIT_S, context.thresholds.held_up_s)
    )
    for other in passages.through[own.junction]:
        if other.row == own.row or other.last < span.start + shift:
            continue
        if other.first > waits and passages.front_enters[other] > waits:
            continue
        met = passages.junctions[own.junction].meeting(own.way, other.way)
        if met is None:
            continue
        ego, foe = passages.occupied(own, met[0]), passages.occupied(other, met[1])
        left_m = passages.left_to(other, met[1][0]) if foe[0] is None else 0.0
        verdict = in_conflict(context, Passing(own, *ego), Passing(other, *foe), left_m)
        if verdict is None:
            continue
        begins, known = verdict
        enters, leaves = (None if when is None else ceil(when) for when in ego)
        last = (leaves if leaves is not None else shift + context.states - 1) - shift
        first = max(span.start, begins - shift)
        known = (
            known
            and own.sure
            and other.sure
            and not _turned_in_later(context, own, other)
            and _is_seen(passages.tracks.present[other.row], first + shift, latest)
        )
        for kinds, is_sure in _kinds(context, own, other):
            together, comes_first = order_of_arrival(context, own, other)
            yield Encounter(
                kinds=kinds,
                first=first,
                enters=max((enters or 0) - shift, 0),
                last=min(last, context.states - 1, _next(context, own) - 1),
                known=known and is_sure,
                other=other,
                together=together,
                comes_first=comes_first,
            )


def _turned_in_later(context: DriveContext, own: Passage, other: Passage) -> bool:
    """Whether a vehicle turned into the road to the junction after ego had driven in already.

    Where links are short, it is unknown whether one still before the junction at their other end
    will come.
    """
    passages, moved_in = context.surroundings.passages, drives_in(context, own, own.last)
    least = np.radians(context.thresholds.turned_deg)
    return any(
        moved_in < passages.front_enters[before] < other.first
        and abs(passages.way(before).turned) > least
        for before in passages.of_row[other.row]
        if before.junction != own.junction
    )


def _is_seen(present: Flags, first: int, last: int) -> bool:
    """Whether a participant's track has no hole between two columns, as far as it extends."""
    there = present[first : last + 1].nonzero()[0]
    return len(there) == 0 or len(there) == there[-1] - there[0] + 1


def _kinds(
    context: DriveContext, own: Passage, other: Passage
) -> Iterator[tuple[tuple[str, ...], bool]]:
    """The kinds of conflict with another one whose way meets ego's, and whether each is sure.

    Whether one on rails, for which laws have an order of its own, also has that of all other
    traffic laws differ, so that it has words of its own; no train at a level crossing has.
    """
    on_rails = _is_on_rails(context, other.row)
    if on_rails:
        yield (_RAIL,), True
        if is_train(context, own, other.row):
            return
    if sides := _sides(context, own, other):
        from_side = ONCOMING not in sides
        ways = map(context.surroundings.passages.way, (own, other))
        settled = from_side and is_settled(*ways)
        unsure = settled is None or (not from_side and may_have_to_stop(context, own, other))
        if not settled:
            yield sides, not (unsure or on_rails)
        if on_rails and from_side and not settled:
            yield (_RAIL_FROM_SIDE,), not unsure


def _sides(context: DriveContext, own: Passage, other: Passage) -> tuple[str, ...]:
    """From where one comes, by the words for it; empty if ego has to let nobody pass there."""
    passages, ring = context.surroundings.passages, context.surroundings.ring(context.side)
    way, own_way = passages.way(other), passages.way(own)
    came_on = way.entries | {lanelet.id for lanelet in before_joining(way, own_way)}
    if came_on & ring and not own_way.entries & ring:
        # On a small ring they come towards ego, or nearly in its direction
        return (FROM_SIDES[0 if context.side == "right" else 1], _RING)
    side = side_of(float(np.degrees(turn(own.heading, other.heading))))
    if not side or (side == ONCOMING and not gives_way_to(context, own, other)):
        return ()
    return (side, _RING) if came_on & ring else (side,)
