"""Round numbers for an axis."""

from itertools import pairwise
from math import floor, log10

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.report.pictures.picture_captions import ticks


@pytest.mark.parametrize(
    ("low", "high", "at_most", "expected"),
    [
        (0, 4, 10, [0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4]),
        (-60, 140, 12, [-60, -40, -20, 0, 20, 40, 60, 80, 100, 120, 140]),
        (0.1, 0.9, 4, [0.2, 0.4, 0.6, 0.8]),
        (-1, 9, 1, [0]),
        (0, 5e-324, 10, []),
        (-1e308, 1e308, 10, []),
    ],
)
def test_examples(low, high, at_most, expected):
    assert ticks(low, high, at_most) == expected


@given(st.floats(-1e4, 1e4), st.floats(0.01, 1e4), st.integers(2, 20))
def test_they_are_round_even_and_neither_many_nor_few(low, span, at_most):
    found = ticks(low, low + span, at_most)
    assert at_most / 2.5 - 1 <= len(found) <= at_most + 1
    assert all(low - 1e-6 <= tick <= low + span + 1e-6 for tick in found)
    steps = [after - before for before, after in pairwise(found)]
    if steps:
        assert steps == pytest.approx([steps[0]] * len(steps), rel=1e-4)
        first = steps[0] / 10.0 ** floor(log10(steps[0]) + 1e-4)
        assert min(abs(first - digit) for digit in (1, 2, 5)) < 1e-3
