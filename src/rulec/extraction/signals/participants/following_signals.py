"""Following: for how long others have been ahead, and whether ego keeps its distance from them.

Where the tolerance of places decides whether a vehicle is in ego's lane, the time began some time
in between. A vehicle that came into the lane before it was first seen needed some time to get where
it is now. If it moves sideways at ``v`` after ``d`` from where it began to be ahead in the lane,
and its lateral deceleration is at most ``cutting_in_mps2`` (``a``), it took at least ``(sqrt(v² +
2ad) - v) / a``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.presences import in_presences
from rulec.extraction.signals import relations
from rulec.extraction.signals.measured_numbers import LONGEST_S, safe_distances
from rulec.extraction.signals.signal_columns import Measured, rounded, rounded_outward
from rulec.extraction.signals.words import word_of_objects
from rulec.extraction.tracks.driven_road import reach_into
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.cells import Cells
from rulec.trace.end_to_end import EndToEnd
from rulec.trace.partly_known.partly_known_values import Truth

_AWAY_MPS = 0.3

_DRIFT_MPS = 0.2
"""A vehicle with a lower lateral speed keeps its lane."""

_MOVES_OFF_MPS2 = 1.0
"""Roughly the greatest lateral acceleration in a change of lanes."""

_BRIEF_S = 1.0

_OUTLIERS = 3.0
"""Places are wrong by this many tolerances now and then, but not for ``_BRIEF_S``."""

_HAIR_S = 1e-6


@word_of_objects("ahead_for")
def _ahead_for(context: DriveContext) -> Measured:
    """Times (s) for which ego has been behind others in the same lane, with their bounds."""
    surely = relations.ahead_in_lane(context).sure
    cells, step_s = relations.possibly_ahead(context), context.recording.step_s
    since, seen = _since(context, cells)
    most = np.where(seen, (cells.columns - since + 1) * step_s, LONGEST_S)
    sure = surely.take(cells.places).nonzero()[0]
    own, least = cells.part(sure), np.zeros(len(cells))
    since, seen = _since(context, own)
    times = (own.columns - since) * step_s
    # All states of a run share the time before its first state
    appears = (~seen).nonzero()[0]
    first = appears[since[appears] == own.columns[appears]]
    earlier = _before(context, own.part(first))
    run = (since[appears] == own.columns[appears]).cumsum() - 1
    times[appears] += earlier[run]
    least[sure] = np.minimum(times, LONGEST_S)
    ends = rounded_outward(least, np.maximum(least, most))
    measured, low, high = (
        in_presences(context, cells, own, 0.0) for own in (rounded(least), *ends)
    )
    return Measured(measured, bounds=(low, high))


def _since(context: DriveContext, cells: Cells) -> tuple[NDArray[intp], Flags]:
    """The first states of runs of cells, and whether the participant was seen just before."""
    spans, begins = context.spans, (np.diff(cells.places, prepend=-2) > 1)
    begins |= spans.begins_here[cells.columns]
    since = cells.columns[begins][begins.cumsum() - 1]
    before = context.relevant.take(cells.places - (cells.columns - since) - 1, mode="clip")
    return since, (since > spans.first[since]) & before


def _before(context: DriveContext, cells: Cells) -> Floats:
    """The least time (s) that others had been ahead when first seen, by their lateral places."""
    limits, own, others = context.thresholds, context.ego_extents, context.extents
    rows, states, reach = cells.rows, cells.columns, limits.touching_m
    right = context.ego_lane
    left = right + 1
    (low, high), (low_r, high_r) = others.cells_from_bounds(cells, left, right)
    from_left = np.maximum(own.left_of_max[0, states, left[states]] - low, -high) + reach
    inside = np.minimum(-low - reach, from_left)
    from_right = np.maximum(high_r - own.left_of_min[0, states, right[states]], low_r) + reach
    inside = np.minimum(inside, np.minimum(high_r - reach, from_right))
    way = np.fmax(inside - context.tolerances.place_m, 0.0)
    across = others.across[rows, states]
    speed = np.maximum(np.abs(across), np.abs(across - own.across[0, states]))
    speed = np.fmax(speed, 0.0) + np.fmax(context.tracks.speed_error[rows, states], 0.0)
    slows = limits.cutting_in_mps2
    time: Floats = (np.sqrt(speed**2 + 2 * slows * way) - speed) / slows
    return time


@once
def parts_soon(context: DriveContext) -> Flags:
    """Mask of participants ahead in ego's lane that are in another lane within ``parting_s``.

    Or that may be clear of ego at its side by then, as on a broad lane; or that are lost from sight
    before, and move aside at ``_AWAY_MPS``, or away from ego at that speed when last seen, so that
    both may be clear of each other by then; if ego closes in, ``_DRIFT_MPS`` away from it is
    enough, where a change of lanes may clear them. Where ways part in a junction, ego is not clear
    of a participant that stops before that. Includes participants that reverse: they come, and ego
    stands or waits behind them.
    """
    follows = relations.ahead_in_lane(context).possible
    horizon = context.steps_in(context.thresholds.parting_s)
    at, spans = Cells.of_drives(follows, context.spans)
    seen, way_across = at.of(context.relevant), at.of(relations.way_across(context))
    apart = at.of(context.extents.lane) != at.of(context.ego_extents.lane[0])
    apart |= way_across > context.thresholds.touching_m - context.tolerances.place_m
    apart &= seen
    until = spans.columns + horizon
    inside = _in_junctions(context, at)
    parts = spans.within(apart & ~inside, horizon)
    stopped = until
    if inside.any():
        stopped = _would_stand(context, at, spans)
        parts |= spans.next_state(apart & inside, horizon) <= np.minimum(stopped, until)
    gone = spans.next_state(~seen)
    last = np.minimum(np.maximum(gone - 1, spans.first), spans.end - 1)
    lost = seen & (gone <= np.minimum(np.where(inside[last], stopped, until), until))
    asked = (~parts & lost & at.of(follows)).nonzero()[0]
    since = last.take(asked)
    left = until.take(asked) - since
    parts[asked] = _go_aside(context, at.part(asked), at.part(since), left)
    parts |= _back(context, at)
    found: Flags = follows & at.laid(parts)
    return found


def _back(context: DriveContext, cells: Cells) -> Flags:
    """Mask of cells of participants that surely move against ego's way."""
    slowest = -cells.of(context.extents.along) - cells.of(context.tracks.speed_error)
    back: Flags = slowest * KMH_PER_MPS >= context.thresholds.standing_kmh
    return back


def _go_aside(context: DriveContext, cells: Cells, seen_last: Cells, left: NDArray[intp]) -> Flags:
    """Mask of cells whose participant moves aside, so that ego may be clear of it later.

    ``seen_last`` are the cells in which it is last seen, ``left`` the states from then on.
    """
    limits, known, others = context.thresholds, context.tolerances, context.extents
    own = context.ego_extents
    left_s = left * context.recording.step_s
    aside = cells.of(others.across) * _side(context, cells) >= _AWAY_MPS
    across = seen_last.of(others.across) - seen_last.of(own.across[0])
    away, still = across * _side(context, seen_last), seen_last.of(relations.way_across(context))
    clear = still + away * left_s
    aside |= (away >= _AWAY_MPS) & (clear > -known.place_m)
    faster = seen_last.of(own.along[0]) - seen_last.of(others.along)
    moved = clear + _MOVES_OFF_MPS2 / 2 * left_s**2
    swings = (faster > known.speed_mps) & (away > _DRIFT_MPS) & (moved > limits.touching_m)
    found: Flags = aside | swings
    return found


def _side(context: DriveContext, cells: Cells) -> Floats:
    """1 where others are left of ego, -1 where they are right of it."""
    others, own = context.extents, context.ego_extents
    theirs, egos = cells.of(others.d_min) + cells.of(others.d_max), own.d_min[0] + own.d_max[0]
    side: Floats = np.sign(theirs - cells.of(egos))
    return side


@word_of_objects("parts_soon")
def may_part(context: DriveContext) -> Truth:
    """Unknown for participants ahead in ego's lane that leave it soon, False for all others.

    No law says how near they may be by then.
    """
    parts = parts_soon(context)
    return Truth(parts & False, parts)


def _in_junctions(context: DriveContext, cells: Cells) -> Flags:
    """Mask of bodies in the junctions of ego's road."""
    extents = context.extents
    return reach_into(context.road.junctions, cells.of(extents.s_min), cells.of(extents.s_max))


def _would_stand(context: DriveContext, at: Cells, spans: EndToEnd) -> NDArray[intp]:
    """The state in which others reach the place where they would stop, braking from now on.

    One past the last state where they do not reach it while they are seen.
    """
    tracks = context.tracks
    x, y = at.of(tracks.x), at.of(tracks.y)
    fastest = np.nan_to_num(at.of(tracks.speed) + at.of(tracks.speed_error))
    braking = fastest**2 / (2 * context.thresholds.braking_mps2)

    def of_pair(own: slice) -> NDArray[intp]:
        steps = np.nan_to_num(np.hypot(np.diff(x[own]), np.diff(y[own])))
        ways = np.append(0.0, steps.cumsum())
        states: NDArray[intp] = ways.searchsorted(ways + braking[own]) + own.start
        return states

    stands: NDArray[intp] = np.maximum(spans.each(of_pair), spans.columns)
    return stands


@word_of_objects("safe_gap")
def keeps_safe_gap(context: DriveContext) -> Truth:
    """Whether ego keeps its distance from participants that are, or may be, ahead in its lane.

    Unknown for a participant that already stood ``reaction_s`` ago if ego can stop behind it: ego
    has seen it stand, and need not react first. Unknown, too, where the distance is too short for
    less than ``_BRIEF_S`` and by at most ``_OUTLIERS`` tolerances, which may be an error of boxes.
    """
    known, limits, followed = context.tolerances, context.thresholds, safe_gaps(context)
    short = followed.safe - followed.gap
    wrong = known.joint(followed.safe_error, known.place_m)
    # Elsewhere the distance is long enough for any participant
    perhaps_short = (short > -wrong).nonzero()[0]
    short, wrong = short.take(perhaps_short), wrong.take(perhaps_short)
    cells = followed.cells.part(perhaps_short)
    stands = cells.of(context.standing)
    # A standing participant that ego drives past does not drive ahead of it
    aside = cells.of(relations.way_across(context)) - limits.touching_m
    room = np.where(stands, aside, -np.inf)
    moot, follows = np.abs(room) < known.place_m, room <= 0
    asked = follows.nonzero()[0]
    moot[asked] |= _need_not_follow(context, cells.part(asked), short.take(asked))
    late = (follows & (short >= wrong)).nonzero()[0]
    far_too_late = short.take(late) > _OUTLIERS * wrong.take(late)
    moot[late] |= _brief_and_slight(context, cells.part(late), far_too_late)
    doubtful = cells.laid((follows & (np.abs(short) < wrong)) | moot)
    return Truth.known(cells.laid(~follows | (short <= 0), True)).unknown_at(doubtful)


def _need_not_follow(context: DriveContext, cells: Cells, short: Floats) -> Flags:
    """Mask of cells whose participant parts soon, or has stood long enough to have been seen.

    ``short`` is by how much (m) the distance is too short if ego reacts first.
    """
    speed = np.maximum(context.ego_extents.along[0], 0.0)
    react_m = cells.of(speed) * context.thresholds.reaction_s
    moot: Flags = cells.of(parts_soon(context))
    asked = (~moot & (short - react_m <= 0)).nonzero()[0]
    moot[asked] = _stood_before(context, cells.part(asked))
    return moot


def _brief_and_slight(context: DriveContext, late: Cells, far_too_late: Flags) -> Flags:
    """Mask of cells where ego is too close only in short runs, and never far too close.

    A short run lasts for less than ``_BRIEF_S``.
    """
    if not len(late):
        return far_too_late
    is_first = np.diff(late.places, prepend=-2) > 1
    is_first |= context.spans.begins_here.take(late.columns)
    begins = is_first.nonzero()[0]
    lengths = np.concatenate((begins[1:], (len(late),))) - begins
    brief = lengths * context.recording.step_s < _BRIEF_S - _HAIR_S
    slight = ~np.logical_or.reduceat(far_too_late, begins)
    return (brief & slight).repeat(lengths)


def _stood_before(context: DriveContext, cells: Cells) -> Flags:
    """Mask of cells of participants that stand, and did for ``reaction_s`` or since first seen."""
    rows = np.unique(cells.rows)
    stands = context.standing[rows]
    steps = context.steps_in(context.thresholds.reaction_s)
    moves_there = ~stands & ~np.isnan(context.extents.s_min[rows])
    stood = stands & ~context.spans.within_last(moves_there, steps)
    found: Flags = stood[rows.searchsorted(cells.rows), cells.columns]
    return found


@dataclass(frozen=True, eq=False, slots=True)
class SafeGaps:
    """The distances (m) that ``safe_gap`` compares, by cell of participants that ego may follow.

    ``safe_error`` covers both distances, except for the places' own error.
    """

    cells: Cells
    gap: Floats
    safe: Floats
    safe_error: Floats


@once
def safe_gaps(context: DriveContext) -> SafeGaps:
    """The distances that ``safe_gap`` compares."""
    cells = relations.possibly_ahead(context)
    gap, (safe, error) = cells.of(relations.gap(context)), safe_distances(context, cells)
    scale = np.maximum(cells.of(context.ego.scale_error[0]), cells.of(context.tracks.scale_error))
    return SafeGaps(cells, gap, safe, error + scale * np.abs(gap))
