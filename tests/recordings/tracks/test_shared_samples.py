"""Samples that others have published, where they are there: format and frame are the same."""

import numpy as np
import pytest

from rulec import read_recording
from support.builders.recorded_data import RECORDINGS

INTERACTION = RECORDINGS.parent / "interaction" / "vehicle_tracks_000.csv"
OBJECTS = RECORDINGS.parent / "osi" / "pedestrian_objects.csv"


@pytest.mark.skipif(not INTERACTION.exists(), reason="the samples are not there")
def test_interaction_with_its_map():
    """Two cars in lanes that lead opposite ways, at 10 m/s; the map lies beside the tracks."""
    recording = read_recording(INTERACTION)
    one, other = recording.participants
    assert (len(one.states), len(other.states), recording.step_s) == (100, 70, 0.1)
    for car, way in ((one, 1), (other, -1)):
        step = min(car.states) + 5
        state = car.states[step]
        assert (np.cos(state.heading), state.speed) == pytest.approx((way, 10), abs=1e-3)
        distances = {
            name: np.abs(lane.centre[:, 1] - state.y).min()
            for name, lane in recording.lanelets.items()
        }
        lane = recording.lanelets[min(distances, key=distances.get)]
        assert min(distances.values()) < 0.01
        assert np.sign(lane.centre[-1, 0] - lane.centre[0, 0]) == way


@pytest.mark.skipif(not OBJECTS.exists(), reason="the samples are not there")
def test_a_table_has_the_states_of_the_trace_that_it_was_made_from():
    """esmini's pedestrian scene as an OSI trace, and its objects as a table, on its map."""
    table = read_recording(OBJECTS, OBJECTS.with_name("fabriksgatan.xodr"))
    trace = read_recording(OBJECTS.with_name("pedestrian.osi"))
    assert table.step_s == trace.step_s
    assert [one.type for one in table.participants] == [one.type for one in trace.participants]
    for one, other in zip(table.participants, trace.participants, strict=True):
        assert list(one.states) == list(other.states)
        for step in list(one.states)[::40]:
            own, its = one.states[step], other.states[step]
            assert (own.x, own.y, own.heading) == pytest.approx((its.x, its.y, its.heading))
            assert own.speed == pytest.approx(its.speed, abs=1e-6)
            assert np.ptp(one.outlines[step], axis=0) == pytest.approx(
                np.ptp(other.outlines[step], axis=0)
            )
