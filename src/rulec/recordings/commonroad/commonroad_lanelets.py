"""Lanelets of a CommonRoad file, with the signs and lights that they refer to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from rulec.recordings import recording
from rulec.recordings.commonroad.areas import read_points
from rulec.recordings.commonroad.traffic_signs import (
    LIMITS,
    MAX_SPEED,
    MIN_SPEED,
    UNKNOWN,
    Sign,
    speed_limit,
)
from rulec.recordings.encodings.tree import Tree

_MARKS: Mapping[str, recording.LaneMark | None] = MappingProxyType(
    {
        "solid": "solid",
        "broad_solid": "solid",
        "solid_solid": "double_solid",
        "dashed": "broken",
        "broad_dashed": "broken",
        "dashed_dashed": "broken",
        "no_marking": "none",
        **dict.fromkeys(("solid_dashed", "dashed_solid", "curb", "lowered_curb", "unknown")),
    }
)
"""CommonRoad's line markings as lane marks; None for kerbs, unknown ones and mixed lines.

The sides of a line that is solid and dashed are unclear.
"""

_TYPES = """
urban country highway driveWay mainCarriageWay accessRamp exitRamp shoulder busLane busStop
bicycleLane sidewalk crosswalk interstate intersection border parking restricted restricted_area
unknown
"""
_USERS_TOO = MappingProxyType({"bicycle": recording.CYCLES_TOO, "taxi": recording.TAXIS_TOO})
"""Users that a bus lane may name besides buses -> its type."""
_FEWEST_POINTS = 2


class LaneletEntry(NamedTuple):
    """A lanelet without its signs, lights and junction, and the ids of its signs and lights."""

    lanelet: recording.Lanelet
    signs: tuple[str, ...]
    lights: tuple[str, ...]


def read_lanelet(tree: Tree) -> LaneletEntry:
    """The lanelet in an element."""
    left, right = (_bound(tree.child(name)) for name in ("leftBound", "rightBound"))
    if len(left) != len(right):
        why = f"a lanelet has {len(left)} points on its left, and {len(right)} on its right"
        raise tree.wrong(why, "the same number on both sides")
    limit = tree.first("speedLimit")
    lanelet = recording.Lanelet(
        id=tree.id(),
        left=left,
        right=right,
        centre=0.5 * (left + right),
        successors=tree.ids("successor"),
        predecessors=tree.ids("predecessor"),
        left_of=_neighbour(tree.first("adjacentLeft")),
        right_of=_neighbour(tree.first("adjacentRight")),
        types=frozenset(_types(tree)),
        # Version 2018b gives limits without signs
        signs=frozenset() if limit is None else frozenset({MAX_SPEED}),
        limit_mps=None if limit is None else speed_limit(limit),
        left_mark=_mark(tree.child("leftBound")),
        right_mark=_mark(tree.child("rightBound")),
        stop_line=_stop_line(tree.first("stopLine")),
    )
    return LaneletEntry(lanelet, tree.ids("trafficSignRef"), tree.ids("trafficLightRef"))


def _types(tree: Tree) -> Iterator[str]:
    kinds = [kind.one_of(_TYPES.split()) for kind in tree.all("laneletType")]
    yield from kinds
    if "busLane" in kinds:
        users = [*tree.all("userOneWay"), *tree.all("userBidirectional")]
        yield from [recording.BUSES_ONLY] if users else []
        yield from [_USERS_TOO[user.text] for user in users if user.text in _USERS_TOO]
    for bound, broad in (
        ("leftBound", recording.BROAD_LEFT),
        ("rightBound", recording.BROAD_RIGHT),
    ):
        mark = tree.child(bound).first("lineMarking")
        if mark is not None and mark.text == "broad_dashed":
            yield broad


def _bound(tree: Tree) -> recording.Points:
    points = read_points(tree)
    if len(points) < _FEWEST_POINTS:
        raise tree.wrong(f"the element `{tree.name}` has fewer than {_FEWEST_POINTS} points")
    if np.ptp(points, axis=0).max() > recording.LONGEST_M:
        raise tree.wrong(f"a lanelet's bound is longer than {recording.LONGEST_M / 1000:g} km")
    return points


def _neighbour(tree: Tree | None) -> str | None:
    """The id of the adjacent lanelet in a reference, if it has the same direction of travel."""
    if tree is None or tree.attributes.get("drivingDir") != "same":
        return None
    return tree.id("ref")


def _mark(bound: Tree) -> recording.LaneMark | None:
    mark = bound.first("lineMarking")
    return None if mark is None else _MARKS[mark.one_of(_MARKS)]


def _stop_line(tree: Tree | None) -> recording.Points | None:
    """The ends of a stop line; None if the file gives no points for it.

    The format then puts it at the end of its lanelet, for want of a place that was measured: in
    recorded traffic everybody stops up to ten metres beyond such lines.
    """
    if tree is None:
        return None
    points = read_points(tree)
    if len(points) == 1:
        raise tree.wrong("a stop line has only one end")
    return points[:2] if len(points) else None


def complete(
    entry: LaneletEntry,
    signs: Mapping[str, tuple[Sign, ...]],
    lights: Mapping[str, recording.Light],
    junction: str,
) -> recording.Lanelet:
    """A lanelet with its junction and those of its signs and lights that the file contains."""
    elements = [element for number in entry.signs for element in signs.get(number, ())]
    lanelet = entry.lanelet
    limiting = [element for element in elements if element.limit_mps is not None]
    limits = [sign.limit_mps for sign in limiting if sign.name in LIMITS] + [lanelet.limit_mps]
    untold = _untold(elements, has_own=lanelet.limit_mps is not None)
    least = [sign.limit_mps for sign in limiting if sign.name == MIN_SPEED]
    inside = {"intersection"} if junction else set()
    ids = sorted(set(entry.lights), key=recording.id_order)
    return replace(
        lanelet,
        types=lanelet.types | inside,
        signs=lanelet.signs | {element.name for element in elements},
        limit_mps=None
        if MAX_SPEED in untold
        else min((limit for limit in limits if limit is not None), default=None),
        untold_signs=untold,
        lights=tuple(lights[number] for number in ids if number in lights),
        junction=junction,
        minimum_mps=None
        if MIN_SPEED in untold
        else max((speed for speed in least if speed is not None), default=None),
    )


def _untold(elements: Iterable[Sign], *, has_own: bool) -> frozenset[str]:
    """The names of signs that may hold; a lanelet's own limit tells the number of a sign's."""
    return frozenset(
        sign.untold
        for sign in elements
        if sign.untold and not (sign.untold == MAX_SPEED and sign.name != UNKNOWN and has_own)
    )
