"""Following: for how long others have been ahead, and whether ego keeps its distance from them.

Where the tolerance of places decides who is in ego's lane, the time began some time in between. Who
came into the lane before anybody saw it needed some time to get where it is now. If it moves
sideways at ``v`` after ``d`` from where it began to be ahead in the lane, and nobody slows down
sideways by more than ``cutting_in_mps2`` (``a``), it took ``(sqrt(v² + 2ad) - v) / a`` at least.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext, PairStates, once, pair_states
from rulec.extraction.signals import relations
from rulec.extraction.signals.measured_numbers import LONGEST_S, safe_distance, safe_distance_error
from rulec.extraction.signals.signal_columns import (
    SignalColumns,
    SignalNames,
    rounded,
    rounded_outward,
)
from rulec.extraction.signals.signal_passes import Passes, signals_by
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.trace.cells import Cells
from rulec.trace.plain_arrays import distinct

_AWAY_MPS = 0.3

_DRIFT_MPS = 0.2
"""Who moves sideways by less keeps its lane."""

_MOVES_OFF_MPS2 = 1.0
"""Who changes lanes gains speed sideways so hard at most, about."""

_BRIEF_S = 1.0

_OUTLIERS = 3.0
"""So many tolerances off are places now and then, but not for ``_BRIEF_S``."""

_HAIR_S = 1e-6


def following_signals(context: DriveContext, names: SignalNames = None) -> SignalColumns:
    """The signal of times behind others, if it is named."""
    return signals_by(_PASSES, context, names)


def _ahead_for(context: DriveContext) -> SignalColumns:
    """Times (s) for which ego has been behind others in one lane, with their bounds."""
    _, surely, perhaps = relations.ahead_in_lane(context)
    cells, step_s = Cells.at(perhaps), context.recording.step_s
    since, seen = _since(context, cells)
    most = np.where(seen, (cells.columns - since + 1) * step_s, LONGEST_S)
    sure = np.flatnonzero(surely.ravel().take(cells.places))
    own, least = cells.part(sure), np.zeros(len(cells))
    since, seen = _since(context, own)
    times = (own.columns - since) * step_s
    # For all of a run it is that of its first state
    appears = np.flatnonzero(~seen)
    first = appears[since[appears] == own.columns[appears]]
    earlier = _before(context, own.part(first))
    run = np.cumsum(since[appears] == own.columns[appears]) - 1
    times[appears] += earlier[run]
    least[sure] = np.minimum(times, LONGEST_S)
    low, high = rounded_outward(least, np.maximum(least, most))
    return SignalColumns(
        about={"ahead_for": cells.laid(rounded(least))},
        bounds={"ahead_for": (cells.laid(low), cells.laid(high))},
    )


def _since(context: DriveContext, cells: Cells) -> tuple[NDArray[intp], Flags]:
    """The states in which runs of cells began, and was one seen the state before?"""
    spans, begins = context.spans, np.diff(cells.places, prepend=-1) > 1
    begins |= spans.begins_here[cells.columns]
    since = cells.columns[begins][np.cumsum(begins) - 1]
    before = context.relevant.ravel().take(cells.places - (cells.columns - since) - 1, mode="clip")
    return since, (since > spans.first[since]) & before


def _before(context: DriveContext, cells: Cells) -> Floats:
    """How long (s) others were ahead at least when first seen, by where they were across."""
    limits, own, others = context.thresholds, context.ego_extents, context.extents
    rows, states, reach = cells.rows, cells.columns, limits.touching_m
    right = context.ego_lane
    left = right + 1
    low, high = others.cells_from_bound(cells, left)
    from_left = np.maximum(own.left_of_max[0, states, left[states]] - low, -high) + reach
    inside = np.minimum(-low - reach, from_left)
    low, high = others.cells_from_bound(cells, right)
    from_right = np.maximum(high - own.left_of_min[0, states, right[states]], low) + reach
    inside = np.minimum(inside, np.minimum(high - reach, from_right))
    way = np.nan_to_num(np.maximum(inside - context.tolerances.place_m, 0.0))
    across = others.across[rows, states]
    speed = np.maximum(np.abs(across), np.abs(across - own.across[0, states]))
    speed = np.nan_to_num(speed) + np.nan_to_num(context.tracks.speed_error[rows, states])
    slows = limits.cutting_in_mps2
    time: Floats = (np.sqrt(speed**2 + 2 * slows * way) - speed) / slows
    return time


@once
def parts_soon(context: DriveContext) -> Flags:
    """Flags of those ahead in ego's lane whose lane is not ego's within ``parting_s``.

    Or who are clear of ego at its side then, as on a broad lane; or who are lost from sight before,
    and go aside by ``_AWAY_MPS``, or do so from each other when they are seen last, such that they
    may be clear of each other then; if ego closes in on them, also where they go aside by
    ``_DRIFT_MPS``, and a change of lanes may have them clear. Where ways part in a junction nobody
    is clear of one that stops before.
    """
    _, _, follows = relations.ahead_in_lane(context)
    cells = follows.nonzero()
    horizon = round(context.thresholds.parting_s / context.recording.step_s)
    (pairs, places), others, own = pair_states(context, cells), context.extents, context.ego_extents
    spans, at, columns = pairs.spans, (pairs.rows, pairs.columns), pairs.columns
    seen, way_across = context.relevant[at], relations.way_across(context)[at]
    apart = others.lane[at] != own.lane[0, columns]
    apart |= way_across > context.thresholds.touching_m
    apart &= seen
    until = spans.columns + horizon
    inside = _in_junctions(context, pairs)
    parts = spans.within(apart & ~inside, horizon)
    stopped = until
    if inside.any():
        stopped = _would_stand(context, pairs)
        parts |= spans.next_state(apart & inside, horizon) <= np.minimum(stopped, until)
    middles = others.d_min[at] + others.d_max[at], own.d_min[0, columns] + own.d_max[0, columns]
    side = np.sign(middles[0] - middles[1])
    gone = spans.next_state(~seen)
    last = np.clip(gone - 1, spans.first, spans.end - 1)
    away = ((others.across[at] - own.across[0, columns]) * side)[last]
    still, left_s = way_across[last], (until - last) * context.recording.step_s
    swings_out = (away >= _AWAY_MPS) & (still + away * left_s > -context.tolerances.place_m)
    closes_in = (own.along[0, columns] - others.along[at])[last] > context.tolerances.speed_mps
    moved = still + away * left_s + _MOVES_OFF_MPS2 / 2 * left_s**2
    swings_out |= closes_in & (away > _DRIFT_MPS) & (moved > context.thresholds.touching_m)
    lost = gone <= np.minimum(np.where(inside[last], stopped, until), until)
    parts |= seen & lost & ((others.across[at] * side >= _AWAY_MPS) | swings_out)
    found = np.zeros(context.relevant.shape, dtype=bool)
    found[cells] = parts[places]
    return found


def may_part(context: DriveContext) -> SignalColumns:
    """Unknown of those ahead in ego's lane who are on another one soon, and False of all others.

    No law says how near they may be by then.
    """
    unknown = parts_soon(context)
    return SignalColumns(
        about={"parts_soon": np.zeros_like(unknown)}, unknown={"parts_soon": unknown}
    )


def _in_junctions(context: DriveContext, pairs: PairStates) -> Flags:
    """Flags of bodies in the junctions of ego's road."""
    inside, at = np.zeros(len(pairs.rows), dtype=bool), (pairs.rows, pairs.columns)
    for start, end in context.road.junctions:
        inside |= (context.extents.s_max[at] >= start) & (context.extents.s_min[at] < end)
    return inside


def _would_stand(context: DriveContext, pairs: PairStates) -> NDArray[intp]:
    """The state in which they get to where they would stop, did they brake from now on.

    One past the last where they do not get there while they are seen.
    """
    tracks, at, spans = context.tracks, (pairs.rows, pairs.columns), pairs.spans
    x, y = tracks.x[at], tracks.y[at]
    fastest = np.nan_to_num(tracks.speed[at] + tracks.speed_error[at])
    braking = fastest**2 / (2 * context.thresholds.braking_mps2)

    def of_pair(own: slice) -> NDArray[intp]:
        steps = np.nan_to_num(np.hypot(np.diff(x[own]), np.diff(y[own])))
        ways = np.append(0.0, steps.cumsum())
        states: NDArray[intp] = np.searchsorted(ways, ways + braking[own]) + own.start
        return states

    stands: NDArray[intp] = np.maximum(spans.each(of_pair), spans.columns)
    return stands


def keeps_safe_gap(context: DriveContext) -> SignalColumns:
    """Whether ego keeps its distance from who is, or may be, ahead in its lane.

    Unknown of one that stood ``reaction_s`` ago already, if ego can stop behind it: it has seen it
    stand, and need not react first. And where it is too short for less than ``_BRIEF_S``, and by no
    more than ``_OUTLIERS`` tolerances: that may be what boxes err.
    """
    place, limits, followed = context.tolerances.place_m, context.thresholds, safe_gaps(context)
    short, wrong = followed.safe - followed.gap, np.hypot(followed.safe_error, place)
    # Elsewhere the distance is long enough, whoever that is
    perhaps_short = np.flatnonzero(short > -wrong)
    short, wrong = short.take(perhaps_short), wrong.take(perhaps_short)
    rows, states = (places.take(perhaps_short) for places in followed.cells)
    cells = rows, states
    stands = context.tracks.speed[cells] * KMH < limits.standing_kmh
    # One that stands, and that ego drives by, does not drive ahead
    aside = relations.way_across(context)[cells] - limits.touching_m
    room = np.where(stands, aside, -np.inf)
    moot, follows = np.abs(room) < place, room <= 0
    asked = np.flatnonzero(follows)
    moot[asked] |= _need_not_follow(context, (rows[asked], states[asked]), short[asked])
    shape = context.relevant.shape
    safe, unknown = np.ones(shape, dtype=bool), np.zeros(shape, dtype=bool)
    safe[cells] = ~follows | (short <= 0)
    unknown[cells] = (follows & (np.abs(short) < wrong)) | moot
    late, far_too_late = np.zeros((2, *shape), dtype=bool)
    late[cells] = follows & (short >= wrong)
    far_too_late[cells] = follows & (short > _OUTLIERS * wrong)
    unknown |= _brief_and_slight(context, late, far_too_late)
    return SignalColumns(about={"safe_gap": safe}, unknown={"safe_gap": unknown})


def _need_not_follow(
    context: DriveContext, cells: tuple[NDArray[intp], ...], short: Floats
) -> Flags:
    """Flags of cells in which who is ahead parts soon, or has stood for long enough to be seen.

    ``short`` is by how much (m) the distance is too short if ego reacts first.
    """
    speed = np.maximum(context.ego_extents.along[0], 0.0)
    react_m = speed[cells[1]] * context.thresholds.reaction_s
    stood = _stood_before(context, distinct(cells[0]))[cells]
    moot: Flags = parts_soon(context)[cells] | (stood & (short - react_m <= 0))
    return moot


def _brief_and_slight(context: DriveContext, late: Flags, far_too_late: Flags) -> Flags:
    """Flags of runs of late states that last for less than ``_BRIEF_S`` and are nowhere far too."""
    places = np.flatnonzero(late)
    if not len(places):
        return late
    is_first = np.diff(places, prepend=-1) > 1
    is_first |= context.spans.begins_here.take(places % context.states)
    begins = np.flatnonzero(is_first)
    lengths = np.diff(begins, append=len(places))
    brief = lengths * context.recording.step_s < _BRIEF_S - _HAIR_S
    slight = ~np.logical_or.reduceat(far_too_late.ravel().take(places), begins)
    found = np.zeros_like(late)
    found.ravel()[places] = np.repeat(brief & slight, lengths)
    return found


def _stood_before(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Flags of those who stand, and have for ``reaction_s`` or since they were seen first.

    Of these rows, False in all others.
    """
    stands = context.tracks.speed[rows] * KMH < context.thresholds.standing_kmh
    steps = round(context.thresholds.reaction_s / context.recording.step_s)
    spans, stood = context.spans, np.zeros(context.relevant.shape, dtype=bool)
    moves_there = ~stands & ~np.isnan(context.extents.s_min[rows])
    stood[rows] = stands & ~spans.within_last(moves_there, steps)
    return stood


@dataclass(frozen=True, eq=False, slots=True)
class SafeGaps:
    """The distances (m) that ``safe_gap`` compares: where ego may follow, rows and states."""

    cells: tuple[NDArray[intp], ...]
    gap: Floats
    safe: Floats
    safe_error: Floats


@once
def safe_gaps(context: DriveContext) -> SafeGaps:
    """The distances that ``safe_gap`` compares."""
    _, _, follows = relations.ahead_in_lane(context)
    cells = follows.nonzero()
    safe, error = safe_distance(context, cells), safe_distance_error(context, cells)
    return SafeGaps(cells, relations.gap(context)[cells], safe, error)


_PASSES: Passes = {("ahead_for",): _ahead_for}
