"""The lines at which ego has to stop: where they are, and when it crosses them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import ceil, floor
from typing import NamedTuple

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once, once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.measured_numbers import own_front, own_speed
from rulec.recordings.recording import STOP_SIGNS, Lanelet

LINE_REACH_M = 40.0

_HAIR = 1e-6
_AT_ONCE_S = 0.05
"""A line crossed this close in time to a state is crossed in it: lights change less often."""


class OwnLine(NamedTuple):
    """The line of a lanelet, between two places (m); ``on_lane``: ego is in its lane, by state."""

    piece: int
    lane: int
    on_lane: Flags
    first: float
    last: float


@once_a_road
def lines_on_road(context: DriveContext) -> Sequence[tuple[int, int, Lanelet]]:
    """The piece, the lane and the lanelet of each line of ego's road, the farthest first."""
    road = context.road
    return [
        (piece, lane, road.lanelet(piece, lane))
        for piece in range(len(road.rows) - 1, -1, -1)
        for lane in range(len(road.rows[piece]))
        if _ends_at_line(context, piece, lane)
    ]


def own_lines(context: DriveContext, counts: Callable[[Lanelet], object]) -> Iterator[OwnLine]:
    """The lines of the lanelets that count, in lanes that ego is ever in, the farthest first."""
    lines = lines_on_road(context)
    lanes = np.unique(context.ego_lane).tolist() if lines else ()
    for piece, lane, lanelet in lines:
        if lane in lanes and counts(lanelet):
            line = stop_line(context, piece, lane)
            yield OwnLine(piece, lane, context.ego_lane == lane, *line)


def has_stop_sign(lanelet: Lanelet) -> bool:
    """Whether vehicles have to stop at a lanelet's end by a sign."""
    return bool(STOP_SIGNS & lanelet.signs)


@once
def passes(context: DriveContext, line: float) -> Flags:
    """Mask of ego crossing a line; again only if it was back by more than places' errors."""
    front, spans = own_front(context), context.spans
    beyond = front > line
    enters = spans.enters(beyond)
    back = spans.latest(front <= line - context.tolerances.place_m)
    again = spans.before(spans.latest(enters)) > np.maximum(back, spans.first - 1)
    return enters & ~again


@once
def may_pass(context: DriveContext, line: float) -> Flags:
    """Mask of states in which it is unknown whether ego has crossed a line.

    Errors of places decide, and not only for a moment: ego is on the line for more than
    ``passed_s``, as when it stands there, or is not surely before it earlier, or beyond it later.
    """
    front, spans, place = own_front(context), context.spans, context.tolerances.place_m
    before, beyond = front <= line - place, front > line + place
    at_line = ~(before | beyond)
    if not at_line.any():
        return at_line
    since, until = spans.latest(~at_line), spans.next_state(~at_line)
    comes, goes = since >= spans.first, until < spans.end
    comes &= before.take(since, mode="clip")
    goes &= beyond.take(until, mode="clip")
    brief = until - since - 1 <= context.thresholds.passed_s / context.recording.step_s + _HAIR
    return at_line & ~(comes & goes & brief)


def may_have_passed(context: DriveContext, line: float, front: Floats | None = None) -> Flags:
    """Mask of the first states of drives in which ego may just have crossed a line.

    No state shows where it was before: it is beyond the line by no more than it may have driven
    since it was last seen, or within a step. ``front``: the places along the road of what crosses.
    """
    found, begins = np.zeros(context.states, dtype=bool), context.spans.begins
    beyond = (own_front(context) if front is None else front)[begins] - line
    found[begins] = (beyond > 0) & (beyond <= _driven_unseen(context))
    return found


@once
def unseen_steps(context: DriveContext) -> NDArray[intp]:
    """By drive, the steps from the last earlier state of ego, or of the track it goes on with.

    One where there is none, as at the beginning of a recording.
    """
    tracks = context.own.tracks
    first = context.steps[context.spans.begins]
    found = np.ones(len(first), dtype=intp)
    for number, (row, step) in enumerate(zip(context.ego.rows.tolist(), first, strict=True)):
        seen = tracks.present[row, : step - tracks.first].nonzero()[0]
        resumes = tracks.participants[row].resumes
        if len(seen):
            found[number] = step - tracks.first - seen[-1]
        elif resumes is not None:
            found[number] = step - resumes
    return found


@once
def _driven_unseen(context: DriveContext) -> Floats:
    """By drive, how far (m) ego may have driven since it was last seen, with errors of places."""
    begins, steps = context.spans.begins, unseen_steps(context)
    seconds = steps * context.recording.step_s
    # It may have braked meanwhile, to its speed now
    braked = np.where(context.ego_moves[begins] | (steps > 1), context.thresholds.braking_mps2, 0.0)
    speed, error = own_speed(context)
    driven: Floats = (speed + error)[begins] * seconds + braked / 2 * seconds**2
    return driven + context.tolerances.place_m


def may_stop_beyond(context: DriveContext, line: tuple[float, float]) -> Flags:
    """Mask of states in which ego comes to where an undrawn line may be, and stops or ends there.

    ``line``: the places between which it is. Drivers stop before lines; but where one stands, the
    line may also be behind it.
    """
    first, last = line
    front, spans = own_front(context), context.spans
    comes = passes(context, first + context.thresholds.touching_m) & (front <= last)
    if not comes.any():
        return comes
    beyond = front > last
    stands = ~beyond & ~context.ego_moves
    goes_on = spans.next_state(beyond)
    found: Flags = comes & ((goes_on >= spans.end) | (spans.next_state(stands | beyond) < goes_on))
    return found


def around_crossing(
    context: DriveContext, front: Floats, line: tuple[float, float]
) -> Callable[[int], range | None]:
    """A function from a state in which ego is beyond a line to the states around its crossing.

    Ego crosses between the states before and after, at its average speed in between; closer to one
    of them than ``_AT_ONCE_S``, it crosses in that state. Where the line lies between two places,
    all states from the first place on count, or from where ego last stood beyond it. None if its
    drive begins between these two: it may have crossed the line before.
    """
    first, last = line
    stands = ~context.ego_moves
    latest = context.spans.latest(passes(context, first) | (stands & (front > first)))
    since = np.where(latest < context.spans.first, context.spans.columns, latest)
    began = front[context.spans.first]
    at_once = _AT_ONCE_S / context.recording.step_s

    def when(state: int, place: float) -> float:
        before, after = front[state - 1], front[state]
        if state == context.spans.first[state] or not before <= place < after:
            return float(state)  # it stood there, or was there from the start
        return state - float((after - place) / (after - before))

    def around(state: int) -> range | None:
        if latest[state] < context.spans.first[state] and began[state] > first:
            return None
        begin, end = when(int(since[state]), first), when(state, last)
        begins = round(begin) if abs(round(begin) - begin) <= at_once else floor(begin)
        ends = round(end) if abs(round(end) - end) <= at_once else ceil(end)
        return range(begins, ends + 1)

    return around


@once_a_road
def drawn_lines(context: DriveContext) -> dict[tuple[int, str], float]:
    """The places along the road of the stop lines that the map has, by piece and lanelet.

    Only near the end of the lanelet: a road may come by again, or lead twice along the same one.
    """
    road = context.road
    drawn = {
        (piece, lanelet.id): lanelet.stop_line.mean(axis=0)
        for piece, row in enumerate(road.rows)
        for lanelet in row
        if lanelet is not None and lanelet.stop_line is not None
    }
    ends = np.array([road.borders[piece + 1] for piece, _ in drawn], dtype=float)
    reach = np.full(len(drawn), LINE_REACH_M)
    middles = np.reshape([*drawn.values()], (-1, 2))
    places = road.line.coordinates_near(middles, ends, reach)[:, 0]
    return dict(zip(drawn, places.tolist(), strict=True))


def _ends_at_line(context: DriveContext, piece: int, lane: int) -> bool:
    """Whether a lanelet has a stop sign or a light, and these stand at its end.

    The map may have cut a lane in pieces and state for each what holds on it: the line is at the
    end of the last piece, unless one is drawn before.
    """
    road = context.road
    own = road.lanelet(piece, lane)
    if not has_line(own):
        return False
    end = float(road.borders[piece + 1])
    if own.stop_line is not None or piece + 1 == len(road.rows):
        return True
    following = road.lanelet(piece + 1, lane)
    same = (own.signs & STOP_SIGNS, own.lights) == (following.signs & STOP_SIGNS, following.lights)
    at_junction = any(low - _HAIR <= end < high for low, high in road.junctions)
    return at_junction or not same or following.id not in own.successors


def has_line(lanelet: Lanelet) -> bool:
    """Whether vehicles may have to stop at a lanelet's end."""
    return bool(lanelet.lights or lanelet.lights_to or STOP_SIGNS & lanelet.signs)


@once_a_road
def stop_line(context: DriveContext, piece: int, lane: int) -> tuple[float, float]:
    """The places along the road between which the line of a lanelet is.

    A vehicle beyond a line by less than ``touching_m`` stands at it. Where the map has no line, it
    is between the lanelet's end and the first place in the junction beyond where other ways cross
    or join ego's, if they do before that junction ends and within ``LINE_REACH_M``.
    """
    lanelet, road = context.road.lanelet(piece, lane), context.road
    end, touching = float(road.borders[piece + 1]), context.thresholds.touching_m
    if lanelet.stop_line is not None:
        place = drawn_lines(context)[piece, lanelet.id]
        if abs(place - end) <= LINE_REACH_M:
            return place, place + touching
    begins, passages = 0.0, context.surroundings.passages
    ends = [high for low, high in road.junctions if low <= end + LINE_REACH_M and high > end]
    edge = None
    for further in range(piece + 1, len(road.rows)):
        begins = float(road.borders[further])
        if begins - end > LINE_REACH_M or (ends and begins >= ends[0]):
            break  # no way crosses there, as where two roads meet in a corner
        edge = passages.first_meeting(road.lanelet(further, lane).id)
        if edge is not None:
            break
    if edge is None:
        return end, end + touching
    return end, max(min(begins + edge, end + LINE_REACH_M), end + touching)
