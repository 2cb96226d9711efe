"""Recordings that programs build: what is right is judged, what is wrong is said at once."""

from pathlib import Path

import numpy as np
import pytest

import rulec
from rulec import (
    Light,
    ObservedLight,
    RulecError,
    build_lanelet,
    build_participant,
    build_recording,
)

ROOT = Path(__file__).parents[2]
STREET = [(0.0, 0.0), (100.0, 0.0)]
T = [0.0, 0.1, 0.2]


def messages(build):
    with pytest.raises(RulecError) as refused:
        build()
    assert {found.code for found in refused.value.diagnostics} == {"R0617"}
    return [f"{found.message} {found.expected} {found.help}" for found in refused.value.diagnostics]


def car(name="a", **more):
    return build_participant(name, "car", T, [10, 11, 12], [0, 0, 0], step_s=0.1, **more)


def test_a_lanelet():
    lane = build_lanelet(7, STREET, 3.0, limit_mps=10, junction="j", successors=[8], foes=[9])
    assert (lane.id, lane.successors, lane.foes, lane.first) == ("7", ("8",), {"9"}, None)
    assert lane.left.tolist() == [[0, 1.5], [100, 1.5]]
    assert lane.types == {"intersection"}


def test_widths_by_point():
    lane = build_lanelet("a", [(0, 0), (0, 0), (50, 0), (100, 0)], [2, 2, 4, 6])
    assert np.hypot(*(lane.left - lane.right).T) == pytest.approx([2, 4, 6])


def test_a_participant():
    """10 m/s along x; its size is a car's, 4.5 x 1.8 m."""
    one = car()
    state = one.states[1]
    assert list(one.states) == [0, 1, 2]
    assert (state.x, state.heading, state.speed) == pytest.approx((11.0, 0.0, 10.0))
    assert np.ptp(one.outlines[1], axis=0) == pytest.approx((4.5, 1.8))
    lit = car(lamps={"brake_light": [True, False, True]})
    assert lit.lamps == {0: {"brake_light"}, 1: frozenset(), 2: {"brake_light"}}
    assert lit.shows == {"brake_light"}


def test_a_recording_is_whole():
    """Predecessors follow from successors, the left neighbour from the right one."""
    lanes = [
        build_lanelet("a", STREET, successors=["b"], left_of="l"),
        build_lanelet("b", [(100, 0), (200, 0)]),
        build_lanelet("l", [(0, 3.5), (100, 3.5)]),
    ]
    recording = build_recording(lanes, [car()], step_s=0.1, side="left", ego="a")
    assert recording.lanelets["b"].predecessors == ("a",)
    assert recording.lanelets["l"].right_of == "a"
    assert (recording.side, recording.ego) == ("left", "a")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"centre": [(0, 0)]}, "`centre` is an array of shape (1, 2) expected two points"),
        ({"centre": [(0, 0), (1, np.nan)]}, "`centre[1, 1]` is nan"),
        ({"centre": [(0, 0), (0, 0)]}, "`centre` has one place only"),
        ({"centre": [("a", 0), (1, 0)]}, "`centre` holds something that is no number"),
        ({"centre": [(0, 0), (50_000, 0)]}, "`centre` is 50,000 m long"),
        ({"width": -1}, "`width` is -1 expected a number above 0"),
        ({"width": 350}, "`width` is 350 expected a number above 0 and below 50, in m"),
        ({"limit_mps": 500}, "`limit_mps` is 500 expected a number above 0 and below 200, in m/s"),
        ({"width": [3, 3, 3]}, "`width` is an array of shape (3,) expected a row of 2 numbers"),
        ({"width": [3, 0]}, "`width[1]` is 0"),
        ({"left_mark": "dashed"}, "`left_mark` is `dashed`"),
        ({"types": ["urbn"]}, "did you mean `urban`?"),
        ({"limit_mps": float("inf")}, "`limit_mps` is inf"),
        ({"stop_line": [1, 2]}, "`stop_line` is an array of shape (2,)"),
        (
            {"lights": [Light(0, (("amber", 9),))]},
            "`lights` is `amber` expected `green`, `inactive`",
        ),
        ({"lights": [Light(0, (("RED", 9),))]}, "did you mean `red`?"),
        *(
            ({"lights": [light]}, "a `Light` that is no programme expected a time step, and pairs")
            for light in (
                *(Light(0, ()), Light(0, (("red", 0),)), Light(0, (("red", -5),))),
                *(Light(0, ((5, "red"),)), Light(0, "red"), Light(0, {"red": 5})),
                *(Light(None, (("red", 5),)), Light(0, (("red", 2.5),)), Light(0, ("red", 5))),
            )
        ),
        ({"lights": [ObservedLight({0.5: "red"})]}, "the time step 0.5 expected whole numbers"),
        ({"lights": [ObservedLight({0: None})]}, "`lights` is `None`"),
        ({"lights": [ObservedLight(None)]}, "without colours by time step"),
    ],
)
def test_a_lanelet_that_makes_no_sense(more, said):
    (found,) = messages(lambda: build_lanelet(**{"identifier": "a", "centre": STREET, **more}))
    assert found.startswith("lanelet `a`: ")
    assert said in found


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"kind": "cra"}, "did you mean `car`?"),
        ({"x": [1, 2]}, "`x` is an array of shape (2,) expected a row of 3 numbers"),
        ({"y": [0, np.inf, 0]}, "`y[1]` is inf"),
        ({"t": [0, 0.1, 0.25]}, "`t[2]` is 0.25, which is no whole number of steps of 0.1 s"),
        ({"t": [0, 0.1, 0.3]}, "`t[2]` is 0.3, and `t[1]` 0.1"),
        ({"step_s": 0}, "`step_s` is 0"),
        ({"length": -2}, "`length` is -2"),
        ({"length": 450}, "`length` is 450 expected a number above 0 and below 100, in m"),
        ({"heading": [0, 0]}, "`heading` is an array of shape (2,)"),
        ({"lamps": {"fog_light": [1, 1, 1]}}, "`lamps` is `fog_light`"),
        ({"lamps": {"horn": [True]}}, "`lamps['horn']` has 1 values expected 3"),
    ],
)
def test_a_participant_that_makes_no_sense(more, said):
    plain = {
        "identifier": "a",
        "kind": "car",
        "t": T,
        "x": [1, 2, 3],
        "y": [0, 0, 0],
        "step_s": 0.1,
    }
    found = messages(lambda: build_participant(**{**plain, **more}))
    assert said in found[0]


def test_a_recording_that_makes_no_sense():
    """All that is wrong is said together."""
    elsewhere = "which is no lanelet of the recording  did you mean `b`?"
    lanes = [build_lanelet("a", STREET, successors=["bb"]), build_lanelet("b", STREET)]
    found = messages(
        lambda: build_recording(
            lanes, [car(), car()], step_s=-1, side="both", ego="c", complete=["STOPS"]
        )
    )
    assert [one.partition(" expected")[0].strip() for one in found] == [
        "the recording: `step_s` is -1",
        "the recording: `side` is `both`",
        "the recording: `complete` is `STOPS`",
        "the recording: there are two participants `a`  give each its own id",
        "lanelet `a`: `successors` has `bb`, " + elsewhere,
        "the recording: `ego` is `c`",
    ]


def test_parts_that_were_made_by_hand_are_checked():
    good = car()
    bad = rulec.Participant(
        id="h",
        type="car",
        standing=False,
        states={0: rulec.TrackState(np.nan, 0, 0, 0, 0)},
        outlines={},
    )
    found = messages(lambda: build_recording([build_lanelet("a", STREET)], [good, bad], step_s=0.1))
    assert "participant `h`: it has no outline at step 0" in found[0]
    assert "at step 0 it is TrackState" in found[1]


def test_a_track_of_another_time_step_is_refused():
    """13 m/s in steps of 0.5 s are 65 m/s in steps of 0.1 s."""
    t = 0.5 * np.arange(6)
    ego = build_participant("ego", "car", t, 20 + 13 * t, 0 * t, step_s=0.5)
    (said,) = messages(lambda: build_recording([build_lanelet("s", STREET)], [ego], step_s=0.1))
    assert "0.1 s apart, it drives 65.0 m/s, and by its speeds 13.0 m/s" in said
    assert "the time step of the recording" in said
    build_recording([build_lanelet("s", STREET)], [ego], step_s=0.5)


def test_who_stops_and_goes_has_speeds_that_fit():
    """Speeds change much from state to state; the middle of each two is what places show."""
    t = 0.5 * np.arange(12)
    speeds = np.array([4.19, 4.19, 3.85, 2.38, 0.92, 0, 0, 0.11, 1.57, 3.04, 4.19, 4.19])
    x = np.append(0.0, ((speeds[1:] + speeds[:-1]) / 4).cumsum())
    own = build_participant("a", "car", t, x * 0.9, 0 * t, step_s=0.5, speed=speeds)
    assert build_recording([build_lanelet("b", STREET)], [own], step_s=0.5).participants == (own,)


def test_what_a_map_and_a_world_call_complete_is_taken():
    road = rulec.read_map(ROOT / "docs/samples/passing.net.xml", 0.1)
    assert "junctions" in road.complete
    found = build_recording(
        road.lanelets.values(), [car()], step_s=0.1, complete=road.complete, side=road.side
    )
    live = rulec.TrafficWorld(found, "a").recording_of([(13.0, 0.0, 0.0, 10.0)])
    again = build_recording(
        live.lanelets.values(), live.participants, step_s=0.1, complete=live.complete
    )
    assert again.complete == live.complete > road.complete


def test_columns_and_pieces_say_the_same():
    """A table in memory and its parts built one by one give equal states."""
    columns = {"track": ["a"] * 3, "t": T, "x": [10, 11, 12], "y": [0.0] * 3}
    lanes = {"lane": ["s", "s"], "x": [0, 100], "y": [0, 0]}
    (one,) = rulec.recording_from_columns(columns, lanes).participants
    other = car()
    for step, state in one.states.items():
        assert np.allclose(
            [state.x, state.y, state.heading, state.speed],
            [other.states[step].x, 0, 0, other.states[step].speed],
        )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"x": [10, "b", 12]}, "row 1: its column `x` holds `b`"),
        ({"x": [10, 11]}, "its columns are of 2 different lengths"),
        ({"x": [10, None, 12]}, "row 1: its column `x` is empty here"),
        ({"x": [[1], [2], [3]]}, "its column `x` is no row of values"),
    ],
)
def test_columns_that_make_no_sense(change, said):
    columns = {"track": ["a"] * 3, "t": T, "x": [10, 11, 12], "y": [0.0] * 3, **change}
    with pytest.raises(RulecError) as refused:
        rulec.recording_from_columns(columns, {"lane": ["s", "s"], "x": [0, 100], "y": [0, 0]})
    assert said in refused.value.diagnostics[0].message


@pytest.mark.parametrize(
    ("tracks", "said", "way_out"),
    [
        ("cars.csv", "they are of type `str`", "read_recording"),
        ([{"track": 1}], "they are of type `list`", ""),
        (
            {"track": ["a"], "t": np.array([0], "datetime64[ns]"), "x": [0], "y": [0]},
            "its column `t` holds dates or durations (datetime64[ns])",
            "total_seconds",
        ),
    ],
)
def test_what_is_no_columns_of_numbers(tracks, said, way_out):
    with pytest.raises(RulecError) as refused:
        rulec.recording_from_columns(tracks, {"lane": ["s", "s"], "x": [0, 100], "y": [0, 0]})
    (found,) = refused.value.diagnostics
    assert said in found.message
    assert way_out in found.help


def test_a_data_frame_is_no_recording():
    with pytest.raises(TypeError, match="recording_from_columns"):
        rulec.verify_recording({"track": ["a"]}, "esterle2019")
