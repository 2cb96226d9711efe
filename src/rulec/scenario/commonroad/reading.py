"""A CommonRoad file through commonroad-io, which is installed on request.

The only file that knows the library. It reports mistakes as whatever exception they lead to, and
talks to the terminal; both are caught here.
"""

from __future__ import annotations

import io
import logging
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.scenario.commonroad.recording import (
    Lanelet,
    Light,
    Participant,
    Points,
    Problem,
    Recording,
    State,
)
from rulec.scenario.commonroad.safe_xml import check_commonroad

_CORNERS = np.array([[1, 1], [1, 0], [1, -1], [0, -1], [-1, -1], [-1, 0], [-1, 1], [0, 1]]) / 2
"""Corners and middles of the sides of a rectangle of length and width 1."""


def read_recording(path: Path) -> Recording:
    """What the file says.

    Raises:
        RulecError: R0610 for a file that cannot be read as CommonRoad, R0611 without the library,
            R0701 if the file cannot be opened.
    """
    check_commonroad(path)
    with _quiet():
        reader = _library(path)
        try:
            scenario, problems = reader(path).open()
            return _recording(path.stem, scenario, problems)
        except (OSError, MemoryError, RulecError):
            raise
        except Exception as reason:  # the library has no exception of its own
            raise _unreadable(path, reason) from None


def _library(path: Path) -> Callable[[Path], Any]:
    try:
        from commonroad.common.file_reader import CommonRoadFileReader
    except ImportError:
        raise RulecError(
            Diagnostic(
                "R0611",
                "CommonRoad scenarios take the package `commonroad-io`, which is not installed",
                Place(str(path)),
                help="`pip install 'rulec[commonroad]'`, some 370 MB with what it needs",
            )
        ) from None
    reader: Callable[[Path], Any] = CommonRoadFileReader
    return reader


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep the library's remarks on old spellings from the terminal."""
    disabled = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings(), redirect_stdout(io.StringIO()):
            with redirect_stderr(io.StringIO()):
                warnings.simplefilter("ignore")
                yield
    finally:
        logging.disable(disabled)


def _unreadable(path: Path, reason: Exception) -> RulecError:
    words = " ".join(str(reason).split())[:200]
    said = f"{type(reason).__name__}: {words}" if words else type(reason).__name__
    return RulecError(
        Diagnostic(
            "R0610",
            "the file cannot be read as a CommonRoad scenario: something in it is missing or does "
            f"not fit (commonroad-io says {said})",
            Place(str(path)),
            help="compare it with CommonRoad's format, https://commonroad.in.tum.de",
        )
    )


def _recording(name: str, scenario: Any, problems: Any) -> Recording:
    signs = {sign.traffic_sign_id: sign for sign in scenario.lanelet_network.traffic_signs}
    lights = {
        light.traffic_light_id: _light(light.traffic_light_cycle)
        for light in scenario.lanelet_network.traffic_lights
        if light.active
    }
    lanelets = {
        x.lanelet_id: _lanelet(x, signs, lights) for x in scenario.lanelet_network.lanelets
    }
    return Recording(
        name,
        float(scenario.dt),
        lanelets,
        tuple(_participants(scenario)),
        tuple(
            _problem(problem, lanelets)
            for _, problem in sorted(problems.planning_problem_dict.items())
        ),
    )


def _light(cycle: Any) -> Light:
    phases = tuple((one.state.value, int(one.duration)) for one in cycle.cycle_elements)
    if not phases or min(duration for _, duration in phases) <= 0:
        raise ValueError("a traffic light has a phase that does not last")
    return Light(int(cycle.time_offset), phases)


def _lanelet(lanelet: Any, signs: Mapping[int, Any], lights: Mapping[int, Light]) -> Lanelet:
    elements = [
        element
        for number in sorted(lanelet.traffic_signs or ())
        if number in signs
        for element in signs[number].traffic_sign_elements
    ]
    limits = [
        float(element.additional_values[0])
        for element in elements
        if element.traffic_sign_element_id.name == "MAX_SPEED" and element.additional_values
    ]
    return Lanelet(
        lanelet.lanelet_id,
        _points(lanelet.left_vertices),
        _points(lanelet.right_vertices),
        _points(lanelet.center_vertices),
        tuple(lanelet.successor or ()),
        tuple(lanelet.predecessor or ()),
        lanelet.adj_left if lanelet.adj_left_same_direction else None,
        lanelet.adj_right if lanelet.adj_right_same_direction else None,
        frozenset(kind.value for kind in lanelet.lanelet_type or ()),
        frozenset(element.traffic_sign_element_id.name for element in elements),
        min(limits, default=None),
        tuple(lights[i] for i in sorted(lanelet.traffic_lights or ()) if i in lights),
    )


def _points(vertices: Any) -> Points:
    points = np.asarray(vertices, dtype=float)[:, :2]
    if len(points) < 2 or not np.isfinite(points).all():
        raise ValueError("a lanelet's bound has fewer than two points, or one that is no place")
    return points


def _participants(scenario: Any) -> Iterator[Participant]:
    for one in scenario.static_obstacles:
        yield _participant(one, [one.initial_state], standing=True)
    for one in scenario.dynamic_obstacles:
        yield _participant(one, _states_of(one), standing=False)
    for one in scenario.environment_obstacle:
        outline = _corners(one.occupancy_at_time(0))
        yield Participant(one.obstacle_id, one.obstacle_type.value, True, {}, {0: outline})
    for one in scenario.phantom_obstacle:
        yield Participant(one.obstacle_id, "unknown", False, {}, dict(_predicted(one)))


def _states_of(obstacle: Any) -> list[Any]:
    trajectory = getattr(obstacle.prediction, "trajectory", None)
    return [obstacle.initial_state, *(trajectory.state_list if trajectory else ())]


def _participant(obstacle: Any, states: Iterable[Any], *, standing: bool) -> Participant:
    known: dict[int, State] = {}
    outlines: dict[int, Points] = {}
    for state in states:
        step = int(state.time_step)
        outline = _rectangle(obstacle.obstacle_shape, state)
        if outline is None:
            outline = _corners(obstacle.occupancy_at_time(step))
        outlines[step] = outline
        known[step] = _state(state, outline)
    if not standing and not hasattr(obstacle.prediction, "trajectory"):
        outlines.update(_predicted(obstacle))
    return Participant(
        obstacle.obstacle_id, obstacle.obstacle_type.value, standing, known, outlines
    )


def _predicted(obstacle: Any) -> Iterator[tuple[int, Points]]:
    """What a prediction without states says is occupied."""
    for occupancy in getattr(obstacle.prediction, "occupancy_set", None) or ():
        shape = getattr(occupancy, "shape", occupancy)
        yield int(occupancy.time_step), _corners(shape)


def _rectangle(shape: Any, state: Any) -> Points | None:
    """The outline in the usual case, a rectangle in an exact place; None in any other."""
    length, width = getattr(shape, "length", None), getattr(shape, "width", None)
    position, heading = state.position, state.orientation
    plain = isinstance(length, (int, float)) and isinstance(width, (int, float))
    if not plain or not isinstance(position, np.ndarray) or not isinstance(heading, (int, float)):
        return None
    cos, sin = np.cos(heading), np.sin(heading)
    corners = _CORNERS * (length, width) - (getattr(shape, "origin_x_shift", 0.0), 0.0)
    outline: Points = corners @ np.array([[cos, sin], [-sin, cos]]) + position[:2]
    return outline


def _corners(occupancy: Any) -> Points:
    """A polygon's corners and the middles of its sides; all of a group's."""
    shape = occupancy.shapely_object
    outline = shape.convex_hull.exterior if shape.geom_type != "Polygon" else shape.exterior
    corners = np.asarray(outline.coords, dtype=float)[:, :2]
    middles = (corners[1:] + corners[:-1]) / 2
    return np.concatenate((corners[:-1], middles))


def _state(state: Any, outline: Points) -> State:
    position = state.position
    x, y = position[:2] if isinstance(position, np.ndarray) else outline.mean(axis=0)
    return State(
        float(x),
        float(y),
        _number(state.orientation),
        _number(getattr(state, "velocity", None)),
        _number(getattr(state, "acceleration", None)),
    )


def _number(value: Any) -> float:
    """A number, the middle of an interval, or 0 for what is not said."""
    if value is None:
        return 0.0
    number = float(value) if isinstance(value, (int, float)) else (value.start + value.end) / 2
    if not isfinite(number):
        raise ValueError("a state has a value that is no finite number")
    return number


def _problem(problem: Any, lanelets: Mapping[int, Lanelet]) -> Problem:
    start = problem.initial_state
    outline = np.zeros((1, 2)) if isinstance(start.position, np.ndarray) else _corners(start.position)
    goals = [point for state in problem.goal.state_list for point in _goal(state)]
    for numbers in (problem.goal.lanelets_of_goal_position or {}).values():
        goals += [lanelets[i].centre[len(lanelets[i].centre) // 2] for i in numbers if i in lanelets]
    return Problem(
        problem.planning_problem_id,
        int(start.time_step),
        _state(start, outline),
        np.array(goals, dtype=float).reshape(-1, 2),
    )


def _goal(state: Any) -> Iterator[Points]:
    position = getattr(state, "position", None)
    if isinstance(position, np.ndarray):
        yield position[:2]
    elif hasattr(position, "shapely_object"):
        centre = position.shapely_object.centroid
        yield np.array([centre.x, centre.y])
