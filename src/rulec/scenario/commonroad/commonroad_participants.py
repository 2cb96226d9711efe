"""Obstacles and planning problems of the library's, as a recording has them.

Places and headings in a file may be areas and intervals. What an obstacle occupies then is all that
it may occupy; where only one number can be used it is the middle.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from rulec.scenario.recorded import recording as recorded
from rulec.scenario.recorded.track import rectangles
from rulec.scenario.xml_element import LARGEST


def commonroad_participants(scenario: Any) -> Iterator[recorded.Participant]:
    """All obstacles of a scenario of the library's, in its order."""
    for obstacle in scenario.static_obstacles:
        yield _participant(obstacle, [obstacle.initial_state], standing=True)
    for obstacle in scenario.dynamic_obstacles:
        yield _participant(obstacle, _states_of(obstacle), standing=False)
    for obstacle in scenario.environment_obstacle:
        outline = _corners(obstacle.occupancy_at_time(0))
        yield recorded.Participant(
            str(obstacle.obstacle_id), obstacle.obstacle_type.value, True, {}, {0: outline}
        )
    for obstacle in scenario.phantom_obstacle:
        yield recorded.Participant(
            str(obstacle.obstacle_id), "unknown", False, {}, dict(_predicted(obstacle))
        )


def _states_of(obstacle: Any) -> list[Any]:
    trajectory = getattr(obstacle.prediction, "trajectory", None)
    return [obstacle.initial_state, *(trajectory.state_list if trajectory else ())]


def _participant(obstacle: Any, states: Iterable[Any], *, standing: bool) -> recorded.Participant:
    known: dict[int, recorded.TrackState] = {}
    outlines: dict[int, recorded.Points] = {}
    for state in states:
        step = int(state.time_step)
        outline = _rectangle(obstacle.obstacle_shape, state)
        if outline is None:
            outline = _corners(obstacle.occupancy_at_time(step))
        outlines[step] = outline
        known[step] = _state(state, outline)
    if not standing and not hasattr(obstacle.prediction, "trajectory"):
        outlines.update(_predicted(obstacle))
    lamps, shows = _lamps(obstacle)
    return recorded.Participant(
        str(obstacle.obstacle_id),
        obstacle.obstacle_type.value,
        standing,
        known,
        outlines,
        lamps=lamps,
        shows=shows,
    )


_SIGNALS: Mapping[str, recorded.Lamp] = {
    "indicator_left": "left_indicator",
    "indicator_right": "right_indicator",
    "hazard_warning_lights": "hazard_lights",
    "braking_lights": "brake_light",
    "flashing_blue_lights": "blue_light",
    "horn": "horn",
}


def _lamps(obstacle: Any) -> tuple[dict[int, frozenset[recorded.Lamp]], frozenset[recorded.Lamp]]:
    """The lamps that are lit by time step, and all that the signal states speak of."""
    series = [getattr(obstacle, "initial_signal_state", None)]
    states = [state for state in series + list(obstacle.signal_series or ()) if state is not None]
    lamps = {
        int(state.time_step): frozenset(
            lamp for name, lamp in _SIGNALS.items() if getattr(state, name, None)
        )
        for state in states
    }
    shows = [
        {lamp for name, lamp in _SIGNALS.items() if getattr(state, name, None) is not None}
        for state in states
    ]
    return lamps, frozenset(shows[0].intersection(*shows[1:])) if shows else frozenset()


def _predicted(obstacle: Any) -> Iterator[tuple[int, recorded.Points]]:
    for occupancy in getattr(obstacle.prediction, "occupancy_set", None) or ():
        shape = getattr(occupancy, "shape", occupancy)
        yield int(occupancy.time_step), _corners(shape)


def _rectangle(shape: Any, state: Any) -> recorded.Points | None:
    length, width = getattr(shape, "length", None), getattr(shape, "width", None)
    position, heading = state.position, state.orientation
    if not isinstance(length, (int, float)) or not isinstance(width, (int, float)):
        return None
    if not isinstance(position, np.ndarray) or not isinstance(heading, (int, float)):
        return None
    shift = getattr(shape, "origin_x_shift", 0.0)
    place, turn = position[None, :2], np.array([heading])
    outline: recorded.Points = rectangles(place, turn, length, width, shift)[0]
    return outline


def _corners(occupancy: Any) -> recorded.Points:
    """Corners and side middles of a polygon, or of a group's polygons."""
    shape = occupancy.shapely_object
    outline = shape.convex_hull.exterior if shape.geom_type != "Polygon" else shape.exterior
    corners = np.asarray(outline.coords, dtype=float)[:, :2]
    middles = (corners[1:] + corners[:-1]) / 2
    return np.concatenate((corners[:-1], middles))


def _state(state: Any, outline: recorded.Points) -> recorded.TrackState:
    position = state.position
    x, y = position[:2] if isinstance(position, np.ndarray) else outline.mean(axis=0)
    return recorded.TrackState(
        _number(float(x)),
        _number(float(y)),
        _number(state.orientation),
        _number(getattr(state, "velocity", None)),
        _number(getattr(state, "acceleration", None)),
    )


def _number(value: Any) -> float:
    """A number, an interval's middle, or 0 for a missing value."""
    if value is None:
        return 0.0
    number = float(value) if isinstance(value, (int, float)) else (value.start + value.end) / 2
    if not abs(number) < LARGEST:
        raise ValueError("a state has a value that is no number, or out of all bounds")
    return number


def planning_problem(
    problem: Any, lanelets: Mapping[str, recorded.Lanelet]
) -> recorded.PlanningProblem:
    """A planning problem of the library's."""
    start = problem.initial_state
    outline = (
        np.zeros((1, 2)) if isinstance(start.position, np.ndarray) else _corners(start.position)
    )
    goals = [point for state in problem.goal.state_list for point in _goal(state)]
    for numbers in (problem.goal.lanelets_of_goal_position or {}).values():
        goals += [
            lanelet.centre[len(lanelet.centre) // 2]
            for number in numbers
            if (lanelet := lanelets.get(str(number))) is not None
        ]
    return recorded.PlanningProblem(
        str(problem.planning_problem_id),
        int(start.time_step),
        _state(start, outline),
        np.array(goals, dtype=float).reshape(-1, 2),
    )


def _goal(state: Any) -> Iterator[recorded.Points]:
    position: Any = getattr(state, "position", None)
    if isinstance(position, np.ndarray):
        yield position[:2]
    elif hasattr(position, "shapely_object"):
        centre = position.shapely_object.centroid
        yield np.array([centre.x, centre.y])
