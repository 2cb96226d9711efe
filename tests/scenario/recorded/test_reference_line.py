"""Street-wise coordinates against circles and straight lines, where they are known."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from shapely import contains_xy

from rulec.scenario.recorded.reference_line import BEYOND_M, reference_line

RADIUS = 60.0
offsets = st.floats(-20, 20)


def arc(pieces, angle=pi):
    """A left turn around (0, RADIUS) from the origin, with corners on the circle."""
    at = np.linspace(0, angle, pieces + 1)
    return np.stack((RADIUS * np.sin(at), RADIUS - RADIUS * np.cos(at)), axis=1)


@given(st.floats(-500, 600), st.floats(-500, 500))
def test_on_a_straight_line_they_are_x_and_y(x, y):
    line = reference_line(np.array([(0.0, 0.0), (30.0, 0.0), (100.0, 0.0)]))
    ((s, d),) = line.coordinates(np.array([(x, y)]))
    assert (s, d) == pytest.approx((x, y), abs=1e-6)
    assert line.length == pytest.approx(100)


@given(st.floats(0.1, pi - 0.1), offsets)
def test_on_a_circle_they_are_the_angle_and_the_distance(angle, offset):
    """With corners every 1.9 m the line and its interpolated directions are those of the circle."""
    line = reference_line(arc(100))
    far = RADIUS - offset  # to the left is towards the centre
    ((s, d),) = line.coordinates(np.array([(far * sin(angle), RADIUS - far * cos(angle))]))
    assert s == pytest.approx(RADIUS * angle, abs=0.05)
    assert d == pytest.approx(offset, abs=0.02)
    assert line.heading_at(s) == pytest.approx(angle, abs=0.02)


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        # On the last leg, through which the first one would lead if it went on backwards
        ((203.0, 0.0), (800, -3)),
        # Beyond where the line begins, far from all of it
        ((100.0, 0.5), (-100, -0.5)),
        # Where it begins, and just before
        ((-1.0, 3.0), (1, -3)),
        ((2.0, 3.0), (-2, -3)),
    ],
)
def test_who_is_beside_the_line_is_not_on_what_it_would_be_beyond_its_ends(place, expected):
    """It leads to the west, 200 m to the south, 400 m to the east, and to the north again."""
    line = reference_line(
        np.array([(0.0, 0.0), (-100, 0), (-100, -200), (200, -200), (200, 300)], dtype=float)
    )
    ((s, d),) = line.coordinates(np.array([place]))
    assert (s, d) == pytest.approx(expected, abs=0.1)


@given(st.floats(0.1, 3), offsets, st.integers(4, 12))
def test_they_do_not_jump_at_corners(angle, offset, pieces):
    """Even where the line is coarse: a step of 1 cm is one of a few centimetres at most."""
    assume(abs(offset) < 12)
    line = reference_line(arc(pieces))
    far = RADIUS - offset
    places = np.array(
        [(far * sin(a), RADIUS - far * cos(a)) for a in (angle, angle + 0.01 / RADIUS)]
    )
    one, other = line.coordinates(places)
    assert np.abs(one - other).max() < 0.05
    assert other[0] > one[0]


@given(st.floats(-1, 1.5), offsets)
def test_a_window_finds_the_same_feet(part, offset):
    line = reference_line(arc(40))
    place = np.array([(RADIUS * part, offset)])
    ((s, d),) = line.coordinates(place)
    ((near_s, near_d),) = line.coordinates_near(place, np.array([s + 3]), np.array([5.0]))
    assert (near_s, near_d) == (s, d)


def test_a_window_keeps_to_its_part_of_a_road_that_comes_near_itself():
    there_and_back = np.array([(0, 0), (50, 0), (60, 5), (50, 10), (0, 10)], dtype=float)
    line = reference_line(there_and_back)
    place = np.array([(20.0, 6.0)])
    ((s, d),) = line.coordinates(place)
    assert (s, d) == pytest.approx((line.length - 20, 4), abs=1e-6)
    ((s, d),) = line.coordinates_near(place, np.array([20.0]), np.array([10.0]))
    assert (s, d) == pytest.approx((20, 6), abs=1e-6)


def test_beyond_the_ends_it_goes_on_straight():
    line = reference_line(arc(100, pi / 2))
    ((s, d), (t, e)) = line.coordinates(np.array([(-30.0, 4.0), (RADIUS + 3, RADIUS + 50)]))
    assert (s, d) == pytest.approx((-30, 4), abs=0.3)
    assert (t, e) == pytest.approx((line.length + 50, -3), abs=0.8)


def test_what_has_no_foot_has_no_coordinates():
    line = reference_line(np.array([(0.0, 0.0), (10.0, 0.0)]))
    found = line.coordinates(np.array([(-BEYOND_M - 1, 0.0), (5.0, 1.0)]))
    assert np.isnan(found[0]).all()
    assert found[1].tolist() == [5, 1]
    assert line.coordinates(np.empty((0, 2))).shape == (0, 2)


def feet_one_by_one(line, place, pieces):
    """The nearest foot of a place, each piece of the line being tried by itself.

    Of those beyond its ends only if none is nearer than 15 m more.
    """
    feet, last = [], len(line.arc) - 1
    for k in pieces:
        across_piece = np.array([-line.ahead[k, 1], line.ahead[k, 0]])
        along, across = (
            (place - line.start[k]) @ line.ahead[k],
            (place - line.start[k]) @ across_piece,
        )
        length = line.lengths[k] - across * line.change[k]
        part = (along + across * line.first[k]) / length if length > 0 else np.nan
        if 0 <= part <= 1:
            off = np.hypot(along - part * line.lengths[k], across)
            more = 15.0 if k in (0, last) else 0.0
            s = line.arc[k] + part * line.lengths[k]
            feet.append((off + more, s, np.copysign(off, across)))
    return min(feet)[1:] if feet else (np.nan, np.nan)


@given(st.integers(0, 2**32 - 1), st.sampled_from([2.0, 30.0]), st.sampled_from([0.0, 1e6]))
def test_the_foot_is_the_nearest_of_all_pieces_however_the_line_winds(seed, step, offset):
    random = np.random.default_rng(seed)
    corners = np.cumsum(random.normal(size=(12, 2)) * step, axis=0) + offset
    line = reference_line(corners)
    places = corners[random.integers(0, 12, 20)] + random.normal(size=(20, 2)) * step
    around, reach = random.uniform(0, line.length, 20), random.uniform(0, 2 * step, 20)
    low, high = (
        np.clip(np.searchsorted(line.arc, around + way * reach, "right") - 1, 0, None)
        for way in (-1, 1)
    )
    every = range(len(line.arc))
    whole, near = line.coordinates(places), line.coordinates_near(places, around, reach)
    for k, place in enumerate(places):
        one, own = feet_one_by_one(line, place, every), range(low[k], high[k] + 1)
        assert whole[k] == pytest.approx(one, abs=1e-5, nan_ok=True)
        assert near[k] == pytest.approx(feet_one_by_one(line, place, own), abs=1e-5, nan_ok=True)


@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 0.02, 0.2, 1.0]), st.sampled_from([0, 1e6]))
def test_rows_of_places_have_the_nearest_feet_of_all_pieces_within_their_reach(seed, bend, offset):
    """Straight, curved and winding lines."""
    random = np.random.default_rng(seed)
    headings = np.cumsum(random.normal(size=15) * bend) + random.uniform(-pi, pi)
    steps = np.stack((np.cos(headings), np.sin(headings)), axis=1) * random.uniform(1, 20, (15, 1))
    line = reference_line(np.cumsum(steps, axis=0) + offset)
    around, reach = random.uniform(-30, line.length + 30, 8), random.uniform(5, 20, 8)
    pieces = np.clip(np.searchsorted(line.arc, around, "right") - 1, 0, len(line.arc) - 1)
    on_line = line.start[pieces] + (around - line.arc[pieces])[:, None] * line.ahead[pieces]
    places = on_line[:, None] + random.normal(size=(8, 3, 2)) * 5
    found = line.coordinates_near(places.reshape(-1, 2), around, reach, 3).reshape(8, 3, 2)
    whole, every = line.coordinates(places[:, 0]), range(len(line.arc))
    for row in range(8):
        expected = feet_one_by_one(line, places[row, 0], every)
        assert whole[row] == pytest.approx(expected, abs=1e-5, nan_ok=True)
        low, high = (
            np.clip(np.searchsorted(line.arc, around[row] + way * reach[row], "right") - 1, 0, None)
            for way in (-1, 1)
        )
        for place, own in zip(places[row], found[row], strict=True):
            expected = feet_one_by_one(line, place, range(low, high + 1))
            assert own == pytest.approx(expected, abs=1e-5, nan_ok=True)


def test_a_bend_too_small_to_divide_by_is_none():
    line = reference_line(np.array([(0.0, 0.0), (10.0, 0.0), (20.0, 1e-308)]))
    places = np.stack((np.linspace(1, 19, 99), np.full(99, 3.0)), axis=1)
    assert line.coordinates(places) == pytest.approx(places)


@given(st.integers(0, 2**32 - 1), st.sampled_from([3.0, 40.0]), st.sampled_from([0.0, 1e6]))
def test_whatever_is_near_a_line_lies_in_its_surroundings(seed, step, offset):
    random = np.random.default_rng(seed)
    line = reference_line(np.cumsum(random.normal(size=(9, 2)) * step, axis=0) + offset)
    near_m, beyond_m = random.uniform(1, 60), random.uniform(0, 500)
    found = line.surroundings(near_m, beyond_m)
    at = random.uniform(-beyond_m, line.length + beyond_m, 100)
    pieces = np.clip(np.searchsorted(line.arc, at, "right") - 1, 0, len(line.arc) - 1)
    on_line = line.start[pieces] + (at - line.arc[pieces])[:, None] * line.ahead[pieces]
    turned, away = random.uniform(0, 2 * pi, 100), near_m * random.uniform(0, 1, 100)
    way = np.stack((np.cos(turned), np.sin(turned)), axis=1)
    assert contains_xy(found, *(on_line + away[:, None] * way).T).all()
    # Not much farther away than that nothing does, nor is a place that is unknown
    far = on_line.max(axis=0) + 2 * near_m + beyond_m + 100
    assert not contains_xy(found, np.array([far[0], np.nan]), np.array([far[1], offset])).any()


def test_the_surroundings_of_a_straight_line_are_a_strip():
    line = reference_line(np.array([[0.0, 0.0], [1000.0, 0.0]]))
    found = line.surroundings(20.0, 100.0)
    off = np.array([0.0, 20.0, 21.0, 300.0])
    assert contains_xy(found, np.full(4, 500.0), off).tolist() == [True, True, False, False]
    along = np.array([-120.0, -121.0, 1120.0, 1121.0])
    assert contains_xy(found, along, np.zeros(4)).tolist() == [True, False, True, False]


def test_surroundings_may_be_as_long_as_the_world():
    """Who is said to drive a million kilometres in a second may come from as far away."""
    line = reference_line(np.array([[0.0, 0.0], [1000.0, 0.0]]))
    found = line.surroundings(20.0, 1e12)
    along = np.array([-1e12, -1e6, 500.0, 1e12])
    assert contains_xy(found, along, np.array([0.0, 20.0, -20.0, 20.0])).all()
