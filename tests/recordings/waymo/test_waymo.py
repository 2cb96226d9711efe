"""Scenarios of Waymo's, written by hand: what a recording makes of them."""

import warnings

import numpy as np
import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.recording import ObservedLight
from rulec.recordings.recording_files import read_recording, read_recordings
from rulec.recordings.recording_format import RecordingSource
from support.builders import waymo_files as w


def write(tmp_path, *scenarios, name="motion.tfrecord-00000-of-01000"):
    path = tmp_path / name
    path.write_bytes(b"".join(map(w.record, scenarios)))
    return path


def read(tmp_path, *scenarios):
    return read_recording(RecordingSource(write(tmp_path, *scenarios)))


@pytest.fixture(scope="module")
def junction(tmp_path_factory):
    return read(tmp_path_factory.mktemp("waymo"), w.crossing(id="4a"))


def test_the_recording(junction):
    assert (junction.name, junction.form, junction.ego) == ("4a", "Waymo scenario", "70")
    assert (junction.side, junction.country, junction.step_s) == ("right", "USA", 0.1)
    assert junction.complete == {"STOP", "junctions"}


def test_tracks_are_those_of_the_file(junction):
    ego, other = junction.participants
    assert [body.type for body in (ego, other)] == ["car", "car"]
    assert [ego.states[k].x for k in (0, 40, 80)] == [-40.0, 0.0, 40.0]
    assert (other.states[10].y, other.states[10].speed) == (-50.0, pytest.approx(10.0))
    assert np.ptp(ego.outlines[0], axis=0) == pytest.approx([4.5, 1.9], abs=1e-6)


def test_lights_are_at_the_lane_before_theirs(junction):
    lane = junction.lanelets["1"]
    (light,) = lane.lights
    assert lane.lights_to == {"2": light}
    assert [light.colour_at(k) for k in (0, 40, 41, 80)] == ["red", "red", "green", "green"]
    # Where the line is painted nobody knows
    assert lane.stop_line is None


def test_a_stop_sign_is_at_the_lane_before_its_own(junction):
    assert {name for name, x in junction.lanelets.items() if x.signs} == {"4"}
    assert junction.lanelets["4"].signs == {"STOP"}
    assert junction.lanelets["4"].lights == ()


def test_bounds_are_lines_and_edges_where_there_are_some(junction):
    lane = junction.lanelets["1"]
    assert lane.centre[:, 0].tolist() == [x for x, _ in w.straight(-60, -10)]
    assert lane.left[:, 1] == pytest.approx(1.7)
    assert lane.right[:, 1] == pytest.approx(-1.9)
    assert (lane.left_mark, lane.right_mark) == ("broken", None)
    # Through the junction they go on to what is usual, 12 ft, from where the lane before ends
    assert junction.lanelets["2"].left[0, 1] == pytest.approx(1.7)
    assert junction.lanelets["5"].left[:, 0] == pytest.approx(-1.8)


@pytest.mark.parametrize(("away_m", "mark"), [(-2.0, "solid"), (-4.0, None)])
def test_a_mark_is_where_its_line_is(tmp_path, away_m, mark):
    """A line beside which there is more room than a lane has is not the lane's bound."""
    features = [
        w.lane(1, w.straight(-60, -10), right_lines=[(0, 10, 21, 2)]),
        w.road_line(21, w.straight(-60, -10, away_m, 10.0), kind=2),
    ]
    lanelets = read(tmp_path, w.crossing(features=features, lights=[])).lanelets
    assert lanelets["1"].right_mark == mark


def test_neighbours_and_junctions(junction):
    lanelets = junction.lanelets
    assert (lanelets["1"].left_of, lanelets["7"].right_of) == ("7", "1")
    assert lanelets["7"].left_of is None
    assert {name for name, x in lanelets.items() if "intersection" in x.types} == {"2", "5"}
    assert lanelets["1"].successors == ("2",)
    assert lanelets["3"].predecessors == ("2",)


def test_limits_are_in_miles_per_hour_and_0_is_none(junction):
    assert junction.lanelets["1"].limit_mps == pytest.approx(45 * 1609.344 / 3600)
    assert junction.lanelets["4"].limit_mps is None


def test_people_walk_along_the_longer_side_of_a_crosswalk(junction):
    crosswalk = junction.lanelets["crosswalk 41"]
    assert crosswalk.types == {"crosswalk"}
    assert sorted(crosswalk.centre.tolist()) == [[13.5, -4.0], [13.5, 4.0]]


def test_where_nobody_saw_whether_there_is_a_light(tmp_path):
    features = [
        w.lane(1, w.straight(-60, -10), exits=[2]),
        w.lane(2, w.straight(-10, 10), entries=[1]),
        w.lane(4, w.upward(-60, -10), exits=[5]),
        w.lane(5, w.upward(-10, 10), entries=[4]),
    ]
    lanelets = read(tmp_path, w.crossing(features=features, lights=[])).lanelets
    assert lanelets["1"].lights == lanelets["4"].lights == (ObservedLight({}, seen=False),)


@pytest.mark.parametrize(
    ("number", "colour"),
    [
        *((w.STOP, "red"), (w.ARROW_STOP, "red"), (w.CAUTION, "yellow"), (2, "yellow")),
        *((w.GO, "green"), (3, "green"), (w.UNKNOWN, ""), (w.FLASHING_STOP, "")),
        *((8, ""), (99, "")),
    ],
)
def test_colours(tmp_path, number, colour):
    (light,) = (
        read(tmp_path, w.crossing(lights=[{2: (number, (-10, 0))}] * 81)).lanelets["1"].lights
    )
    assert (light.colour_at(0), light.seen) == (colour, True)


def test_lanes_that_cross_at_other_heights_make_no_junction(tmp_path):
    features = [
        w.lane(1, [(x, y, 6.0) for x, y in w.straight(-60, 60)]),
        w.lane(4, [(x, y, 0.0) for x, y in w.upward(-60, 60)]),
    ]
    lanelets = read(tmp_path, w.crossing(features=features, lights=[])).lanelets
    assert not any(x.types for x in lanelets.values())


def test_a_lane_is_cut_where_the_one_beside_it_begins(tmp_path):
    """A pocket begins beside the second half of a lane of 100 m; its lanes are whole pieces."""
    features = [
        w.lane(1, w.straight(-100, 0), exits=[3], left_lanes=[(2, 10, 20, 0, 10)]),
        w.lane(2, w.straight(-50, 0, 3.5), right_lanes=[(1, 10, 20, 0, 10)]),
        w.lane(3, w.straight(0, 50), entries=[1]),
    ]
    lanelets = read(tmp_path, w.crossing(features=features, lights=[])).lanelets
    assert set(lanelets) == {"1.1", "1.2", "2", "3"}
    assert (lanelets["1.1"].left_of, lanelets["1.2"].left_of) == (None, "2")
    assert lanelets["1.1"].successors == ("1.2",)
    assert lanelets["1.2"].successors == ("3",)
    assert lanelets["3"].predecessors == ("1.2",)
    assert lanelets["1.2"].centre[[0, -1], 0].tolist() == [-50.0, 0.0]
    # Half-way between the centres, and the same of both
    assert lanelets["1.2"].left[:, 1] == pytest.approx(1.75)


def test_lanes_of_no_length_are_led_through(tmp_path):
    features = [
        w.lane(1, w.straight(-60, 0), exits=[2]),
        w.lane(2, [(0.0, 0.0)], entries=[1], exits=[3]),
        w.lane(3, w.straight(0, 60), entries=[2]),
    ]
    lanelets = read(tmp_path, w.crossing(features=features, lights=[])).lanelets
    assert lanelets["1"].successors == ("3",)
    assert lanelets["3"].predecessors == ("1",)


def gone(*steps):
    """A car that nobody sees at some time steps."""
    return [None if k in steps else w.state(-40.0 + k, 0.0, 0.0, (10.0, 0.0)) for k in range(81)]


def test_who_is_lost_for_half_a_second_has_moved_evenly(tmp_path):
    body = read(tmp_path, w.crossing(tracks=[(70, w.VEHICLE, gone(*range(10, 15)))]))
    assert body.participants[0].states[12].x == pytest.approx(-28.0)
    (remark,) = body.remarks
    assert remark.endswith("are assumed to move evenly meanwhile: 5 states")
    longer = read(tmp_path, w.crossing(tracks=[(70, w.VEHICLE, gone(*range(10, 16)))]))
    assert sorted(set(range(81)) - set(longer.participants[0].states)) == list(range(10, 16))
    assert longer.remarks == ()


@pytest.mark.parametrize(
    ("kind", "size", "type_"),
    [
        (w.VEHICLE, (4.5, 1.9), "car"),
        (w.VEHICLE, (11.0, 2.6), "vehicle"),
        (w.VEHICLE, (2.2, 0.9), "vehicle"),
        (w.PEDESTRIAN, (0.8, 0.8), "pedestrian"),
        (w.CYCLIST, (1.8, 0.8), "bicycle"),
        (w.OTHER, (1.0, 1.0), "unknown"),
        (0, (1.0, 1.0), "unknown"),
    ],
)
def test_types(tmp_path, kind, size, type_):
    states = [w.state(0.1 * k, 0.0, size=size) for k in range(81)]
    (body,) = read(tmp_path, w.crossing(tracks=[(70, kind, states)])).participants
    assert body.type == type_


def test_who_drives_backwards_has_a_speed_below_0(tmp_path):
    states = [w.state(-0.1 * k, 0.0, 0.0, (-1.0, 0.0)) for k in range(81)]
    (body,) = read(tmp_path, w.crossing(tracks=[(70, w.VEHICLE, states)])).participants
    assert body.states[5].speed == -1.0


JITTER = np.random.default_rng(1).uniform(-0.02, 0.02, 81)


@pytest.mark.parametrize("late", [JITTER, np.arange(81) % 2 * 0.02, np.arange(81) * 0.001])
def test_times_may_be_off_by_a_quarter_of_a_step(tmp_path, late):
    """From one to the next, that may be half a step; and clocks may be slow."""
    times = (0.1 * np.arange(81) + late).tolist()
    recording = read(tmp_path, w.crossing(times=times))
    assert recording.step_s == pytest.approx(0.1, abs=0.0011)
    assert list(recording.participants[0].states) == list(range(81))


def test_the_step_is_that_of_many_times(tmp_path):
    """Of 81 intervals, most are 0.12 s, the others 0.08 s."""
    times = [0.1 * k + 0.02 * (k % 2) for k in range(82)]
    recording = read(tmp_path, w.crossing(times=times))
    assert (recording.step_s, list(recording.participants[0].states)[-1]) == (0.1, 80)


@pytest.mark.parametrize("late", [0.03, 0.05, -0.04])
def test_times_that_are_farther_off_are_refused(tmp_path, late):
    """From place to place, by turns."""
    times = [0.1 * k + late * (k % 4 == 3) - late * (k % 4 == 1) for k in range(81)]
    with pytest.raises(RulecError, match="its times are uneven"):
        read(tmp_path, w.crossing(times=times))


def test_what_was_not_valid_may_be_anything(tmp_path):
    nothing = w.state(float("nan"), 0.0, 0.0, (10.0, 0.0), valid=False)
    states = [w.state(k - 40.0, 0.0, 0.0, (10.0, 0.0)) for k in range(80)]
    body = read(tmp_path, w.crossing(tracks=[(70, w.VEHICLE, [*states, nothing])])).participants[0]
    assert list(body.states) == list(range(80))


def test_a_line_with_points_that_almost_coincide_warns_nobody(tmp_path):
    """GEOS divides by the squares of distances."""
    features = [
        w.lane(1, w.straight(-60, 0), right_lines=[(0, 12, 21, 2)]),
        w.road_line(21, [(0, -1.75), (-3e-255, -1.75), (-60, -1.75)], kind=2),
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        lanelets = read(tmp_path, w.crossing(features=features, lights=[])).lanelets
    assert lanelets["1"].right[:, 1] == pytest.approx(-1.75)


def test_several_scenarios_in_a_file(tmp_path):
    path = write(tmp_path, w.crossing(id="a"), w.crossing(id="b"))
    assert [x.name for x in read_recordings(RecordingSource(path))] == ["a", "b"]
    chosen = RecordingSource(path, scenario_id="b")
    assert [x.name for x in read_recordings(chosen)] == ["b"]
    with pytest.raises(RulecError, match="there is no scenario `c` in the file"):
        list(read_recordings(RecordingSource(path, scenario_id="c")))


def test_a_broken_scenario_does_not_hide_the_others(tmp_path):
    bad = w.crossing(id="bad", times=[0.0, 0.1, 0.15])
    path = write(tmp_path, w.crossing(id="a"), bad, w.crossing(id="b"))
    found = read_recordings(RecordingSource(path))
    assert [next(found).name, next(found).name] == ["a", "b"]
    begin = len(w.record(w.crossing(id="a"))) + 12
    with pytest.raises(
        RulecError, match=f"at byte {begin:,}, `record 2 / metadata / ts` is invalid: its"
    ):
        next(found)


GOOD = [w.state(0.0, 0.0)] * 81


@pytest.mark.parametrize(
    ("parts", "why"),
    [
        ({"times": []}, "there are no times"),
        ({"times": [0.0] * 81}, "its times do not ascend"),
        ({"times": [float("nan")] * 81}, "metadata / ts` contains a number that is not below"),
        ({"times": [0.1 * k for k in range(40)]}, "has 81 states for 40 times"),
        ({"tracks": []}, "`record 1 / tracks` contains no road users"),
        ({"tracks": [(70, 1, [None] * 81)]}, "`record 1 / tracks` contains no road users"),
        ({"tracks": [(70, 1, GOOD), (70, 1, GOOD)]}, "there is a second track 70"),
        ({"ego": 2}, "`sdc_track_index` is 2 of 2 tracks"),
        ({"ego": -1}, "`sdc_track_index` is -1 of 2 tracks"),
        (
            {"tracks": [(70, 1, [w.state(float("nan"), 0.0)] * 81)]},
            "70 / state / position` contains a number",
        ),
        ({"tracks": [(70, 1, [w.state(1e300, 0.0)] * 81)]}, "a number that is not below 1e+08"),
        ({"tracks": [(70, 1, [w.state(0.0, 0.0, size=(0.0, 1.0))] * 81)]}, "no length or width"),
        (
            {"features": [w.lane(1, [(0, 0), (30_000, 0)])]},
            "`record 1 / map_features / 1` is longer than 20 km",
        ),
        ({"features": [w.lane(1, [(0, 0), (1, 0)])] * 2}, "there is a second map feature 1"),
        (
            {"features": [w.crosswalk(1, [(0, 0), (1, 0)])]},
            "`record 1 / map_features / 1` has fewer than 3 corners",
        ),
        ({"lights": [{2: (w.STOP, (-10, 0))}] * 82}, "has 82 states for 81 times"),
    ],
)
def test_what_is_refused(tmp_path, parts, why):
    with pytest.raises(RulecError) as caught:
        read(tmp_path, w.crossing(**parts))
    assert [x.code for x in caught.value.diagnostics] == ["R0610"]
    assert why in str(caught.value)
    assert "at byte" in str(caught.value)
