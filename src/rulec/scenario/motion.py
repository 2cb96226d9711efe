"""An obstacle's place at an instant, and its swept space."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from math import atan2, cos, degrees, inf, radians, sin
from typing import Literal

from rulec.scenario.footprints import bounds_within, displacement_within, displacements
from rulec.scenario.geometry import Box
from rulec.scenario.scenario_model import (
    ConstantAcceleration,
    Footprints,
    Motion,
    Obstacle,
    Trajectory,
)

Facing = Literal["along", "left", "against", "right"]


def span(motion: Motion) -> tuple[float, float]:
    """First and last time (s) at which the obstacle is there."""
    match motion:
        case ConstantAcceleration():
            return 0.0, inf
        case Trajectory(points):
            return points[0][0], points[-1][0]
        case Footprints(times):
            return times[0], times[-1]


def position_at(motion: ConstantAcceleration | Trajectory, time: float) -> tuple[float, float]:
    """The centre ``(s, d)`` at a time (s) within ``span``."""
    match motion:
        case ConstantAcceleration():
            return _accelerated(motion, time)
        case Trajectory(points):
            return _interpolated(points, time)


def swept(obstacle: Obstacle, start: float, end: float) -> Box | None:
    """The bounds of the space occupied from ``start`` to ``end`` (s).

    Both times are included.

    Exact: between the times that it looks at, motion along and across the road is monotone. None if
    the obstacle is not there in that interval.
    """
    if isinstance(obstacle.motion, Footprints):
        return bounds_within(obstacle.motion, start, end)
    first, last = span(obstacle.motion)
    start, end = max(start, first), min(end, last)
    if start > end:
        return None
    times = [start, end]
    if isinstance(obstacle.motion, Trajectory):
        times += [point[0] for point in obstacle.motion.points if start < point[0] < end]
    centres = [position_at(obstacle.motion, time) for time in times]
    half_length, half_width = obstacle.length / 2, obstacle.width / 2
    return Box(
        min(s for s, _ in centres) - half_length,
        max(s for s, _ in centres) + half_length,
        min(d for _, d in centres) - half_width,
        max(d for _, d in centres) + half_width,
    )


def facing(obstacle: Obstacle, start: float, end: float) -> Facing:
    """The walking direction from ``start`` to ``end`` (s), by right angles.

    It is rounded to a right angle of the road.

    Who stands keeps the direction of the last steps before, failing that takes that of the next
    steps. A direction half-way between two right angles counts as across the road.
    """
    if obstacle.walking_direction is not None:
        angle = radians(obstacle.walking_direction)
        return _right_angle(cos(angle), sin(angle))
    return _right_angle(*_heading(obstacle.motion, start, end))


def stands_forever(motion: Motion) -> bool:
    """True if the obstacle never moves, and so shows no direction."""
    return _heading(motion, 0.0, 0.0) == (0.0, 0.0)


def _heading(motion: Motion, start: float, end: float) -> tuple[float, float]:
    match motion:
        case ConstantAcceleration():
            speed = motion.speed or max(motion.acceleration, 0.0)
            return speed, motion.lateral_speed
        case Trajectory(points):
            steps = [
                (t0, t1, s1 - s0, d1 - d0)
                for (t0, s0, d0), (t1, s1, d1) in pairwise(points)
                if (s0, d0) != (s1, d1)
            ]
            return _nearest_step(tuple(steps), _step_within(motion, start, end), end)
        case Footprints():
            meanwhile = displacement_within(motion, start, end)
            return _nearest_step(displacements(motion), meanwhile, end)


def _nearest_step(
    steps: tuple[tuple[float, float, float, float], ...],
    meanwhile: tuple[float, float],
    end: float,
) -> tuple[float, float]:
    """The displacement within an interval, or at rest a neighbouring one.

    At rest it is that of the last step before, else of the next.
    """
    if meanwhile != (0.0, 0.0) or not steps:
        return meanwhile
    before = [step for step in steps if step[1] <= end]
    return (before[-1] if before else steps[0])[2:]


def _step_within(motion: Trajectory, start: float, end: float) -> tuple[float, float]:
    first, last = span(motion)
    start, end = (min(max(time, first), last) for time in (start, end))
    (s0, d0), (s1, d1) = position_at(motion, start), position_at(motion, end)
    return s1 - s0, d1 - d0


def _right_angle(ahead: float, left: float) -> Facing:
    # The cosine of 90° is not quite 0, and 45° should not fall to either side by rounding
    angle = round(degrees(atan2(left, ahead)), 6)
    if 45 <= angle <= 135:
        return "left"
    if -135 <= angle <= -45:
        return "right"
    return "along" if -45 < angle < 45 else "against"


def _accelerated(motion: ConstantAcceleration, time: float) -> tuple[float, float]:
    speed, acceleration = motion.speed, motion.acceleration
    if speed == 0 and acceleration < 0:
        acceleration = 0.0
    if speed * acceleration < 0:
        time = min(time, -speed / acceleration)
    s = motion.s + speed * time + acceleration * time * time / 2
    d = motion.d + motion.lateral_speed * time
    if motion.until_d is not None:
        d = min(d, motion.until_d) if motion.lateral_speed > 0 else max(d, motion.until_d)
    return s, d


def _interpolated(
    points: tuple[tuple[float, float, float], ...], time: float
) -> tuple[float, float]:
    following = bisect_right(points, time, key=lambda point: point[0])
    if following == len(points):
        return points[-1][1:]
    (t0, s0, d0), (t1, s1, d1) = points[following - 1 : following + 1]
    part = (time - t0) / (t1 - t0)
    return s0 + part * (s1 - s0), d0 + part * (d1 - d0)
