"""Ego's lanelets state by state, and what the lanelets of the whole map contain."""

from __future__ import annotations

from collections.abc import Callable, Set
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once, once_a_map
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.recordings.recording import Lanelet
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_Value = TypeVar("_Value")

SHOULDER, CYCLE_LANE = "shoulder", "bicycleLane"
"""The lanelet types of hard shoulders and of cycle lanes."""


@dataclass(frozen=True, eq=False, slots=True)
class OwnLanelets:
    """The lanelets of ego's lane at its middle.

    ``places`` are the distinct (piece, lane) pairs, ``lanelets`` the lanelet of each; ``number`` is
    the index of the pair by state.
    """

    places: tuple[tuple[int, int], ...]
    lanelets: tuple[Lanelet, ...]
    number: NDArray[intp]

    def values(self, value: Callable[[Lanelet], _Value]) -> list[_Value]:
        """The values of a function of the lanelet, by state."""
        of_each = [value(lanelet) for lanelet in self.lanelets]
        return [of_each[number] for number in self.number.tolist()]

    def told(self, value: Callable[[Lanelet], bool | None]) -> Truth:
        """Whether a function of the lanelet returns True, by state; None stands for unknown."""
        of_each = [value(lanelet) for lanelet in self.lanelets]
        true = np.array([x is True for x in of_each], dtype=bool)
        not_false = np.array([x is not False for x in of_each], dtype=bool)
        return Truth(true[self.number], not_false[self.number])

    def flags(self, holds: Callable[[Lanelet], bool]) -> Flags:
        """Mask of the states in which a condition holds for the lanelet."""
        of_each = np.array([holds(lanelet) for lanelet in self.lanelets], dtype=bool)
        flags: Flags = of_each[self.number]
        return flags


@once
def own_lanelets(context: DriveContext) -> OwnLanelets:
    """The lanelets of ego's lane."""
    return _of_places(context, *context.ego_places)


def lanelets_at(context: DriveContext, middle: Floats, lanes: NDArray[intp]) -> OwnLanelets:
    """The lanelets at places along the road in given lanes, by state."""
    return _of_places(context, *context.places_at(middle, lanes))


def _of_places(
    context: DriveContext, places: tuple[tuple[int, int], ...], number: NDArray[intp]
) -> OwnLanelets:
    lanelets = tuple(context.road.lanelet(*place) for place in places)
    return OwnLanelets(places, lanelets, number)


@dataclass(frozen=True, eq=False, slots=True)
class MapContents:
    """What lanelets of a map have: types, signs, limits, lights, marks."""

    types: frozenset[str]
    signs: frozenset[str]
    untold_signs: frozenset[str]
    limits: bool
    minima: bool
    lights: bool
    marks: bool


@once_a_map
def map_contents(context: DriveContext) -> MapContents:
    """What at least one lanelet of the recording's map has."""
    lanelets = context.recording.lanelets.values()
    return MapContents(
        types=frozenset().union(*(lanelet.types for lanelet in lanelets)),
        signs=frozenset().union(*(lanelet.signs for lanelet in lanelets)),
        untold_signs=frozenset().union(*(lanelet.untold_signs for lanelet in lanelets)),
        limits=any(lanelet.limit_mps is not None for lanelet in lanelets),
        minima=any(lanelet.minimum_mps is not None for lanelet in lanelets),
        lights=any(lanelet.lights for lanelet in lanelets),
        marks=any(lanelet.left_mark or lanelet.right_mark for lanelet in lanelets),
    )


def may_hold(context: DriveContext, signs: Set[str]) -> Flags:
    """Mask of states in which the map does not say whether one of these signs holds."""
    if not signs & map_contents(context).untold_signs:
        return np.zeros(context.states, dtype=bool)
    may = own_lanelets(context).flags(lambda lanelet: bool(signs & lanelet.untold_signs))
    may |= context.spans.before(may)
    return may


@once
def travel_lanes(context: DriveContext) -> Flags:
    """Mask of the lanes (second axis) beside ego that are meant for driving, by state.

    All existing lanes except hard shoulders, which are not part of the carriageway, lanes beyond
    these, which belong to another carriageway, such as a road beside the main one, and cycle lanes,
    unless ego is a cycle.
    """
    return travel_lanes_at(context, context.ego_extents.s[0])


@once
def travel_lanes_first(context: DriveContext) -> Flags:
    """``travel_lanes`` with lanes as the first axis, along which they are faster to count."""
    return np.ascontiguousarray(travel_lanes(context).T)


def travel_lanes_at(context: DriveContext, places: Floats) -> Flags:
    """``travel_lanes`` beside places along the road, one per state."""
    types, travel = map_contents(context).types, context.road.lanes.existing_at(places)
    if CYCLE_LANE in types:
        cycles = _lanes_of(context, CYCLE_LANE, places)
        travel = travel & ~(cycles & ~context.ego_is("light_rider")[:, None])
    if SHOULDER not in types:
        return travel
    shoulders = _lanes_of(context, SHOULDER, places)
    # The number of shoulders to the right of each lane
    nearer: NDArray[intp] = shoulders.cumsum(axis=1) - shoulders
    lanes, own = np.arange(shoulders.shape[1]), context.ego_lane[:, None]
    low, high = np.minimum(lanes, own), np.maximum(lanes, own)
    between: NDArray[intp] = (
        np.take_along_axis(nearer, high, axis=1)
        - np.take_along_axis(nearer, low, axis=1)
        - np.take_along_axis(shoulders, low, axis=1)
    )
    return travel & ~shoulders & (between <= 0)


def _lanes_of(context: DriveContext, kind: str, places: Floats) -> Flags:
    """Mask of the lanes (second axis) of a type, by place along the road."""
    of_places: Flags = lanes_of_type(context.road, kind)[context.road.piece(places)]
    return of_places


def lanes_of_type(road: DrivenRoad, kind: str) -> Flags:
    """Mask of the lanes (second axis) of a type, by the road's pieces."""
    return np.array([[x is not None and kind in x.types for x in row] for row in road.rows])


def those_on_lanes(context: DriveContext, kind: str, others: Flags) -> Flags:
    """Mask ``others`` reduced to participants whose lane is of a type."""
    flags, cells, extents = lanes_of_type(context.road, kind), Cells.at(others), context.extents
    return cells.laid(flags[context.road.piece(cells.of(extents.s)), cells.of(extents.lane)])


def room_beside(context: DriveContext) -> tuple[Floats, Floats]:
    """The room (m) in ego's lane to ego's right and left."""
    lane, own = context.steady_lane, context.ego_extents
    return own.from_bound(lane)[0][0], -own.from_bound(lane + 1)[1][0]


@once
def beyond_edges(context: DriveContext) -> tuple[Floats, Floats]:
    """How far (m) ego's middle is beyond the right and the left edge of the lanes of its way."""
    own, (first, end) = context.ego_extents, context.lane_edges
    return -own.middle_from(first)[0], own.middle_from(end)[0]
