"""Holes in SUMO's data: short ones are filled as those of tables are, longer ones cut tracks."""

import numpy as np
import pytest

from rulec import read_recording, recording_from_columns
from rulec.recordings.mending.mended_recording import mended
from support.builders.sumo_files import body, data, moment, written

STEPS = 60


def driving(k):
    return 20.0 + k


def teleported(k):
    return driving(k) if k < 30 else driving(k) + 60


def waiting(k):
    return 20.0 if k < 30 else 80.0 + k


def read(folder, missing, place=driving, **more):
    """A vehicle at 10 m/s and another one behind it, which is always there."""
    own = {**more}
    own.setdefault("speed", 10.0)
    moments = [
        moment(
            k / 10,
            body("always", x=driving(k) - 15),
            *([] if k in missing else [body(x=place(k), **own)]),
        )
        for k in range(STEPS)
    ]
    return read_recording(written(folder, data(*moments)))


def said(recording):
    return [x for x in recording.remarks if "cut" in x or "missing" in x]


def own_tracks(recording):
    return {x.id: list(x.states) for x in recording.participants if x.id.startswith("f.0")}


def test_who_is_missing_for_a_moment_was_there(tmp_path):
    recording = read(tmp_path, {30, 31, 32})
    assert [*own_tracks(recording)] == ["f.0"]
    (remark,) = said(recording)
    assert remark.startswith("vehicles are missing while they drive")
    assert remark.endswith("whether all traffic is recorded: `f.0`")
    assert "arrivals" not in recording.complete
    (body,) = (x for x in mended(recording).participants if x.id == "f.0")
    assert [*body.states] == [*range(STEPS)]
    assert body.states[31].x == pytest.approx(driving(31) - 2.0)


def test_a_moment_that_is_missing_for_all(tmp_path):
    moments = [moment(k / 10, body(x=driving(k))) for k in range(STEPS) if k != 30]
    recording = read_recording(written(tmp_path, data(*moments)))
    assert [*own_tracks(recording)] == ["f.0"]
    assert said(recording)


def test_nobody_is_missing(tmp_path):
    recording = read(tmp_path, set())
    assert said(recording) == []
    assert "arrivals" in recording.complete


def test_who_is_put_elsewhere_meanwhile_is_another_one(tmp_path):
    """As SUMO teleports vehicles: nothing of the traffic is missing then."""
    recording = read(tmp_path, {29, 30}, teleported)
    assert own_tracks(recording) == {"f.0": [*range(29)], "f.0_2": [*range(31, STEPS)]}
    (remark,) = said(recording)
    assert remark.startswith("1 track is cut at holes in which it jumps")
    assert "arrivals" in recording.complete
    assert [x.resumes for x in recording.participants if x.id == "f.0_2"] == [28]


@pytest.mark.parametrize(
    ("place", "speed", "whole"), [(driving, 10.0, False), (waiting, 0.0, True)]
)
def test_who_is_away_for_longer_is_another_one(tmp_path, place, speed, whole):
    """SUMO takes out those that wait; of one that drives, states are missing."""
    recording = read(tmp_path, {*range(25, 40)}, place, speed=speed)
    assert [*own_tracks(recording)] == ["f.0", "f.0_2"]
    assert said(recording)[0].startswith("1 track is cut at holes of more than 1 s")
    assert ("arrivals" in recording.complete) == whole
    assert len(said(recording)) == 2 - whole


def test_passengers_are_away_while_they_ride(tmp_path):
    walker = {"element": "person", "kind": "DEFAULT_PEDTYPE", "speed": 1.0}
    recording = read(tmp_path, {*range(25, 40)}, **walker)
    assert [*own_tracks(recording)] == ["f.0", "f.0_2"]
    assert said(recording) == []
    assert "arrivals" in recording.complete


@pytest.mark.parametrize("missing", [{30}, {30, 31, 32}, {*range(25, 40)}, {5, 6, 7, 40}])
def test_tables_of_tracks_are_cut_and_filled_alike(tmp_path, missing):
    known = [k for k in range(STEPS) if k not in missing]
    table = recording_from_columns(
        {
            "track": ["f.0"] * len(known),
            "t": [k / 10 for k in known],
            "x": [driving(k) - 2.0 for k in known],
            "y": [-4.8] * len(known),
        },
        {"lane": ["a", "a"], "x": [0.0, 300.0], "y": [-4.8, -4.8]},
    )
    ours = read(tmp_path, missing)
    assert own_tracks(mended(table)) == own_tracks(mended(ours))
    cut = [[x for x in read.remarks if "cut" in x] for read in (table, ours)]
    assert cut[0] == cut[1]


def test_an_articulated_bus_is_where_it_would_be(tmp_path):
    bus = {"kind": "DEFAULT_RAILTYPE"}
    whole, part = (read(tmp_path, missing, **bus) for missing in (set(), {30, 31, 32}))
    then, now = (mended(x).participants[-1] for x in (whole, part))
    for k in range(STEPS):
        places = [(x.states[k].x, x.states[k].y, x.states[k].heading) for x in (then, now)]
        assert places[0] == pytest.approx(places[1], abs=1e-6)
    assert np.ptp(now.outlines[31], axis=0)[0] > 20
