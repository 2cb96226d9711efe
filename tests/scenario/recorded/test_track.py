"""Tracks of rigid bodies as arrays."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.recordings.recording import TrackState
from rulec.recordings.track import Track, TrackOutlines, TrackStates, rectangles

TRACK = Track(
    np.array([2, 5]),
    np.array([[10.0, 1.0, 0.0, 8.0, 0.5], [20.0, 2.0, pi / 2, 9.0, 0.0]]),
    4.0,
    2.0,
)


def test_states_by_step():
    states = TrackStates(TRACK)
    assert list(states) == [2, 5]
    assert len(states) == 2
    assert states[2] == TrackState(10, 1, 0, 8, 0.5)
    for step in (1, 3, 6):
        with pytest.raises(KeyError):
            states[step]


def test_outlines_lie_around_the_places():
    outlines = TrackOutlines(TRACK)
    assert list(outlines) == [2, 5]
    assert outlines[2].min(axis=0) == pytest.approx([8, 0])
    assert outlines[2].max(axis=0) == pytest.approx([12, 2])
    # A quarter turned: 4 m long along y
    assert outlines[5].min(axis=0) == pytest.approx([19, 0])
    assert outlines[5].max(axis=0) == pytest.approx([21, 4])


def test_a_shift_moves_the_body_back():
    (corners,) = rectangles(np.array([[0.0, 0.0]]), np.array([0.0]), 4.0, 2.0, 1.0)
    assert corners[:, 0].max() == pytest.approx(1)
    assert corners[:, 0].min() == pytest.approx(-3)


@given(st.floats(-pi, pi), st.floats(-1e4, 1e4), st.floats(-1e4, 1e4))
def test_a_rectangle_keeps_its_size_and_middle(heading, x, y):
    (corners,) = rectangles(np.array([[x, y]]), np.array([heading]), 4.0, 2.0)
    assert corners.mean(axis=0) == pytest.approx([x, y], abs=1e-6)
    away = np.hypot(*(corners - (x, y)).T)
    assert away[::2] == pytest.approx([5**0.5] * 4)
    assert away[1::2] == pytest.approx([2, 1, 2, 1])
