"""Bounds whose points are out of order."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.recordings.commonroad.scenario_content import in_order, with_ordered_bounds
from support.builders.recordings import straight

ALONG = np.stack((np.arange(0.0, 60.0, 10.0), np.zeros(6)), axis=1)
ROUND = 30.0 * np.stack([f(np.radians(np.arange(0, 136, 15))) for f in (np.cos, np.sin)], axis=1)


@pytest.mark.parametrize("line", [ALONG, ROUND])
@given(data=st.data())
def test_inner_points_come_into_order(line, data):
    inner = data.draw(st.permutations(range(1, len(line) - 1)))
    shuffled = line[[0, *inner, len(line) - 1]]
    found = in_order(shuffled)
    assert sorted(map(tuple, found)) == sorted(map(tuple, line))
    assert found[[0, -1]].tolist() == line[[0, -1]].tolist()
    length = np.hypot(*np.diff(found, axis=0).T).sum()
    assert length <= np.hypot(*np.diff(shuffled, axis=0).T).sum() + 1e-9


@pytest.mark.parametrize("line", [ALONG, ROUND])
@pytest.mark.parametrize("place", range(1, 4))
def test_two_that_are_exchanged_are_put_right(line, place):
    exchanged = line.copy()
    exchanged[[place, place + 1]] = line[[place + 1, place]]
    assert in_order(exchanged).tolist() == line.tolist()


@pytest.mark.parametrize(
    "line",
    [
        ALONG,
        # A turn by hand-drawn points, a careless point, a hairpin
        [(0, 0), (10, 0), (10, 5), (0, 5)],
        [(0, 0), (10, 0), (9, 0.1), (20, 0)],
        [(0, 0), (30, 0), (32, 3), (30, 6), (0, 6)],
    ],
)
def test_what_does_not_go_back_stays(line):
    points = np.array(line, dtype=float)
    assert in_order(points) is points


def test_very_many_points_stay():
    points = np.array([(10.0 * (k + (k % 2)), 0.0) for k in range(2000)])
    points[1:-1:3] = points[1:-1:3][::-1]
    assert in_order(points) is points


def test_a_lane_is_mended_with_its_middle():
    good = straight(1, 0, 40)
    xs = np.array([0.0, 20.0, 10.0, 40.0])
    left, right = (np.stack((xs, np.full(4, y)), axis=1) for y in (2.0, -2.0))
    bad = replace(good, id="2", left=left, right=right, centre=0.5 * (left + right))
    lanelets, changed = with_ordered_bounds({"1": good, "2": bad})
    assert changed == ("2",)
    assert lanelets["1"] is good
    assert lanelets["2"].centre.tolist() == [[x, 0.0] for x in (0.0, 10.0, 20.0, 40.0)]
    assert with_ordered_bounds({}) == ({}, ())
