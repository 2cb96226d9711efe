"""Tracks that go on with another body, as after an exchange of ids, are cut there."""

import numpy as np
import pytest

from rulec import recording_from_columns
from rulec.recordings.mending.mended_recording import mended
from rulec.recordings.mending.track_jumps import jumps, without_jumps
from rulec.recordings.mending.wrong_places import Path
from rulec.recordings.recording import Participant, Recording
from rulec.recordings.track import Track, TrackOutlines, TrackStates

STEPS = np.arange(40)


def driving(x, y, speed=15.0, step_s=0.1):
    return np.stack((x + speed * step_s * STEPS, np.full(len(STEPS), y)), axis=1)


def exchanged(one, other, at=20):
    before = (at > STEPS)[:, None]
    return np.where(before, one, other), np.where(before, other, one)


def found(*tracks, step_s=0.1):
    return jumps([Path(STEPS, places) for places in tracks], step_s)


@pytest.mark.parametrize("ahead", [0.0, 1.0, 3.0, 30.0])
def test_exchanged_ids_cut_both_tracks(ahead):
    assert found(*exchanged(driving(50, 0), driving(50 + ahead, 3.5))) == [[20], [20]]


def test_bodies_that_stand_may_be_exchanged():
    assert found(*exchanged(driving(50, 0, 0.0), driving(51, 3.5, 0.0))) == [[20], [20]]
    assert found(*exchanged(driving(50, 0, 0.0), driving(56, 0, 0.0))) == [[20], [20]]


def test_a_simulator_changes_lanes_in_one_step():
    changes = driving(50, 0)
    changes[20:, 1] += 3.2
    assert found(changes, driving(60, 3.2)) == [[], []]


@pytest.mark.parametrize("held", [2, 5])
def test_a_track_that_is_held_catches_up(held):
    """As one that was measured less often than it is written; or once, for a second."""
    places = driving(50, 0)
    assert found(places[STEPS // held * held]) == [[]]
    frozen = places.copy()
    frozen[20:30] = places[20]
    assert found(frozen) == [[]]


@pytest.mark.parametrize("step_s", [0.04, 0.1, 0.5, 1.0])
def test_driving_is_no_jump(step_s):
    t = STEPS * step_s
    stops = np.minimum(t, 3.0)
    braking = np.stack((30 * stops - 5 * stops**2, 0 * t), axis=1)
    swerving = np.stack((15 * t, 2 * np.sin(2 * t)), axis=1)
    assert found(braking, swerving, step_s=step_s) == [[], []]


@pytest.mark.parametrize("noise_m", [0.1, 0.3, 1.0])
def test_noise_is_no_jump(noise_m):
    random = np.random.default_rng(1)
    for _ in range(100):
        assert found(driving(0, 0) + random.normal(0, noise_m, (40, 2))) == [[]]


def body(name, places, kind="car"):
    rows = np.column_stack((places, np.zeros((len(places), 3))))
    track = Track(STEPS, rows, 4.0, 2.0)
    return Participant(name, kind, False, TrackStates(track), TrackOutlines(track))


def test_what_follows_is_another_participant():
    one, other = exchanged(driving(50, 0), driving(53, 3.5))
    bodies = (body("7", one), body("8", other), body("7_2", driving(200, 0)))
    recording = Recording("", 0.1, {}, bodies)
    cut = without_jumps(recording)
    assert [(x.id, min(x.states), max(x.states), x.resumes) for x in cut.participants] == [
        ("7", 0, 19, None),
        ("7_3", 20, 39, 19),
        ("8", 0, 19, None),
        ("8_2", 20, 39, 19),
        ("7_2", 0, 39, None),
    ]
    remark = (
        "2 tracks are cut at jumps that no vehicle can make, and what follows is another road "
        "user: `7`, `8`"
    )
    assert cut.remarks == (remark,)
    whole = mended(recording)
    assert [x.id for x in whole.participants] == [x.id for x in cut.participants]
    assert mended(whole) is whole


def test_a_jump_shortly_before_the_end_leaves_nothing_behind_it():
    places = driving(50, 0)
    places[38:] -= (4.0, 0.0)
    cut = without_jumps(Recording("", 0.1, {}, (body("7", places),)))
    assert [(x.id, len(x.states)) for x in cut.participants] == [("7", 38)]
    assert cut.remarks == ("2 positions are left out, as no vehicle gets there so fast: `7`",)


def test_pedestrians_may_jump():
    places = driving(50, 0, 1.0)
    places[20:] += 2.0
    recording = Recording("", 0.1, {}, (body("7", places, "pedestrian"),))
    assert without_jumps(recording) is recording


@pytest.mark.parametrize("headings", [True, False])
def test_tracks_of_a_table_are_cut_before_anything_follows_from_them(headings):
    tracks = exchanged(driving(50, 0), driving(53, 3.5))
    columns = {
        "track": ["7"] * 40 + ["8"] * 40,
        "t": np.tile(STEPS / 10, 2),
        "x": np.concatenate([places[:, 0] for places in tracks]),
        "y": np.concatenate([places[:, 1] for places in tracks]),
    }
    if headings:
        columns["heading"] = np.zeros(80)
    lanes = {"lane": ["a", "a"], "x": [0.0, 300.0], "y": [0.0, 0.0], "width": [3.5, 3.5]}
    recording = recording_from_columns(columns, lanes)
    parts = recording.participants
    assert [(x.id, x.resumes) for x in parts] == [
        ("7", None),
        ("8", None),
        ("7_2", 19),
        ("8_2", 19),
    ]
    for part in parts:
        assert all(state.heading == pytest.approx(0) for state in part.states.values())
        assert all(state.speed == pytest.approx(15) for state in part.states.values())
    assert any("2 tracks are cut at jumps" in remark for remark in recording.remarks)
    assert mended(recording).participants == parts
