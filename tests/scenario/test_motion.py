"""Prediction: positions, and what is swept in an interval."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.scenario import Box, ConstantAcceleration, Obstacle, Trajectory
from rulec.scenario.motion import facing, position_at, span, stands_forever, swept
from support.generators.random_scenarios import motions


def thing(motion, direction=None, kind="vehicle"):
    return Obstacle("o", kind, 4.0, 2.0, motion, direction)


@pytest.mark.parametrize(
    ("motion", "time", "expected"),
    [
        (ConstantAcceleration(10, 1, 5), 2, (20, 1)),
        (ConstantAcceleration(10, 1, 5, 2), 2, (24, 1)),  # 10 + 10 + 4
        (ConstantAcceleration(0, 0, 8, -2), 4, (16, 0)),  # stops after 4 s and 16 m
        (ConstantAcceleration(0, 0, 8, -2), 9, (16, 0)),  # and stays there
        (ConstantAcceleration(0, 0, -8, 2), 9, (-16, 0)),  # so does oncoming traffic
        (ConstantAcceleration(0, 0, 0, -3), 5, (0, 0)),  # standing, brakes on
        (ConstantAcceleration(0, 0, 0, 2), 3, (9, 0)),  # sets off
        (ConstantAcceleration(0, 0, 0, 0, 1.5), 2, (0, 3)),
        (ConstantAcceleration(0, 0, 10, 0, 1, 3.5), 5, (50, 3.5)),  # a lane change that ends
        (ConstantAcceleration(0, 4, 10, 0, -1, 0.5), 5, (50, 0.5)),
        (ConstantAcceleration(0, 0, 2, -1, 1), 5, (2, 2)),  # who stands does not slide sideways
        (Trajectory(((0, 0, 0), (2, 10, 0), (4, 10, 3))), 1, (5, 0)),
        (Trajectory(((0, 0, 0), (2, 10, 0), (4, 10, 3))), 3, (10, 1.5)),
        (Trajectory(((0, 0, 0), (2, 10, 0), (4, 10, 3))), 4, (10, 3)),
    ],
)
def test_position(motion, time, expected):
    assert position_at(motion, time) == pytest.approx(expected)


def test_swept_while_braking_to_standstill():
    """8 m/s, -2 m/s²: from 15 m at 3 s to 16 m at 4 s, where it stays; a body of 4 m by 2 m."""
    assert swept(thing(ConstantAcceleration(0, 0, 8, -2)), 3, 6) == Box(13, 18, -1, 1)


def test_swept_sees_the_turning_point_inside_the_interval():
    there_and_back = Trajectory(((0, 0, 0), (0.4, 10, 2), (1, 0, 0)))
    assert swept(thing(there_and_back), 0, 1) == Box(-2, 12, -1, 3)


def test_a_trajectory_is_there_from_its_first_to_its_last_time():
    late = thing(Trajectory(((1, 0, 0), (2, 10, 0))))
    assert swept(late, 0, 0.5) is None
    assert swept(late, 0, 1) == Box(-2, 2, -1, 1)
    assert swept(late, 1.5, 9) == Box(3, 12, -1, 1)
    assert swept(late, 2.5, 9) is None


@given(motions(), st.floats(0, 3), st.floats(0.01, 1.5), st.floats(0, 1))
def test_every_moment_lies_in_what_is_swept(motion, start, length, part):
    obstacle = thing(motion)
    first, last = span(motion)
    time = start + part * length
    box = swept(obstacle, start, start + length)
    if not first <= time <= last:
        return
    s, d = position_at(motion, time)
    assert box is not None
    assert box.s_min - 1e-9 <= s - 2 <= s + 2 <= box.s_max + 1e-9
    assert box.d_min - 1e-9 <= d - 1 <= d + 1 <= box.d_max + 1e-9


@given(motions(), st.floats(0, 2), st.floats(0.01, 1.5))
def test_what_is_swept_is_no_larger_than_needed(motion, start, length):
    """Each side is reached, up to what a fine sampling can see (15 + 8 t m/s for a thousandth)."""
    first, last = span(motion)
    low, high = max(start, first), min(start + length, last)
    box = swept(thing(motion), start, start + length)
    if low > high:
        assert box is None
        return
    times = [low + (high - low) * i / 1000 for i in range(1001)]
    places = [position_at(motion, time) for time in times]
    reached = (
        min(s for s, _ in places) - 2,
        max(s for s, _ in places) + 2,
        min(d for _, d in places) - 1,
        max(d for _, d in places) + 1,
    )
    assert (box.s_min, box.s_max, box.d_min, box.d_max) == pytest.approx(reached, abs=0.5)


@pytest.mark.parametrize(
    ("motion", "direction", "expected"),
    [
        (ConstantAcceleration(0, 0, 0, 0, 1), None, "left"),
        (ConstantAcceleration(0, 0, 0, 0, -1), None, "right"),
        (ConstantAcceleration(0, 0, 1), None, "along"),
        (ConstantAcceleration(0, 0, -1), None, "against"),
        (ConstantAcceleration(0, 0, 1, 0, 0.9), None, "along"),
        (ConstantAcceleration(0, 0, 1, 0, 1), None, "left"),  # half-way counts as across
        (ConstantAcceleration(0, 0, -1, 0, -1), None, "right"),
        (ConstantAcceleration(0, 0, 0, 0, 1), -90, "right"),  # what the file says comes first
        (ConstantAcceleration(0, 0), 100, "left"),
        (ConstantAcceleration(0, 0), 225, "right"),
        (ConstantAcceleration(0, 0), -360, "along"),
        (ConstantAcceleration(0, 0), 180, "against"),
    ],
)
def test_facing(motion, direction, expected):
    assert facing(thing(motion, direction, "pedestrian"), 0, 1) == expected


def test_facing_follows_a_trajectory_and_is_kept_while_standing():
    """Along the pavement for 2 s, a wait of 2 s, then across for 2 s."""
    walk = Trajectory(((0, 0, -3), (2, 2, -3), (4, 2, -3), (6, 2, 0)))
    walker = thing(walk, None, "pedestrian")
    seen = [facing(walker, t, t + 1) for t in range(7)]
    assert seen == ["along", "along", "along", "along", "left", "left", "left"]


def test_facing_of_one_who_has_not_set_off_is_that_of_the_first_steps():
    walker = thing(Trajectory(((0, 0, -3), (2, 0, -3), (4, 0, 3))), None, "pedestrian")
    assert facing(walker, 0, 1) == "left"


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        (ConstantAcceleration(0, 0), True),
        (ConstantAcceleration(0, 0, 0, -1), True),
        (ConstantAcceleration(0, 0, 0, 1), False),
        (ConstantAcceleration(0, 0, 0, 0, 1), False),
        (Trajectory(((0, 1, 1),)), True),
        (Trajectory(((0, 1, 1), (1, 1, 1))), True),
        (Trajectory(((0, 1, 1), (1, 1, 2))), False),
    ],
)
def test_stands_forever(motion, expected):
    assert stands_forever(motion) == expected
