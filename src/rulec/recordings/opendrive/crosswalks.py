"""Pedestrian crossings of an OpenDRIVE file: objects, and the standard's signal 1000003."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from rulec.recordings.opendrive.content.elements import MapRoad, RoadObject
from rulec.recordings.opendrive.lane_furniture import drivable, piece_at
from rulec.recordings.opendrive.lane_lines import places_beside, span_at
from rulec.recordings.opendrive.pieces import RoadPiece
from rulec.recordings.opendrive.plan_view import place_on
from rulec.recordings.opendrive.posted_signs import Posted
from rulec.recordings.opendrive.signal_catalogues import CROSSWALK, WALKERS_LIGHTS
from rulec.recordings.recording import LONGEST_M, Lanelet, Points
from rulec.recordings.road_map import crosswalk

_LIGHT_AT_M = 10.0
"""Pedestrian lights stand at most this far from their crossing."""

_USUAL_M = 4.0
"""The depth of a crossing for which the file gives none."""

_SIDES = 4
_SMALLEST_M2 = 0.1


def crosswalks(
    road: MapRoad, pieces: Sequence[RoadPiece], posted: Sequence[Posted]
) -> Iterator[Lanelet]:
    """The crossings on a road as lanelets that lead across it."""
    signals = [x.signal for x in posted]
    lights = [x.s for x in signals if x.dynamic and x.type in WALKERS_LIGHTS]
    for number, thing in enumerate(road.objects):
        if is_crosswalk(thing):
            name = f"{road.id}.crosswalk {thing.id or number}"
            yield from _crosswalk(name, _corners(road, thing), road, thing.s, lights)
    for number, signal in enumerate(road.signals):
        if signal.type == CROSSWALK:
            depth = signal.value or _USUAL_M
            ends = signal.s, signal.s + (-depth if signal.orientation == "-" else depth)
            low, high = max(min(ends), 0.0), min(max(ends), road.length)
            across = _carriageway(piece_at(pieces, signal.s), signal.s)
            if across is not None and high > low:
                right, left = across
                ring = [(low, right), (high, right), (high, left), (low, left)]
                name = f"{road.id}.crosswalk signal {number}"
                yield from _crosswalk(name, places_beside(road, ring), road, signal.s, lights)


def is_crosswalk(thing: RoadObject) -> bool:
    """Whether an object is a pedestrian crossing; before version 1.8, its type says so."""
    return "crosswalk" in (thing.type, thing.subtype) or thing.subtype == "pedestrianCrossing"


def _carriageway(piece: RoadPiece, s: float) -> tuple[float, float] | None:
    """The lowest and the highest ``t`` of the carriageway's lanes at ``s``; None without any."""
    spans = [span_at(piece, key.lane, s) for key in drivable(piece)]
    if not spans:
        return None
    return min(low for low, _ in spans), max(high for _, high in spans)


def _corners(road: MapRoad, thing: RoadObject) -> Points:
    if thing.on_road and thing.corners:
        return places_beside(road, thing.corners)
    length, width = thing.length / 2, thing.width / 2
    own = thing.corners or ((length, width), (-length, width), (-length, -width), (length, -width))
    place = places_beside(road, [(thing.s, thing.t)])[0]
    turned = _heading(road, thing.s) + thing.heading
    cos, sin = np.cos(turned), np.sin(turned)
    corners: Points = place + np.array(own) @ np.array([[cos, sin], [-sin, cos]])
    return corners


def _heading(road: MapRoad, s: float) -> float:
    return place_on(road.geometries, min(s, road.length))[2]


def _crosswalk(
    name: str, corners: Points, road: MapRoad, s: float, lights: Sequence[float]
) -> Iterator[Lanelet]:
    """The lanelet of a crossing; nothing if its outline has no area or is too large."""
    ring = corners[:-1] if len(corners) > 1 and np.allclose(corners[0], corners[-1]) else corners
    if len(ring) != _SIDES:
        whole = shapely.MultiPoint(ring).minimum_rotated_rectangle
        if whole.geom_type != "Polygon":
            return
        ring = shapely.get_coordinates(whole)[:_SIDES]
    outline = shapely.Polygon(ring)
    if np.ptp(ring, axis=0).max() > LONGEST_M or outline.area < _SMALLEST_M2:
        return
    if not outline.exterior.is_ccw:
        ring = ring[::-1]
    # Counter-clockwise; the first and third sides must be those across the road
    along = np.array([np.cos(_heading(road, s)), np.sin(_heading(road, s))])
    sides = np.roll(ring, -1, axis=0) - ring
    parts = np.abs(sides @ along) / np.maximum(np.hypot(*sides.T), 1e-9)
    if parts[0] + parts[2] > parts[1] + parts[3]:
        ring = np.roll(ring, -1, axis=0)
    right, left = ring[:2], ring[:1:-1]
    directed = any(abs(light - s) <= _LIGHT_AT_M for light in lights)
    yield crosswalk(name, left, right, directed=directed)
