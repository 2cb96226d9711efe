"""Signals of the lanes next to ego's: whether they are free, and whether that is known.

The near one decides whether ego keeps to the kerb as it should, the far one whether it may pass.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once, once_a_recording, once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_lanelets import CYCLE_LANE, SHOULDER, own_lanelets, travel_lanes
from rulec.extraction.signals.map.lanes_ahead import Leads, junctions_ahead
from rulec.extraction.signals.map.roundabout_signals import roundabouts
from rulec.extraction.signals.queues import LOOSE, close_by, lanes_that_go_on, queues_by_lane
from rulec.extraction.signals.words import word
from rulec.extraction.tracks.tracks import Tracks
from rulec.recordings.recording import RAMPS, Lanelet, LaneMark, Side
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.plain_arrays import ranges

_SOON_M = 10.0
"""A vehicle within this distance behind ego, plus its gain in ``passed_s``, is soon beside it."""

_SOLID = frozenset({"solid", "double_solid"})

_BUS_LANE, _CYCLE_LANE = frozenset({"busLane"}), frozenset({CYCLE_LANE})
_RESERVED = frozenset({SHOULDER, *_BUS_LANE})

_UNSEEN_S = 5.0
"""A vehicle whose track has ended is assumed to drive on as before for this long (s)."""

_FASTER_MPS = 10.0

_CHANGE_S = 4.0
"""At the earliest, a change of lanes begins this long (s) before the middle crosses the mark."""

_SOON_AGAIN = 2.0
"""A move back is of no use if ego has to come out within this many times ``catching_up_s``."""

_AT_EASE_S = 1.8
"""Drivers are told to keep this far behind others: half the speedometer, in metres (§ 4 StVO)."""

_STANDING_CAMERAS = frozenset(
    {
        "CommonRoad scenario",
        "NGSIM tracks",
        "highD tracks",
        "levelX tracks",
        "INTERACTION tracks",
    }
)
"""Formats of data recorded from above a stretch of road, or invented for one."""


@word("near_lane_is_free")
def _on_near_lane(context: DriveContext) -> Truth:
    free, within_error = _near_lane_is_free(context)
    doubtful = _goes_back(context)
    # Rarely needed: an ego in the lane next to the kerb mostly stays there
    if (free & _next_lane(context, context.side)[1]).any():
        doubtful |= _perhaps_on_near_lane(context) | _of_no_use(context)
    # Maps do not say for which buses a bus lane is, or when; and those that may use it need not
    doubtful |= _is_beside(context, _BUS_LANE)
    return Truth.known(free).unknown_at(free & doubtful | within_error)


def _next_lane(context: DriveContext, side: Side) -> tuple[NDArray[intp], Flags]:
    """The lane at a side of ego, and the mask of states where it exists and is for driving."""
    lane = context.ego_lane + (1 if side == "left" else -1)
    count = travel_lanes(context).shape[1]
    inside = (lane >= 0) & (lane < count)
    lane = np.minimum(np.maximum(lane, 0), count - 1)
    return lane, inside & travel_lanes(context)[np.arange(context.states), lane]


@word("other_lane_available")
def _far_lane_is_free(context: DriveContext) -> Flags:
    """Whether nobody is in the place beside ego on the next far lane, now or soon."""
    lane, there = _next_lane(context, "left" if context.side == "right" else "right")
    cells = _on_lane(context, lane, there.nonzero()[0])
    gap, station = relations.gap(context)[cells], relations.station(context)[cells]
    along, own = context.extents.along[cells], context.ego_extents.along[0, cells[1]]
    near = gap <= np.maximum(along - own, 0.0) * context.thresholds.passed_s + _SOON_M
    free: Flags = there.copy()
    beside = station == relations.BESIDE
    free[cells[1][beside | ((station == relations.IN_FRONT_OF) & near)]] = False
    return free


def _near_lane_is_free(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks: ego, in the next lane to the kerb, would be at safe distances; errors decide it.

    It cannot go there across a solid line, as beside lanes for turning off; nor to a bus lane, or
    across a cycle lane; nor, from a through lane, to a lane for joining or leaving; nor to one that
    leads elsewhere at a junction within ``preparing_s``. A bus stays on its own lane.
    """
    taken, surely_taken, perhaps_taken = np.zeros((3, context.states), dtype=bool)
    lane, there = _next_lane(context, context.side)
    cycles_beside = _is_beside(context, _CYCLE_LANE) & ~context.ego_is("light_rider")
    if not there.any():
        return ~cycles_beside, taken
    parted = own_lanelets(context).flags(lambda lanelet: _near_mark(lanelet, context) in _SOLID)
    turned, _ = _sorted_ahead(context)
    on_ramp = own_lanelets(context).flags(lambda lanelet: not RAMPS.isdisjoint(lanelet.types))
    ramp_beside = _is_beside(context, RAMPS) & ~on_ramp
    buses = context.ego_is("bus")
    bus_lane_beside = _is_beside(context, _BUS_LANE) & ~buses
    for_buses = own_lanelets(context).flags(lambda lanelet: not _BUS_LANE.isdisjoint(lanelet.types))
    kept = parted | ramp_beside | bus_lane_beside | (for_buses & buses) | turned
    cells = _on_lane(context, lane, (there & ~kept).nonzero()[0])
    short, error = _short_of_safe(context, cells)
    for states, is_short in (
        (taken, short > 0),
        (surely_taken, short >= error),
        (perhaps_taken, short > -error),
    ):
        states[cells[1][is_short]] = True
    free: Flags = np.where(there, ~(taken | kept), ~cycles_beside)
    return free, perhaps_taken & ~surely_taken


def _short_of_safe(
    context: DriveContext, cells: tuple[NDArray[intp], ...]
) -> tuple[Floats, Floats]:
    """By how much (m) ego and others would be too near each other in one lane, and its error.

    Negative where they are farther apart than the one behind needs to stop, infinite beside each
    other.
    """
    limits, known = context.thresholds, context.tolerances
    own = np.maximum(context.ego_extents.along[0, cells[1]], 0.0)
    other = np.maximum(context.extents.along[cells], 0.0)
    own_error, other_error = context.ego.speed_error[0, cells[1]], context.tracks.speed_error[cells]
    station = relations.station(context)[cells]
    leads = station == relations.BEHIND
    behind, ahead = np.where(leads, own, other), np.where(leads, other, own)
    behind_error, ahead_error = (
        np.where(leads, *errors) for errors in ((own_error, other_error), (other_error, own_error))
    )
    gap, braking = relations.gap(context)[cells], limits.braking_mps2
    safe = limits.reaction_s * behind + (behind**2 - ahead**2) / (2 * braking)
    of_speeds = known.joint(
        (limits.reaction_s + behind / braking) * behind_error, ahead / braking * ahead_error
    )
    short = np.where(station == relations.BESIDE, np.inf, safe - gap)
    return short, known.joint(of_speeds, known.place_m)


def _goes_back(context: DriveContext) -> Flags:
    """Mask of states from which ego changes to a lane nearer to the kerb within ``_CHANGE_S``.

    Whether that lane was free before is unknown: ego may have had to look for room there.
    """
    lane, spans = context.steady_lane, context.spans
    kerbward = spans.after(lane) - lane
    changes = kerbward < 0 if context.side == "right" else kerbward > 0
    steps = context.steps_in(_CHANGE_S)
    return spans.within(changes, steps - 1)


def _of_no_use(context: DriveContext) -> Flags:
    """Mask of states in which it is unknown whether ego has to use the next lane to the kerb.

    A slower vehicle is on it that ego would reach within twice ``catching_up_s``, or one at less
    than ``_AT_EASE_S``; it begins or ends near ego while others go on, as beside a ramp; it becomes
    a shoulder or bus lane within ``preparing_s``; it is full except for a gap; ego is in a slow
    queue itself, with others on the next lane, too; or drivers choose their lanes before a junction
    or a ring, which is unknown beyond the map's end.
    """
    lane, there = _next_lane(context, context.side)
    states = context.spans.columns
    side_lane = ~lanes_that_go_on(context)[states, lane]
    queues, are_slow = queues_by_lane(context)
    full, own = (queues[LOOSE, number, states] for number in (lane, context.ego_lane))
    slow = are_slow[context.ego_lane, states]
    _, sorting = _sorted_ahead(context)
    map_ends = (
        context.road.borders[-1] - context.ego_extents.s_max[0] < context.thresholds.approach_m
    )
    no_use: Flags = there & (side_lane | full | sorting | map_ends | _reserved_ahead(context, lane))
    no_use |= _slower_ahead(context, lane, (there & ~no_use).nonzero()[0])
    queues_beside = (there & ~no_use & own & slow).nonzero()[0]
    used = close_by(context)[:, queues_beside]
    used &= context.extents.lane[:, queues_beside] == lane[queues_beside]
    no_use[queues_beside] = used.any(axis=0)
    return no_use


def _slower_ahead(context: DriveContext, lane: NDArray[intp], states: NDArray[intp]) -> Flags:
    """Mask of those states in which ego would soon have to leave a lane again, or brake there."""
    cells = _on_lane(context, lane, states)
    gap, station = relations.gap(context)[cells], relations.station(context)[cells]
    own = context.ego_extents.along[0, cells[1]]
    faster = own - context.extents.along[cells]
    soon = gap <= faster * (_SOON_AGAIN * context.thresholds.catching_up_s)
    soon |= gap < own * _AT_EASE_S
    found = np.zeros(context.states, dtype=bool)
    found[cells[1][(station == relations.BEHIND) & soon]] = True
    return found


@once
def _sorted_ahead(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks: the next lane to the kerb leads elsewhere than ego; drivers choose lanes.

    They do ``preparing_s`` before lights, rings, and where one lane leads to several roads.
    """
    lane, there = _next_lane(context, context.side)
    front, reach = context.ego_extents.s_max[0], _reach(context)
    elsewhere, sorting = np.zeros((2, context.states), dtype=bool)
    for junction in junctions_ahead(context):
        nears = there & (front <= junction.low) & (junction.low - front <= reach)
        leads = [junction.leads[number] for number in np.minimum(lane, len(junction.leads) - 1)]
        elsewhere |= nears & np.array([lead is Leads.ELSEWHERE for lead in leads])
        sorting |= nears & np.array([junction.lit or lead is Leads.BOTH for lead in leads])
    for begins, *_ in roundabouts(context):
        sorting |= there & (front <= begins) & (begins - front <= reach)
    return elsewhere, sorting & ~elsewhere


def _reach(context: DriveContext) -> Floats:
    """How far (m) ahead drivers look when they choose a lane, by state."""
    speed = np.maximum(context.ego_extents.along[0], 0.0)
    reach: Floats = np.maximum(
        speed * context.thresholds.preparing_s, context.thresholds.approach_m
    )
    return reach


@once_a_road
def _reserved_from(context: DriveContext) -> Sequence[tuple[int, float]]:
    """Lanes that become a shoulder or bus lane after being open to all, and from where on (m)."""
    road = context.road
    return [
        (number, float(road.borders[piece + 1]))
        for piece, rows in enumerate(pairwise(road.rows))
        for number, (lanelet, beyond) in enumerate(zip(*rows, strict=True))
        if lanelet and beyond and _RESERVED & beyond.types and not _RESERVED & lanelet.types
    ]


def _reserved_ahead(context: DriveContext, lane: NDArray[intp]) -> Flags:
    """Mask of states in which a lane will soon be a shoulder or a bus lane."""
    front, found = context.ego_extents.s_max[0], np.zeros(context.states, dtype=bool)
    for number, place in _reserved_from(context):
        found |= (lane == number) & (front <= place) & (place - front <= _reach(context))
    return found


def _is_beside(context: DriveContext, types: frozenset[str]) -> Flags:
    """Mask of states in which the next lane to the kerb has any of these types."""
    own, way = own_lanelets(context), -1 if context.side == "right" else 1
    of_each = np.zeros(len(own.places), dtype=bool)
    for number, (piece, lane) in enumerate(own.places):
        row = context.road.rows[piece]
        beside = row[lane + way] if 0 <= lane + way < len(row) else None
        of_each[number] = beside is not None and not types.isdisjoint(beside.types)
    return of_each[own.number]


def _near_mark(lanelet: Lanelet, context: DriveContext) -> LaneMark | None:
    return lanelet.right_mark if context.side == "right" else lanelet.left_mark


def _perhaps_on_near_lane(context: DriveContext) -> Flags:
    """Mask of states in which an unseen vehicle may be near ego on the next lane to the kerb.

    Its track ended less than ``_UNSEEN_S`` ago, or begins within that time, in sight of ego, and it
    drives on as before. No vehicle is seen behind the last one recorded on ego's road. Where all
    traffic is recorded, nobody drives unseen.
    """
    if "arrivals" in context.recording.complete:
        return np.zeros(context.states, dtype=bool)
    lane, there = _next_lane(context, context.side)
    found: Flags = there & ~_known_behind(context)
    others, step_s = context.extents, context.recording.step_s
    for rows, edge, states in _unseen(context, int(_UNSEEN_S / step_s) + 1):
        away_s = (states - edge) * step_s
        place = others.s[rows, edge] + others.along[rows, edge] * away_s
        near = np.abs(place - context.ego_extents.s[0, states]) < context.thresholds.approach_m
        near &= (others.lane[rows, edge] == lane[states]) & (np.abs(away_s) < _UNSEEN_S)
        near &= there[states]
        found[states[near]] = True
    return found


def _unseen(context: DriveContext, most: int) -> Iterator[tuple[NDArray[intp], ...]]:
    """The states after others were last seen in a drive, up to their return, and those before.

    Yields rows, the states in which they were seen, and at most ``most`` states for each.
    """
    spans, seen = context.spans, context.driving_along
    bounds = np.array(spans.bounds, dtype=intp)
    begins = seen.copy()
    begins[:, 1:] &= ~seen[:, :-1] | spans.begins_here[1:]
    ends = seen.copy()
    ends[:, :-1] &= ~seen[:, 1:] | spans.begins_here[1:]
    (rows, first), last = begins.nonzero(), ends.nonzero()[1]
    drives = spans.number[first]
    is_next = (rows[1:] == rows[:-1]) & (drives[1:] == drives[:-1])
    until, since = bounds[drives + 1], bounds[drives]
    until[:-1][is_next] = first[1:][is_next]
    since[1:][is_next] = last[:-1][is_next] + 1
    yield _around(rows, last, (last + 1, np.minimum(last + most + 1, until)))
    yield _around(rows, first, (np.maximum(first - most, since), first))


def _around(
    rows: NDArray[intp], edge: NDArray[intp], bounds: tuple[NDArray[intp], NDArray[intp]]
) -> tuple[NDArray[intp], ...]:
    """Rows and edges for each state of their ranges, and these states."""
    first, end = bounds
    lengths = end - first
    states, _ = ranges(first, lengths)
    return rows.repeat(lengths), edge.repeat(lengths), states


def _known_behind(context: DriveContext) -> Flags:
    """Mask of states in which a vehicle coming from behind would have been recorded.

    A vehicle faster by ``_FASTER_MPS`` has to brake for ego only within a certain distance. The
    road is seen as far back as a vehicle is recorded; with a stationary camera that records later
    arrivals, as far back as any vehicle on ego's road was during the drive.
    """
    limits, own = context.thresholds, np.maximum(context.ego_extents.along[0], 0.0)
    faster = own + _FASTER_MPS
    safe = limits.reaction_s * faster + (faster**2 - own**2) / (2 * limits.braking_mps2)
    rear, others = context.ego_extents.s_min[0], context.extents
    farthest = np.where(context.going_along, others.s_min, np.inf).min(axis=0, initial=np.inf)
    arrivals = _records_arrivals(context)
    if context.own is not context.surroundings and context.recording.whole is None:
        arrivals |= _some_arrive(context.own.tracks)
    if context.recording.form in _STANDING_CAMERAS and arrivals:
        seen = np.where(context.driving_along, others.s_min, np.inf)
        nearest = np.minimum(rear, seen.min(axis=0, initial=np.inf))
        first = np.minimum.reduceat(nearest, context.spans.begins)
        farthest = np.minimum(farthest, context.spans.spread(first))
    known: Flags = rear - farthest >= safe
    return known


@once_a_recording
def _records_arrivals(context: DriveContext) -> bool:
    """Whether some vehicle's record begins later than the first step.

    Otherwise vehicles that came later are left out, as in CommonRoad's cuts from longer recordings.
    """
    if context.recording.whole is not None:
        return context.recording.whole.arrivals
    return _some_arrive(context.surroundings.tracks)


def _some_arrive(tracks: Tracks) -> bool:
    """Whether some vehicle is present only from later than the first step on."""
    vehicles = tracks.present[tracks.of_type("vehicle")]
    return bool((~vehicles[:, :1] & vehicles.any(axis=1, keepdims=True)).any())


def _on_lane(
    context: DriveContext, lane: NDArray[intp], states: NDArray[intp]
) -> tuple[NDArray[intp], NDArray[intp]]:
    """Vehicles that go ego's way on a lane, given by state, in some states: rows and states."""
    chosen = np.zeros(context.states, dtype=bool)
    chosen[states] = True
    cells = Cells.at(context.in_lane(lane) & context.going_along & chosen)
    return cells.rows, cells.columns
