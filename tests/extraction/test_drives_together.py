"""Drives along one road that are looked at together: each is the one that it is by itself."""

import numpy as np
import pytest

from rulec.extraction.drives import Drives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.recordings.recording_files import read_recording
from rulec.recordings.recording_format import RecordingSource
from support.builders.drive_contexts import steady
from support.builders.recorded_data import RECORDINGS
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.generators.random_recordings import lanes


def assert_alike(found, egos):
    together, by_itself = Drives(found, "right", expected=egos), Drives(found, "right")
    for ego in egos:
        for one, other in zip(together.of(ego), by_itself.of(ego), strict=True):
            if isinstance(other, NoDrive):
                assert one == other
                continue
            assert (one.ego, one.start_s, one.kinds) == (other.ego, other.start_s, other.kinds)
            assert (one.trace, one.places) == (other.trace, other.places)
            names = other.arrays.objects
            for word, numbers in other.decided_by.items():
                own = [one.decided_by[word].margin(name, 0) for name in names]
                assert own == [numbers.margin(name, 0) for name in names]


def test_drives_of_different_lengths():
    cars = [
        steady(7, 0, 0, steps=8),
        steady(8, 20, 0, steps=8),
        steady(9, 12, 4, first=2, steps=5, kind="truck"),
        steady(10, 35, 0, first=4, steps=4),
    ]
    assert_alike(recording(lanes(2), cars), ("7", "8", "9", "10"))


def test_one_that_stands_in_one_drive_and_moves_in_the_next():
    """Ego at 15 m/s would go round one that never moves 57 m ahead; this one goes on later."""
    places = {step: (63.0 + 5 * max(step - 8, 0), 0.0) for step in range(13)}
    cars = [steady(7, 0, 0, 15.0), steady(8, 0, 0, 15.0, first=9), vehicle(9, places)]
    two_ways = [straight(1, 0, 600), lanelet(2, [(600, 4), (0, 4)])]
    assert_alike(recording(two_ways, cars, step_s=0.5), ("7", "8", "9"))


def test_one_that_comes_from_afar_faces_nobody_there():
    """At 98° to the northward road all the time: it never comes towards ego.

    The road begins eastward, and against that it would.
    """
    way, bend = np.radians(188.0), np.linspace(0, np.pi / 2, 10)
    line = [
        (-60.0, 0.0),
        *np.array((20 * np.sin(bend) - 20, 20 - 20 * np.cos(bend))).T,
        (0.0, 600.0),
    ]
    egos = [
        vehicle(7, {k: (0.0, 100.0 + 2.5 * k) for k in range(60)}, speed=5.0, heading=np.pi / 2),
        vehicle(8, {k: (0.0, 60.0 + 2.5 * k) for k in range(60)}, speed=5.0, heading=np.pi / 2),
    ]
    places = {
        k: (-3.0 * (60 - k) * np.cos(way) + 3.0, 260.0 - 3.0 * (60 - k) * np.sin(way))
        for k in range(60)
    }
    comes = vehicle(9, places, speed=6.0, heading=way, kind="bicycle")
    # With so many elsewhere, places are known near the road only
    far = [
        vehicle(10 + n, {k: (2e3 + k, 50.0 * n) for k in range(60)}, speed=2.0) for n in range(4)
    ]
    found = recording([lanelet(1, line)], [*egos, comes, *far], step_s=0.5)
    assert_alike(found, ("7", "8"))
    (drive,) = Drives(found, "right").of("7")
    seen = [state["oncoming"]["9"] for state in drive.trace.states if "9" in state["oncoming"]]
    assert seen
    assert not any(seen)


@pytest.mark.long
@pytest.mark.skipif(not RECORDINGS.is_dir(), reason="no recordings")
def test_recorded_drives():
    for path in sorted(RECORDINGS.glob("*.xml")):
        found = read_recording(RecordingSource(path))
        assert_alike(found, Drives(found, "right").egos())
