"""Queues of vehicles that go ego's way: by lane, on all lanes, and which lanes show them.

Vehicles count up to ``flow_reach_m`` away, or as far as ``fewest`` vehicles of a queue at ego's
speed need. A lane's vehicles are those whose middle is in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once, once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.ego_lanelets import travel_lanes_first
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.cells import Cells
from rulec.trace.plain_arrays import medians_hold

_BODY_M = 5.0
"""Roughly the length of a vehicle (m)."""

_HAIR_M = 0.01

_SIDE_LANE_M = 300.0
"""A lane that begins or ends within this distance serves to join or leave."""

_UNEVEN_M = 20.0
"""Maps cut off their lanes unevenly by up to this distance."""

_MOST = 0.5
"""In a queue more than this part of the gaps are short."""

READINGS = range(3)
MEASURED, STRICT, LOOSE = READINGS
"""Readings of a short gap: as measured, surely, and perhaps or only by some definitions."""


def lanes_that_decide(context: DriveContext) -> Flags:
    """Mask of lanes (second axis) that go on, and on which a queue would show.

    A short acceleration lane, or a lane whose map ends soon, has no room for ``fewest`` vehicles at
    the largest distances of a queue. A lane that begins or ends near ego while others go on serves
    to join or leave, as between two ramps.
    """
    there, _ = _lane_lengths(context)
    room = _length_near(context, there, _reach(context))
    enough = room >= _shortest_queue(context)[:, None] - _HAIR_M
    return enough & lanes_that_go_on(context)


@once
def lanes_that_go_on(context: DriveContext) -> Flags:
    """Mask of lanes (second axis) that neither begin nor end near ego while others go on."""
    _, only_others = _lane_lengths(context)
    without = _length_near(context, only_others, np.full(context.states, _SIDE_LANE_M))
    goes_on: Flags = without <= _UNEVEN_M
    return goes_on


@once_a_road
def _lane_lengths(context: DriveContext) -> tuple[Floats, Floats]:
    """The length (m) of each lane up to each place of the lanes, and the length with others only.

    One row per lane.
    """
    lanes = context.road.lanes
    only_others = lanes.there.any(axis=1, keepdims=True) & ~lanes.there
    for nearer, lane in _other_roads(context.road):
        only_others[nearer, lane] = False
    parts = lanes.s[1:] - lanes.s[:-1]
    sums = ((where.T * parts).cumsum(axis=1) for where in (lanes.there, only_others))
    there, without = (np.pad(rows, ((0, 0), (1, 0))) for rows in sums)
    return there, without


def _other_roads(road: DrivenRoad) -> Iterator[tuple[slice, list[int]]]:
    """Lanes of another road that ego's joins or leaves, and the range where they are not beside it.

    They do not begin or end there: beyond, on the map, they outnumber ego's that go on. Maps may
    lead each lane through a junction by itself: lanes that are missing for no more than
    ``_UNEVEN_M`` are the same road's.
    """
    for piece, (before, after) in enumerate(pairwise(road.rows), 1):
        border = int(road.lanes.s.searchsorted(road.borders[piece]))
        was, will_be = _lanes_around(road, piece)
        both = sum([lane is not None and was[k] for k, lane in enumerate(after)])
        come = [k for k, lane in enumerate(after) if lane and not was[k] and lane.predecessors]
        if len(come) > both:
            yield slice(border), come
        both = sum([lane is not None and will_be[k] for k, lane in enumerate(before)])
        leave = [k for k, lane in enumerate(before) if lane and not will_be[k] and lane.successors]
        if len(leave) > both:
            yield slice(border, None), leave


def _lanes_around(road: DrivenRoad, piece: int) -> tuple[Sequence[bool], Sequence[bool]]:
    """Which lanes there are up to ``_UNEVEN_M`` before a piece, and from its beginning on."""
    place, borders = road.borders[piece], road.borders
    before = [k for k in range(piece) if borders[k + 1] > place - _UNEVEN_M or k == piece - 1]
    after = [
        k for k in range(piece, len(road.rows)) if borders[k] < place + _UNEVEN_M or k == piece
    ]
    was, will_be = (
        [any(road.rows[k][lane] is not None for k in pieces) for lane in range(len(road.rows[0]))]
        for pieces in (before, after)
    )
    return was, will_be


def _length_near(context: DriveContext, lengths: Floats, reach_m: Floats) -> Floats:
    """The length (m) of each lane (second axis) within ``reach_m`` of ego, by state."""
    s, own = context.road.lanes.s, context.ego_extents.s[0]
    places = np.concatenate((own + reach_m, own - reach_m))
    near: Floats = np.zeros((len(lengths), len(own)))
    for lane in lengths.any(axis=1).nonzero()[0].tolist():
        up_to = np.interp(places, s, lengths[lane])
        near[lane] = up_to[: len(own)] - up_to[len(own) :]
    by_state: Floats = near.T
    return by_state


def _length_ahead(context: DriveContext) -> Floats:
    """The length (m) of ego's lane ahead of it on the map, by state."""
    there, _ = _lane_lengths(context)
    s, front, lane = context.road.lanes.s, context.ego_extents.s_max[0], context.ego_lane
    ahead = np.zeros(context.states)
    for number, lengths in enumerate(there):
        own = lane == number
        ahead[own] = lengths[-1] - np.interp(front[own], s, lengths)
    return ahead


def _shortest_queue(context: DriveContext) -> Floats:
    """The length (m) of ``fewest`` vehicles at the largest distances of a queue, by state."""
    limits, speed = context.thresholds, context.ego_extents.along[0]
    gap = np.maximum(limits.queue_gap_m, limits.queue_headway_s * speed)
    length: Floats = limits.fewest * (gap + _BODY_M)
    return length


def longest_gaps(context: DriveContext, speed: Floats, speed_error: Floats) -> Floats:
    """The longest gap (m) in a queue in front of vehicles at ``speed`` (m/s), by reading."""
    limits = context.thresholds
    wrong = limits.queue_headway_s * np.fmax(speed_error, 0.0)
    wrong = context.tolerances.joint(context.tolerances.place_m, wrong)
    longest, loose = (
        np.maximum(limits.queue_gap_m, headway_s * speed)
        for headway_s in (limits.queue_headway_s, limits.loose_headway_s)
    )
    return np.array((longest, longest - wrong, loose + wrong))


def _reach(context: DriveContext) -> Floats:
    """How far (m) ahead and behind traffic is considered, by state."""
    limits = context.thresholds
    far = np.minimum(_shortest_queue(context) / 2, limits.near_m)
    return np.maximum(limits.flow_reach_m, far)


@once
def close_by(context: DriveContext) -> Flags:
    """Mask of vehicles that go ego's way and are part of the traffic around it."""
    return context.going_along & (relations.gap(context) <= _reach(context))


@dataclass(frozen=True, eq=False, slots=True)
class VehiclesAround:
    """Ego and the vehicles around it that go its way: one entry per vehicle and state.

    ``lane`` is that of the middle. ``place`` is the flat index of lane and state, ``counts`` (lane
    x state) the number of entries there, and ``number`` an entry's index among these. ``speed``
    (m/s) is along the road, 0 for vehicles that reverse.
    """

    state: NDArray[intp]
    lane: NDArray[intp]
    place: NDArray[intp]
    number: NDArray[intp]
    counts: NDArray[intp]
    s_min: Floats
    s_max: Floats
    speed: Floats
    speed_error: Floats


@once
def vehicles_around(context: DriveContext) -> VehiclesAround:
    """The traffic around ego, with ego's entries first."""
    own, others, there = context.ego_extents, context.extents, close_by(context)
    cells, n_lanes = Cells.at(there), context.existing_lanes.shape[1]
    numbers, counts = np.zeros(there.shape, dtype=np.int16), []
    for number in range(n_lanes):
        inside, egos = there & (others.lane == number), own.lane[0] == number
        up_to = np.concatenate((egos[None], inside)).astype(np.int16)
        # Adding whole rows is faster than cumsum
        for earlier, later in pairwise(up_to):
            later += earlier
        numbers += (up_to[1:] - 1) * inside
        counts.append(up_to[-1].astype(intp))

    def of_all(of_ego: NDArray[Any], of_others: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate((of_ego[0], cells.of(of_others)))

    lane: NDArray[intp] = of_all(own.lane, others.lane)
    state = np.concatenate((context.spans.columns, cells.columns))
    return VehiclesAround(
        state=state,
        lane=lane,
        place=lane * context.states + state,
        number=of_all(np.zeros_like(own.lane), numbers),
        counts=np.array(counts),
        s_min=of_all(own.s_min, others.s_min),
        s_max=of_all(own.s_max, others.s_max),
        speed=np.maximum(of_all(own.along, others.along), 0.0),
        speed_error=of_all(context.ego.speed_error, context.tracks.speed_error),
    )


@once
def queues_by_lane(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks of queues, and of lanes whose median speed is that of slow queues, by lane and state.

    In a queue more than half of the gaps are short. The mask of queues has the reading of short
    gaps as its first axis.
    """
    around = vehicles_around(context)
    n_places, shape = around.counts.size, around.counts.shape
    enough = around.counts.ravel() >= context.thresholds.fewest
    several = enough.take(around.place).nonzero()[0]
    place = around.place.take(several)
    slow = medians_hold(
        place,
        around.speed.take(several),
        n_places,
        lambda speed: speed * KMH_PER_MPS < context.thresholds.slow_queue_kmh,
    )
    queues = np.zeros((len(READINGS), n_places), dtype=bool)
    if len(several):
        places = enough.nonzero()[0]
        counts = around.counts.take(places)
        n_short = _short_gaps(context, several, enough.cumsum().take(place) - 1, counts)
        queues[:, places] = n_short > _MOST * np.maximum(counts - 1, 0)
    return queues.reshape(len(READINGS), *shape), slow.reshape(shape)


def _short_gaps(
    context: DriveContext, chosen: NDArray[intp], rows: NDArray[intp], counts: NDArray[intp]
) -> NDArray[intp]:
    """The number of short gaps between vehicles in a lane, by reading and row.

    ``chosen`` entries of all vehicles are in these ``rows``, with ``counts`` entries each.
    """
    around, shape = vehicles_around(context), (int(counts.max()), len(counts))
    # One column per lane and state, which ends in NaN
    at = around.number.take(chosen) * len(counts) + rows
    own = around.s_min.take(chosen)
    rears, fronts = np.full((2, *shape), np.nan)
    np.put(rears, at, own)
    at = rears.argsort(axis=0, kind="stable").argsort(axis=0).ravel().take(at) * len(counts) + rows
    entries = np.zeros(shape, dtype=intp)
    np.put(rears, at, own)
    np.put(fronts, at, around.s_max.take(chosen))
    np.put(entries, at, chosen)
    behind, gaps = entries[:-1], rears[1:] - fronts[:-1]
    # Gaps up to this are short at any speed
    most_wrong = np.fmax.reduce(around.speed_error, initial=0.0)
    near = longest_gaps(context, np.zeros(1), most_wrong)[STRICT]
    short = (gaps <= near)[None].repeat(len(READINGS), axis=0)
    rest = (gaps > near).ravel().nonzero()[0]
    behind, gaps = behind.ravel().take(rest), gaps.ravel().take(rest)
    longest_m = longest_gaps(context, around.speed.take(behind), around.speed_error.take(behind))
    for flags, limit in zip(short, longest_m, strict=True):
        np.put(flags, rest, gaps <= limit)
    found: NDArray[intp] = short.sum(axis=1)
    return found


@once
def dense_lines(context: DriveContext) -> tuple[Flags, Flags, Flags]:
    """Masks of states with queues on all lanes: as measured, surely, and unknown."""
    queues, _ = queues_by_lane(context)
    lanes = travel_lanes_first(context)
    decides = lanes & (lanes_that_decide(context).T | queues)
    all_queue = np.logical_and((queues | ~decides).all(axis=1), decides.any(axis=1))
    # A few lanes say nothing about the others; where all traffic is recorded there is no queue then
    few = 2 * decides.sum(axis=1) < lanes.sum(axis=0)
    whole = "arrivals" in context.recording.complete
    all_queue &= ~(few & whole)
    # A vehicle with none ahead drives freely, unless the one ahead is no longer recorded: ego is
    # then first of a line, and at least half of the lanes have one
    every, loose = decides[LOOSE].sum(axis=0), queues[LOOSE] & decides[LOOSE]
    lines = loose[context.ego_lane, context.spans.columns] & (2 * loose.sum(axis=0) >= every)
    gap, gap_behind = (
        gap_in_lane(context, side) for side in (relations.BEHIND, relations.IN_FRONT_OF)
    )
    cut_off = (lines | all_queue[LOOSE]) & np.isinf(gap) & (not whole)
    speed = context.ego_extents.along[0]
    longest = longest_gaps(context, speed, context.ego.speed_error[0])
    dense, surely, loosely = (
        all_queue[reading] & (gap <= longest[reading]) for reading in READINGS
    )
    # There is no queue where the world ends and all its traffic is recorded, and ego is in none if
    # it sees a longer empty part of its lane ahead
    empty = (gap > longest[LOOSE]) & (_length_ahead(context) > longest[LOOSE])
    nobody_knows = ~decides[MEASURED].any(axis=0) & ~empty & (not whole)
    # The last vehicle behind a queue may be in it or not
    surely &= ~few[MEASURED] & (gap_behind <= longest[LOOSE])
    return dense, surely, (loosely | dense) & ~surely | cut_off | nobody_knows


def gap_in_lane(context: DriveContext, station: int) -> Floats:
    """The gap (m) to the nearest vehicle in ego's lane to which ego has ``station``, by state.

    As far as traffic is considered; infinity without any.
    """
    cells = Cells.at(close_by(context) & (relations.station(context) == station))
    cells = cells.part((cells.of(context.extents.lane) == cells.of(context.ego_lane)).nonzero()[0])
    return cells.least(cells.of(relations.gap(context)))
