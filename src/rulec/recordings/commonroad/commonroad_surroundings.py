"""Traffic lights, intersections and the weather of a CommonRoad file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from math import radians
from typing import NamedTuple

from rulec.recordings import recording
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.polylines import crossings

_COLOURS = frozenset({"red", "yellow", "redYellow", "green", "inactive"})
_WET = frozenset({"light_rain", "mid_rain", "heavy_rain", "hail"})
_DRY = frozenset({"clear", "sunny", "cloudy"})
_WEATHERS = _WET | _DRY | {"fog", "snow", "unknown"}
_GROUNDS = frozenset({"wet", "clean", "dirty", "damaged", "snow", "ice", "unknown"})
_FALLS = _WET | {"snow"}
_DAYTIMES = {"night": True, "day": False, "morning": False, "noon": False, "afternoon": False}
_FAR_M = 1000.0
_CROSSING_RAD = radians(30.0)
_WAYS = tuple(
    f"{word}{way}" for word in ("outgoing", "successors") for way in ("Right", "Straight", "Left")
)


class Intersection(NamedTuple):
    """An intersection, and the lanelets with which the ways through it begin."""

    id: str
    starts: tuple[str, ...]


def read_light(tree: Tree) -> recording.Light | None:
    """The programme of a traffic light; None if it has none or is out of order."""
    active, cycle = tree.first("active"), tree.first("cycle")
    if cycle is None or (active is not None and active.word in ("false", "0")):
        return None
    phases = []
    for element in cycle.all("cycleElement"):
        steps = element.child("duration").whole()
        if steps <= 0:
            raise element.wrong("a traffic light has a phase of no duration")
        phases.append((element.child("color").one_of(_COLOURS), steps))
    offset = cycle.first("timeOffset")
    begin = 0 if offset is None else offset.whole()
    return recording.Light(begin, tuple(phases)) if phases else None


def read_intersection(tree: Tree) -> Intersection:
    """The intersection in an element."""
    starts = [
        number for incoming in tree.all("incoming") for way in _WAYS for number in incoming.ids(way)
    ]
    return Intersection(tree.id(), tuple(starts))


def junctions(
    intersections: Iterable[Intersection], lanelets: Mapping[str, recording.Lanelet]
) -> dict[str, str]:
    """Lanelet -> the intersection of the file that it lies in.

    A way through an intersection may consist of several lanelets, and the file names only the
    first. A lanelet that no other one crosses, ahead of crossed ones, only leads to the
    intersection. It lies in it if its type says so, as where vehicles wait for oncoming traffic
    before turning.
    """
    waiting = list(intersections)
    crossed = _crossed(lanelets) if waiting else set()
    inside: dict[str, str] = {}
    for intersection in waiting:
        for start in intersection.starts:
            if start in lanelets:
                chain = _crossed_after(start, lanelets, crossed)
                within = start in crossed or "intersection" in lanelets[start].types
                members = chain | {start} if within else chain
                inside.update(dict.fromkeys(members or {start}, intersection.id))
    return inside


def leading_away(
    inside: Mapping[str, str], lanelets: Mapping[str, recording.Lanelet]
) -> frozenset[str]:
    """The lanelets marked as an intersection that are the road behind one of the file's.

    Several ways through the intersection have become one there, which nothing crosses. Maps made by
    hand mark such roads over their whole length.
    """
    marked = [
        lanelet
        for lanelet in lanelets.values()
        if "intersection" in lanelet.types
        and lanelet.id not in inside
        and len(lanelet.predecessors) > 1
        and inside.keys() >= set(lanelet.predecessors)
    ]
    crossed = _crossed(lanelets) if marked else set()
    return frozenset(lanelet.id for lanelet in marked) - crossed


def _crossed_after(
    start: str, lanelets: Mapping[str, recording.Lanelet], crossed: Set[str]
) -> set[str]:
    """The crossed lanelets that follow ``start`` without a gap, with ``start`` if it is crossed."""
    following = {start} & crossed
    waiting = [start]
    while waiting:
        for number in lanelets[waiting.pop()].successors:
            if number in crossed and number not in following:
                following.add(number)
                waiting.append(number)
    return following


def _crossed(lanelets: Mapping[str, recording.Lanelet]) -> set[str]:
    """The lanelets whose centre lines cross that of another one."""
    names = list(lanelets)
    pairs = crossings([lanelet.centre for lanelet in lanelets.values()], _CROSSING_RAD)
    return {names[number] for pair in pairs for number in (pair.first, pair.second)}


def read_weather(location: Tree) -> recording.Weather:
    """The weather at a location.

    When it is dry, only the ground decides whether the road is wet.
    """
    environment = location.first("environment")
    if environment is None:
        return recording.Weather()
    sky, soil = map(environment.first, ("weather", "underground"))
    weather = None if sky is None else sky.one_of(_WEATHERS)
    ground = None if soil is None else soil.one_of(_GROUNDS)
    wet = True if weather in _WET or ground == "wet" else None
    if ground in ("clean", "dirty", "damaged") and weather in _DRY:
        wet = False
    icy = {"ice": True, "clean": False, "wet": False}.get(str(ground))
    daytime = environment.first("timeOfDay")
    return recording.Weather(
        wet,
        icy,
        _FAR_M if weather in _DRY else None,
        raining=weather in _FALLS if weather in _FALLS | _DRY | {"fog"} else None,
        night=None if daytime is None else _DAYTIMES.get(daytime.word),
    )
