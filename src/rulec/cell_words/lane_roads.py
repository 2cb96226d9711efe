"""The roads that drives have along the lanes of a scene's road.

A drive that goes on in another lane has its road along that lane: it may come from elsewhere, lanes
that part or join are counted from it, and it has its own lanelets' bounds, junctions and lanes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np

from rulec.array_types import Floats
from rulec.cell_words.probe_drives import ProbeDrives
from rulec.extraction.tracks.driven_road import DrivenRoad
from rulec.recordings.recording import Lanelet
from rulec.scenario.recorded.scene_origin import SceneOrigin

Row = Sequence["Lanelet | None"]

_MOST_M = 1.0
_HAIR_M = 0.05


@dataclass(frozen=True, slots=True)
class Parting:
    """A place (m) of the road beyond which lanes may differ, ahead (1) of ego or behind (-1).

    ``shifts`` are the possible numbers of lanes farther left, ascending; empty if unknown.
    """

    place: float
    way: int
    shifts: Sequence[int]


@dataclass(frozen=True, eq=False)
class LaneRoads:
    """A scene's ``road`` and the ``others`` along those of its lanes that ego may reach.

    The other roads begin at ego's place, on the road's piece with the number ``piece``.
    """

    origin: SceneOrigin
    road: DrivenRoad
    piece: int
    others: tuple[tuple[DrivenRoad, int], ...]

    @property
    def roads(self) -> tuple[DrivenRoad, ...]:
        """All of the roads."""
        return self.road, *(road for road, _ in self.others)

    def in_scene(
        self, road: DrivenRoad, stretches: Sequence[tuple[float, float]]
    ) -> list[tuple[float, float]]:
        """Stretches of a road as intervals along the scene's road."""
        line, found = road.line, []
        for ends in stretches:
            s = np.array(ends)
            piece = np.clip(np.searchsorted(line.arc, s, "right") - 1, 0, len(line.arc) - 1)
            places = line.start[piece] + line.ahead[piece] * (s - line.arc[piece])[:, None]
            first, last = (self.origin.line.coordinates(places)[:, 0] - self.origin.ego_s).tolist()
            found.append((first, last))
        return found

    def apart(self, line_s: Floats) -> tuple[Floats, Floats]:
        """How far (m) the scene's line and its lane bounds are from those of drives.

        In bends each line along a road cuts corners in its own way, and lanes that part overlap.
        """
        lanes, straight = self.origin.lanes, self.origin.lanes.straight
        there = np.pad(lanes.existing_at(line_s + self.origin.ego_s), ((0, 0), (1, 1)))
        line_d, bounds_d = np.zeros((2, len(line_s)))
        for number, d in enumerate((0.0, *straight.tolist())):
            places, _ = self.origin.places(line_s, np.full(len(line_s), d))
            for road in self.roads:
                found = road.line.coordinates(places)[:, :2]
                beside = (found[:, 0] > 0.0) & (found[:, 0] < road.line.arc[-1])
                if not beside.any():
                    continue
                if number:
                    beside &= there[:, number - 1] | there[:, number]
                    aside = np.abs(road.lanes.from_bounds(found)).min(axis=1)
                else:
                    aside = np.abs(found[:, 1] - np.median(found[beside, 1]))
                apart = bounds_d if number else line_d
                apart[beside] = np.maximum(apart[beside], np.minimum(aside[beside], _MOST_M))
        return line_d, bounds_d

    def other_lanes(self, line_s: Floats) -> Iterator[tuple[float, float]]:
        """The stretches of the scene's road where another road has other lanes beside it."""
        places, _ = self.origin.places(line_s, np.zeros(len(line_s)))
        own, differs = _lanes_at(self.road, places), np.zeros(len(line_s), dtype=bool)
        for road, _ in self.others:
            theirs = _lanes_at(road, places)
            differs |= [
                bool(ids) and not rows.isdisjoint(others) and ids != others_there
                for (rows, ids), (others, others_there) in zip(own, theirs, strict=True)
            ]
        for differ, run in groupby(range(len(line_s)), key=differs.__getitem__):
            numbers = list(run)
            if differ:
                last = min(numbers[-1] + 1, len(line_s) - 1)
                yield float(line_s[max(numbers[0] - 1, 0)]), float(line_s[last])

    def partings(self) -> list[Parting]:
        """Where one lane becomes several, or several become one, ahead of ego and behind it.

        A drive's lanes beyond are those that its lane leads to or comes from; ego may be in any.
        """
        found = []
        for (before, after), border in zip(
            pairwise(self.road.rows), self.road.borders[1:-1].tolist(), strict=True
        ):
            ((place, _),) = self.in_scene(self.road, [(border, border)])
            way = 1 if place > 0.0 else -1
            near, far = (before, after) if way > 0 else (after, before)
            shifts = {0}
            for row, others, onward in ((near, far, way), (far, near, -way)):
                for k, lanelet in enumerate(row):
                    linked = () if lanelet is None else linked_with(lanelet, onward)
                    into = [j for j, lane in enumerate(others) if lane and lane.id in linked]
                    if len(into) > 1:
                        shifts |= {k - j if row is near else j - k for j in into}
            if len(shifts) > 1:
                found.append(Parting(place, way, tuple(sorted(shifts))))
        found += [parting for road, first in self.others for parting in self._behind(road, first)]
        return list(_joined(found))

    def _behind(self, road: DrivenRoad, first: int) -> Iterator[Parting]:
        """Where behind ego another road's lanes differ, or it is no longer this road."""
        (own,) = (
            k
            for k, lanelet in enumerate(self.road.rows[self.piece])
            if lanelet is not None and lanelet is road.rows[first][road.own_lanes[first]]
        )
        shift = own - road.own_lanes[first]
        lanes = {
            lanelet.id: k + shift
            for row in road.rows[: first + 1]
            for k, lanelet in enumerate(row)
            if lanelet is not None
        }
        known = 0, 0
        for piece in reversed(range(self.piece)):
            row = [(k, lane.id) for k, lane in enumerate(self.road.rows[piece]) if lane is not None]
            shifts = {lanes[name] - k for k, name in row if name in lanes}
            least, most = min(known[0], *shifts, 0), max(known[1], *shifts, 0)
            more = {0, least - known[0], most - known[1]}
            if not shifts or more != {0}:
                border = float(self.road.borders[piece + 1])
                ((place, _),) = self.in_scene(self.road, [(border, border)])
                yield Parting(place, -1, tuple(sorted(more)) if shifts else ())
            if not shifts:
                return
            known = least, most


def _joined(partings: Sequence[Parting]) -> Iterator[Parting]:
    """The partings, with those at the same place joined into one."""
    at = [(round(parting.place / _HAIR_M), parting.way) for parting in partings]
    for key in dict.fromkeys(at):
        own = [parting for one, parting in zip(at, partings, strict=True) if one == key]
        known = all(parting.shifts for parting in own)
        shifts = sorted({by for parting in own for by in parting.shifts}) if known else ()
        yield Parting(own[0].place, own[0].way, tuple(shifts))


def lane_roads(
    probes: ProbeDrives, road: DrivenRoad, ego_d: float, lanes: Sequence[int] | None = None
) -> LaneRoads:
    """The roads along a road's lanes that ego may reach, or along all if ``lanes`` is None."""
    origin = probes.origin
    places, _ = origin.places(np.zeros(1), np.full(1, ego_d))
    piece = int(road.piece(road.line.coordinates(places)[:, 0])[0])
    others = []
    for chain in _chains(road.rows[piece:], range(len(road.rows[0])) if lanes is None else lanes):
        found = probes.among.map.road(tuple(lanelet.id for lanelet in chain))
        if not isinstance(found, str) and not found[0].meets_itself and found[0] is not road:
            others.append(found)
    return LaneRoads(origin, road, piece, tuple(others))


def linked_with(lanelet: Lanelet, way: int) -> tuple[str, ...]:
    """The lanelets to which a lanelet leads (1), or that lead to it (-1)."""
    return lanelet.successors if way > 0 else lanelet.predecessors


def _chains(rows: Sequence[Row], lanes: Sequence[int]) -> Iterator[list[Lanelet]]:
    """Chains of lanelets that lead to each other from the first row on, covering these lanes."""
    known = set[str]()
    for lane in lanes:
        for number, row in enumerate(rows):
            lanelet = row[lane]
            if lanelet is None or lanelet.id in known:
                continue
            chain = [lanelet]
            for before in reversed(rows[:number]):
                own = [one for one in before if one and chain[0].id in one.successors]
                if not own:
                    break
                chain.insert(0, own[0])
            for after in rows[number + 1 :]:
                own = [one for one in after if one and one.id in chain[-1].successors]
                if not own:
                    break
                chain.append(next((one for one in own if one.id not in known), own[0]))
            known |= {one.id for one in chain}
            if chain[0] in rows[0]:
                yield chain


def _lanes_at(road: DrivenRoad, places: np.ndarray) -> list[tuple[frozenset[str], frozenset[str]]]:
    """The lanelets beside each other at each place, and those of them that exist as lanes there."""
    s = road.line.coordinates(places)[:, 0]
    known: dict[tuple[int, bytes], tuple[frozenset[str], frozenset[str]]] = {}
    found = []
    beside = (s > 0.0) & (s < road.line.arc[-1])
    there = road.lanes.existing_at(s)
    for piece, flags, is_beside in zip(road.piece(s).tolist(), there, beside.tolist(), strict=True):
        key = piece if is_beside else -1, flags.tobytes()
        if key not in known:
            row = road.rows[piece] if is_beside else ()
            known[key] = (
                frozenset(lane.id for lane in row if lane),
                frozenset(lane.id for lane, own in zip(row, flags, strict=False) if lane and own),
            )
        found.append(known[key])
    return found
