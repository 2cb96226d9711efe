"""Who drives against all lanes of a carriageway that is surely one-way.

Two lanes lead east along y = 0 and 4, and 20 m away two lead west; traffic goes along them.
"""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.drives import Drive, Drives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.extraction.tracks.surroundings import Surroundings
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.drive_verdicts import violated
from support.builders.recordings import lanelet, recording, straight, vehicle

GERMAN = machines("de")


def carriageways(**more):
    return [
        straight(1, 0, 400, left_of=2, **more),
        straight(2, 0, 400, y=4, right_of=1, **more),
        lanelet(3, [(400, 20), (0, 20)], right_of=4, **more),
        lanelet(4, [(400, 24), (0, 24)], left_of=3, **more),
    ]


def one_lane_each_way():
    return [straight(1, 0, 400), lanelet(3, [(400, 20), (0, 20)])]


def eastward(number, x=0.0, y=0.0, mps=15.0, count=12):
    return vehicle(number, {k: (x + mps * k / 2, y) for k in range(count)}, speed=mps)


def westward(number, x=300.0, y=0.0, mps=15.0, count=12, kind="car", heading=pi):
    places = {k: (x - mps * k / 2, y) for k in range(count)}
    return vehicle(number, places, kind, speed=mps, heading=heading)


def drives(found, ego="7"):
    return [*Drives(found, "right").of(ego)]


def only(found):
    (drive,) = drives(found)
    assert isinstance(drive, Drive), drive.why
    return drive


def test_the_side_it_drives_on_is_the_wrong_way():
    drive = only(recording(carriageways(), [westward(7), eastward(8, 100)]))
    assert drive.ego == "7"
    assert {state["driving_side"] for state in drive.trace.states} == {"wrong_way"}
    assert {state["one_way"] for state in drive.trace.states} == {True}
    speeds = {round(state["speed"].middle, 3) for state in drive.trace.states}
    assert speeds == {54.0}  # 15 m/s in km/h


def test_what_depends_on_the_direction_has_no_value():
    """One that comes towards it is neither ahead nor behind, by the road's direction."""
    drive = only(recording(carriageways(), [westward(7), eastward(8, 100)]))
    for state in drive.trace.states:
        directed = {"ahead_for", "stopped", "lane", "light", "lane_change", "crosses_stop_line"}
        told = directed & state.keys()
        assert {"lane", "light"} <= told, told
        for name in told:
            value = state[name]
            assert UNKNOWN in (value, *(value.values() if isinstance(value, dict) else ())), name


@pytest.mark.parametrize("book", ["de", "fr", "it", "us-ca", "cn"])
def test_the_law_blames_it_for_nothing_else(book):
    found = recording(carriageways(), [westward(7), eastward(8, 100, 4.0), eastward(9, 60, 4.0)])
    answers = violated(found, machines(book), defaults=False)
    assert set(answers["7"]) == {"wrong_way"}
    assert not answers["8"], answers["8"]


def test_who_keeps_left_on_the_other_carriageway_is_asked_as_before():
    lawful = recording(carriageways(), [westward(7, y=20.0)])
    (drive,) = drives(lawful)
    assert {state["driving_side"] for state in drive.trace.states} == {"own_side"}


@pytest.mark.parametrize(
    ("lanes", "ego"),
    [
        (one_lane_each_way(), westward(7)),  # of a road with two directions maps may have one
        (carriageways(), westward(7, count=2)),  # for half a second
        (carriageways(), westward(7, mps=1.5)),  # for 8.25 m
        (carriageways(), westward(7, kind="bicycle")),
        (carriageways(types=frozenset({"busLane"})), westward(7)),
    ],
    ids=["one lane", "for a moment", "not far", "a cycle", "a lane for buses"],
)
def test_who_is_not_surely_driving_the_wrong_way_has_no_drive(lanes, ego):
    (answer,) = drives(recording(lanes, [ego, eastward(8, 100, 4.0)]))
    assert isinstance(answer, NoDrive)
    assert "never on a lane in its direction" in answer.why


def test_a_motorway_with_one_lane_is_one_way():
    lanes = [straight(1, 0, 400, types=frozenset({"interstate"}))]
    drive = only(recording(lanes, [westward(7)]))
    assert drive.trace.states[0]["driving_side"] == "wrong_way"
    assert drive.trace.states[0]["road_class"] == "motorway"
    # Its heading is that of its motion: it may be backing up
    assert drive.trace.states[5]["reversing"] is UNKNOWN


def test_who_drives_backwards_drives_along_its_lane():
    """It heads the way of its lane: it has a drive in which it reverses."""
    drive = only(recording(carriageways(), [westward(7, heading=0.0)]))
    assert {state["driving_side"] for state in drive.trace.states} == {"own_side"}
    assert drive.trace.states[5]["reversing"] is True


def test_lanes_that_traffic_uses_the_other_way_are_drawn_the_other_way():
    cars = [westward(7), westward(8, 330), westward(9, 360), eastward(10, 0, 4.0)]
    (answer,) = drives(recording(carriageways(), cars))
    assert isinstance(answer, NoDrive)
    # One of many is not the map's fault
    many = [eastward(k, 12 * k, count=4) for k in range(20, 26)]
    assert isinstance(only(recording(carriageways(), [*cars[:2], *many])), Drive)


def test_who_turns_round_on_a_carriageway_has_a_drive_before_and_one_after():
    places = {k: (100 + 7.5 * k, 0.0) for k in range(8)}
    places |= {8: (157.0, 1.5), 9: (157.0, 3.5)}
    places |= {10 + k: (150 - 7.5 * k, 4.0) for k in range(10)}
    body = vehicle(7, places)
    headings = {**dict.fromkeys(range(8), 0.0), 8: pi / 3, 9: 2 * pi / 3}
    from_places = {
        k: replace(state, heading=headings.get(k, pi), speed=10.0)
        for k, state in body.states.items()
    }
    body = replace(body, states=from_places)
    first, *_, last = drives(recording(carriageways(), [body, eastward(8)]))
    assert (first.arrays.id, last.arrays.id[:2]) == ("7", "7#")
    assert first.trace.states[0]["driving_side"] == "own_side"
    assert {state["driving_side"] for state in last.trace.states} == {"wrong_way"}
    assert last.start_s >= 5.0


def test_a_stretch_goes_over_lanelets_from_their_end():
    lanes = [
        straight(1, 0, 200, left_of=2, successors=(5,)),
        straight(2, 0, 200, y=4, right_of=1, successors=(6,)),
        straight(5, 200, 400, left_of=6, predecessors=(1,)),
        straight(6, 200, 400, y=4, right_of=5, predecessors=(2,)),
        *carriageways()[2:],
    ]
    drive = only(recording(lanes, [westward(7, count=25), eastward(8, 100, 4.0)]))
    assert drive.arrays.n_states == 25
    assert [drive.places[0].lanelet, drive.places[24].lanelet] == ["5", "1"]
    assert {state["driving_side"] for state in drive.trace.states} == {"wrong_way"}


def test_round_a_ring_the_wrong_way():
    radius = 20.0
    angles = np.linspace(0, 2 * pi, 49)
    corners = [(radius * np.cos(a), radius * np.sin(a)) for a in angles]
    ring = [
        lanelet(
            k + 1,
            corners[12 * k : 12 * k + 13],
            successors=((k + 1) % 4 + 1, *((8,) if k == 2 else ())),
            predecessors=((k - 1) % 4 + 1, *((9,) if k == 0 else ())),
        )
        for k in range(4)
    ]
    # A street leads in from the east and one out to the south
    ring += [
        lanelet(9, [(80, -6), (30, -4), (20, 0)], successors=(1,)),
        lanelet(8, [(0, -20), (6, -28), (6, -80)], predecessors=(3,)),
    ]
    at = {k: 1.0 - 5.0 * k / 2 / radius for k in range(20)}
    body = vehicle(7, {k: (radius * np.cos(a), radius * np.sin(a)) for k, a in at.items()})
    turned = {
        k: replace(state, heading=at[k] - pi / 2, speed=5.0) for k, state in body.states.items()
    }
    body = replace(body, states=turned)
    found = recording(ring, [body])
    assert len(Surroundings(found, tracks_of(found, USUAL), USUAL).ring("right")) == 4
    (drive,) = drives(found)
    assert isinstance(drive, Drive)
    assert {state["driving_side"] for state in drive.trace.states} == {"wrong_way"}
    assert set(violated(found, GERMAN, defaults=False)["7"]) == {"wrong_way"}
