"""ScenarioNet's scenarios: what a recording makes of them, whatever data set they are from."""

import copy
from pathlib import Path

import numpy as np
import pytest

from rulec import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.recordings.encodings.wire_format import WireFile
from rulec.recordings.recording_files import read_recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.waymo.waymo_file import WAYMO
from support.builders import scenarionet_files
from support.builders import waymo_files as w
from support.builders.scene_verdicts import verdicts

CROSSING = w.crossing(id="4a")
DICTIONARY = scenarionet_files.from_waymo(WireFile(CROSSING, Path("some"), WAYMO))


def read(tmp_path, dictionary, name="sd_some.pkl"):
    path = scenarionet_files.write(tmp_path / name, dictionary)
    return read_recording(RecordingSource(path))


def waymo(tmp_path, content=CROSSING):
    path = tmp_path / "some.tfrecord"
    path.write_bytes(w.record(content))
    return read_recording(RecordingSource(path))


def changed(**metadata):
    """The scenario as one of another data set."""
    dictionary = copy.deepcopy(DICTIONARY)
    dictionary["metadata"].update(metadata)
    return dictionary


def same_lanelets(one, other):
    assert one.keys() == other.keys()
    for own, its in zip(one.values(), other.values(), strict=True):
        for line in ("left", "right", "centre"):
            assert (getattr(own, line) == getattr(its, line)).all()
        assert (own.stop_line is None) == (its.stop_line is None)
        for field in ("id", "successors", "predecessors", "left_of", "right_of", "types", "signs"):
            assert getattr(own, field) == getattr(its, field)
        for field in ("limit_mps", "lights", "lights_to", "left_mark", "right_mark"):
            assert getattr(own, field) == getattr(its, field)


def test_a_scene_of_waymo_s_is_the_same_in_both_formats(tmp_path):
    one, other = waymo(tmp_path), read(tmp_path, DICTIONARY)
    same_lanelets(one.lanelets, other.lanelets)
    for field in ("name", "step_s", "side", "country", "complete", "ego", "remarks"):
        assert getattr(one, field) == getattr(other, field)
    for own, its in zip(one.participants, other.participants, strict=True):
        assert (own.id, own.type) == (its.id, its.type)
        assert dict(own.states) == dict(its.states)


def test_both_are_judged_alike_and_as_was_thought_out(tmp_path):
    """Car 70 drives past its light at 3 s, which is red for 4.1 s; 71 past its stop sign at 5 s."""
    rulebook = compile_rulebook("us-ca")
    found = verdicts(waymo(tmp_path), rulebook)
    assert found == verdicts(read(tmp_path, DICTIONARY), rulebook)
    violated = {ego: {rule for rule, *_ in own} for (ego, _), (own, *_) in found.items()}
    assert {name: own & {"red_light", "stop_sign"} for name, own in violated.items()} == {
        "70": {"red_light"},
        "71": {"stop_sign"},
    }


def test_what_the_conversion_has_made_up_is_missing(tmp_path):
    """Of nuScenes marks, limits and stop signs are not the map's."""
    found = read(tmp_path, changed(dataset="nuscenes", map="singapore-queenstown"))
    assert found.side == "left"
    assert found.country == "SGP"
    assert found.complete == {"junctions"}
    lane = found.lanelets["1"]
    assert (lane.limit_mps, lane.left_mark, lane.stop_line) == (None, None, None)
    assert not any(x.signs for x in found.lanelets.values())
    assert found.form == "ScenarioNet scenario"


@pytest.mark.parametrize(
    ("map_name", "side", "country"),
    [
        ("boston-seaport", "right", "USA"),
        ("singapore-onenorth", "left", "SGP"),
        ("sg-one-north", "left", "SGP"),
        ("us-nv-las-vegas-strip", "right", "USA"),
        ("elsewhere", None, ""),
    ],
)
def test_sides_of_traffic_by_the_map_s_name(tmp_path, map_name, side, country):
    found = read(tmp_path, changed(dataset="nuplan", map=map_name))
    assert (found.side, found.country) == (side, country)


def test_nuscenes_ego_is_turned_and_moved_to_its_middle(tmp_path):
    dictionary = changed(dataset="nuscenes", map="boston-seaport")
    state = dictionary["tracks"]["70"]["state"]
    state["length"], state["width"] = state["width"], state["length"]
    found = read(tmp_path, dictionary)
    ego = found.participants[0]
    # A Zoe's middle is 2.042 m before its rear end, its rear axle 0.657 m
    assert ego.states[40].x == pytest.approx(1.385)
    assert np.ptp(ego.outlines[40], axis=0) == pytest.approx([4.5, 1.9])
    assert len(found.remarks) == 2


def test_lanes_without_successors_lead_to_those_that_begin_where_they_end(tmp_path):
    dictionary = changed(dataset="nuscenes", map="boston-seaport")
    for feature in dictionary["map_features"].values():
        for key in ("entry_lanes", "exit_lanes"):
            feature.pop(key, None)
    lanelets = read(tmp_path, dictionary).lanelets
    assert [lanelets[name].successors for name in ("1", "2", "3", "7")] == [("2",), ("3",), (), ()]
    assert lanelets["5"].predecessors == ("4",)


def test_lanes_lead_to_none_that_begins_beside_their_end(tmp_path):
    """MetaDrive's lead to all lanes of the next road; to get to another one is a lane change."""
    dictionary = changed(dataset="metadrive")
    lanes = {}
    for name, begin, y in (("1", -60.0, 0.0), ("2", -60.0, 3.5), ("3", 0.0, 0.0), ("4", 0.5, 3.5)):
        line = [[begin + 6 * k, y] for k in range(11)]
        after, before = (["3", "4"], []) if begin < -1 else ([], ["1", "2"])
        lanes[name] = {"type": "LANE_SURFACE_STREET", "polyline": line, "width": 3.5}
        lanes[name] |= {"exit_lanes": after, "entry_lanes": before}
    dictionary["map_features"], dictionary["dynamic_map_states"] = lanes, {}
    lanelets = read(tmp_path, dictionary).lanelets
    assert [lanelets[name].successors for name in "1234"] == [("3",), ("4",), (), ()]
    # A gap of half a metre along the lane is none between lanes
    assert [lanelets[name].predecessors for name in "1234"] == [(), (), ("1",), ("2",)]


def test_bounds_are_those_of_a_lane_s_own_outline(tmp_path):
    dictionary = changed(dataset="nuscenes", map="boston-seaport")
    outline = [(-61, 1.5), (-9, 1.5), (-9, -1.2), (-61, -1.2), (-61, 1.5)]
    dictionary["map_features"]["1"]["polygon"] = [list(map(float, place)) for place in outline]
    lane = read(tmp_path, dictionary).lanelets["1"]
    assert lane.left[:, 1] == pytest.approx(1.5)
    assert lane.right[:, 1] == pytest.approx(-1.2)


def two_lanes_of_nuplan():
    """Two lanes side by side, each by its ends and outline alone, which nobody calls neighbours."""
    dictionary = changed(dataset="nuplan", map="us-ma-boston")
    dictionary["dynamic_map_states"] = {}
    lanes = {}
    for name, y in (("1", 0.0), ("2", 3.2)):
        low, high = y - 1.6, y + 1.6
        outline = [[-60.0, low], [40.0, low], [40.0, high], [-60.0, high], [-60.0, low]]
        ends = [[-60.0, y], [40.0, y]]
        lanes[name] = {"type": "LANE_SURFACE_STREET", "polyline": ends, "polygon": outline}
    dictionary["map_features"] = lanes
    return dictionary


def test_lanes_side_by_side_are_neighbours_where_the_conversion_names_none(tmp_path):
    found = read(tmp_path, two_lanes_of_nuplan())
    assert (found.lanelets["1"].left_of, found.lanelets["2"].right_of) == ("2", "1")
    assert found.lanelets["1"].left[:, 1] == pytest.approx(1.6)
    (remark,) = found.remarks
    assert "1 and 2" in remark


@pytest.mark.parametrize(("drawn", "kept"), [(False, False), (True, True)])
def test_of_crossings_nothing_is_told_where_the_conversion_leaves_them_out(tmp_path, drawn, kept):
    """Nobody is about: where crossings are told, ego keeps the rules of crossings."""
    dictionary = two_lanes_of_nuplan()
    if drawn:
        ring = [[0.0, -2.0], [4.0, -2.0], [4.0, 6.0], [0.0, 6.0]]
        dictionary["map_features"]["9"] = {"type": "CROSSWALK", "polygon": ring}
    recording = read(tmp_path, dictionary)
    told = selected_drives(recording, RequestedDrives(), "some", "right").told_words()
    words = {"crossing_zone", "distance_to_crossing", "nearest_to_crossing"}
    assert (words <= told, bool(words & told)) == (kept, kept)


def test_lights_of_nuplan(tmp_path):
    dictionary = changed(dataset="nuplan", map="us-ma-boston")
    words = ["TRAFFIC_LIGHT_RED", "TRAFFIC_LIGHT_GREEN", "TRAFFIC_LIGHT_UNKNOWN", None]
    dictionary["dynamic_map_states"]["2"]["state"]["object_state"][:4] = words
    (light,) = read(tmp_path, dictionary).lanelets["1"].lights
    assert [light.colour_at(k) for k in range(4)] == ["red", "green", "", ""]


def test_cones_stand_for_good(tmp_path):
    dictionary = copy.deepcopy(DICTIONARY)
    dictionary["tracks"]["71"]["type"] = "TRAFFIC_CONE"
    cone = read(tmp_path, dictionary).participants[1]
    assert (cone.standing, len(cone.states), cone.object_types) == (True, 1, ("obstacle",))


def test_where_nobody_was_seen_anything_may_be_written(tmp_path):
    """As NaN, in arrays and in lists."""
    dictionary = copy.deepcopy(DICTIONARY)
    state = dictionary["tracks"]["70"]["state"]
    state["valid"][40:43] = 0
    expected = read(tmp_path, copy.deepcopy(dictionary)).participants[0]
    for key in ("position", "velocity", "heading", "length", "width"):
        state[key] = np.array(state[key], dtype=float)
        state[key][40:43] = np.nan
    state["heading"] = state["heading"].tolist()
    found = read(tmp_path, dictionary).participants[0]
    assert list(found.states.items()) == list(expected.states.items())
    assert len(found.states) == 81


def test_ids_may_be_whole_numbers(tmp_path):
    dictionary = copy.deepcopy(DICTIONARY)
    ego = read(tmp_path, copy.deepcopy(dictionary)).ego
    dictionary["tracks"] = {int(name): track for name, track in dictionary["tracks"].items()}
    assert ego
    assert read(tmp_path, dictionary).ego == ego


def test_states_of_a_light_that_are_no_words_have_no_colour(tmp_path):
    """Lists of several lengths among them."""
    dictionary = copy.deepcopy(DICTIONARY)
    shown = dictionary["dynamic_map_states"]["2"]["state"]
    shown["object_state"] = [["a"], ["a", "b"], *list(shown["object_state"])[2:]]
    lights = [
        light for lane in read(tmp_path, dictionary).lanelets.values() for light in lane.lights
    ]
    assert lights
    assert not any(light.colour_at(step) for light in lights for step in (0, 1))


def _set(*keys_and_value):
    *keys, last, value = keys_and_value

    def change(dictionary):
        for key in keys:
            dictionary = dictionary[key]
        dictionary[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (_set("tracks", {}), "`tracks` contains no road users"),
        (_set("tracks", []), "`tracks` is no dictionary"),
        (_set("tracks", "70", "state", "valid", np.ones(90)), "has 90 states for 81 times"),
        (_set("tracks", "70", "state", "heading", np.ones(3)), "`tracks / 70 / state / heading`"),
        (_set("tracks", "70", "state", "position", np.ones((81, 1))), "not that of points"),
        (
            _set("tracks", "70", "state", "position", np.full((81, 3), np.nan)),
            "a number that is not below",
        ),
        (_set("tracks", "70", "state", "length", np.zeros(81)), "no length or width"),
        (
            _set("tracks", "70", "state", "length", np.array(["a"] * 81)),
            "other things than numbers",
        ),
        (_set("metadata", "ts", np.zeros(81)), "its times do not ascend"),
        (_set("metadata", "ts", []), "there are no times"),
        (_set("metadata", "sdc_id", "99"), "ego is `99`"),
        (_set("metadata", "coordinate", "left-handed"), "left-handed"),
        (_set("metadata", None), "it has no `metadata`"),
        (_set("map_features", "1", "polyline", [[0, 0], [1]]), "rows of different lengths"),
        (_set("map_features", "1", "polyline", [["a", "b"]]), "other things than numbers"),
        (_set("map_features", "1", "polyline", [[0.0, 0.0], [3e4, 0.0]]), "longer than 20 km"),
        (_set("map_features", "1", "polyline", [[[0.0]]]), "other things than numbers"),
        (_set("map_features", "1", "polyline", [[10**18, 0]]), "a number that is not below"),
        (_set("map_features", "1", "polyline", [[10**400, 0]]), "a whole number of 167 bytes"),
        (_set("map_features", "1", "exit_lanes", [[1]]), "is no text"),
        (_set("map_features", "1", "exit_lanes", [[1], [1, 2]]), "exit_lanes / 0` is no text"),
        (_set("map_features", "1", "speed_limit_mph", [[1], [1, 2]]), "rows of different lengths"),
        (_set("tracks", 70, DICTIONARY["tracks"]["70"]), "`tracks` has the key `70` twice"),
        (_set("map_features", "1", "left_boundaries", [{"lane_start_index": "x"}]), "no whole"),
        (_set("map_features", "41", "polygon", np.zeros((2, 2))), "fewer than 3 corners"),
        (_set("dynamic_map_states", "2", "state", "object_state", ["a"] * 82), "82 states for 81"),
    ],
)
def test_what_is_refused(tmp_path, change, why):
    dictionary = copy.deepcopy(DICTIONARY)
    change(dictionary)
    with pytest.raises(RulecError) as caught:
        read(tmp_path, dictionary)
    assert [x.code for x in caught.value.diagnostics] == ["R0610"]
    assert why in str(caught.value)


def test_the_summary_of_a_data_set_is_no_scenario(tmp_path):
    with pytest.raises(RulecError, match="not of a scenario") as caught:
        read(tmp_path, {"sd_some.pkl": {"id": "a"}}, "dataset_summary.pkl")
    assert "not the summary of a data set" in str(caught.value.diagnostics[0].help)


def test_one_list_in_many_places_is_refused_in_time(tmp_path):
    """1,000 lanes whose centres are one list of 20,000 points would be 20 million."""
    points = [[0.1 * k, 0.0] for k in range(20_000)]
    dictionary = copy.deepcopy(DICTIONARY)
    dictionary["map_features"] = {
        str(k): {"type": "LANE_SURFACE_STREET", "polyline": points} for k in range(1000)
    }
    with pytest.raises(RulecError, match="more than 5,000,000 values"):
        read(tmp_path, dictionary)
