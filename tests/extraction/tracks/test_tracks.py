"""Tracks: who is where when, and velocities as differences of places."""

from dataclasses import replace
from math import nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.tracks.tracks import ObjectTypes, tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from rulec.trace.laid_out import LaidOut, columns_of
from support.builders.recordings import recording, straight, vehicle

ROAD = [straight(1, -100, 300)]


def tracks(*participants, **thresholds):
    return tracks_of(recording(ROAD, participants), replace(USUAL, **thresholds))


def test_columns_begin_with_the_first_step_of_anybody():
    found = tracks(vehicle(7, {3: (0, 0), 4: (5, 0)}), vehicle(8, {5: (9, 1), 6: (9, 2)}))
    assert found.first == 3
    assert found.present.tolist() == [[True, True, False, False], [False, False, True, True]]
    assert found.x[0, :2].tolist() == [0, 5]
    assert np.isnan(found.x[0, 2:]).all()
    assert found.y[1, 2:].tolist() == [1, 2]


def test_velocities_are_differences_over_the_window_around_a_moment():
    # Half a second apart: 5 m, then 10 m. What the file says of speeds does not count
    found = tracks(vehicle(7, {0: (0, 0), 1: (5, 0), 2: (15, 0)}, speed=99))
    assert found.vx[0] == pytest.approx([10, 15, 20])
    assert found.speed[0] == pytest.approx([10, 15, 20])
    # 10 m/s are of the first half second, 20 of the second one: of half a second later
    assert found.acceleration[0] == pytest.approx([20, 20, 20])
    wide = tracks(vehicle(7, {0: (0, 0), 1: (5, 0), 2: (15, 0)}), smoothing_s=2.0)
    assert wide.vx[0] == pytest.approx([15, 15, 15])


def test_no_difference_is_taken_over_an_absence():
    places = {0: (0, 0), 1: (5, 0), 4: (100, 0), 5: (110, 0)}
    assert tracks(vehicle(7, places)).vx[0, [0, 1, 4, 5]] == pytest.approx([10, 10, 20, 20])


def test_in_a_single_moment_the_stated_speed_counts():
    found = tracks(vehicle(7, {0: (0, 0)}, speed=6, heading=np.pi / 2))
    assert (found.vx[0, 0], found.vy[0, 0]) == (pytest.approx(0), pytest.approx(6))
    assert found.acceleration[0, 0] == 0


@pytest.mark.parametrize(
    ("kind", "speed"), [("car", 0.0), ("bicycle", 0.0), ("train", 0.0), ("pedestrian", 2.0)]
)
def test_what_steers_has_no_speed_across_its_heading(kind, speed):
    """It drives east and then stands, but noise moves it to and fro across that by 1 m each 0.5 s.

    Only who walks may have walked so, at 2 m/s.
    """
    places = {k: (min(10.0 * k, 40.0), 0.0 if k < 5 else float(k % 2)) for k in range(9)}
    found = tracks(vehicle(8, places, kind, heading=0.0, speed=0.0), smoothing_s=0.5)
    assert found.speed[0, -1] == pytest.approx(speed)


def test_a_standing_participant_is_there_all_the_time():
    found = tracks(vehicle(7, {0: (0, 0), 3: (9, 0)}), vehicle(8, {0: (5, 2)}, standing=True))
    assert found.present[1].all()
    assert found.x[1].tolist() == [5, 5, 5, 5]
    assert found.speed[1].tolist() == [0, 0, 0, 0]
    # Its outline is handed out once
    bodies = found.bodies
    assert [*zip(bodies.rows.tolist(), bodies.columns.tolist(), strict=True)] == [
        *((0, 0), (0, 3), (1, 0))
    ]


def test_types_include_their_supertypes():
    found = tracks(
        vehicle(1, {0: (0, 0)}, "truck"),
        vehicle(2, {0: (9, 0)}, "bicycle"),
        vehicle(3, {0: (20, 0)}, "made of cheese"),
    )
    assert found.of_type("vehicle").tolist() == [True, False, False]
    assert found.of_type("vulnerable_user").tolist() == [False, True, False]
    assert found.of_type("road_user").tolist() == [True, True, True]


def test_a_part_has_the_rows_and_columns_asked_for():
    bodies = [vehicle(k, {step: (step + 10 * k, k) for step in range(4)}) for k in range(3)]
    part = tracks(*bodies).part(np.array([2, 0]), slice(1, 3))
    assert [body.id for body in part.participants] == ["2", "0"]
    assert part.first == 1
    assert part.x.tolist() == [[21, 22], [1, 2]]


@given(
    st.floats(-50, 50),
    st.floats(-50, 50),
    st.sets(st.integers(0, 12), min_size=2),
    st.floats(0.5, 4),
)
def test_constant_velocity_is_found_wherever_it_can_be(vx, vy, steps, smoothing_s):
    places = {k: (vx * 0.5 * k, vy * 0.5 * k) for k in sorted(steps)}
    found = tracks(vehicle(7, places), smoothing_s=smoothing_s)
    for step in steps:
        alone = step - 1 not in steps and step + 1 not in steps
        expected = 0.0 if alone else vx
        assert found.vx[0, step - found.first] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("ranges", "expected"),
    [
        ([slice(1, 3), slice(1, 3)], [[9, 10, 9, 10], [1, 2, nan, nan]]),
        ([slice(1, 3), slice(2, 4)], [[9, 10, 10, 11], [1, 2, nan, nan]]),
    ],
)
def test_who_is_absent_from_a_range_has_no_values_in_it(ranges, expected):
    values, absent = np.arange(12.0).reshape(3, 4), np.zeros((2, 4), dtype=bool)
    absent[1, 2:] = True
    laid = LaidOut(np.array([2, 0]), columns_of(ranges), absent)
    assert np.array_equal(laid(values), expected, equal_nan=True)
    by_lane = laid(np.stack((values, -values), axis=-1))
    for lane, sign in enumerate((1, -1)):
        assert np.array_equal(by_lane[..., lane], sign * np.array(expected), equal_nan=True)
    flags = laid(values > 0)
    assert flags.tolist() == [[True] * 4, [True, True, False, False]]


def test_a_part_of_a_part_is_of_the_whole_and_lays_out_what_is_asked_for():
    bodies = [vehicle(7 + k, {step: (9 * step, k) for step in range(k, 8)}) for k in range(4)]
    whole = tracks(*bodies)
    part = whole.part(np.array([1, 2, 3]), slice(2, 7))
    again = part.part(np.array([0, 2]), slice(1, 4))
    assert (again.first, again.rows.tolist()) == (3, [1, 3])
    assert [body.id for body in again.participants] == ["8", "10"]
    assert again.y.tolist() == [[1.0, 1.0, 1.0], [3.0, 3.0, 3.0]]
    assert again.x.tolist() == whole.x[[1, 3], 3:6].tolist() == [[27.0, 36.0, 45.0]] * 2
    assert {"x", "y"} <= again.__dict__.keys()
    assert not {"x", "y", "speed"} & part.__dict__.keys()


def test_the_same_tracks_seen_as_those_of_others():
    one = tracks(vehicle(7, {0: (0, 0), 1: (9, 0)})).part(np.array([0]), slice(0, 1))
    types = ObjectTypes([vehicle(7, {0: (0, 0)}), vehicle(8, {0: (5, 0)})])
    other = one.seen_as((vehicle(8, {0: (5, 0)}),), types, np.array([1]))
    assert (other.rows.tolist(), other.x.tolist(), other.first) == ([1], [[0.0]], 0)
    assert other.of_type("vehicle").tolist() == [True]
    assert one.rows.tolist() == [0]
