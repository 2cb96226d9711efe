"""Long recordings of many vehicles: what is read stays small, however it was written."""

import tracemalloc

from rulec import read_recording
from support.builders.sumo_files import body, data, moment, written

STEPS, VEHICLES = 400, 50


def test_a_state_takes_little_memory(tmp_path):
    """Ten numbers or so; as objects with outlines of their own it would be ten times as much."""
    steps = [
        moment(k / 10, *(body(f"f.{n}", x=float(k), y=-4.8 + n / 99) for n in range(VEHICLES)))
        for k in range(STEPS)
    ]
    file = written(tmp_path, data(*steps))
    read_recording(file)  # what is imported on the way is not the recording's
    tracemalloc.start()
    recording = read_recording(file)
    kept, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    states = sum(len(one.states) for one in recording.participants)
    assert states == STEPS * VEHICLES
    assert kept / states < 100
    assert most / states < 300
