"""Where vehicles are along lanelets: as Shapely says, whatever the lanelet's middle looks like."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
import shapely

from rulec.extraction.tracks.matching.lane_candidates import (
    NEAR_M,
    feet_on,
    leading_on,
)
from rulec.extraction.tracks.matching.lane_strips import LaneStrip
from rulec.scenario.recorded.reference_line import turn
from rulec.scenario.recorded.route import lanelet_area
from support.builders.recordings import lanelet


def winding(random, n):
    return np.cumsum(random.normal(size=(n, 2)) * 3, axis=0) + random.uniform(-1e4, 1e4, 2)


def along_x(random, n):
    return np.stack((np.arange(n) * random.uniform(0.3, 5), random.normal(size=n) * 0.3), axis=-1)


def on_a_grid(random, n):
    """Lines that cross themselves, with corners that come twice and places as near to several."""
    return np.round(random.uniform(-5, 5, size=(n, 2)))


def round_a_circle(random, n):
    angle = np.linspace(0, random.uniform(0.1, 7), n)
    return np.stack((np.cos(angle), np.sin(angle)), axis=-1) * random.uniform(3, 50)


@pytest.mark.parametrize("shape", [winding, along_x, on_a_grid, round_a_circle])
def test_feet_are_those_of_shapely_to_the_last_digit(shape):
    random = np.random.default_rng(7)
    asked = []
    for far in (0.0, 0.1, 3.0, 30.0) * 40:
        line = shape(random, int(random.integers(2, 40)))
        places = line[random.integers(0, len(line), 20)] + random.normal(size=(20, 2)) * far
        asked.append((line, np.round(places * 2) / 2 if shape is on_a_grid else places))
    along, away = feet_on(asked)
    lines = np.repeat([shapely.LineString(line) for line, _ in asked], 20)
    points = shapely.points(np.concatenate([places for _, places in asked]))
    assert (along == shapely.line_locate_point(lines, points)).all()
    assert (away == shapely.distance(lines, points)).all()


def test_a_corner_and_places_beyond_the_ends():
    line = np.array([[0.0, 0.0], [0.0, 0.0], [4.0, 0.0], [4.0, 3.0]])
    along, away = feet_on([(line, np.array([[-3.0, 4.0], [1.0, 2.0], [4.0, 5.0], [7.0, -4.0]]))])
    assert along.tolist() == [0.0, 1.0, 7.0, 4.0]
    assert away.tolist() == [5.0, 2.0, 2.0, 5.0]


@pytest.mark.parametrize("shape", [winding, along_x, round_a_circle])
def test_who_leads_on_somewhere_is_not_left_out(shape):
    random = np.random.default_rng(11)
    left_out = 0
    for _ in range(100):
        line = shape(random, int(random.integers(2, 12)))
        steps, headings = np.diff(line, axis=0), random.uniform(-7, 7, 50)
        directions = np.arctan2(steps[:, 1], steps[:, 0])
        fits = (np.abs(turn(directions[:, None], headings)) < np.pi / 2).any(axis=0)
        leading = leading_on(line, headings)
        assert leading[fits].all()
        left_out += int((~leading).sum())
    assert left_out


@pytest.mark.parametrize("shape", [winding, along_x, round_a_circle])
@pytest.mark.parametrize("width", [0.2, 2.0, 3.5, 12.0])
def test_who_is_near_a_lane_is_as_near_as_shapely_says(shape, width):
    random = np.random.default_rng(13)
    near = 0
    for far in (1.0, 3.0, 6.0) * 20:
        line = shape(random, int(random.integers(2, 12)))
        lane = lanelet(1, line, width)
        area = lanelet_area(lane)
        x, y = (line[random.integers(0, len(line), 50)] + random.normal(size=(50, 2)) * far).T
        told = shapely.dwithin(area, shapely.points(x, y), NEAR_M)
        assert (LaneStrip.of(lane, area).near(x, y, NEAR_M) == told).all()
        near += int(told.sum())
    assert 0 < near < 60 * 50


def test_who_is_near_a_straight_lane_is_told_without_shapely():
    """Lanes with repeated corners that begin with no width: few places are left to Shapely."""
    random = np.random.default_rng(17)
    n_asked = n_near = n_far = 0
    for _ in range(60):
        line = along_x(random, int(random.integers(3, 12)))
        lane = lanelet(1, line, [0.0, *random.uniform(2, 4, len(line) - 1)])
        left, right = (bound.repeat(2, axis=0) for bound in (lane.left, lane.right))
        lane = replace(lane, left=left, right=right)
        area = lanelet_area(lane)
        x, y = (line[random.integers(0, len(line), 50)] + random.normal(size=(50, 2)) * 6).T
        told = shapely.dwithin(area, shapely.points(x, y), NEAR_M)
        with patch.object(shapely, "dwithin", wraps=shapely.dwithin) as dwithin:
            near = LaneStrip.of(lane, area).near(x, y, NEAR_M)
        assert (near == told).all()
        n_asked += sum(len(call.args[1]) for call in dwithin.call_args_list)
        n_near, n_far = n_near + int(told.sum()), n_far + int((~told).sum())
    assert min(n_near, n_far) > 500
    assert n_asked < (n_near + n_far) / 3
