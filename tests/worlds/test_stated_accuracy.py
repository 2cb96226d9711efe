"""Tracks that are wrong within what a user says of them: nobody is accused, or acquitted, for that.

Bodies drift slowly, each its own way, by as much as places may be off and no faster than speeds
may; speeds that the file states are off by as much, all the time or from state to state.
"""

from dataclasses import replace

import numpy as np
import pytest

import rulec
from rulec.recordings.track import TrackOutlines, TrackStates, outlines_on_track
from support.damages.compared import Comparison, said
from support.worlds.scoring import SIMULATED_WORLD
from support.worlds.stored import StoredWorld

PLACE_M, SPEED_MPS = 0.5, 0.3
WORLDS = ["motorway", "zebra", "all_way_stop"]


def drifting(rows, times, pick):
    """Off by half a metre to some side, which goes round or back and forth, or stays."""
    fastest = SPEED_MPS / PLACE_M * pick.choice([0.0, 0.5, 1.0])
    phase = fastest * times + pick.uniform(0, 2 * np.pi)
    rows[:, 0] += PLACE_M * np.cos(phase)
    rows[:, 1] += PLACE_M * np.sin(phase) * pick.choice([-1.0, 0.0, 1.0])


def misstated(rows, _times, pick):
    """Speeds that are too high, too low, or now this, now that."""
    by = pick.choice([1.0, -1.0, 0.0])
    rows[:, 3] += SPEED_MPS * (by or pick.uniform(-1, 1, len(rows)))
    rows[:, 3] = np.maximum(rows[:, 3], 0.0)


def changed(recording, change):
    bodies = []
    for number, body in enumerate(recording.participants):
        on_track = outlines_on_track(body)
        if on_track is not None:
            rows = on_track.track.rows.copy()
            times = on_track.track.steps * recording.step_s
            change(rows, times, np.random.default_rng([7, number]))
            track = replace(on_track.track, rows=rows)
            body = replace(body, states=TrackStates(track), outlines=TrackOutlines(track))
        bodies.append(body)
    assert bodies != list(recording.participants)
    return replace(recording, participants=tuple(bodies))


def compared(name, change, **stated):
    """What is said of a world whose tracks are wrong, held against what is said of right ones."""
    world, rules = StoredWorld(name), rulec.compile_rulebook("de")
    recording, found = rulec.read_recording(world.data, world.net), Comparison()
    then = said(recording, rules, assumed=SIMULATED_WORLD)
    found.add(then, said(changed(recording, change), rules, assumed=SIMULATED_WORLD, **stated))
    return found


@pytest.mark.parametrize(
    ("change", "stated"),
    [
        (drifting, {"place_error_m": PLACE_M, "speed_error_mps": SPEED_MPS}),
        (misstated, {"speed_error_mps": SPEED_MPS}),
    ],
)
@pytest.mark.parametrize("name", WORLDS)
def test_errors_within_what_is_stated_accuse_and_acquit_nobody(name, change, stated):
    found = compared(name, change, **stated)
    assert (dict(found.false), dict(found.surer), dict(found.acquitted)) == ({}, {}, {})
    # Not for want of verdicts
    assert found.found


@pytest.mark.parametrize(("name", "change"), [("all_way_stop", drifting), ("motorway", misstated)])
def test_such_errors_accuse_where_nobody_states_them(name, change):
    assert compared(name, change).false
