"""Intersections, stop lines and the weather of the library's, as a recording has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from typing import Any

import numpy as np
import shapely

from rulec.scenario.recorded import recording

_WET = frozenset({"light_rain", "mid_rain", "heavy_rain", "hail"})
_DRY = frozenset({"clear", "cloudy"})
_FAR_M = 1000.0
_ACUTE = 0.5


def commonroad_junctions(network: Any) -> dict[int, str]:
    """Lanelet -> the intersection that it lies in, by the network's own intersections.

    Ways through an intersection may be of several lanelets, of which it names the first: those that
    nobody crosses, before others that are crossed, only lead to it.
    """
    by_id = {lanelet.lanelet_id: lanelet for lanelet in network.lanelets}
    crossed = _crossed(list(by_id.values())) if network.intersections else set()
    inside: dict[int, str] = {}
    for intersection in network.intersections:
        starts = [
            number
            for incoming in intersection.incomings
            for way in ("outgoing_right", "outgoing_straight", "outgoing_left")
            for number in getattr(incoming, way) or ()
            if number in by_id
        ]
        for start in starts:
            chain = _crossed_after(start, by_id, crossed)
            members = chain if start in crossed or not chain else chain - {start}
            inside.update(dict.fromkeys(members or {start}, str(intersection.intersection_id)))
    return inside


def _crossed_after(start: int, by_id: Mapping[int, Any], crossed: Set[int]) -> set[int]:
    """The lanelets that are crossed and follow one end to end, itself included."""
    found = {start} & crossed
    waiting = [start]
    while waiting:
        for number in by_id[waiting.pop()].successor or ():
            if number in crossed and number not in found:
                found.add(number)
                waiting.append(number)
    return found


def _crossed(lanelets: Sequence[Any]) -> set[int]:
    """The lanelets whose middles others cross at more than an acute angle."""
    lines = [shapely.LineString(lanelet.center_vertices[:, :2]) for lanelet in lanelets]
    pairs = shapely.STRtree(lines).query(lines, predicate="crosses").T.tolist()
    crossed: set[int] = set()
    for one, other in pairs:
        place = shapely.point_on_surface(shapely.intersection(lines[one], lines[other]))
        turned = _direction(lines[one], place) - _direction(lines[other], place)
        if one < other and abs(np.sin(turned)) > _ACUTE:
            crossed.update((lanelets[one].lanelet_id, lanelets[other].lanelet_id))
    return crossed


def _direction(line: shapely.LineString, place: shapely.Point) -> float:
    at = line.project(place)
    before, after = (line.interpolate(max(at + away, 0.0)) for away in (-0.5, 0.5))
    return float(np.arctan2(after.y - before.y, after.x - before.x))


def stop_line(lanelet: Any) -> recording.Points | None:
    """The ends of a stop line; the library puts one without a place at the lanelet's end."""
    line = lanelet.stop_line
    if line is None or line.start is None or line.end is None:
        return None
    return np.array([line.start[:2], line.end[:2]], dtype=float)


def commonroad_weather(environment: Any) -> recording.Weather:
    """The weather that a scenario states; dry weather leaves only what lies on the road."""
    weather = getattr(getattr(environment, "weather", None), "value", None)
    ground = getattr(getattr(environment, "underground", None), "value", None)
    wet = True if weather in _WET or ground == "wet" else None
    if ground in ("clean", "dirty", "damaged") and weather in _DRY:
        wet = False
    icy = {"ice": True, "clean": False, "wet": False}.get(str(ground))
    return recording.Weather(wet, icy, _FAR_M if weather in _DRY else None)
