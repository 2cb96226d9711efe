"""What is occupied when that is known from time to time."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.scenario import Box, Footprints, Obstacle, Trajectory
from rulec.scenario.geometry import centred
from rulec.scenario.motion import facing, stands_forever, swept

coordinates = st.floats(-50, 50)
points = st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=5)


def as_both(places):
    """The same motion as a trajectory and as footprints, one position a second."""
    times = range(len(places))
    trajectory = Trajectory(
        tuple((float(t), s, d) for t, (s, d) in zip(times, places, strict=True))
    )
    boxes = tuple(centred(s, d, 4.0, 2.0) for s, d in places)
    footprints = Footprints(tuple(map(float, times)), boxes)
    return (Obstacle("a", "pedestrian", 4.0, 2.0, motion) for motion in (trajectory, footprints))


@given(points, st.floats(-1, 6), st.floats(0, 3))
def test_of_one_shape_they_sweep_what_a_trajectory_sweeps(places, start, duration):
    one, other = (swept(each, start, start + duration) for each in as_both(places))
    if one is None or other is None:
        assert one is other is None
    else:
        for side in ("s_min", "s_max", "d_min", "d_max"):
            assert getattr(other, side) == pytest.approx(getattr(one, side), abs=1e-9)


@given(points, st.integers(0, 10), st.integers(1, 6))
def test_they_face_where_a_trajectory_faces(places, start, duration):
    # Halves are exact: rounding must not decide who stands, and what is across
    places = [(round(s), 2.5 * round(d)) for s, d in places]
    start, duration = start / 2, duration / 2
    one, other = as_both(places)
    if not stands_forever(one.motion):
        assert facing(one, start, start + duration) == facing(other, start, start + duration)
    assert stands_forever(one.motion) == stands_forever(other.motion)


def test_where_nothing_is_known_there_is_nothing():
    box = Box(0, 4, 0, 2)
    moved = Box(10, 14, 0, 2)
    obstacle = Obstacle(
        "a", "car", 4, 2, Footprints((0.0, 1.0, 2.0, 3.0), (box, None, moved, moved))
    )
    assert swept(obstacle, 0, 0.5) == box
    assert swept(obstacle, 0.5, 1.5) is None
    assert swept(obstacle, 0.5, 2) == moved
    assert swept(obstacle, 0, 3) == Box(0, 14, 0, 2)
    assert swept(obstacle, 3.1, 4) is None


def test_a_shape_that_changes_is_swept_whole():
    turning = Footprints((0.0, 2.0), (Box(0, 4, -1, 1), Box(1, 3, -2, 2)))
    assert swept(Obstacle("a", "car", 4, 2, turning), 1, 1) == Box(0.5, 3.5, -1.5, 1.5)
    assert swept(Obstacle("a", "car", 4, 2, turning), 1, 9) == Box(0.5, 3.5, -2, 2)
