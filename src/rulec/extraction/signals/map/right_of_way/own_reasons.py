"""What else may make a participant slow down before ego's way: then it may not be held up by ego.

Its own way may bend; a sign, a light or the order of the ways may tell it to give way; somebody
else may be ahead in its way; the limit may be lower there. Each is a reason only if it explains the
speeds that are driven: a bend ahead those that are then driven in the bend, a line those from which
one can stop there, somebody ahead those of one that comes nearer to them, and a limit those above
it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from rulec.array_types import Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.oncoming_priority import SLOWEST_MPS, turns_far
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.extraction.tracks.at_junctions.junctions import Junction, JunctionWay, entry_lights
from rulec.recordings.recording import GIVE_WAY_SIGNS, LIMIT_SIGN, STOP_SIGNS
from rulec.scenario.recorded.reference_line import turn

_BENDS_MPS2 = 2.0
"""A vehicle in a bend with this usual lateral acceleration may be slow because of the bend."""

_TURNS_S = 0.5
"""Turns are means over this time (s)."""

_AS_FAST = 0.9
"""Speeds that differ by less are the same."""

_OUT_OF_BEND = 1.5
"""Drivers speed up in a bend; one that drives it faster than so many times its speed before it was
slow for something else."""

_JUST_S = 6.0
"""Bends driven this long before show which speeds a driver takes them at."""

_PREPARES_MPS2 = 0.5
"""Who would need less than this to stop at a place does not brake for it yet."""

_EXPLAINS = 0.5
"""A reason for less than this part of a vehicle's braking is not its reason."""

_AT_LINE_M = 1.0
"""A front this far beyond a line is still at it: lines are not where drivers stop."""

_IN_WAY_M = 1.5
"""Somebody whose middle is nearer than this to the way that a vehicle will drive is in its way."""

_AHEAD_S = 6.0
"""Somebody farther ahead by time is no reason to brake yet."""


@dataclass(frozen=True, slots=True)
class _Braking:
    """When the second of two rows, ego's and another one's, begins to brake and is slowest.

    ``least_mps2``: a reason asks at least for this.
    """

    rows: tuple[int, int]
    first: int
    slowest: int
    least_mps2: float


def slows_for_itself(context: DriveContext, rows: tuple[int, int], since: int, last: int) -> bool:
    """Whether the second of two rows, ego's and another one's, may be slow for reasons of its own.

    From ``since``, when its speed is not yet due to ego, to the column ``last``.
    """
    first, slowest = _slowing(context, rows[1], since, last)
    acceleration = context.surroundings.passages.tracks.acceleration[rows[1], first : slowest + 1]
    hardest = -float(np.fmin.reduce(acceleration, initial=0.0))
    braking = _Braking(rows, first, slowest, max(_EXPLAINS * hardest, _PREPARES_MPS2))
    return (
        _slows_for_bend(context, braking)
        or _slows_at_line(context, braking)
        or _is_behind_another(context, braking)
        or _slows_for_limit(context, braking)
    )


def _slowing(context: DriveContext, row: int, first: int, last: int) -> tuple[int, int]:
    """When a participant begins to brake between two columns, and when it is slowest."""
    speed = context.surroundings.passages.tracks.speed[row, first : max(last, first) + 1]
    known = np.where(np.isnan(speed), np.inf, speed)
    slowest = int(known.argmin())
    fast = known[: slowest + 1] >= _AS_FAST * known[: slowest + 1].max()
    return first + int(fast.nonzero()[0][-1]), first + slowest


def _across(context: DriveContext, row: int, first: int, last: int) -> Floats:
    """A participant's lateral acceleration (m/s²) from its turns, in each of some columns."""
    tracks, step_s = context.surroundings.passages.tracks, context.recording.step_s
    steps = max(round(_TURNS_S / step_s), 1)
    heading = np.unwrap(tracks.heading[row, first : last + steps + 1])
    turns = np.abs(heading[steps:] - heading[:-steps]) / steps / step_s
    across: Floats = turns * tracks.speed[row, first : first + len(turns)]
    return across


def _slows_for_bend(context: DriveContext, braking: _Braking) -> bool:
    """Whether a participant drives a bend not much faster than when it was slowest before it.

    One that has just driven round another place faster than this bend would ask of it at its speed
    before did not slow down for the bend.
    """
    row, first, slowest = braking.rows[1], braking.first, braking.slowest
    speed = context.surroundings.passages.tracks.speed[row]
    slow = int((~np.append(speed[slowest:] <= _OUT_OF_BEND * speed[slowest], False)).argmax())
    across = _across(context, row, slowest, slowest + slow)
    bends = across >= _BENDS_MPS2
    if not bends.any():
        return False
    sharpest = (across[bends] / speed[slowest : slowest + len(across)][bends] ** 2).max()
    before = max(first - context.steps_in(_JUST_S), 0)
    taken = np.fmax.reduce(_across(context, row, before, first), initial=0.0)
    return bool(sharpest * speed[first] ** 2 > taken)


def _slows_at_line(context: DriveContext, braking: _Braking) -> bool:
    """Whether a participant that brakes may have to give way at a line, or has to wait beyond it.

    One that could not stop at the line any more as it began to brake, and does not stand there, did
    not brake for the line. Nor did one that is slowest beyond it; but that one may stand there for
    somebody else.
    """
    passages, row = context.surroundings.passages, braking.rows[1]
    first, slowest = braking.first, braking.slowest
    travelled, speed = passages.travelled[row], passages.tracks.speed[row]
    stands = speed[slowest] < SLOWEST_MPS
    for passage in passages.of_row.get(row, ()):
        line = travelled[passage.first] - passages.lengths[row] / 2
        left = line - travelled[first]
        waits = stands and _meets_another(context, passage, braking)
        if travelled[slowest] > line + _AT_LINE_M:
            if waits and slowest <= passage.last:
                return True
            continue
        needed = speed[first] ** 2 / (2 * max(left, 0.1))
        too_late = needed > context.thresholds.braking_mps2 and not stands
        if needed < braking.least_mps2 or too_late:
            continue
        if _is_told_to_stop(context, passage, braking):
            return True
        # Who sees nobody does not stand there
        if (waits or not stands) and _may_have_to_wait(context, passage, braking):
            return True
    return False


def _slows_for_limit(context: DriveContext, braking: _Braking) -> bool:
    """Whether a participant gets as slow as a limit at or beyond a junction asks, and no slower.

    One that the map does not tell may ask for any speed.
    """
    passages, lanelets = context.surroundings.passages, context.recording.lanelets
    row, first = braking.rows[1], braking.first
    speed = passages.tracks.speed[row]
    soon = first + context.steps_in(_AHEAD_S)
    for passage in passages.of_row.get(row, ()):
        if not (passage.first <= soon and passage.last >= first):
            continue
        way = passages.way(passage)
        beyond = [lanelets[name] for name in way.names | way.exits if name in lanelets]
        if any(LIMIT_SIGN in lanelet.untold_signs for lanelet in beyond):
            return True
        limits = (lanelet.limit_mps for lanelet in beyond)
        lowest = min((limit for limit in limits if limit is not None), default=np.inf)
        if lowest < _AS_FAST * speed[first] and speed[braking.slowest] > _AS_FAST * lowest:
            return True
    return False


def _is_told_to_stop(context: DriveContext, passage: Passage, braking: _Braking) -> bool:
    """Whether a stop sign, or a light that is not green, stops a participant at a junction."""
    way = context.surroundings.passages.way(passage)
    signs = any(entry.signs & STOP_SIGNS for entry in way.approaches)
    return signs or any(colour != "green" for colour in _shown(context, way, braking))


def _meets_another(context: DriveContext, passage: Passage, braking: _Braking) -> bool:
    """Whether anybody else may be, or come, in the way of a participant that waits at a line."""
    passages, rows, column = context.surroundings.passages, braking.rows, braking.slowest
    junction = passages.junctions[passage.junction]
    strays = [x[1:] for x in passages.astray.get(passage.junction, ()) if x[0] not in rows]
    crossing = [
        (x.first, x.last)
        for x in passages.through[passage.junction]
        if x.row not in rows and junction.meeting(passage.way, x.way) is not None
    ]
    soon = column + context.steps_in(context.thresholds.held_up_s)
    return any(first <= soon and last >= column for first, last in (*strays, *crossing))


def _may_have_to_wait(context: DriveContext, passage: Passage, braking: _Braking) -> bool:
    """Whether a sign or the order of the ways may tell a participant to give way at a junction."""
    way = context.surroundings.passages.way(passage)
    told = [entry.signs | entry.untold_signs for entry in way.approaches]
    if any(signs & GIVE_WAY_SIGNS for signs in told) or turns_far(context, passage):
        return True
    # Where lights are green they order the ways, and not what the map says without them
    if any(True for _ in _shown(context, way, braking)):
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


def _shown(context: DriveContext, way: JunctionWay, braking: _Braking) -> Iterator[str]:
    """What the lights at a way's entry show while a participant brakes."""
    begin = context.surroundings.passages.tracks.first
    columns = range(begin + braking.first, begin + braking.slowest + 1)
    for _, lights in entry_lights(way):
        for light in lights:
            yield from map(light.colour_at, columns)


def _is_behind_another(context: DriveContext, braking: _Braking) -> bool:
    """Whether somebody else is so near ahead in a participant's way that it has to brake."""
    columns = range(braking.first, braking.slowest + 1)
    return any(_has_to_brake_for(context, braking, column) for column in columns)


def _has_to_brake_for(context: DriveContext, braking: _Braking, column: int) -> bool:
    """Whether somebody other than ego is in a participant's way in a column, and slower."""
    passages, (ego, row) = context.surroundings.passages, braking.rows
    tracks, lengths = passages.tracks, passages.lengths
    if (way := _way_ahead(context, row, column)) is None:
        return False
    there = tracks.present[:, column].nonzero()[0]
    places = shapely.points(tracks.x[there, column], tracks.y[there, column])
    near = shapely.dwithin(places, way, _IN_WAY_M)
    others, ahead = there[near], shapely.line_locate_point(way, places[near])
    in_way = (ahead > 0) & (others != row) & (others != ego)
    others, ahead = others[in_way], ahead[in_way]
    heading = tracks.heading[row, column]
    along = tracks.vx[others, column] * np.cos(heading)
    along += tracks.vy[others, column] * np.sin(heading)
    gaps = ahead - (lengths[others] + lengths[row]) / 2
    closing = np.maximum(float(tracks.speed[row, column]) - np.maximum(along, 0.0), 0.0)
    return bool((closing**2 / (2 * np.maximum(gaps, 0.1)) >= braking.least_mps2).any())


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
