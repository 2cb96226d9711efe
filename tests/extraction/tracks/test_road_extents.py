"""Extents along and across a road, in Frenet coordinates."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.extraction.tracks.lane_sets import is_in, lane_sets
from rulec.extraction.tracks.road_extents import road_extents
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.drive_contexts import driven_road
from support.builders.recordings import lanelet, recording, straight, vehicle

BOUNDS = ("s_min", "s_max", "d_min", "d_max")


def extents(lanes, *participants, route=("1",)):
    found = recording(lanes, participants)
    return road_extents(tracks_of(found, USUAL), driven_road(found, route))


def bounds(found, row=0, column=0):
    return [float(getattr(found, name)[row, column]) for name in BOUNDS]


@given(st.floats(5, 95), st.floats(-6, 6), st.floats(0.5, 12), st.floats(0.3, 3))
def test_on_a_straight_road_extents_are_coordinates(x, y, length, width):
    found = extents([straight(1, 0, 100)], vehicle(7, {0: (x, y)}, length=length, width=width))
    along = [x - length / 2, x + length / 2]
    across = [y - width / 2, y + width / 2]
    assert bounds(found) == pytest.approx([*along, *across], abs=1e-6)
    # The lane is 4 m wide
    assert found.left_of_min[0, 0] == pytest.approx([across[0] + 2, across[0] - 2], abs=1e-6)
    assert found.left_of_max[0, 0] == pytest.approx([across[1] + 2, across[1] - 2], abs=1e-6)


@given(st.floats(-pi, pi), st.floats(-900, 900), st.floats(-900, 900))
def test_they_do_not_depend_on_where_the_road_lies_and_leads(angle, x, y):
    def placed(s, d):
        return x + s * cos(angle) - d * sin(angle), y + s * sin(angle) + d * cos(angle)

    road = lanelet(1, [placed(0, 0), placed(100, 0)])
    body = vehicle(7, {0: placed(40, 1), 1: placed(45, 1)}, heading=angle)
    found = extents([road], body)
    assert bounds(found) == pytest.approx([38, 42, 0, 2], abs=1e-6)
    assert found.left_of[0, 0] == pytest.approx([3, -1], abs=1e-6)
    assert found.turned[0] == pytest.approx([0, 0], abs=1e-6)
    assert (found.along[0, 0], found.across[0, 0]) == pytest.approx((10, 0), abs=1e-6)


def test_motion_is_seen_from_the_road():
    places = {0: (50.0, 0.0), 1: (53.0, -1.0)}
    found = extents([straight(1, 0, 100)], vehicle(7, places, heading=radians(-20)))
    assert found.turned[0, 0] == pytest.approx(radians(-20))
    # Half a second: 3 m ahead are 6 m/s, 1 m to the right are -2 m/s to the left
    assert (found.along[0, 0], found.across[0, 0]) == pytest.approx((6, -2))
    towards = extents([straight(1, 0, 100)], vehicle(7, {0: (60, 0), 1: (50, 0)}, heading=pi))
    assert abs(towards.turned[0, 0]) == pytest.approx(pi)
    assert towards.along[0, 0] == pytest.approx(-20)


def test_across_a_lane_that_widens_places_are_measured_from_where_its_bounds_are():
    # 4 m wide at the middle of the road, 8 m at its end
    road = lanelet(1, [(0, 0), (50, 0), (100, 0)], width=[4, 4, 8])
    found = extents([road], vehicle(7, {0: (99.9, 0)}, length=0.2, width=4.0))
    assert found.left_of_min[0, 0] == pytest.approx([2, -6], abs=0.05)
    assert found.left_of_max[0, 0] == pytest.approx([6, -2], abs=0.05)


# A lane 4 m wide, and left of it one that opens evenly to 4 m within 100 m
OPENING = [
    straight(1, 0, 100, left_of=2),
    lanelet(2, [(0, 2), (100, 4)], width=[0, 4], right_of=1),
]


@given(st.floats(1, 99), st.floats(-1, 6))
@example(50.0, 2.0)
def test_who_reaches_into_a_lane_that_opens_is_in_it_by_so_much(x, y):
    found = extents(OPENING, vehicle(7, {0: (x, y)}, length=0.2, width=2.0))
    opened = 0.04 * x
    into = max(0.0, min(y + 1, 2 + opened) - max(y - 1, 2))
    assert np.maximum(found.inside[0, 0, 1], 0) == pytest.approx(into, abs=0.02)
    assert found.left_of[0, 0] == pytest.approx([y + 2, y - 2, y - 2 - opened], abs=0.01)
    # Who is on the mark itself is left of it
    assert found.lane[0, 0] == (y >= 2)


def test_beside_the_road_the_nearest_lane_counts():
    # Marks lie at -2, 2 and 6
    lanes = [straight(1, 0, 100, left_of=2), straight(2, 0, 100, y=4, right_of=1)]
    bodies = [vehicle(k, {0: (50, y)}) for k, y in enumerate((-9.0, 1.9, 2.1, 9.0))]
    assert extents(lanes, *bodies).lane[:, 0].tolist() == [0, 0, 1, 1]


def test_a_standing_body_has_one_extent_for_all_steps():
    post = vehicle(8, {0: (70, 3)}, standing=True)
    found = extents([straight(1, 0, 100)], vehicle(7, {0: (0, 0), 3: (9, 0)}), post)
    assert found.s_min[1].tolist() == [68, 68, 68, 68]
    assert np.isnan(found.s_min[0, 1:3]).all()


def test_a_body_is_not_torn_apart_where_a_road_meets_itself():
    # There and back again, 5 m apart: a lorry that reaches over the middle stays on its side
    points = [(0, 0), (100, 0), (105, 2.5), (100, 5), (0, 5)]
    lorry = vehicle(7, {0: (30, 1.5)}, length=10, width=2.6)
    s_min, s_max, d_min, d_max = bounds(extents([lanelet(1, points, width=2)], lorry))
    assert (s_min, s_max) == pytest.approx((25, 35), abs=0.1)
    assert (d_min, d_max) == pytest.approx((0.2, 2.8), abs=0.05)


def test_one_row_and_a_part():
    bodies = [vehicle(k, {0: (10 * k, 0), 1: (10 * k + 1, 0)}) for k in (1, 2, 3)]
    found = extents([straight(1, 0, 100)], *bodies)
    assert found.of(1).s.tolist() == [[20, 21]]
    assert found.part(np.array([2, 0]), slice(1, 2)).s.tolist() == [[31], [11]]
    assert found.moved(np.array([0.0, 0.5])).left_of[2, 1] == pytest.approx([2.5, -1.5])


@pytest.mark.parametrize("n_lanes", [1, 2, 8, 9, 64, 65, 70])
def test_a_set_of_lanes_has_those_that_are_flagged(n_lanes):
    flags = np.random.default_rng(n_lanes).random((4, 6, n_lanes)) < 0.4
    sets = lane_sets(flags)
    for lane in range(n_lanes):
        assert (is_in(sets, lane) == flags[..., lane]).all()
    lanes = np.arange(6) * 7 % n_lanes
    assert (is_in(sets, lanes) == flags[:, np.arange(6), lanes]).all()
    assert ((sets != 0) == flags.any(axis=2)).all()
