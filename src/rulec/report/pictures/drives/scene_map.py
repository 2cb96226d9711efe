"""The map around a drive: areas of lanelets, marks, lights and signs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import Lanelet, LaneMark, Points, Recording
from rulec.report.pictures.drives.drive_scene import (
    MarkKind,
    RoadArea,
    RoadMark,
    SceneLight,
    SceneSign,
    Surface,
)

MAP_REACH_M = 150.0
"""A lanelet farther from ego's path (m) is not drawn."""

_FOOTWAYS = frozenset({"sidewalk", "bicycleLane"})
_MARKS: dict[LaneMark | None, MarkKind] = {
    "solid": "solid",
    "double_solid": "solid",
    "broken": "broken",
    None: "unsaid",
}
_SIGN_TEXTS = {
    "STOP": "STOP",
    "YIELD": "▽",
    "PRIORITY": "◇",
    "NO_OVERTAKING_START": "NO PASSING",
    "RIGHT_BEFORE_LEFT": "×",
}
_SAME_MARK_M = 0.2


def lanelets_near(recording: Recording, path: Points) -> list[Lanelet]:
    """The lanelets near a path; crosswalks come last, to be drawn over the others."""
    low, high = path.min(axis=0) - MAP_REACH_M, path.max(axis=0) + MAP_REACH_M
    near = [
        lanelet
        for lanelet in recording.lanelets.values()
        if _meets(lanelet, low, high) and _distance(lanelet, path) <= MAP_REACH_M
    ]
    return sorted(near, key=lambda lanelet: _surface(lanelet) == "crossing")


def _meets(lanelet: Lanelet, low: NDArray[float64], high: NDArray[float64]) -> bool:
    bounds = np.concatenate([lanelet.left, lanelet.right])
    return bool((bounds.max(axis=0) >= low).all() and (bounds.min(axis=0) <= high).all())


def _distance(lanelet: Lanelet, path: Points) -> float:
    """The smallest distance (m) of a sample of the path's points to a lanelet's centre line."""
    start, along = lanelet.centre[:-1], np.diff(lanelet.centre, axis=0)
    length = np.maximum((along**2).sum(axis=1), 1e-9)
    from_start = path[:: max(1, len(path) // 200), None, :] - start
    part = np.clip((from_start * along).sum(axis=2) / length, 0, 1)
    return float(np.hypot(*np.moveaxis(from_start - part[..., None] * along, 2, 0)).min())


def road_areas(lanelets: Iterable[Lanelet], origin: Points) -> Iterator[RoadArea]:
    """The area of each lanelet."""
    for lanelet in lanelets:
        kinds = ", ".join(sorted(lanelet.types))
        limit = lanelet.limit_mps
        speed = "" if limit is None else f", limit {limit * KMH_PER_MPS:.0f} km/h"
        ring = np.concatenate([lanelet.left, lanelet.right[::-1]]) - origin
        tip = f"lanelet {lanelet.id}{f', {kinds}' if kinds else ''}{speed}"
        yield RoadArea(ring, _surface(lanelet), tip)


def _surface(lanelet: Lanelet) -> Surface:
    if "crosswalk" in lanelet.types:
        return "crossing"
    return "footway" if lanelet.types & _FOOTWAYS else "lane"


def road_marks(lanelets: Sequence[Lanelet], origin: Points) -> Iterator[RoadMark]:
    """The boundaries of lanes, each once, even if neighbouring lanelets share it."""
    drawn: set[tuple[int, ...]] = set()
    for lanelet in lanelets:
        if _surface(lanelet) == "crossing":
            continue
        for line, mark in ((lanelet.left, lanelet.left_mark), (lanelet.right, lanelet.right_mark)):
            ends = sorted(np.round(line[[0, -1]] / _SAME_MARK_M).astype(int).tolist())
            place = (*ends[0], *ends[1])
            if place not in drawn and mark != "none":
                drawn.add(place)
                yield RoadMark(line - origin, _MARKS[mark])


def scene_lights(lanelets: Iterable[Lanelet], origin: Points, steps: range) -> Iterator[SceneLight]:
    """The lights of lanelets, with their colours over a range of time steps."""
    for lanelet in lanelets:
        end = np.stack([lanelet.left[-1], lanelet.right[-1]]) - origin
        for number, light in enumerate(lanelet.lights):
            colours: list[tuple[int, str]] = []
            for state, step in enumerate(steps):
                colour = light.colour_at(step)
                if not colours or colours[-1][1] != colour:
                    colours.append((state, colour))
            share = (end[1] - end[0]) / len(lanelet.lights)
            line = end[0] + share * np.array([[number], [number + 1]])
            yield SceneLight(line, tuple(colours))


def scene_signs(lanelets: Sequence[Lanelet], origin: Points) -> Iterator[SceneSign]:
    """The signs at the right of the road, where they begin to apply."""
    by_id = {lanelet.id: lanelet for lanelet in lanelets}
    for lanelet in lanelets:
        before = [by_id[name] for name in lanelet.predecessors if name in by_id]
        beside = [by_id[name] for name in (lanelet.right_of,) if name in by_id]
        shown = [
            (_SIGN_TEXTS[sign], sign.lower().replace("_", " "))
            for sign in sorted(lanelet.signs & _SIGN_TEXTS.keys())
            if not any(sign in other.signs for other in (*before, *beside))
        ]
        limit = lanelet.limit_mps
        if limit is not None and all(other.limit_mps != limit for other in (*before, *beside)):
            shown.append((f"{limit * KMH_PER_MPS:.0f}", f"limit {limit * KMH_PER_MPS:.0f} km/h"))
        across = lanelet.right[0] - lanelet.left[0]
        outwards = across / max(float(np.hypot(*across)), 1e-9)
        along = np.array([-outwards[1], outwards[0]])
        for number, (text, name) in enumerate(shown):
            at = lanelet.right[0] - origin + outwards * 1.8 + along * (1.0 + 3.5 * number)
            yield SceneSign((float(at[0]), float(at[1])), text, name)
