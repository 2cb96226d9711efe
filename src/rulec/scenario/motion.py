"""An obstacle's position at an instant, and the space it sweeps."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from itertools import pairwise
from math import atan2, cos, degrees, inf, radians, sin
from typing import Literal

from rulec.scenario import scenario_model as model
from rulec.scenario.geometry import Box, centred, enclosing

Facing = Literal["along", "left", "against", "right"]


def span(motion: model.Motion) -> tuple[float, float]:
    """The first and the last time (s) at which the obstacle exists."""
    match motion:
        case model.ConstantAcceleration():
            return 0.0, inf
        case model.Trajectory(points):
            return points[0][0], points[-1][0]
        case model.Footprints(times):
            return times[0], times[-1]


def position_at(
    motion: model.ConstantAcceleration | model.Trajectory, time: float
) -> tuple[float, float]:
    """The centre ``(s, d)`` at a time (s) within ``span``."""
    match motion:
        case model.ConstantAcceleration():
            return _accelerated(motion, time)
        case model.Trajectory(points):
            return _interpolated(points, time)


def swept(obstacle: model.Obstacle, start: float, end: float) -> Box | None:
    """The bounding box of the space occupied from ``start`` to ``end`` (s), both included.

    Exact, because motion along and across the road is monotone between the times that are
    evaluated. None if the obstacle does not exist in that interval.
    """
    motion = obstacle.motion
    if isinstance(motion, model.Footprints):
        boxes = _footprints_within(motion, start, end)
        return enclosing(boxes) if boxes else None
    first, last = span(motion)
    start, end = max(start, first), min(end, last)
    if start > end:
        return None
    times = [start, end]
    if isinstance(motion, model.Trajectory):
        times += [point[0] for point in motion.points if start < point[0] < end]
    length, width = obstacle.length, obstacle.width
    return enclosing([centred(*position_at(motion, time), length, width) for time in times])


def facing(obstacle: model.Obstacle, start: float, end: float) -> Facing:
    """The walking direction from ``start`` to ``end`` (s), rounded to right angles of the road.

    An obstacle at rest has the direction of its last movement before, otherwise that of its next
    one. A direction half-way between two right angles counts as across the road.
    """
    if obstacle.walking_direction is not None:
        angle = radians(obstacle.walking_direction)
        return _right_angle(cos(angle), sin(angle))
    return _right_angle(*_heading(obstacle.motion, start, end))


def stands_forever(motion: model.Motion) -> bool:
    """Whether the obstacle never moves, so that its motion shows no direction."""
    return _heading(motion, 0.0, 0.0) == (0.0, 0.0)


def _heading(motion: model.Motion, start: float, end: float) -> tuple[float, float]:
    """The displacement in an interval; at rest that of the last step before, else of the next."""
    match motion:
        case model.ConstantAcceleration():
            speed = motion.speed or max(motion.acceleration, 0.0)
            return speed, motion.lateral_speed
        case model.Trajectory(points):
            first, last = span(motion)
            (s0, d0), (s1, d1) = (
                position_at(motion, min(max(time, first), last)) for time in (start, end)
            )
            meanwhile = s1 - s0, d1 - d0
            steps = [(t1, (s1 - s0, d1 - d0)) for (_, s0, d0), (t1, s1, d1) in pairwise(points)]
        case model.Footprints():
            boxes = _footprints_within(motion, start, end)
            meanwhile = boxes[0].shift_to(boxes[-1]) if boxes else (0.0, 0.0)
            steps = [
                (time, before.shift_to(after))
                for time, (before, after) in zip(
                    motion.times[1:], pairwise(motion.boxes), strict=True
                )
                if before is not None and after is not None
            ]
    steps = [step for step in steps if step[1] != (0.0, 0.0)]
    if meanwhile != (0.0, 0.0) or not steps:
        return meanwhile
    past = [way for time, way in steps if time <= end]
    return past[-1] if past else steps[0][1]


def _right_angle(ahead: float, left: float) -> Facing:
    # The cosine of 90° is not quite 0, and 45° should not fall to either side by rounding
    angle = round(degrees(atan2(left, ahead)), 6)
    if 45 <= angle <= 135:
        return "left"
    if -135 <= angle <= -45:
        return "right"
    return "along" if -45 < angle < 45 else "against"


def _accelerated(motion: model.ConstantAcceleration, time: float) -> tuple[float, float]:
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


def _footprints_within(motion: model.Footprints, start: float, end: float) -> list[Box]:
    first, last = bisect_left(motion.times, start), bisect_right(motion.times, end)
    ends = (_footprint_at(motion, start), *motion.boxes[first:last], _footprint_at(motion, end))
    return [box for box in ends if box is not None]


def _footprint_at(motion: model.Footprints, time: float) -> Box | None:
    times, boxes = motion.times, motion.boxes
    after = bisect_left(times, time)
    if after == len(times):
        return None
    if times[after] == time:
        return boxes[after]
    earlier, later = (boxes[after - 1], boxes[after]) if after else (None, None)
    if earlier is None or later is None:
        return None
    part = (time - times[after - 1]) / (times[after] - times[after - 1])
    return Box(
        earlier.s_min + part * (later.s_min - earlier.s_min),
        earlier.s_max + part * (later.s_max - earlier.s_max),
        earlier.d_min + part * (later.d_min - earlier.d_min),
        earlier.d_max + part * (later.d_max - earlier.d_max),
    )
