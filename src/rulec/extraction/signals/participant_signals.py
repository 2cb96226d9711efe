"""Signals of other participants: relations, gaps, speeds, oncoming and standing ones."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext, once
from rulec.extraction.presences import in_presences, presence_cells, presence_runs
from rulec.extraction.recording_parts import span_of
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_lanelets import (
    CYCLE_LANE,
    SHOULDER,
    map_contents,
    those_on_lanes,
)
from rulec.extraction.signals.following_signals import keeps_safe_gap, may_part
from rulec.extraction.signals.intention_signals import may_have_broken_down
from rulec.extraction.signals.map.lanes_ahead import leads_elsewhere
from rulec.extraction.signals.measured_numbers import (
    LONGEST_S,
    difference_bounds,
    gap_bounds,
    gaps,
    headway_bounds,
    lateral_gap_bounds,
    moves,
    own_speed,
    speed_differences,
)
from rulec.extraction.signals.settling import only_when, with_one_change
from rulec.extraction.signals.signal_columns import (
    Bounds,
    SignalColumns,
    rounded,
    rounded_outward,
)
from rulec.extraction.signals.signal_passes import SignalPasses
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.scenario.paper_words import LATERALS, STATIONS
from rulec.trace.cells import Cells
from rulec.trace.plain_arrays import distinct

_ALONG = 0.5
"""Sine of the largest angle to the road at which a participant heads along it."""

_FACES_RAD = np.radians(120.0)
"""Beyond this angle to the road a participant faces ego."""

_TWO_WHEELED = ("motorcycle", "bicycle")

_EDGE_M, _ROOM_M = 0.5, 3.05
"""A parked vehicle is at the edge; the widest vehicle (2.55 m) needs half a metre more to pass."""

_ASKED_FOR_M = 3.0
"""No law requires more room between a vehicle and a cycle, or people in the road."""


def _position(context: DriveContext) -> SignalColumns:
    """The paper's positions; unknown, like stations, for participants at ego's side at first."""
    position = relations.position(context)
    at_side = (position == "l") | (position == "r")
    return SignalColumns(
        about={"position": position}, unknown={"position": _at_first(context) & at_side}
    )


def _station(context: DriveContext) -> SignalColumns:
    """The stations; unknown within the tolerance of places, except while ego or the other passes.

    There only the moment is in doubt, unless passing takes longer than ``passed_s``. Unknown, too,
    for cycles and people that were never seen beside ego while it went past them, and for
    participants beside it in their first state: ego may have come up from behind.
    """
    station, others = relations.station(context), relations.possible_stations(context)
    doubtful = np.logical_or.reduce([station != codes for codes in others])
    there = context.relevant & ~np.isnan(context.extents.s_min)
    longest = round(context.thresholds.passed_s / context.recording.step_s)
    station = with_one_change(station, doubtful, there, context.spans)
    doubtful &= ~only_when(station, doubtful, there, longest, context.spans)
    beside = _at_first(context) & (relations.station(context) == relations.BESIDE)
    return SignalColumns(
        about={"station": station},
        unknown={"station": doubtful | _passed_unseen(context) | beside},
        texts={"station": STATIONS},
    )


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


def _lateral(context: DriveContext) -> SignalColumns:
    """The sides of others; unknown within tolerances, except while ego or the other moves over.

    There only the moment is in doubt, as with stations.
    """
    laterals = relations.laterals(context)
    there = context.relevant & ~np.isnan(context.extents.s_min)
    longest = round(context.thresholds.passed_s / context.recording.step_s)
    codes = with_one_change(laterals.codes, laterals.doubtful, there, context.spans)
    over = only_when(codes, laterals.doubtful, there, longest, context.spans)
    return SignalColumns(
        about={"lateral": codes},
        unknown={"lateral": laterals.doubtful & ~over},
        texts={"lateral": LATERALS},
    )


def _gap(context: DriveContext) -> SignalColumns:
    return _measured("gap", gaps(context)[0], gap_bounds(context))


def _time_headway(context: DriveContext) -> SignalColumns:
    # The speed that the word `speed` has
    cells = presence_cells(context)
    speed, drives = cells.of(own_speed(context)[0]), cells.of(moves(context))
    seconds = gaps(context)[0] / np.where(drives, speed, 1.0)
    headway = np.where(drives, np.minimum(seconds, LONGEST_S), LONGEST_S)
    return _measured("time_headway", headway, headway_bounds(context))


def _lateral_gap(context: DriveContext) -> SignalColumns:
    gap = presence_cells(context).of(relations.lateral_gap(context))
    return _measured("lateral_gap", gap, lateral_gap_bounds(context))


def _speed_difference(context: DriveContext) -> SignalColumns:
    difference, _ = speed_differences(context)
    return _measured("speed_difference", difference, difference_bounds(context))


def _time_to_collision(context: DriveContext) -> SignalColumns:
    """The time (s) in which ego reaches participants ahead in its lane, at both current speeds."""
    measured, surely, perhaps = relations.ahead_in_lane(context)
    # Ego runs into no other participants
    cells, place = relations.perhaps_ahead(context), context.tolerances.place_m
    closing = cells.of(context.ego_extents.along[0]) - cells.of(context.extents.along)
    errors = context.ego.speed_error[0], context.tracks.speed_error
    wrong = context.tolerances.joint(*map(cells.of, errors))
    way = cells.of(relations.way_along(context))

    def seconds(counts: Flags, more_m: float, faster: Floats) -> Floats:
        runs_into = cells.of(counts) & (faster > 0)
        taken = np.maximum(way + more_m, 0.0) / np.where(runs_into, faster, 1.0)
        return np.where(runs_into, np.minimum(taken, LONGEST_S), LONGEST_S)

    seconds_measured = rounded(seconds(measured, 0.0, closing))
    soonest = seconds(perhaps, -place, closing + wrong)
    latest_s = seconds(surely, place, closing - wrong)
    found, low, high = (
        in_presences(context, cells, own, LONGEST_S)
        for own in (seconds_measured, *rounded_outward(soonest, latest_s))
    )
    return SignalColumns(
        about={"time_to_collision": found}, bounds={"time_to_collision": (low, high)}
    )


def _measured(name: str, values: Floats, bounds: Bounds) -> SignalColumns:
    return SignalColumns(about={name: rounded(values)}, bounds={name: bounds})


def _precedes(context: DriveContext) -> SignalColumns:
    """The participant next ahead of ego in its lane."""
    (follows, _, _), cells = relations.ahead_in_lane(context), relations.perhaps_ahead(context)
    counts = cells.of(follows) & ~cells.of(_comes_towards(context)) & cells.of(context.relevant)
    ahead = cells.part(counts.nonzero()[0])
    gap = ahead.of(relations.gap(context))
    return SignalColumns(about={"precedes": ahead.laid(gap == ahead.of(ahead.least(gap)))})


def _one_between(context: DriveContext) -> SignalColumns:
    """Whether another vehicle ahead in ego's lane is nearer to ego than a participant ahead.

    It is if it is nearer by more than the tolerance of places, and unknown within that.
    """
    (_, surely, _), cells = relations.ahead_in_lane(context), relations.perhaps_ahead(context)
    drives = context.tracks.of_type("vehicle")[cells.rows] & ~cells.of(_comes_towards(context))
    gap, place = cells.of(relations.gap(context)), context.tolerances.place_m
    nearest, may_be = (
        cells.of(cells.part(ahead).least(gap.take(ahead)))
        for ahead in ((cells.of(surely) & drives).nonzero()[0], drives.nonzero()[0])
    )
    between = gap > nearest + place
    unknown = ~between & (gap > may_be - place) & (gap > may_be)
    return SignalColumns(
        about={"one_between": cells.laid(between)},
        unknown={"one_between": cells.laid(unknown)},
    )


def _oncoming(context: DriveContext) -> SignalColumns:
    return SignalColumns(about={"oncoming": _comes_towards(context)})


@once
def _comes_towards(context: DriveContext) -> Flags:
    """Mask of participants that move against ego's direction, or wait on lanes of that way."""
    along = context.extents.along
    faces: Flags = np.abs(context.extents.turned) > _FACES_RAD
    comes = faces & (along * -KMH >= context.thresholds.standing_kmh)
    others = Cells.at(faces & ~comes)
    comes.ravel()[others.places] = _waits_elsewhere(context, others)
    return comes


def _waits_elsewhere(context: DriveContext, cells: Cells) -> Flags:
    """Mask of cells of drivers and riders that face ego on lanes not of its way.

    They may stand in a queue there. Ego does not overtake them, nor oncoming ones that move, nor
    follow one that waits in a junction for its turn. A body that always stands there, the wrong way
    round, is an obstacle in ego's lanes. One that faces ego and moves away from it reverses, or its
    box drifts: it counts as standing.
    """
    rows = distinct(cells.rows)
    slow = np.abs(context.extents.along[rows]) * KMH < context.thresholds.standing_kmh
    still = context.spans.all(slow)[rows.searchsorted(cells.rows), cells.columns]
    drivers = context.tracks.of_type("vehicle") | context.tracks.of_type("light_rider")
    moves_elsewhere = cells.of(context.elsewhere) & ~still
    waits: Flags = drivers[cells.rows] & (moves_elsewhere | ~cells.of(context.on_lanes))
    return waits


def _goes_across(context: DriveContext) -> SignalColumns:
    """Whether participants move across the road more than along it.

    A person or cycle that crosses keeps crossing, even if it stops or is hit, until it leaves the
    road or moves along it. Unknown where the tolerance of speeds decides.
    """
    least = context.thresholds.standing_kmh / KMH
    along, across = np.abs(context.extents.along), np.abs(context.extents.across)
    goes: Flags = (across >= least) & (across > along)
    # The error of a difference of two speeds
    wrong = context.tolerances.joint(context.tracks.speed_error, context.tracks.speed_error)
    unsure = (np.maximum(along, across) >= least) & (np.abs(across - along) <= wrong)
    users = context.tracks.of_type("vulnerable_user").nonzero()[0]
    if len(users):
        off = _mostly_along(context, users) | ~context.tracks.on_lane[users]
        went = goes[users] & ~unsure[users]
        goes[users] |= context.spans.latest(goes[users]) > context.spans.latest(off)
        unsure[users] &= context.spans.latest(went) <= context.spans.latest(off)
        present = context.tracks.present[users]
        known, away = map(context.spans.latest, ((goes[users] | off) & present, ~present))
        unsure[users] |= _appears_there(context, users, away) & (known <= away)
    return SignalColumns(about={"goes_across": goes}, unknown={"goes_across": unsure})


def _appears_there(context: DriveContext, rows: NDArray[intp], away: NDArray[intp]) -> Flags:
    """Mask of participants in ``rows`` first recorded in the road, after the recording's start.

    Or recorded there again after the states in which they were last ``away``. Such a track may
    continue the one of a participant that went across.
    """
    first, bodies = context.surroundings.whole.first, context.tracks.participants
    later = [span_of(bodies[row])[0] > first for row in rows.tolist()]
    appears = np.array(later)[:, None] | (away >= context.spans.first)
    found: Flags = appears & context.tracks.on_lane[rows]
    return found


def _mostly_along(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask of participants in ``rows`` that have moved along the road in most recent steps.

    By steps: in means over a second, a collision that displaces a body at once lasts as long.
    """
    least, step_s = context.thresholds.standing_kmh / KMH, context.recording.step_s
    others, spans = context.extents, context.spans
    along, across = others.s[rows], others.d_min[rows] + others.d_max[rows]
    s, d = (np.abs(values - spans.before(values)) for values in (along, across / 2))
    turns = (s >= least * step_s) & (s > d)
    steps = max(round(context.thresholds.smoothing_s / step_s), 1)
    return 2 * spans.count_of_last(turns, steps) > steps


def _stopped(context: DriveContext) -> SignalColumns:
    stands = context.tracks.speed * KMH < context.thresholds.standing_kmh
    return SignalColumns(about={"stopped": stands})


def _parked(context: DriveContext) -> SignalColumns:
    standing = [body.standing for body in context.tracks.participants]
    parked = _constant(context, standing) | _stays_aside(context)
    return SignalColumns(
        about={"parked": parked}, unknown={"parked": may_have_broken_down(context) & ~parked}
    )


def _stays_aside(context: DriveContext) -> Flags:
    """Mask of vehicles that stand aside for as long as they are recorded.

    Their middles are beside the lanes of ego's road, or their sides at the road's edge with room
    for all others in their lane. Vehicles that wait in a lane do not stand aside, however long.
    """
    lanes, vehicles = context.existing_lanes, context.tracks.of_type("vehicle").nonzero()[0]
    aside = np.zeros(context.relevant.shape, dtype=bool)
    first, end = lanes.argmax(axis=1), lanes.shape[1] - lanes[:, ::-1].argmax(axis=1)
    still = vehicles[relations.stays(context, vehicles)]
    if len(still):
        others = context.extents.part(still, slice(None))
        out = (others.middle_from(first) < 0) | (others.middle_from(end) > 0)
        wide = [context.tracks.participants[row].type not in _TWO_WHEELED for row in still.tolist()]
        out |= np.array(wide)[:, None] & _at_edge(others, context.there[still])
        aside[still] = context.spans.all(out | ~context.relevant[still])
    return aside


def _at_edge(others: RoadExtents, there: Flags) -> Flags:
    """Mask of bodies at an edge of the lanes, in a lane that has room beside them.

    ``there``: the lanes (last axis) that exist at their places.
    """
    first, end = there.argmax(axis=2), there.shape[2] - there[..., ::-1].argmax(axis=2)
    right = (others.from_bound(first)[0] < _EDGE_M) & (others.from_bound(first + 1)[1] < -_ROOM_M)
    left = (others.from_bound(end)[1] > -_EDGE_M) & (others.from_bound(end - 1)[0] > _ROOM_M)
    at_edge: Flags = there.any(axis=2) & (right | left)
    return at_edge


def _on_shoulder(context: DriveContext) -> SignalColumns:
    """Whether vehicles heading along the road stand beside its lanes or are on a hard shoulder.

    Only at the near side: at the far one they may be on lanes of the other direction. A vehicle
    that moves beside the lanes may be on a lane that the road does not contain.
    """
    others, there = context.extents, context.there
    if context.side == "right":
        beyond = -others.middle_from(there.argmax(axis=2))
    else:
        beyond = others.middle_from(there.shape[2] - there[..., ::-1].argmax(axis=2))
    vehicles = context.tracks.of_type("vehicle")[:, None] & there.any(axis=2)
    along = vehicles & ~context.elsewhere & (np.abs(np.sin(others.turned)) < _ALONG)
    inside = those_on_lanes(context, SHOULDER, along)
    stands = context.tracks.speed * KMH < context.thresholds.standing_kmh
    loose = context.tolerances.place_m + np.abs(context.map_offset_m)
    beside = along & (inside | (stands & (beyond > 0)))
    unsure = along & ~inside & ((np.abs(beyond) < loose) | (~stands & (beyond > 0)))
    return SignalColumns(about={"on_shoulder": beside}, unknown={"on_shoulder": unsure})


def _two_wheeled(context: DriveContext) -> SignalColumns:
    two_wheeled = [body.type in _TWO_WHEELED for body in context.tracks.participants]
    return SignalColumns(about={"two_wheeled": _constant(context, two_wheeled)})


def _constant(context: DriveContext, flags: list[bool]) -> Flags:
    return np.array(flags, dtype=bool)[:, None].repeat(context.states, axis=1)


def _in_the_road(context: DriveContext) -> SignalColumns:
    """Whether people are on a lane; unknown at the outermost edges of ego's, where they may wait.

    Unknown, too, for riders on a cycle lane: it may be a path beside the road.
    """
    unsure, users = np.zeros_like(context.relevant), context.tracks.of_type("vulnerable_user")
    if len(rows := users.nonzero()[0]):
        error = context.tolerances.place_m + np.abs(context.map_offset_m)
        least = np.maximum(context.thresholds.changed_m, error)
        lanes, others = context.existing_lanes, context.extents.part(rows, slice(None))
        for edge in (lanes.argmax(axis=1), lanes.shape[1] - lanes[:, ::-1].argmax(axis=1)):
            low, high = others.from_bound(edge)
            unsure[rows] |= np.abs(low + high) / 2 <= least
    if CYCLE_LANE in map_contents(context).types:
        rides = context.tracks.of_type("light_rider")[:, None] & context.tracks.on_lane
        unsure |= those_on_lanes(context, CYCLE_LANE, rides)
    return SignalColumns(
        about={"in_the_road": context.tracks.on_lane},
        only={"in_the_road": users},
        unknown={"in_the_road": unsure & context.tracks.on_lane},
    )


participant_signals = SignalPasses(
    {
        ("position",): _position,
        ("station",): _station,
        ("lateral",): _lateral,
        ("gap",): _gap,
        ("time_headway",): _time_headway,
        ("lateral_gap",): _lateral_gap,
        ("speed_difference",): _speed_difference,
        ("time_to_collision",): _time_to_collision,
        ("safe_gap",): keeps_safe_gap,
        ("parts_soon",): may_part,
        ("precedes",): _precedes,
        ("one_between",): _one_between,
        ("oncoming",): _oncoming,
        ("goes_across",): _goes_across,
        ("stopped",): _stopped,
        ("parked",): _parked,
        ("on_shoulder",): _on_shoulder,
        ("leads_elsewhere",): leads_elsewhere,
        ("two_wheeled",): _two_wheeled,
        ("in_the_road",): _in_the_road,
    }
)
"""The signals about objects."""
