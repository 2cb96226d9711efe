"""Planning problems of a CommonRoad file: where ego starts, and where it should go."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import shapely

from rulec.recordings import recording
from rulec.recordings.commonroad.areas import corners, geometry, is_area, read_area, read_point
from rulec.recordings.commonroad.commonroad_participants import track_state
from rulec.recordings.commonroad.states import State, read_state
from rulec.recordings.encodings.tree import Tree


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
