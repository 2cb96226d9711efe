"""Lanelets of Argoverse 2's maps, thought out by hand on a small town."""

import json

import numpy as np
import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.argoverse.map_archive import MARKS, read_map_archive
from rulec.recordings.map_files import read_map
from support.builders.argoverse_files import along, line, segment, town, write_map


@pytest.fixture
def lanelets(tmp_path):
    return read_map_archive(write_map(tmp_path)).lanelets


def test_a_map_is_of_the_united_states(tmp_path):
    road = read_map(write_map(tmp_path), 0.1)
    assert (road.side, road.country, road.form) == ("right", "USA", "Argoverse 2 map")
    assert road.complete == frozenset()


def test_a_mark_of_the_order_of_bytes_is_none_of_the_map(tmp_path):
    path = write_map(tmp_path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert read_map(path, 0.1).lanelets.keys() == read_map(write_map(tmp_path), 0.1).lanelets.keys()


def test_bounds_keep_their_points_and_have_as_many(lanelets):
    lane = lanelets["10"]
    assert lane.left.tolist() == [[0, 0], [30, 0], [60, 0]]
    assert lane.right.tolist() == [[0, -3.5], [30, -3.5], [60, -3.5]]
    assert lane.centre.tolist() == [[0, -1.75], [30, -1.75], [60, -1.75]]


def test_a_neighbour_leads_the_same_way(lanelets):
    assert (lanelets["10"].left_of, lanelets["10"].right_of) == (None, "11")
    assert (lanelets["11"].left_of, lanelets["11"].right_of) == ("10", None)
    assert lanelets["20"].left_of is None


def test_ways_on_lead_to_what_is_on_the_map_and_back(lanelets):
    assert lanelets["10"].successors == ("12",)
    # The file does not say it; the other lane's successor does
    assert lanelets["12"].predecessors == ("10",)


def test_marks_and_types(lanelets):
    assert (lanelets["10"].left_mark, lanelets["10"].right_mark) == ("double_solid", "broken")
    assert (lanelets["12"].left_mark, lanelets["12"].right_mark) == ("none", "none")
    assert lanelets["12"].types == {"intersection"}
    assert lanelets["10"].types == frozenset()


@pytest.mark.parametrize(
    ("kind", "mark"),
    [
        ("SOLID_DASH_WHITE", "solid"),
        ("DASH_SOLID_YELLOW", "broken"),
        ("DOUBLE_DASH_WHITE", "broken"),
        ("DOUBLE_SOLID_YELLOW", "double_solid"),
        ("SOLID_BLUE", None),
        ("UNKNOWN", None),
    ],
)
def test_a_mark_is_the_line_on_the_lanes_own_side(kind, mark):
    assert MARKS.get(kind) == mark


@pytest.mark.parametrize(("kind", "type_"), [("BIKE", "bicycleLane"), ("BUS", "busLane")])
def test_lanes_of_others(tmp_path, kind, type_):
    content = town()
    content["lane_segments"]["11"]["lane_type"] = kind
    assert read_map_archive(write_map(tmp_path, content)).lanelets["11"].types == {type_}


def test_a_crossing_lies_between_its_edges_whichever_way_they_lead(lanelets):
    crossing = lanelets["30"]
    assert crossing.types == {"crosswalk"}
    # Upward along the first edge: its left is where x is less
    assert crossing.left.tolist() == [[38, -8], [38, 5]]
    assert crossing.right.tolist() == [[42, -8], [42, 5]]


def test_what_is_cut_to_a_point_is_no_lane(tmp_path):
    content = town()
    content["lane_segments"]["13"] = segment(13, line((9, 9), (9, 9)), line((9, 8), (8, 8)))
    content["lane_segments"]["10"]["successors"] = [13]
    lanelets = read_map_archive(write_map(tmp_path, content)).lanelets
    assert "13" not in lanelets
    assert lanelets["10"].successors == ()


def test_uneven_bounds_are_paired_by_their_lengths(tmp_path):
    content = {"lane_segments": {"1": segment(1, line((0, 0), (9, 0), (10, 0)), along(0, 20, -4))}}
    lane = read_map_archive(write_map(tmp_path, content)).lanelets["1"]
    assert lane.left.tolist() == [[0, 0], [9, 0], [10, 0]]
    assert lane.right.tolist() == [[0, -4], [18, -4], [20, -4]]


def changed(**more):
    content = town()
    content["lane_segments"]["10"] |= more
    return content


BAD = {
    "no lanes": ({"lane_segments": {}}, "there is no lane segment in it"),
    "no map": ([], "Expected `object`"),
    "lane type": (changed(lane_type="TRAM"), "lane segment 10 is of type `TRAM`"),
    "one point": (changed(left_lane_boundary=line((1, 1))), "fewer than two points"),
    "far away": (changed(left_lane_boundary=along(0, 1e9, 1)), "not on earth"),
    "long": (changed(left_lane_boundary=along(0, 30_000, 1)), "longer than 20 km"),
    "twice": (changed(id=11), "`11` is in it twice"),
    "a text": (changed(is_intersection="yes"), "is_intersection"),
    "no bound": (changed(left_lane_boundary=None), "left_lane_boundary"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_is_refused(tmp_path, name):
    content, why = BAD[name]
    path = write_map(tmp_path, content)
    with pytest.raises(RulecError) as caught:
        read_map_archive(path)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    assert found.place.file == str(path)
    assert why in found.message


@pytest.mark.parametrize(
    "text",
    ["", "{", "[" * 100_000, '{"lane_segments": ' * 5000, '{"a": 1e999}', "NaN", "\xff\xfe"],
)
def test_what_is_no_json_is_refused(tmp_path, text):
    path = write_map(tmp_path)
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(RulecError) as caught:
        read_map_archive(path)
    assert caught.value.diagnostics[0].code == "R0610"


def test_a_number_of_many_digits_is_refused(tmp_path):
    path = write_map(tmp_path)
    path.write_text(json.dumps(town()).replace('"id": 10,', f'"id": {"9" * 9000},'))
    with pytest.raises(RulecError):
        read_map_archive(path)


def test_places_are_floats(lanelets):
    assert {x.left.dtype for x in lanelets.values()} == {np.dtype(float)}
