"""Signals of other participants: ego's relations to them, gaps and speeds, and what they do."""

from __future__ import annotations

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.presences import in_presences, presence_cells, presence_runs
from rulec.extraction.signals import relations
from rulec.extraction.signals.lateral_gaps import lateral_gaps
from rulec.extraction.signals.measured_numbers import (
    LONGEST_S,
    difference_bounds,
    gaps,
    headway_bounds,
    own_speed,
    speed_differences,
)
from rulec.extraction.signals.participants.participant_conduct import (
    comes_towards,
)
from rulec.extraction.signals.settling import only_when, with_one_change
from rulec.extraction.signals.signal_columns import (
    Measured,
    rounded,
    rounded_outward,
)
from rulec.extraction.signals.words import word_of_objects
from rulec.scenario.paper_words import LATERALS, STATIONS
from rulec.trace.partly_known.partly_known_values import Truth

_ASKED_FOR_M = 3.0
"""No law requires more room between a vehicle and a cycle, or people in the road."""


@word_of_objects("position")
def _position(context: DriveContext) -> Measured:
    """The paper's positions; unknown, like stations, for participants at ego's side at first."""
    position = relations.position(context)
    at_side = (position == "l") | (position == "r")
    return Measured(position, _at_first(context) & at_side)


@word_of_objects("station")
def _station(context: DriveContext) -> Measured:
    """The stations; unknown within the tolerance of places, except while ego or the other passes.

    There only the moment is in doubt, unless passing takes longer than ``passed_s``. Unknown, too,
    for cycles and people that were never seen beside ego while it went past them, and for
    participants beside it in their first state: ego may have come up from behind.
    """
    station, others = relations.station(context), relations.possible_stations(context)
    doubtful = np.logical_or.reduce([station != codes for codes in others])
    there = context.relevant & ~np.isnan(context.extents.s_min)
    longest = context.steps_in(context.thresholds.passed_s)
    station = with_one_change(station, doubtful, there, context.spans)
    doubtful &= ~only_when(station, doubtful, there, longest, context.spans)
    beside = _at_first(context) & (relations.station(context) == relations.BESIDE)
    return Measured(station, doubtful | _passed_unseen(context) | beside, texts=STATIONS)


@once
def _at_first(context: DriveContext) -> Flags:
    """Mask of others' first states in a drive, if they were not recorded just before."""
    runs, spans, first = presence_runs(context), context.spans, np.zeros_like(context.relevant)
    rows, columns = runs.rows, spans.begins[runs.drives] + runs.first
    present = context.surroundings.tracks.present
    before = np.maximum(context.columns[columns] - 1, 0)
    unseen = ~present[context.tracks.rows[rows], before] | (columns == spans.first[columns])
    first[rows[unseen], columns[unseen]] = True
    return first


def _passed_unseen(context: DriveContext) -> Flags:
    """Mask of cycles and people near ego's side that it passed from one state to the next.

    Set in both states: how near ego was while beside them lies in between.
    """
    passed, spans = np.zeros(context.relevant.shape, dtype=bool), context.spans
    rows = context.tracks.of_type("vulnerable_user").nonzero()[0]
    if not len(rows):
        return passed
    station = relations.station(context)[rows]
    near = (relations.way_across(context)[rows] < _ASKED_FOR_M) & context.relevant[rows]
    ahead = near & (station == relations.BEHIND)
    past = near & (station == relations.IN_FRONT_OF)
    comes = past & spans.before(ahead)
    passed[rows] = comes | (ahead & spans.after(comes))
    return passed


@word_of_objects("lateral")
def _lateral(context: DriveContext) -> Measured:
    """The sides of others; unknown within tolerances, except while ego or the other moves over.

    There only the moment is in doubt, as with stations.
    """
    laterals = relations.laterals(context)
    there = context.relevant & ~np.isnan(context.extents.s_min)
    longest = context.steps_in(context.thresholds.passed_s)
    codes = with_one_change(laterals.codes, laterals.doubtful, there, context.spans)
    over = only_when(codes, laterals.doubtful, there, longest, context.spans)
    return Measured(codes, laterals.doubtful & ~over, texts=LATERALS)


@word_of_objects("gap")
def _gap(context: DriveContext) -> Measured:
    gap, least, most = gaps(context)
    return Measured(rounded(gap), bounds=rounded_outward(least, most))


@word_of_objects("time_headway")
def _time_headway(context: DriveContext) -> Measured:
    # The speed that the word `speed` has
    cells = presence_cells(context)
    speed, drives = cells.of(own_speed(context)[0]), cells.of(context.ego_moves)
    seconds = gaps(context)[0] / np.where(drives, speed, 1.0)
    headway = np.where(drives, np.minimum(seconds, LONGEST_S), LONGEST_S)
    return Measured(rounded(headway), bounds=headway_bounds(context))


@word_of_objects("lateral_gap")
def _lateral_gap(context: DriveContext) -> Measured:
    gap, bounds = lateral_gaps(context)
    return Measured(rounded(gap), bounds=bounds)


@word_of_objects("speed_difference")
def _speed_difference(context: DriveContext) -> Measured:
    difference, _ = speed_differences(context)
    return Measured(rounded(difference), bounds=difference_bounds(context))


@word_of_objects("time_to_collision")
def _time_to_collision(context: DriveContext) -> Measured:
    """The time (s) in which ego reaches participants ahead in its lane, at both current speeds."""
    measured, ahead = relations.measured_ahead(context), relations.ahead_in_lane(context)
    # Ego runs into no other participants
    cells, place = relations.possibly_ahead(context), context.tolerances.place_m
    closing = cells.of(context.ego_extents.along[0]) - cells.of(context.extents.along)
    errors = context.ego.speed_error[0], context.tracks.speed_error
    wrong = context.tolerances.joint(*map(cells.of, errors))
    way = cells.of(relations.way_along(context))

    def seconds(counts: Flags, more_m: float, faster: Floats) -> Floats:
        runs_into = cells.of(counts) & (faster > 0)
        taken = np.maximum(way + more_m, 0.0) / np.where(runs_into, faster, 1.0)
        return np.where(runs_into, np.minimum(taken, LONGEST_S), LONGEST_S)

    seconds_measured = rounded(seconds(measured, 0.0, closing))
    soonest = seconds(ahead.possible, -place, closing + wrong)
    latest_s = seconds(ahead.sure, place, closing - wrong)
    found, low, high = (
        in_presences(context, cells, own, LONGEST_S)
        for own in (seconds_measured, *rounded_outward(soonest, latest_s))
    )
    return Measured(found, bounds=(low, high))


@word_of_objects("precedes")
def _precedes(context: DriveContext) -> Flags:
    """The participant next ahead of ego in its lane."""
    cells = relations.possibly_ahead(context)
    counts = (
        cells.of(relations.measured_ahead(context))
        & ~cells.of(comes_towards(context))
        & cells.of(context.relevant)
    )
    ahead = cells.part(counts.nonzero()[0])
    gap = ahead.of(relations.gap(context))
    return ahead.laid(gap == ahead.of(ahead.least(gap)))


@word_of_objects("one_between")
def _one_between(context: DriveContext) -> Truth:
    """Whether another vehicle ahead in ego's lane is nearer to ego than a participant ahead.

    It is if it is nearer by more than the tolerance of places, and unknown within that.
    """
    surely, cells = relations.ahead_in_lane(context).sure, relations.possibly_ahead(context)
    drives = context.tracks.of_type("vehicle")[cells.rows] & ~cells.of(comes_towards(context))
    gap, place = cells.of(relations.gap(context)), context.tolerances.place_m
    nearest, nearest_of_all = (
        cells.of(cells.part(ahead).least(gap.take(ahead)))
        for ahead in ((cells.of(surely) & drives).nonzero()[0], drives.nonzero()[0])
    )
    between = gap > nearest + place
    possible = between | ((gap > nearest_of_all - place) & (gap > nearest_of_all))
    return Truth(cells.laid(between), cells.laid(possible))
