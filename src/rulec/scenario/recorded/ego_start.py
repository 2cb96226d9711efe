"""Ego's state and lanelet at time 0."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, hypot, isfinite, sin
from typing import TypedDict

import numpy as np

from rulec.diagnostics import RulecError, SourceLocation, named
from rulec.recordings import recording as recorded
from rulec.recordings.recording_messages import NOT_IN_RECORDING
from rulec.scenario.motion_bounds import MotionBounds, bounds_of
from rulec.scenario.recorded.route import lanelet_of
from rulec.scenario.scenario_model import Choice

_FARTHEST = 1e15
"""The largest time step number considered; no file has that many steps."""

_SAME_PLACE_M = 0.1

_AGAINST_MPS = 2.0
"""Ego moving backwards faster than this (m/s) is on the oncoming side or reverses, not turning."""

_TREMBLES_MPS = 0.1
"""The track of a standing vehicle moves slower than this (m/s), in any direction."""


@dataclass(frozen=True, slots=True)
class EgoStart:
    """Ego's state at time 0, which is a time step of the file, and its goals.

    ``participant`` is the recorded participant that ego replaces, if any.
    """

    participant: str | None
    step: int
    state: recorded.TrackState
    targets: recorded.Points


def ego_start(recording: recorded.Recording, choice: Choice, file: str) -> EgoStart:
    """The start of the chosen ego. Raises RulecError R0612 if the file does not contain it."""
    problems = {problem.id: problem for problem in recording.problems}
    moving = {
        participant.id: participant.states
        for participant in recording.participants
        if participant.states and not participant.standing
    }
    if not problems and not moving:
        message = "the file has no moving participant and no planning problem"
        raise choice_error(message, "use a recording with a moving vehicle", file)
    if choice.ego is None and not problems and recording.ego not in moving:
        message = "the file has no planning problem that defines ego"
        raise choice_error(
            message, f"choose one of its vehicles with --ego: {named_ids(moving)}", file
        )
    own = recording.problems[0].id if problems else recording.ego
    number = own if choice.ego is None else str(choice.ego)
    if number in problems:
        return _of_problem(problems[number], recording, choice, named_ids(moving), file)
    if number not in moving:
        message = f"there is no planning problem and no moving obstacle {number}"
        raise choice_error(message, f"choose one of {named_ids([*problems, *moving])}", file)
    states = moving[number]
    step = min(states) if choice.at_s is None else _step(recording, choice.at_s, file)
    if step not in states:
        first, last = (k * recording.step_s for k in (min(states), max(states)))
        message = f"obstacle {number} has no state at {step * recording.step_s:g} s"
        raise choice_error(message, f"choose a time from {first:g} s to {last:g} s", file)
    goal = states[max(states)]
    return EgoStart(number, step, states[step], np.array([[goal.x, goal.y]]))


def _of_problem(
    problem: recorded.PlanningProblem,
    recording: recorded.Recording,
    choice: Choice,
    others: str,
    file: str,
) -> EgoStart:
    if choice.at_s is not None and _step(recording, choice.at_s, file) != problem.step:
        raise choice_error(
            f"planning problem {problem.id} defines ego at "
            f"{problem.step * recording.step_s:g} s, and at no other time",
            "leave out --at-time"
            + (f", or choose a vehicle with --ego: {others}" if others else ""),
            file,
        )
    own = (
        participant.id for participant in recording.participants if _is_ego(participant, problem)
    )
    return EgoStart(next(own, None), problem.step, problem.start, problem.goals)


def _is_ego(participant: recorded.Participant, problem: recorded.PlanningProblem) -> bool:
    """Whether a participant is the recorded drive of ego: it is at the problem's start place."""
    state = participant.states.get(problem.step)
    place = problem.start
    return state is not None and hypot(state.x - place.x, state.y - place.y) < _SAME_PLACE_M


def ego_size(recording: recorded.Recording, start: EgoStart, choice: Choice) -> tuple[float, float]:
    """Ego's length and width (m): the chosen width, else the recorded size; 0 if unknown."""
    length, width = 0.0, 0.0
    for participant in recording.participants:
        if participant.id == start.participant:
            heading = participant.states[start.step].heading
            ahead = np.array([cos(heading), sin(heading)])
            left = np.array([-ahead[1], ahead[0]])
            length, width = (
                float(np.ptp(participant.outlines[start.step] @ way)) for way in (ahead, left)
            )
    return length, width if choice.ego_width_m is None else choice.ego_width_m


class EgoMotionFields(TypedDict):
    """The fields of an ``Ego`` that describe its motion."""

    speed: float | None
    lateral_speed: float
    bounds: MotionBounds


def ego_motion(
    recording: recorded.Recording, start: EgoStart, heading: float, reference: str, file: str
) -> EgoMotionFields:
    """Ego's speed along and across a road with direction ``heading`` (rad), and its motion bounds.

    The bounds are those of the type of the participant that ego replaces, else a car's. Ego stands
    if its track only trembles, or backs slowly; else it could go aside without going ahead. Raises
    RulecError R0612 if it moves backwards along its lanelet ``reference``: maneuvers only go ahead.
    """
    types = (body.object_types for body in recording.participants if body.id == start.participant)
    bounds = bounds_of(next(types, ()))
    speed, turned = start.state.speed, start.state.heading - heading
    if not isfinite(speed):
        return {"speed": None, "lateral_speed": 0.0, "bounds": bounds}
    ahead, sideways = speed * cos(turned), speed * sin(turned)
    if ahead < -_AGAINST_MPS:
        raise choice_error(
            f"ego moves backwards along lanelet {reference}, at {-ahead:.1f} m/s",
            "choose a time at which it moves in its lane's direction with --at-time, a lanelet in "
            "its direction with --reference, or another ego with --ego; if the lanelet is drawn "
            "backwards, reverse its points, and exchange its borders",
            file,
        )
    if abs(speed) < _TREMBLES_MPS or speed < 0 < cos(turned):
        ahead = sideways = 0.0
    return {"speed": max(ahead, 0.0), "lateral_speed": sideways, "bounds": bounds}


def reference_lanelet(
    recording: recorded.Recording, choice: Choice, state: recorded.TrackState, file: str
) -> str:
    """The lanelet whose centre line is the reference line. Raises RulecError R0612."""
    if choice.reference is not None:
        reference = str(choice.reference)
        if reference not in recording.lanelets:
            message = f"there is no lanelet {reference}"
            raise choice_error(message, f"choose one of {named_ids(recording.lanelets)}", file)
        return reference
    own = lanelet_of(recording, state)
    if own is None:
        message = f"ego is on no lanelet, at x = {state.x:g}, y = {state.y:g}"
        raise choice_error(
            message, "choose a lanelet with --reference, or another ego with --ego", file
        )
    return own


def _step(recording: recorded.Recording, at_s: float, file: str) -> int:
    at_s = float(at_s)
    step = round(min(max(at_s / recording.step_s, -_FARTHEST), _FARTHEST))
    if abs(step * recording.step_s - at_s) > 1e-6:
        message = f"the file has no states at {at_s:g} s"
        raise choice_error(
            message, f"choose a multiple of its time step, {recording.step_s:g} s", file
        )
    return step


def named_ids(ids: Iterable[str]) -> str:
    """Ids as text for messages."""
    return named(list(ids))


def choice_error(message: str, way_out: str, file: str) -> RulecError:
    """The error R0612: what was chosen is not in the file."""
    return NOT_IN_RECORDING.error(SourceLocation(file), message, help=way_out)
