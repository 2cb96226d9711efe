"""Boxes that a detector turned round, or spun, are turned as vehicles can be."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.recordings.mending.mended_recording import with_steady_headings
from rulec.recordings.recording import Participant, Recording, TrackState
from rulec.recordings.track import Track, TrackOutlines, TrackStates, rectangles

STEP_S = 0.1


def body(places, headings, kind="car", form="track"):
    """A participant by places along x (m) and headings (degrees)."""
    rows = np.zeros((len(places), 5))
    rows[:, 0], rows[:, 2] = places, np.radians(headings)
    steps = np.arange(len(places))
    track = Track(steps, rows, 4.0, 2.0)
    if form == "track":
        return Participant("1", kind, False, TrackStates(track), TrackOutlines(track))
    outlines = rectangles(rows[:, :2], rows[:, 2], 4.0, 2.0)
    states = {step: TrackState(*row) for step, row in enumerate(rows.tolist())}
    return Participant("1", kind, False, states, dict(enumerate(outlines)))


def headings(one, step_s=STEP_S):
    """Its headings (whole degrees, 0 to 359) once they are steadied."""
    (found,) = with_steady_headings(Recording("", step_s, {}, (one,), ())).participants
    for step, state in found.states.items():
        corners = rectangles(np.array([[state.x, state.y]]), np.array([state.heading]), 4.0, 2.0)
        assert np.allclose(found.outlines[step], corners[0])
    return [round(float(np.degrees(x.heading))) % 360 for x in found.states.values()]


DRIVES = np.arange(30) * 1.0
STANDS = np.zeros(30)


@pytest.mark.parametrize("form", ["track", "dicts"])
@pytest.mark.parametrize("places", [DRIVES, STANDS])
@pytest.mark.parametrize("wrong", [{10}, {4, 5, 6}, {0}, {29}, {7, 9, 10, 12}, {0, 28, 29}])
def test_what_is_turned_round_for_a_moment_is_turned_back(form, places, wrong):
    told = [180 if step in wrong else 0 for step in range(30)]
    assert headings(body(places, told, form=form)) == [0] * 30


@given(st.sets(st.integers(0, 29), max_size=4), st.integers(-179, 180))
def test_any_few_that_are_turned_round_are_turned_back(wrong, way):
    told = [way + 180 if step in wrong else way for step in range(30)]
    places = np.cos(np.radians(way)) * DRIVES
    one = body(places, told)
    one.states.track.rows[:, 1] = np.sin(np.radians(way)) * DRIVES
    assert headings(one) == [way % 360] * 30


def test_who_is_turned_round_for_longer_may_be_so():
    told = [180 if 10 <= step < 20 else 0 for step in range(30)]
    assert headings(body(STANDS, told)) == [x % 360 for x in told]


def test_who_backs_up_at_the_end_of_its_track_is_not_turned():
    """Its box is right for three states and wrong for all others, or the reverse: nobody knows."""
    told = [180] * 3 + [0] * 27
    assert headings(body(-DRIVES, told)) == told


def test_who_turns_as_vehicles_do_is_left_alone():
    """90° on 8 m, as sharp as a small car can: the same recording comes back."""
    turn = np.linspace(0, np.pi / 2, 30)
    one = body(5.0 * np.sin(turn), np.degrees(turn))
    one.states.track.rows[:, 1] = 5.0 * (1 - np.cos(turn))
    recording = Recording("", STEP_S, {}, (one,), ())
    assert with_steady_headings(recording) is recording


@pytest.mark.parametrize("kind", ["pedestrian", "unknown"])
def test_who_does_not_steer_turns_at_will(kind):
    told = [180 if step == 5 else 0 for step in range(30)]
    assert headings(body(STANDS, told, kind)) == told


def test_between_states_far_apart_one_may_turn():
    told = [180 if step == 5 else 0 for step in range(30)]
    assert headings(body(STANDS, told), step_s=1.0) == told


def test_who_spins_while_it_stands_is_turned_as_before_and_after():
    """Directions of places that flicker: it comes along x, stands for two seconds, and goes on."""
    comes = np.arange(-15, 0) * 1.0
    places = np.concatenate((comes, np.zeros(20), -comes[::-1]))
    spins = [37, 120, -150, 80, 10, 170, -60, 45, 130, -100] * 2
    found = headings(body(places, [0] * 15 + spins + [0] * 15))
    assert found == [0] * 50


@pytest.mark.parametrize("kind", ["car", "bicycle", "pedestrian"])
def test_who_spins_all_the_time_is_left_alone(kind):
    """97° a step is no box turned round, and nothing before or after says how it stands."""
    told = [(97 * step) % 360 for step in range(30)]
    assert headings(body(STANDS, told, kind)) == told


def test_who_stands_is_turned_as_where_it_really_moves():
    """Headings are directions of motion between places with noise of 0.1 m.

    A car brakes, stands and turns off to the left; where it creeps they are noise, too.
    """
    t = np.arange(0, 16.05, STEP_S)
    speed = np.interp(t, [0, 3, 6, 10, 14], [6, 6, 0, 0, 6])
    way = np.append(0, np.cumsum((speed[1:] + speed[:-1]) / 2 * STEP_S))
    true = np.maximum(way - way[80], 0) / 10.0
    steps = np.diff(way, prepend=0)[:, None] * np.column_stack((np.cos(true), np.sin(true)))
    for seed in range(20):
        places = steps.cumsum(axis=0) + np.random.default_rng(seed).normal(scale=0.1, size=(161, 2))
        dx, dy = np.diff(places, axis=0, append=places[-1:]).T
        one = body(places[:, 0], np.degrees(np.arctan2(dy, dx)))
        one.states.track.rows[:, 1] = places[:, 1]
        found = np.array(headings(one))[(t > 6.5) & (t < 9.5)]
        assert np.abs((found + 180) % 360 - 180).max() < 40
