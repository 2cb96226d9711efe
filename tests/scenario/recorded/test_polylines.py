"""Lines through points, and places in areas."""

import numpy as np
import pytest
import shapely

from rulec.recordings.polylines import densified, densified_lines, places_in

BENT = [(0, 0), (3, 0), (3, 2)]
FARTHER = [(10, 0), (10, 1), (10, 2.5)]


def test_no_points_are_farther_apart_than_asked_and_corners_stay():
    expected = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 2)]
    assert densified(np.array(BENT, dtype=float), 1.0) == pytest.approx(np.array(expected))


def test_from_one_line_to_the_next_there_is_no_way():
    points, counts = densified_lines([np.array(line, dtype=float) for line in (BENT, FARTHER)], 1.0)
    assert counts == [6, 4]
    expected = [(10, 0), (10, 1), (10, 1.75), (10, 2.5)]
    assert points[6:] == pytest.approx(np.array(expected))


def test_places_are_in_all_areas_that_they_are_inside_of_or_at_the_edge_of():
    areas = [
        shapely.box(0, 0, 2, 2),
        shapely.box(1, 1, 4, 4),
        shapely.Polygon([(10, 0), (12, 2), (12, 0), (10, 2)]),  # crosses itself
        shapely.MultiPolygon([shapely.box(20, 0, 21, 1), shapely.box(22, 0, 23, 1)]),
    ]
    at = [(1.5, 1.5), (2, 0.5), (3, 3), (4.1, 3), (10.5, 1), (11, 1), (11, 1.5), (22, 1), (9, 9)]
    places, numbers = places_in(areas, *np.array(at).T)
    pairs = sorted(zip(places.tolist(), numbers.tolist(), strict=True))
    assert pairs == [(0, 0), (0, 1), (1, 0), (2, 1), (4, 2), (5, 2), (7, 3)]


def test_where_nobody_is_no_place_is_in_an_area():
    nobody = np.zeros(0)
    assert [len(own) for own in places_in([shapely.box(0, 0, 1, 1)], nobody, nobody)] == [0, 0]
    assert [len(own) for own in places_in([], *np.ones((2, 3)))] == [0, 0]
