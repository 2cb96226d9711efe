"""Facts about a whole recording, computed once: junctions, passages, carriageways."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import kept_in
from rulec.extraction.recording_parts import whole_recording
from rulec.extraction.tracks.at_junctions.junction_passages import (
    JunctionPassages,
    junction_passages,
)
from rulec.extraction.tracks.at_junctions.rings import ring_lanelets
from rulec.extraction.tracks.heading_errors import head_as_they_move, heading_errors
from rulec.extraction.tracks.source_tolerances import Tolerances, tolerances_of
from rulec.extraction.tracks.tracks import ObjectTypes, Tracks
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import HEADINGS, Lanelet, Recording, Side, WholeRecording, is_lane
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import directions_beside, lanelet_area, lanes_beside

SAME_CARRIAGEWAY_M = 1.5
OTHER_CARRIAGEWAY_M = 30.0
"""Greatest distances (m) between the lanes of a carriageway, and the carriageways of a road."""

_AGAINST = np.radians(135.0)

_DRIFT_M = 1.5
"""Boxes of standing participants drift by up to this."""

_IN_TRAFFIC = frozenset({"hazard_lights", "blue_light", "doors", "left_doors", "right_doors"})
"""Nobody leaves a parked vehicle with these on or open."""

_IN_LANE_M = 0.5
"""Who waits in a lane is no farther (m) from its middle line; who parks stands at its edge."""

_ALONG_LANE = np.radians(30.0)

_HAIR = 1e-9
"""Upper bound on rounding errors of a cosine."""

BACKS_MPS = 4.5
"""Hardly anybody backs along a lane faster (16 km/h), steered by the rear and looking back."""

Directions = tuple["bool | None", "bool | None"]

_once_a_map = kept_in("of_map")


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The junctions, passages and carriageways of a recording.

    ``computed`` caches signals' results about the recording, ``of_map`` those about its map.
    """

    recording: Recording
    tracks: Tracks
    thresholds: Thresholds
    computed: dict[object, Any] = field(default_factory=dict)
    of_map: dict[object, Any] = field(default_factory=dict)

    def __reduce__(self) -> tuple[type[Surroundings], tuple[object, ...]]:
        # Caches are dropped and computed again: their keys are functions, which cannot be pickled.
        return Surroundings, (self.recording, self.tracks, self.thresholds)

    def and_one(self, other: Surroundings, row: int, types: ObjectTypes) -> Surroundings:
        """These surroundings, with one row of ``other``'s participants added as the last.

        ``types`` are those of all of them.
        """
        tracks = self.tracks.and_one(other.tracks, row, types)
        joined = replace(self, tracks=tracks, computed={})
        joined.__dict__["passages"] = self.passages.and_one(other.passages, row, tracks)
        for name in ("tolerances", "_lanes", "_both_ways"):
            joined.__dict__[name] = getattr(self, name)
        for name in ("heading_errors", "head_as_they_move", "waits"):
            both = getattr(self, name), getattr(other, name)[row : row + 1]
            joined.__dict__[name] = np.concatenate(both)
        return joined

    @cached_property
    def whole(self) -> WholeRecording:
        """Facts about the whole recording."""
        return whole_recording(self.recording)

    @cached_property
    def tolerances(self) -> Tolerances:
        """The errors of places and speeds."""
        return tolerances_of(self.recording, self.thresholds, self.whole)

    @cached_property
    def heading_errors(self) -> Floats:
        """The possible errors (rad) of headings, by row and column."""
        return heading_errors(
            self.tracks,
            self.whole,
            self.recording.step_s,
            are_stated=self.states_all_headings,
        )

    @cached_property
    def head_as_they_move(self) -> Flags:
        """Mask of participants, by row, whose headings do not show whether they back.

        These are the directions in which they move. Some sources state the headings of all.
        """
        if self.states_all_headings:
            return np.zeros(len(self.tracks.participants), dtype=bool)
        return head_as_they_move(self.tracks)

    @property
    def states_all_headings(self) -> bool:
        """Whether the source states everybody's headings: none is only a direction of motion."""
        return not self.recording.complete.isdisjoint({"arrivals", HEADINGS})

    @cached_property
    def passages(self) -> JunctionPassages:
        """The passages of all participants through junctions."""
        return junction_passages(self.recording, self.tracks)

    @cached_property
    def stays(self) -> Flags:
        """Mask of participants that stand for as long as they are recorded, by row.

        No two places of one are farther apart than ``_DRIFT_M``.
        """
        tracks = self.tracks
        spreads = [
            np.where(tracks.present, places, -np.inf).max(axis=1, initial=-np.inf)
            - np.where(tracks.present, places, np.inf).min(axis=1, initial=np.inf)
            for places in (tracks.x, tracks.y)
        ]
        diagonal = np.hypot(spreads[0], spreads[1])
        still: Flags = diagonal <= _DRIFT_M
        # For a few the spreads do not decide: they depend on the direction of a file's axes
        in_doubt = (np.maximum(*spreads) <= _DRIFT_M) & np.isfinite(diagonal) & ~still
        for row in in_doubt.nonzero()[0].tolist():
            own = tracks.present[row]
            places = shapely.multipoints(np.column_stack((tracks.x[row, own], tracks.y[row, own])))
            corners = shapely.get_coordinates(shapely.convex_hull(places))
            farthest = max(np.hypot(*(corners - corner).T).max() for corner in corners)
            still[row] = farthest <= _DRIFT_M
        return still

    @cached_property
    def in_traffic(self) -> Flags:
        """Mask of participants, by row, that move at some time or ``waits`` says so of."""
        moves: Flags = self.tracks.fastest * KMH_PER_MPS >= self.thresholds.standing_kmh
        return moves | self.waits

    @cached_property
    def waits(self) -> Flags:
        """Mask of vehicles, by row, that stand for as long as they are recorded and do not park.

        They run on rails, show lamps or open doors as nobody does that parks, or stand in the
        middle of a lane and in its direction.
        """
        tracks = self.tracks
        still = self.stays & tracks.of_type("vehicle") & tracks.present.any(axis=1)
        found: Flags = still & tracks.of_type("rail_vehicle")
        for row in (still & ~found).nonzero()[0].tolist():
            body = tracks.participants[row]
            lit = any(_IN_TRAFFIC & lamps for lamps in body.lamps.values())
            found[row] = lit or (not body.standing and self._stands_in_lane(row))
        return found

    def _stands_in_lane(self, row: int) -> bool:
        """Whether a participant is, when first seen, in the middle of a lane of its direction."""
        column = int(self.tracks.present[row].argmax())
        place = shapely.Point(self.tracks.x[row, column], self.tracks.y[row, column])
        lanes, tree = self._lanes
        near = [lanes[index] for index in tree.query(place, predicate="intersects").tolist()]
        at, heading = np.array([place]), float(self.tracks.heading[row, column])
        return any(
            shapely.distance(shapely.LineString(lane.centre), place) <= _IN_LANE_M
            and abs(turn(heading, float(directions_beside(lane, at)[0]))) < _ALONG_LANE
            for lane in near
        )

    @_once_a_map
    def ring(self, side: Side) -> frozenset[str]:
        """The lanelets of roundabouts, for traffic that keeps to ``side``."""
        return ring_lanelets(self.recording, side)

    @cached_property
    def _lanes(self) -> tuple[list[Lanelet], shapely.STRtree]:
        lanes = [x for x in self.recording.lanelets.values() if is_lane(x)]
        lanes = [x for x in lanes if "intersection" not in x.types]
        return lanes, shapely.STRtree([lanelet_area(x) for x in lanes])

    @cached_property
    def _both_ways(self) -> bool:
        """Whether some lanelet of the map has one beside it that leads the other way."""
        lanes, _ = self._lanes
        return any(self._nearest_opposite(lane.id) <= OTHER_CARRIAGEWAY_M for lane in lanes)

    @_once_a_map
    def directions(self, name: str) -> Directions:
        """Whether a lanelet's carriageway is one-way, and whether a strip or barrier divides it.

        None is unknown. Decided by the nearest lane beside its middle that leads the other way. A
        map without any may have left them out. In a junction the roads that lead there decide.
        """
        lanelet = self.recording.lanelets[name]
        if "intersection" in lanelet.types:
            found = {self.directions(road.id) for road in self._roads_before(lanelet)}
            return found.pop() if len(found) == 1 else (None, None)
        nearest = self._nearest_opposite(name)
        if nearest <= SAME_CARRIAGEWAY_M:
            return False, False
        if nearest <= OTHER_CARRIAGEWAY_M:
            return True, True
        complete = "light" in self.recording.complete
        return (
            True if complete or self._both_ways else None,
            False if complete else None,
        )

    def is_surely_one_way(self, lanelet: Lanelet, side: Side) -> bool:
        """Whether nobody may drive against a lane: in rings, on motorways, on several lanes.

        Of a carriageway with a single lane, some maps contain only one direction.
        """
        if lanelet.id in self.ring(side) or "interstate" in lanelet.types:
            return True
        if "intersection" in lanelet.types or not self.directions(lanelet.id)[0]:
            return False
        beside = (lanes_beside(self.recording, lanelet.id, left=left) for left in (True, False))
        return "lanes" in self.recording.complete or any(beside)

    def _roads_before(self, lanelet: Lanelet) -> Iterator[Lanelet]:
        """The lanelets outside junctions from which a lanelet in a junction can be reached."""
        seen, waiting = {lanelet.id}, [lanelet]
        while waiting:
            for name in set(waiting.pop().predecessors) & self.recording.lanelets.keys() - seen:
                seen.add(name)
                before = self.recording.lanelets[name]
                if "intersection" in before.types:
                    waiting.append(before)
                else:
                    yield before

    @_once_a_map
    def _nearest_opposite(self, name: str) -> float:
        """The distance (m) from a lanelet's carriageway to a lane that leads the other way."""
        lanelet, (lanes, tree) = self.recording.lanelets[name], self._lanes
        beside = [
            name
            for left in (True, False)
            for name in lanes_beside(self.recording, lanelet.id, left=left)
        ]
        middle = shapely.LineString(lanelet.centre).interpolate(0.5, normalized=True)
        places = np.array([middle])
        heading = float(directions_beside(lanelet, places)[0])
        far, opposite = OTHER_CARRIAGEWAY_M, []
        x, y = middle.x, middle.y
        around = shapely.box(x - far, y - far, x + far, y + far)
        for index in tree.query(around).tolist():
            lane = lanes[index]
            if lane.id in (lanelet.id, *beside) or not _turns_against(lane, heading):
                continue
            turned = abs(turn(heading, float(directions_beside(lane, places)[0])))
            is_across = turned > _AGAINST and _is_beside(lane, middle, heading)
            area = tree.geometries[index]
            if is_across and shapely.dwithin(area, middle, far):
                opposite.append(area)
        if not opposite:
            return np.inf
        row = [lanelet, *(self.recording.lanelets[name] for name in beside)]
        own = shapely.intersection(
            shapely.union_all([lanelet_area(x) for x in row]),
            shapely.buffer(middle, OTHER_CARRIAGEWAY_M),
        )
        return float(shapely.distance(opposite, own).min())


def _turns_against(lane: Lanelet, heading: float) -> bool:
    """Whether some part of a lane may lead against a heading (rad)."""
    steps = lane.centre[1:] - lane.centre[:-1]
    along = steps @ np.array([np.cos(heading), np.sin(heading)])
    return bool((along <= (np.cos(_AGAINST) + _HAIR) * np.hypot(*steps.T)).any())


def _is_beside(lane: Lanelet, place: shapely.Point, heading: float) -> bool:
    """Whether the nearest place of a lane is across from a place, not ahead of or behind it."""
    line = shapely.LineString(lane.centre)
    near = line.interpolate(line.project(place))
    away = np.array([near.x - place.x, near.y - place.y])
    along = abs(float(away @ np.array([np.cos(heading), np.sin(heading)])))
    return along <= 1.0 + 0.2 * float(np.hypot(*away))
