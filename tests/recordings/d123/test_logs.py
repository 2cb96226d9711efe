"""123D's logs and maps: bodies, ego between its poses, lights, lanes with their marks."""

import numpy as np
import pytest

import rulec
from rulec import RulecError, read_map, read_recording
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.tellable_words import TELLABLE_WORDS, told_words
from rulec.recordings.d123.log_files import OddPackError, unpacked
from rulec.recordings.recording_inputs import input_files
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders import d123_files as d123


def test_bodies(tmp_path):
    recording = read_recording(d123.drive(tmp_path))
    bodies = {one.id: one for one in recording.participants}
    assert {key: one.type for key, one in bodies.items()} == {
        "ego": "car",
        "car": "car",
        "walker": "pedestrian",
        "rider": "bicycle",
    }
    assert (recording.ego, recording.step_s, recording.name) == ("ego", 0.1, "some")
    assert (recording.side, recording.country) == ("right", "USA")
    car = bodies["car"].states[3]
    assert (car.x, car.y, car.heading, car.speed) == pytest.approx((33.0, 1.75, 0.0, 10.0))
    assert bodies["walker"].states[0].heading == pytest.approx(np.pi / 2)
    # A rider and the cycle are one body, as large as both
    assert np.ptp(bodies["rider"].outlines[0], axis=0) == pytest.approx((1.8, 0.6))


def test_ego_is_at_its_middle_at_the_moments_of_boxes(tmp_path):
    """Its pose is at x = 5 at the first one and 10 m/s fast, its middle a metre ahead."""
    file = d123.drive(tmp_path)
    states = read_recording(file).participants[0].states
    assert [states[k].x for k in (0, 1, 8)] == pytest.approx([6.0, 7.0, 14.0])
    # Poses only every 0.2 s, between the moments: on the line from one to the next
    ego = {1_050_000 + 200_000 * k: d123.pose(5.5 + 2 * k, 1.75, 0.1 * k) for k in range(4)}
    moments = [1_000_000 + 100_000 * k for k in range(9)]
    boxes = [[d123.box("car", d123.CAR, 30.0 + k, 1.75)] for k in range(9)]
    states = read_recording(d123.write_log(tmp_path, moments, boxes, ego)).participants[0].states
    assert states[1].heading == pytest.approx(0.025)
    assert states[2].x == pytest.approx(((6.5) + (7.5 + np.cos(0.1))) / 2 + 0.5, abs=0.01)
    # Nothing is said of ego half a second before its first pose and after its last
    late = {10**6 + 600_000: d123.pose(5, 1.75)}
    states = read_recording(d123.write_log(tmp_path, moments, boxes, late)).participants[0].states
    assert list(states) == [1, 2, 3, 4, 5, 6, 7, 8]


def test_lanes(tmp_path):
    d123.drive(tmp_path)
    roads = read_map(tmp_path / "map.arrow", 0.1)
    lanes = roads.lanelets
    assert set(lanes) == {"1", "2", "3", "4", "crosswalk 5"}
    one, two, three, back = (lanes[name] for name in "1234")
    assert (one.right_of, one.left_of, two.left_of, back.left_of) == ("2", None, "1", None)
    assert (one.successors, three.predecessors) == (("3",), ("1",))
    assert (one.types, two.types, three.types) == (set(), {"busLane"}, {"intersection"})
    assert (one.limit_mps, two.limit_mps) == (13.4, None)
    assert one.left.tolist() == [[0, 3.5], [60, 3.5]]
    assert one.centre.tolist() == [[0, 1.75], [60, 1.75]]
    # Of two kinds of lines along one bound nobody says which is whose; beside lane 3 there is none
    assert (one.left_mark, one.right_mark, two.left_mark) == ("double_solid", "broken", "broken")
    assert (two.right_mark, three.left_mark) == (None, None)
    assert (roads.side, roads.country) == ("right", "USA")
    # People walk along the longer way
    assert np.ptp(lanes["crosswalk 5"].centre, axis=0) == pytest.approx((0, 12))


def test_lanes_side_by_side_are_neighbours_where_none_is_named(tmp_path):
    """As in logs of data sets whose maps do not name them."""
    file, town = d123.drive(tmp_path), d123.town()
    for _, _, said, *_ in town:
        said.pop("left_lane_id", None)
        said.pop("right_lane_id", None)
    d123.write_map(tmp_path, town)
    recording = read_recording(file)
    assert recording.lanelets["1"].right_of == "2"
    assert len(recording.remarks) == 1


@pytest.mark.parametrize("kind", ["SOLID", [6], {"a": 6}, 6.0, None, 99])
def test_lines_of_an_odd_kind_are_no_marks(tmp_path, kind):
    town = d123.town()
    line = next(place for place, (layer, name, *_) in enumerate(town) if (layer, name) == (9, 0))
    town[line][2]["road_line_type"] = kind
    roads = read_map(d123.write_map(tmp_path, town), 0.1)
    assert roads.lanelets["1"].left_mark is None
    assert roads.lanelets["1"].right_mark == "broken"


def test_lights_are_for_the_way_to_their_lane(tmp_path):
    one, *others = read_recording(d123.drive(tmp_path)).lanelets.values()
    (light,) = one.lights_to.values()
    assert list(one.lights_to) == ["3"]
    assert [light.colour_at(step) for step in (0, 4, 5, 8)] == ["red", "red", "green", "green"]
    assert not any(lane.lights_to for lane in others)


def zone_at(x, kind, lanes, name=6):
    """Half a metre along the road, across lane 1."""
    return d123.stop_zone(name, kind, lanes, (x, 0), (x + 0.5, 0), (x + 0.5, 3.5), (x, 3.5))


@pytest.mark.parametrize(
    ("zone", "signs"),
    [
        # For the lane behind the line, where it begins, and for the one before it, where it ends
        *[(zone_at(60, 2, [3]), {"1": {"STOP"}}), (zone_at(59, 3, [1]), {"1": {"YIELD"}})],
        # A light's zone is no sign; nor is one of a kind that there is none of
        *[(zone_at(60, 1, [3]), {}), (zone_at(60, 0, [3]), {}), (zone_at(60, "2", [3]), {})],
    ],
)
def test_stop_zones_are_signs_of_the_lanes_that_end_there(tmp_path, zone, signs):
    file = d123.write_map(tmp_path, [*d123.town(), zone])
    roads = read_map(file, 0.1)
    assert {key: one.signs for key, one in roads.lanelets.items() if one.signs} == signs
    assert (roads.remarks, roads.complete) == ((), frozenset())


@pytest.mark.parametrize(
    ("x", "lanes"),
    [
        # In the middle of its lane; for none, or none of the map; where one that is in no
        # intersection begins, as zones are drawn whose signs stand at lanes' ends
        *[(30, [1]), (60, []), (60, [77]), (0, [1])],
        # In an intersection ways go on
        (120, [3]),
    ],
)
def test_stop_zones_elsewhere_are_left_out_with_a_remark(tmp_path, x, lanes):
    file = d123.write_map(tmp_path, [*d123.town(), zone_at(x, 2, lanes)])
    roads = read_map(file, 0.1)
    assert not any(one.signs for one in roads.lanelets.values())
    (remark,) = roads.remarks
    assert remark == "stop zones whose lanes do not begin or end there are left out: 1"


@pytest.mark.parametrize(
    ("x", "lanes", "untold"),
    [
        # By where it lies, and by what it is said to be for
        *[(30, [1], {"1"}), (60, [], {"1", "3"}), (30, [77], {"1"}), (0, [2], {"1", "2"})],
        # Beyond the map's edge
        (200, [77], set()),
    ],
)
def test_signs_of_zones_that_are_not_placed_are_unknown_there(tmp_path, x, lanes, untold):
    file = d123.write_map(tmp_path, [*d123.town(), zone_at(x, 2, lanes)])
    found = read_map(file, 0.1).lanelets
    assert {name: one.untold_signs for name, one in found.items() if one.untold_signs} == {
        name: {"STOP"} for name in untold
    }


def drive_on_lane_two(tmp_path, *zones):
    """Who drives on lane 2 at 10 m/s; lane 1 has a stop sign, and other zones are somewhere."""
    moments = [d123.SECOND_US + 100_000 * k for k in range(30)]
    boxes = [[d123.box("car", d123.CAR, 5.0 + k, -1.75)] for k in range(30)]
    ego = {moment: d123.pose(1.0 + k, 1.75) for k, moment in enumerate(moments)}
    d123.write_map(tmp_path, [*d123.town(), zone_at(60, 2, [3]), *zones])
    file = d123.write_log(tmp_path, moments, boxes, ego)
    drives = selected_drives(read_recording(file), RequestedDrives(egos=("car",)), "some", "right")
    (drive,) = drives.of("car")
    return drive.trace.states


STOP_WORDS = ("stop_sign", "crosses_stop_line", "distance_to_stop_line")


def test_of_a_stop_sign_that_is_not_placed_nothing_is_known(tmp_path):
    """That other signs are placed does not say that there is none here."""
    for state in drive_on_lane_two(tmp_path)[3:9]:
        assert [state[word] for word in STOP_WORDS] == [False, False, 0]
    states = drive_on_lane_two(tmp_path, zone_at(30, 2, [2], name=7))
    for k, state in enumerate(states[3:9], 3):
        signs, crosses, distance = (state[word] for word in STOP_WORDS)
        assert signs is crosses is UNKNOWN
        # At most at the lane's end, at x = 60; the front is 2.25 m ahead of the middle
        assert (distance.low, distance.high) == pytest.approx((0, 60 - 2.25 - 5 - k))
    # Of a sign to give way the same
    zones = [zone_at(60, 3, [3], name=7), zone_at(30, 3, [2], name=8)]
    for states, said in ((zones[:1], False), (zones, UNKNOWN)):
        assert drive_on_lane_two(tmp_path, *states)[4]["give_way_sign"] is said


def test_stop_signs_of_waymo_are_for_the_lanes_behind_them_and_are_all(tmp_path):
    """Its maps in this form have no intersections."""
    town = d123.town()
    town[2][2]["lane_group_id"] = None
    file = d123.write_map(tmp_path, [*town, zone_at(60, 2, [3])], said={"dataset": "wod-motion"})
    roads = read_map(file, 0.1)
    assert (roads.lanelets["1"].signs, roads.complete) == ({"STOP"}, {"STOP"})


@pytest.mark.parametrize("lanes", [5, ["3"], {"3": 3}])
def test_stop_zones_with_odd_lanes_are_refused(tmp_path, lanes):
    file = d123.write_map(tmp_path, [*d123.town(), zone_at(60, 2, lanes)])
    with pytest.raises(RulecError, match="`lane_ids` is no list of ids"):
        read_map(file, 0.1)


def test_who_drives_past_a_stop_zone_has_not_stopped(tmp_path):
    """Ego goes from x = 36 past the end of lane 1 at 10 m/s."""
    moments = [d123.SECOND_US + 100_000 * k for k in range(50)]
    boxes = [[d123.box("car", d123.CAR, 100.0 + k, 1.75)] for k in range(50)]
    ego = {moment: d123.pose(35.0 + k, 1.75) for k, moment in enumerate(moments)}
    d123.write_map(tmp_path, [*d123.town(), zone_at(60, 2, [3])])
    file = d123.write_log(tmp_path, moments, boxes, ego)
    (answer,) = rulec.verify_recording(file, "us-ca", RequestedDrives(egos=("ego",))).answers()
    assert "stop_sign" in {one.rule for one in answer.answer.violations}


def test_the_map_of_a_place_is_in_a_folder_of_its_own(tmp_path):
    folder = tmp_path / "logs" / "nuplan_val" / "some"
    folder.mkdir(parents=True)
    file = d123.drive(folder)
    (folder / "map.arrow").unlink()
    about = {"dataset": "nuplan", "location": "sg-one-north"}
    moments, ego = [0, 100_000], {0: d123.pose(5, 1.75), 100_000: d123.pose(6, 1.75)}
    boxes = [[d123.box("car", 0, 30.0 + k, 1.75)] for k in range(2)]
    labels = "py123d.parser.registry.NuPlanBoxDetectionLabel"
    d123.write_log(folder, moments, boxes, ego, said=about, labels=labels)
    with pytest.raises(RulecError, match="R0614"):
        read_recording(file)
    maps = tmp_path / "maps" / "nuplan"
    maps.mkdir(parents=True)
    d123.write_map(maps, d123.town(), "nuplan_sg-one-north.arrow", about)
    recording = read_recording(folder)
    assert (recording.side, recording.country, len(recording.lanelets)) == ("left", "SGP", 5)
    assert recording.participants[1].type == "vehicle"
    assert input_files([str(tmp_path)]).paths == (str(folder),)


def test_what_it_tells(tmp_path):
    file = d123.drive(tmp_path)
    town = d123.town()
    town[0][2]["lane_type"] = 1
    d123.write_map(tmp_path, [*town, zone_at(60, 2, [3]), zone_at(60, 3, [3], name=7)])
    told = told_words(selected_drives(read_recording(file), RequestedDrives(), "some", "right"))
    # Where nobody has doors or rails these are told, too
    assert told - {"boarding", "conflict_with_rail", "leaving_stop"} == TELLABLE_WORDS["123d"]


@pytest.mark.parametrize(
    ("labels", "label", "said"),
    [
        ("somewhere.Labels", 0, "its labels are those of `Labels`"),
        (d123.AV2, 77, "a label is 77, which `AV2SensorBoxDetectionLabel` has not"),
    ],
)
def test_labels_that_are_not_known(tmp_path, labels, label, said):
    d123.drive(tmp_path)
    boxes, ego = [[d123.box("car", label, 30.0, 1.75)]], {0: d123.pose(5, 1.75)}
    with pytest.raises(RulecError) as refused:
        read_recording(d123.write_log(tmp_path, [0], boxes, ego, labels=labels))
    assert said in refused.value.diagnostics[0].message


def test_parts_that_are_missing(tmp_path):
    file = d123.drive(tmp_path)
    for name in ("ego_state_se3.arrow", "box_detections_se3.arrow"):
        (tmp_path / name).unlink()
        with pytest.raises(RulecError, match=f"there is no `{name}` beside it"):
            read_recording(file)


@pytest.mark.parametrize(
    ("value", "data"),
    [
        (5, b"\x05"),
        (-1, b"\xff"),
        (None, b"\xc0"),
        ("ab", b"\xa2ab"),
        (b"ab", b"\xc4\x02ab"),
        ([1, [2]], b"\x92\x01\x91\x02"),
        ({"a": 1.5}, b"\x81\xa1a\xcb\x3f\xf8\0\0\0\0\0\0"),
        (40_000, b"\xcd\x9c\x40"),
    ],
)
def test_message_pack(value, data):
    """The short forms; tests' files have the long ones."""
    assert unpacked(data) == value
    assert unpacked(d123.packed(value)) == value


@pytest.mark.parametrize(
    "data",
    [b"", b"\xc1", b"\x92\x01", b"\xdd\xff\xff\xff\xff", b"\x05\x05", b"\xd4\0\0", b"\xa1\xff"],
)
def test_what_is_no_message_pack(data):
    with pytest.raises(OddPackError):
        unpacked(data)


def test_values_within_values_are_bounded():
    unpacked(b"\x91" * 16 + b"\x01")
    for depth in (17, 100_000):
        with pytest.raises(OddPackError):
            unpacked(b"\x91" * depth + b"\x01")
