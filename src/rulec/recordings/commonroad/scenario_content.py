"""The content of a CommonRoad scenario, and the recording made from it.

Planning problems say where ego starts, and where it should go.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
import shapely

from rulec.diagnostics.phrases import named
from rulec.recordings import recording
from rulec.recordings.adjacency import with_neighbours
from rulec.recordings.commonroad.areas import corners, geometry, is_area, read_area, read_point
from rulec.recordings.commonroad.commonroad_lanelets import LaneletEntry, complete, read_lanelet
from rulec.recordings.commonroad.commonroad_participants import (
    read_body,
    read_environment_obstacle,
    read_phantom,
    track_state,
    without_constant_indicators,
)
from rulec.recordings.commonroad.commonroad_surroundings import (
    Intersection,
    junctions,
    leading_away,
    read_intersection,
    read_light,
    read_weather,
)
from rulec.recordings.commonroad.countries import country_in, side_in
from rulec.recordings.commonroad.states import State, TimeExtent, read_state
from rulec.recordings.commonroad.traffic_signs import Sign, read_sign
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.recording import Lanelet, Points


class ProblemEntry(NamedTuple):
    """A planning problem; its goals may refer to lanelets of the file."""

    id: str
    start: State
    goals: tuple[Tree, ...]


def read_problem(tree: Tree) -> ProblemEntry:
    """The planning problem in an element."""
    goals = [goal.first("position") for goal in tree.all("goalState")]
    start = read_state(tree.child("initialState"), initial=True)
    return ProblemEntry(tree.id(), start, tuple(goal for goal in goals if goal is not None))


def planning_problem(
    entry: ProblemEntry, lanelets: Mapping[str, recording.Lanelet]
) -> recording.PlanningProblem:
    """A planning problem with the centres of its goals, and the middle points of goal lanelets."""
    start = entry.start
    outline = corners(geometry(start.area)) if start.area else np.zeros((1, 2))
    goals = [point for goal in entry.goals for point in _middle(goal, lanelets)]
    for goal in entry.goals:
        for number in goal.ids("lanelet"):
            centre = lanelets[number].centre
            goals.append(tuple(centre[len(centre) // 2].tolist()))
    return recording.PlanningProblem(
        entry.id,
        start.step,
        track_state(start, outline),
        np.array(goals, dtype=float).reshape(-1, 2),
    )


def _middle(goal: Tree, lanelets: Mapping[str, recording.Lanelet]) -> Iterator[tuple[float, float]]:
    if (point := goal.first("point")) is not None:
        yield read_point(point)
        return
    # Files in Protocol Buffers also contain the outlines of goal lanelets
    if is_area(goal) and not goal.first("lanelet"):
        centre = geometry(read_area(goal)).centroid
    else:
        centre = (
            shapely.GeometryCollection(
                [_outline(goal, number, lanelets) for number in goal.ids("lanelet")]
            )
            .buffer(0)
            .centroid
        )
    if not centre.is_empty:
        yield centre.x, centre.y


def _outline(goal: Tree, number: str, lanelets: Mapping[str, recording.Lanelet]) -> shapely.Polygon:
    lanelet = lanelets.get(number)
    if lanelet is None:
        raise goal.wrong(f"the goal is lanelet {number}, which is not in the file")
    around = shapely.Polygon(np.concatenate((lanelet.right, lanelet.left[::-1])))
    return shapely.geometry.polygon.orient(around, sign=-1.0)


SHORTEST_STEP_S = 1e-6

_T = TypeVar("_T")


@dataclass(slots=True)
class Content:
    """What has been read of a file so far, by id; participants by kind, then by id.

    ``remarks`` are those that the recording will have.
    """

    step_s: float = 0.0
    sign_country: str = ""
    lanelets: dict[str, LaneletEntry] = field(default_factory=dict)
    signs: dict[str, tuple[Sign, ...]] = field(default_factory=dict)
    lights: dict[str, recording.Light | None] = field(default_factory=dict)
    intersections: dict[str, Intersection] = field(default_factory=dict)
    bodies: dict[str, dict[str, recording.Participant]] = field(default_factory=dict)
    problems: dict[str, ProblemEntry] = field(default_factory=dict)
    weather: recording.Weather = field(default_factory=recording.Weather)
    extent: TimeExtent = field(default_factory=TimeExtent)
    remarks: list[str] = field(default_factory=list)


def to_recording(content: Content, path: Path, form: FileFormat) -> recording.Recording:
    """The recording of a scenario, named after its file.

    Raises RulecError R0610 for time steps that are too far apart.
    """
    bodies = [body for kind in _KINDS for body in content.bodies.get(kind, {}).values()]
    content.extent.check(path, form, len(bodies))
    participants, remarks = without_constant_indicators(bodies)
    lanelets = _lanelets(content)
    name = Path(path.name.removesuffix(".gz")).stem
    # The country in the file takes precedence: a copy may have any name.
    country = content.sign_country if side_in(content.sign_country) else country_in(name)
    problems = sorted(content.problems.values(), key=lambda problem: int(problem.id))
    return with_neighbours(
        recording.Recording(
            name,
            content.step_s,
            lanelets,
            participants,
            tuple(planning_problem(problem, lanelets) for problem in problems),
            side=side_in(country),
            country=country or content.sign_country,
            weather=content.weather,
            remarks=(*content.remarks, *remarks),
        )
    )


def add_step(content: Content, root: Tree) -> None:
    """Read the length of a time step from the root element."""
    content.step_s = root.number("timeStepSize")
    if content.step_s < SHORTEST_STEP_S:
        raise root.wrong(f"a time step of {content.step_s:g} s is too short")


def add(content: Content, tree: Tree) -> None:
    """Read an element below the root."""
    match tree.name:
        case "lanelet":
            _enter(content.lanelets, tree, read_lanelet)
        case "trafficSign":
            _enter(content.signs, tree, lambda sign: read_sign(sign, content.sign_country))
        case "trafficSignValue":
            # The part with the traffic gives what a sign shows at that time
            content.signs[tree.id()] = read_sign(tree, content.sign_country)
        case "trafficLight":
            _enter(content.lights, tree, read_light)
        case "intersection":
            _add_intersection(content, read_intersection(tree))
        case "planningProblem":
            _enter(content.problems, tree, read_problem)
        case "location":
            content.weather = read_weather(tree)
        case "obstacle":
            # Version 2018b
            role = tree.child("role").one_of(("static", "dynamic"))
            _add_participant(content, tree, f"{role}Obstacle")
        case kind if kind in _KINDS:
            _add_participant(content, tree, kind)


_KINDS: Mapping[str, Callable[[Tree, TimeExtent], recording.Participant]] = {
    "staticObstacle": lambda tree, extent: read_body(tree, extent, standing=True),
    "dynamicObstacle": lambda tree, extent: read_body(tree, extent, standing=False),
    "environmentObstacle": lambda tree, _: read_environment_obstacle(tree),
    "phantomObstacle": read_phantom,
}


def _add_participant(content: Content, tree: Tree, kind: str) -> None:
    number = tree.id()
    if any(number in bodies for bodies in content.bodies.values()):
        raise tree.wrong(f"there are two obstacles `{number}`")
    content.bodies.setdefault(kind, {})[number] = _KINDS[kind](tree, content.extent)


def _add_intersection(content: Content, intersection: Intersection) -> None:
    """Add an intersection; where published maps reuse an id, each one gets an id of its own."""
    number = intersection.id
    if number in content.intersections:
        remark = f"there are several intersections `{number}`: each is treated as a separate one"
        if remark not in content.remarks:
            content.remarks.append(remark)
        number = f"{number}#{len(content.intersections) + 1}"
    content.intersections[number] = intersection._replace(id=number)


def _enter(known: dict[str, _T], tree: Tree, read: Callable[[Tree], _T]) -> None:
    number = tree.id()
    if number in known:
        raise tree.wrong(f"there are two elements `{tree.name}` with the id `{number}`")
    known[number] = read(tree)


def _lanelets(content: Content) -> dict[str, recording.Lanelet]:
    plain, disordered = with_ordered_bounds(
        {number: entry.lanelet for number, entry in content.lanelets.items()}
    )
    if disordered:
        content.remarks.append(
            "bounds turn back on themselves, so their points were put in order: "
            f"those of the lanelets {named(disordered)}"
        )
    inside = junctions(content.intersections.values(), plain)
    for number in leading_away(inside, plain):
        plain[number] = replace(plain[number], types=plain[number].types - {"intersection"})
    lights = {number: light for number, light in content.lights.items() if light is not None}
    lanelets = {
        number: complete(
            entry._replace(lanelet=plain[number]), content.signs, lights, inside.get(number, "")
        )
        for number, entry in content.lanelets.items()
    }
    return _with_untold_signs(content, lanelets)


def _with_untold_signs(
    content: Content, lanelets: dict[str, recording.Lanelet]
) -> dict[str, recording.Lanelet]:
    """The lanelets, with the priority signs beside the carriageway among ``untold_signs``.

    Published maps attach give-way signs to a sidewalk where it is nearer than the lane, so that the
    lanelets for which such signs hold are unknown.
    """
    beside = {n: lanelet for n, lanelet in lanelets.items() if recording.NO_LANES & lanelet.types}
    signs = (
        frozenset().union(*(lanelet.signs for lanelet in beside.values())) & recording.REGULATING
    )
    if not signs:
        return lanelets
    content.remarks.append(
        "priority signs are at lanelets beside the carriageway: "
        "the lanes for which they hold are unknown"
    )
    return {
        number: lanelet
        if number in beside
        else replace(lanelet, untold_signs=lanelet.untold_signs | (signs - lanelet.signs))
        for number, lanelet in lanelets.items()
    }


_BACK_M = 2.0
"""Shorter steps back along a bound are careless drawing, and make it hardly longer."""

_SHARP = -0.5
"""The cosine of the angle beyond which a bound turns back; no lane turns as much at one point."""

_HAIR_M = 1e-6
_MOST_POINTS, _MOST_PASSES = 100, 10
"""Converters that disorder points do not write more; the time of a pass grows with their square."""


def with_ordered_bounds(
    lanelets: Mapping[str, Lanelet],
) -> tuple[dict[str, Lanelet], tuple[str, ...]]:
    """Lanelets by id with the points of their bounds in order, and the ids of those changed."""
    disordered = _going_back(
        [bound for own in lanelets.values() for bound in (own.left, own.right)]
    )
    ordered = dict(lanelets)
    names, changed = tuple(lanelets), []
    for name in dict.fromkeys(names[place // 2] for place in disordered):
        lanelet = lanelets[name]
        left, right = in_order(lanelet.left), in_order(lanelet.right)
        if left is not lanelet.left or right is not lanelet.right:
            ordered[name] = replace(lanelet, left=left, right=right, centre=0.5 * (left + right))
            changed.append(name)
    return ordered, tuple(changed)


def in_order(points: Points) -> Points:
    """The points in an order that makes the line through them short; the first and last one stay.

    Each inner point is moved to where the line becomes shortest (the *or-opt* move of Or, 1976, for
    one point), until it gets no shorter. A line that nowhere turns back is left as it is, and so is
    one of more than ``_MOST_POINTS``.
    """
    if len(points) > _MOST_POINTS or not _going_back([points]):
        return points
    order = list(range(len(points)))
    for _ in range(_MOST_PASSES):
        is_shorter = False
        for point in range(1, len(points) - 1):
            rest = [x for x in order if x != point]
            line = points[rest]
            gaps = np.hypot(*np.diff(line, axis=0).T)
            ways = np.hypot(*(line - points[point]).T)
            longer = ways[:-1] + ways[1:] - gaps
            at = order.index(point)
            best = int(longer.argmin()) + 1
            if longer[best - 1] < longer[at - 1] - _HAIR_M:
                order, is_shorter = [*rest[:best], point, *rest[best:]], True
        if not is_shorter:
            break
    return points[order]


def _going_back(bounds: Iterable[Points]) -> list[int]:
    """The indices of the bounds that turn back on themselves, once for each point where they do."""
    bounds = list(bounds)
    if not bounds:
        return []
    number = np.arange(len(bounds)).repeat([len(bound) for bound in bounds])
    ways = np.diff(np.concatenate(bounds), axis=0)
    lengths = np.hypot(*ways.T)
    lengths[number[1:] != number[:-1]] = 0.0
    before, after = lengths[:-1], lengths[1:]
    is_long = np.minimum(before, after) > _BACK_M
    turns = (ways[:-1] * ways[1:]).sum(axis=1)
    going_back: list[int] = number[1:-1][is_long & (turns < _SHARP * before * after)].tolist()
    return going_back
