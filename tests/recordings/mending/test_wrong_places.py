"""Places that no body reaches and leaves again in time are errors of measurement."""

from dataclasses import replace

import numpy as np
import pytest

from rulec import recording_from_columns
from rulec.recordings.mending.mended_recording import mended
from rulec.recordings.mending.wrong_places import Path, without_wrong_places, wrong_places
from rulec.recordings.recording import Participant, Recording, TrackState
from rulec.recordings.track import Track, TrackOutlines, TrackStates, rectangles


def driving(count=40, step_s=0.1, speed=10.0, braking=3.0):
    """Places of a car that brakes to a stand along x, and its steps."""
    t = np.arange(count) * step_s
    t_stop = np.minimum(t, speed / braking)
    x = speed * t_stop - braking / 2 * t_stop**2
    return np.arange(count), np.stack((x, np.zeros(count)), axis=1)


def wrong(places, step_s=0.1, steps=None):
    steps = np.arange(len(places)) if steps is None else steps
    return wrong_places(Path(steps, places), step_s).nonzero()[0].tolist()


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("first", [1, 7, 25, 36])
@pytest.mark.parametrize("off", [(2.0, 0.0), (0.0, -2.0), (-4.0, 3.0)])
def test_a_place_from_which_it_comes_back_at_once_is_wrong(first, count, off):
    _, places = driving()
    places[first : first + count] += off
    assert wrong(places) == [*range(first, first + count)]


def test_two_places_that_differ_are_wrong_both():
    _, places = driving()
    places[7] += (3.0, 0.0)
    places[8] -= (0.0, 4.0)
    assert wrong(places) == [7, 8]


@pytest.mark.parametrize("step_s", [0.04, 0.1, 0.5, 1.0])
def test_driving_is_right(step_s):
    """Braking and swerving as hard as tyres can, and stops."""
    t = np.arange(200) * step_s
    swerving = np.stack((15 * t, 2 * np.sin(2 * t)), axis=1)
    for places in (driving(200, step_s)[1], driving(200, step_s, 30, 10)[1], swerving):
        assert not wrong(places, step_s)


def test_what_does_not_come_back_is_no_wrong_place():
    _, places = driving()
    places[20:] += (0.0, 3.5)
    assert not wrong(places)
    places[24:] -= (0.0, 3.5)
    assert not wrong(places)


def test_a_track_that_slips_forward_is_none_either():
    """As in a picture of two cameras: it gains 2 m within four steps, and drives on."""
    _, places = driving(speed=15.0)
    places[10:, 0] += np.interp(np.arange(30), [0, 4], [0, 2.5])
    assert not wrong(places)


@pytest.mark.parametrize("noise_m", [0.1, 0.3, 1.0])
def test_noise_is_right(noise_m):
    random = np.random.default_rng(1)
    for _ in range(100):
        _, places = driving(200)
        places += random.normal(0, noise_m, places.shape)
        assert not wrong(places)


def test_a_hole_beside_it_counts_as_time():
    steps, places = driving()
    known = np.delete(np.arange(40), [12, 13])
    places[11] += (0.0, 2.5)
    assert wrong(places[known], steps=steps[known]) == [11]


def body(places, form):
    rows = np.column_stack((places, np.zeros((len(places), 3))))
    steps = np.arange(len(places))
    track = Track(steps, rows, 4.0, 2.0)
    if form == "track":
        return Participant("7", "car", False, TrackStates(track), TrackOutlines(track))
    outlines = rectangles(places, np.zeros(len(places)), 4.0, 2.0)
    states = {step: TrackState(*row) for step, row in enumerate(rows.tolist())}
    return Participant("7", "car", False, states, dict(enumerate(outlines)))


@pytest.mark.parametrize("form", ["track", "states"])
def test_they_are_left_out_and_filled_in(form):
    _, places = driving()
    right = places.copy()
    places[7:9] += (3.0, 0.0)
    found = Recording("", 0.1, {}, (body(places, form), replace(body(right, form), id="8")))
    bare = without_wrong_places(found)
    assert [*bare.participants[0].states] == [*range(7), *range(9, 40)]
    assert bare.participants[1] is found.participants[1]
    assert bare.remarks == ("2 positions are left out, as no vehicle gets there so fast: `7`",)
    (filled, _), remarks = mended(found).participants, mended(found).remarks
    assert [filled.states[step].x for step in range(40)] == pytest.approx(right[:, 0], abs=0.01)
    assert [*filled.outlines] == [*range(40)]
    assert remarks == bare.remarks
    assert mended(mended(found)).remarks == bare.remarks


def test_headings_of_a_table_do_not_follow_them():
    x = 20.0 + np.arange(40)
    y = np.where(np.arange(40) == 20, 3.0, 0.0)
    columns = {"track": ["7"] * 40, "t": np.arange(40) / 10, "x": x, "y": y}
    lanes = {"lane": ["a", "a"], "x": [0.0, 100.0], "y": [0.0, 0.0], "width": [3.5, 3.5]}
    found = recording_from_columns(columns, lanes)
    (car,) = found.participants
    assert 20 not in car.states
    assert all(abs(car.states[step].heading) < 1e-9 for step in car.states)
    assert all(car.states[step].speed == pytest.approx(10) for step in car.states)
    assert "1 position is left out, as no vehicle gets there so fast: `7`" in found.remarks
