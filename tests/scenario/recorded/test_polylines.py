"""Lines through points."""

import numpy as np
import pytest

from rulec.recordings.polylines import densified, densified_lines

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
