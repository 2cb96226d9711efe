"""Bounds of outlines in a road's coordinates."""

from types import SimpleNamespace

import numpy as np

from rulec.scenario.recorded.joined_outlines import JoinedOutlines
from rulec.scenario.recorded.lane_coordinates import kept_off_touched, outline_bounds


def test_an_outline_whose_middle_is_not_beside_the_line_has_no_bounds():
    line = SimpleNamespace(
        coordinates=lambda places: np.where(places[:, :1] > 5, np.nan, places),
        coordinates_near=lambda places, around, reach, counts: places.copy(),
    )
    near, far = np.array([(0.0, 1.0), (4.0, 3.0)]), np.array([(6.0, 1.0), (8.0, 3.0)])
    low, high = outline_bounds(
        JoinedOutlines.of([near, far]), line, lambda places: places[:, 1:] * 2
    )
    assert low[0].tolist() == [0, 1, 2]
    assert high[0].tolist() == [4, 3, 6]
    assert np.isnan(low[1]).all()
    assert np.isnan(high[1]).all()


def test_a_lane_that_is_merely_touched_is_left():
    straight = np.array([-2.0, 2.0, 6.0])

    def kept(low, high):
        found = kept_off_touched(np.array([low]), np.array([high]), straight)
        return tuple(float(bound[0]) for bound in found)

    assert kept(0.2, 2.2) == (0.2, 2.0)
    assert kept(0.4, 2.4) == (0.4, 2.4)
    assert kept(1.8, 3.8) == (2.0, 3.8)
    # Beside the road, and from there into it
    assert kept(7.0, 9.0) == (7.0, 9.0)
    assert kept(-9.0, -7.0) == (-9.0, -7.0)
    assert kept(5.8, 7.8) == (6.0, 7.8)
    # Who is narrow is where most of it is
    assert kept(1.7, 2.1) == (1.7, 2.0)
