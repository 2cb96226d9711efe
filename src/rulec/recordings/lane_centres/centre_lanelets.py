"""Lanelets from lanes given by their centre lines, with the neighbours and signs of these."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from rulec.recordings.lane_centres.lane_pieces import (
    LanePiece,
    mark_of,
    neighbours_of_pieces,
    pieces_of_lanes,
)
from rulec.recordings.lane_centres.lane_widths import HalfWidths, at_their_lines, half_widths
from rulec.recordings.lane_centres.road_features import (
    BoundaryPart,
    CentreLane,
    LaneSide,
    NeighbourPart,
    RoadFeatures,
)
from rulec.recordings.lanes.lanes_along import led_to
from rulec.recordings.polylines import arc_lengths, crossings, far_apart, parallel_line
from rulec.recordings.recording import Lanelet, ObservedLight, Points
from rulec.recordings.road_map import crosswalk_with_outline

ALL_JUNCTIONS = frozenset({"junctions"})
"""Such maps contain all junctions; elsewhere, lanes cross only at different heights."""

_CLOSEST_M = 0.01
_STOP = frozenset({"STOP"})


def centre_lanelets(features: RoadFeatures, *, has_lights: bool) -> dict[str, Lanelet]:
    """The lanelets of a road, by id: its lanes, cut into pieces, and its crosswalks.

    ``has_lights``: whether the file contains observed lights; other junctions may then have lights
    that were not observed.
    """
    features = replace(features, lanes=_sound_lanes(features.lanes))
    features = replace(features, lanes=at_their_lines(features))
    lanes = features.lanes
    inside = junction_stretches(features)
    pieces = pieces_of_lanes(lanes, inside)
    left_of = neighbours_of_pieces(lanes, pieces)
    right_of = {left: right for right, left in left_of.items()}
    widths = half_widths(features)
    lanelets: dict[str, Lanelet] = {}
    for name, own in pieces.items():
        lane = lanes[name]
        bounds = _bounds(lane, widths[name])
        before = [pieces[other][-1].id for other in lane.follows if other in pieces]
        after = [pieces[other][0].id for other in lane.leads_to if other in pieces]
        for number, piece in enumerate(own):
            part = slice(piece.start, piece.end + 1)
            lanelets[piece.id] = Lanelet(
                id=piece.id,
                left=bounds[0][part],
                right=bounds[1][part],
                centre=lane.centre[part, :2],
                successors=tuple(after) if number == len(own) - 1 else (own[number + 1].id,),
                predecessors=(own[number - 1].id,) if number else tuple(before),
                left_of=left_of.get(piece.id),
                right_of=right_of.get(piece.id),
                types=lane.types | _junction_type(piece, inside.get(name)),
                limit_mps=lane.limit_mps,
                left_mark=mark_of(lane.left, piece),
                right_mark=mark_of(lane.right, piece),
            )
    lanelets.update(_regulated(lanelets, features, pieces, has_lights=has_lights))
    for name, polygon in features.crosswalks.items():
        lanelets[f"crosswalk {name}"] = crosswalk_with_outline(f"crosswalk {name}", polygon)
    return lanelets


def _junction_type(piece: LanePiece, stretch: tuple[int, int] | None) -> frozenset[str]:
    """The type of a piece whose middle lies in a junction."""
    if stretch is None or not 2 * stretch[0] <= piece.start + piece.end <= 2 * stretch[1]:
        return frozenset()
    return frozenset({"intersection"})


def _sound_lanes(lanes: Mapping[str, CentreLane]) -> dict[str, CentreLane]:
    """The lanes with some length, without repeated points; links lead past the lanes left out."""
    kept = {
        name: far_apart(lane.centre[:, :2], _CLOSEST_M).tolist() if len(lane.centre) else []
        for name, lane in lanes.items()
    }
    there = {name for name, points in kept.items() if len(points) > 1}
    after = {name: lane.leads_to for name, lane in lanes.items()}
    before = {name: lane.follows for name, lane in lanes.items()}
    sound = {}
    for name in lanes:
        if name in there:
            lane, points = lanes[name], kept[name]
            sound[name] = replace(
                lane,
                centre=lane.centre[points],
                follows=led_to(before, name, there.__contains__),
                leads_to=led_to(after, name, there.__contains__),
                left=_renumbered(lane.left, points, kept),
                right=_renumbered(lane.right, points, kept),
            )
    return sound


def _renumbered(side: LaneSide, points: list[int], kept: Mapping[str, list[int]]) -> LaneSide:
    def now(index: int, of: list[int]) -> int:
        return max(int(np.searchsorted(of, index, side="right")) - 1, 0)

    return LaneSide(
        boundaries=tuple(
            BoundaryPart(now(part.start, points), now(part.end, points), part.line, part.mark)
            for part in side.boundaries
        ),
        neighbours=tuple(
            NeighbourPart(
                part.lane,
                now(part.start, points),
                now(part.end, points),
                now(part.other_start, kept[part.lane]),
                now(part.other_end, kept[part.lane]),
            )
            for part in side.neighbours
            if part.lane in kept and len(kept[part.lane]) > 1
        ),
    )


def _bounds(lane: CentreLane, widths: HalfWidths) -> tuple[Points, Points]:
    centre = lane.centre[:, :2]
    return parallel_line(centre, widths.left), parallel_line(centre, -widths.right)


def _regulated(
    lanelets: Mapping[str, Lanelet],
    features: RoadFeatures,
    pieces: Mapping[str, tuple[LanePiece, ...]],
    *,
    has_lights: bool,
) -> Iterator[tuple[str, Lanelet]]:
    """The lanelets that lead to lanes with lights or stop signs, with these attached.

    The files attach both to the lane after the line; here they belong to the one before it, or stay
    where they are if there is none. A light's stop point is not a line: cars wait up to 2 m beyond
    it.
    """
    behind: dict[str, list[str]] = defaultdict(list)
    for name, own in pieces.items():
        for before in lanelets[own[0].id].predecessors:
            behind[before].append(name)
        if not lanelets[own[0].id].predecessors and name in features.stop_lanes:
            first = lanelets[own[0].id]
            line = np.stack((first.left[0], first.right[0]))
            yield first.id, replace(first, signs=first.signs | _STOP, stop_line=line)
    for before, names in behind.items():
        lanelet = lanelets[before]
        if "intersection" in lanelet.types:
            continue
        stops = [name for name in names if name in features.stop_lanes]
        seen = {name: features.lights[name] for name in names if name in features.lights}
        lights = {name: ObservedLight(colours) for name, colours in seen.items()}
        if has_lights and not stops:
            inside = [x for x in names if "intersection" in lanelets[pieces[x][0].id].types]
            lights = {x: lights.get(x, ObservedLight({}, seen=False)) for x in inside}
        if stops or lights:
            yield (
                before,
                replace(
                    lanelet,
                    signs=_STOP if stops else frozenset(),
                    lights=tuple(lights.values()),
                    lights_to={pieces[name][0].id: light for name, light in lights.items()},
                ),
            )


CROSSING_RAD = np.radians(30.0)
"""Lanes that meet at a smaller angle (rad) merge or diverge rather than cross."""

APART_M = 2.5
"""Lanes whose heights differ by more (m) do not meet: a truck fits through below."""


LONGEST_M = 60.0
"""The longest way (m) through a junction; of a longer lane only a part lies in one."""

AROUND_M = 15.0
"""How far (m) that part extends before and after the crossings with other lanes."""

Stretch = tuple[int, int]
"""The part of a lane between two points of its centre line, by index."""


def junction_stretches(features: RoadFeatures) -> dict[str, Stretch]:
    """The lanes in junctions, with the parts of them that lie there.

    These are lanes whose centre line crosses another at the same height, lanes with a light or a
    stop sign, which stand where a junction begins, and lanes that begin at the same place as one of
    these.
    """
    lanes, crossed = features.lanes, _crossed(features.lanes)
    begin = (features.stop_lanes | set(features.lights)) & set(lanes)
    begin_with = defaultdict(set)
    for lane in lanes.values():
        for before in lane.follows:
            begin_with[before].add(lane.id)
    for group in begin_with.values():
        if group & (begin | crossed.keys()):
            begin |= group
    return {
        name: _stretch(lanes[name], crossed.get(name, []), from_start=name in begin)
        for name in sorted(begin | crossed.keys())
    }


def _stretch(lane: CentreLane, places: list[float], *, from_start: bool) -> Stretch:
    along = arc_lengths(lane.centre[:, :2])
    last = len(along) - 1
    if along[-1] <= LONGEST_M:
        return 0, last
    starts = [0.0] if from_start else []
    low = min([*starts, *(place - AROUND_M for place in places)])
    high = max([*starts, *places]) + AROUND_M
    start, end = np.searchsorted(along, [low, high]).tolist()
    return int(start), min(int(end), last)


def _crossed(lanes: Mapping[str, CentreLane]) -> dict[str, list[float]]:
    """The lanes that others cross, with the positions of the crossings along them (m)."""
    cars = [lane for lane in lanes.values() if "bicycleLane" not in lane.types]
    found: dict[str, list[float]] = defaultdict(list)
    for pair in crossings([lane.centre[:, :2] for lane in cars], CROSSING_RAD):
        first, second = cars[pair.first], cars[pair.second]
        apart_m = _height(first, pair.first_along) - _height(second, pair.second_along)
        # Unknown heights do not separate lanes
        if not abs(apart_m) > APART_M:
            found[first.id].append(pair.first_along)
            found[second.id].append(pair.second_along)
    return found


def _height(lane: CentreLane, along: float) -> float:
    """The height (m) of a centre line where the segment at a place along it (m) begins."""
    piece = int(arc_lengths(lane.centre[:, :2])[1:-1].searchsorted(along, "right"))
    return float(lane.centre[piece, 2])
