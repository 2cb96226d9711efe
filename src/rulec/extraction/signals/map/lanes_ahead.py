"""Where the lanes before a junction lead: along ego's road beyond it, elsewhere, or to both."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from itertools import pairwise

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.computed_once import once_a_recording, once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import map_contents
from rulec.extraction.signals.map.roundabout_signals import roundabouts
from rulec.extraction.signals.words import word_of_objects
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.extraction.tracks.at_junctions.junctions import JunctionWay
from rulec.recordings.recording import Lanelet
from rulec.scenario.recorded.reference_line import turn
from rulec.trace.partly_known.partly_known_values import Truth

_BEYOND_M = 1.0
"""This far behind a junction the lanes are those that go on."""

_HAIR_M = 0.01

_PARTS_RAD = np.radians(20.0)

_SOLID = frozenset({"solid"})


class Leads(Enum):
    """Where a lane leads beyond a junction; ``NOWHERE``: the map has no way from it."""

    ALONG = auto()
    ELSEWHERE = auto()
    BOTH = auto()
    NOWHERE = auto()


@dataclass(frozen=True, eq=False, slots=True)
class JunctionAhead:
    """A junction on ego's road, from ``low`` to ``high``, and where each lane before it leads.

    ``turned`` is the angle (rad) by which ego's road turns there. ``lit``: it may have lights.
    """

    low: float
    high: float
    turned: float
    leads: Sequence[Leads]
    lit: bool


@once_a_road
def junctions_ahead(context: DriveContext) -> Sequence[JunctionAhead]:
    """The junctions and forks of ego's road, and where the lanes before them lead."""
    return (*_junctions_ahead(context), *_forks_ahead(context))


def _junctions_ahead(context: DriveContext) -> Iterator[JunctionAhead]:
    road, ways = context.road, _ways_from(context)
    for low, high in road.junctions:
        if low <= _HAIR_M:
            continue
        turned = road.turned(low, high)
        row = road.rows[int(road.piece(np.array([low - _HAIR_M]))[0])]
        (beyond,) = road.lanes.existing_at(np.array([high + _BEYOND_M]))
        leads = []
        for number, lanelet in enumerate(row):
            lead = Leads.NOWHERE
            if lanelet is not None:
                lead = _lead(context, ways.get(lanelet.id, ()), turned)
            # A lane that does not exist on the road beyond leads to another road
            if lanelet is not None and beyond.any() and not beyond[number] and lead != Leads.BOTH:
                lead = Leads.ELSEWHERE
            leads.append(lead)
        lights = [light for lanelet in row if lanelet is not None for light in lanelet.lights]
        told = "light" in context.recording.complete or map_contents(context).lights
        lit = bool(lights) or not told
        yield JunctionAhead(low, high, turned, tuple(leads), lit)


def _forks_ahead(context: DriveContext) -> Iterator[JunctionAhead]:
    """Where lanes fork outside junctions, as before a separate lane for turning off."""
    road, known = context.road, context.recording.lanelets
    for piece, (row, beyond) in enumerate(pairwise(road.rows)):
        place = float(road.borders[piece + 1])
        if any(low <= place <= high for low, high in road.junctions):
            continue
        ids = {lanelet.id for lanelet in beyond if lanelet is not None}
        onward = _end_heading(road.lanelet(piece + 1, road.own_lanes[piece + 1]))
        leads = []
        for lanelet in row:
            others = [] if lanelet is None else [x for x in lanelet.successors if x in known]
            parts = bool(others) and ids.isdisjoint(others)
            parts &= all(abs(turn(onward, _end_heading(known[x]))) > _PARTS_RAD for x in others)
            leads.append(Leads.ELSEWHERE if parts else Leads.ALONG)
        if Leads.ELSEWHERE in leads:
            yield JunctionAhead(place, place, 0.0, tuple(leads), lit=False)


def _end_heading(lanelet: Lanelet) -> float:
    """The direction (rad) in which a lanelet ends."""
    dx, dy = lanelet.centre[-1] - lanelet.centre[-2]
    return float(np.arctan2(dy, dx))


def _goes_along(context: DriveContext, way: JunctionWay, turned: float) -> bool:
    """Whether a way turns by about as much as ego's road does there (rad)."""
    return bool(abs(turn(way.turned, turned)) <= np.radians(context.thresholds.turned_deg))


def _lead(context: DriveContext, ways: Sequence[JunctionWay], turned: float) -> Leads:
    along = [_goes_along(context, way, turned) for way in ways]
    if not along:
        return Leads.NOWHERE
    if all(along):
        return Leads.ALONG
    return Leads.BOTH if any(along) else Leads.ELSEWHERE


@word_of_objects("leads_elsewhere")
def leads_elsewhere(context: DriveContext) -> Truth:
    """Whether a participant's lane before a junction does not go on along ego's road beyond it.

    Where ways from a lane lead there and elsewhere, the way that the participant takes decides; in
    the junction, the way that it is on. Unknown where the map ends, on lanes that a solid line
    separates from ego's there, and before a ring: drivers choose among several lanes by the exit
    that they will take.
    """
    others, reach = context.extents, context.thresholds.approach_m
    elsewhere, untold = np.zeros((2, *context.relevant.shape), dtype=bool)
    # Riders near ego's road, but on lanes of another one
    elsewhere |= context.relevant & context.tracks.on_lane & ~context.on_lanes
    end, parted = _parted_at_the_end(context)
    if parted.any():
        near = context.on_lanes & (context.road.line.length - others.s_max <= reach)
        near &= others.s >= end
        untold |= near & parted[np.clip(others.lane, 0, len(parted) - 1)]
    rings = {begins for begins, _, at_junction in roundabouts(context) if at_junction}
    for junction in junctions_ahead(context):
        there = context.relevant & (others.s <= junction.high)
        there &= junction.low - others.s_max <= reach
        for row in there.any(axis=1).nonzero()[0].tolist():
            for passage in _passages_at(context, row, junction):
                inside = (context.columns >= passage.first) & (context.columns <= passage.last)
                other, told = _is_on_another_way(context, passage, junction)
                elsewhere[row] |= there[row] & inside & other
                untold[row] |= there[row] & inside & (not told)
        # One that waits there may be past the place where the junction begins for ego
        near = context.on_lanes & (others.s <= junction.high)
        near &= junction.low - others.s_max <= reach
        if not near.any():
            continue
        untold |= near & (junction.low in rings) & (others.lane != context.ego_lane)
        lane = np.clip(others.lane, 0, len(junction.leads) - 1)
        away, both = (
            np.array([leads is kind for leads in junction.leads])[lane]
            for kind in (Leads.ELSEWHERE, Leads.BOTH)
        )
        elsewhere |= near & away
        for row in (near & both).any(axis=1).nonzero()[0].tolist():
            turns_off = _turns_off(context, row, junction)
            elsewhere[row] |= near[row] & both[row] & bool(turns_off)
            untold[row] |= near[row] & both[row] & (turns_off is None)
    return Truth(elsewhere, elsewhere | untold)


@once_a_road
def _parted_at_the_end(context: DriveContext) -> tuple[float, Flags]:
    """Where the map's last piece begins, and its lanes that a solid line separates from ego's.

    Lanes for turning off are drawn like that before junctions, and a junction may come after the
    map's end. On maps that have all lanes, nothing comes after it.
    """
    road, known = context.road, context.recording.lanelets
    row, own, begin = road.rows[-1], road.own_lanes[-1], float(road.borders[-2])
    ends = not any(x in known for lanelet in row if lanelet is not None for x in lanelet.successors)
    parted = np.zeros(len(row), dtype=bool)
    if ends and "lanes" not in context.recording.complete:
        solid = [
            right is not None and left is not None and {right.left_mark, left.right_mark} >= _SOLID
            for right, left in pairwise(row)
        ]
        for lane in range(len(row)):
            parted[lane] = any(solid[min(lane, own) : max(lane, own)])
    return begin, parted


def _passages_at(context: DriveContext, row: int, junction: JunctionAhead) -> Iterator[Passage]:
    """A participant's passages of a junction on ego's road."""
    numbers, passages = (
        _numbers_at(context, junction.low, junction.high),
        context.surroundings.passages,
    )
    of_row = passages.of_row.get(int(context.tracks.rows[row]), ())
    return (passage for passage in of_row if passage.junction in numbers)


@once_a_road
def _numbers_at(context: DriveContext, low: float, high: float) -> frozenset[int]:
    """The numbers of the map's junctions whose ways are on ego's road between two places."""
    inside = context.road.ids_between(low, high)
    junctions = enumerate(context.surroundings.passages.junctions)
    return frozenset(number for number, x in junctions if not inside.isdisjoint(x.names))


def _turns_off(context: DriveContext, row: int, junction: JunctionAhead) -> bool | None:
    """Whether a participant leaves ego's road at a junction; None if its track does not show it."""
    for passage in _passages_at(context, row, junction):
        if passage.sure:
            way = context.surroundings.passages.way(passage)
            return not _goes_along(context, way, junction.turned)
    return None


def _is_on_another_way(
    context: DriveContext, passage: Passage, junction: JunctionAhead
) -> tuple[bool, bool]:
    """Whether a participant passes a junction on another way than ego's, and whether that is told.

    It came on another road, as its direction then shows, or it turns differently. Not told where
    its track does not show its way.
    """
    passages = context.surroundings.passages
    begins = passage.first == int(passages.tracks.present[passage.row].argmax())
    came_from = context.road.line.heading_at(junction.low - _HAIR_M)
    came = abs(turn(came_from, passage.heading)) > np.radians(context.thresholds.turned_deg)
    leaves = not _goes_along(context, passages.way(passage), junction.turned)
    other = bool(came and not begins) or (passage.sure and bool(came or leaves))
    return other, other or passage.sure or not (begins or leaves)


@once_a_recording
def _ways_from(context: DriveContext) -> Mapping[str, Sequence[JunctionWay]]:
    """Lanelet before a junction -> the ways that lead on from it."""
    ways: dict[str, list[JunctionWay]] = defaultdict(list)
    for junction in context.surroundings.passages.junctions:
        for way in junction.ways:
            for entry in way.entries:
                ways[entry].append(way)
    return ways
