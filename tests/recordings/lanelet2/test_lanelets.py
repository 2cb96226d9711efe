"""Lanelets of Lanelet2 maps: where they lie, what leads where, and what their tags say."""

import math

import numpy as np
import pytest

from rulec.recordings.lanelet2.lane_tags import velocity
from rulec.recordings.map_files import read_map
from support.builders.lanelet2_files import MapFile, two_way_street


def lanelets_of(file, folder):
    return read_map(file.write(folder), 0.1).lanelets


def one_lane(folder, left=None, right=None, **tags):
    """The lanelet between lines with some tags, 50 m to the east and 4 m wide."""
    file = MapFile()
    on_left = file.line((0, 2), (50, 2), **(left or {"type": "road_border"}))
    on_right = file.line((0, -2), (50, -2), **(right or {"type": "road_border"}))
    name = file.lanelet(on_left, on_right, **tags)
    return lanelets_of(file, folder)[name]


def test_bounds_lead_as_traffic_does_whatever_way_lines_are_drawn(tmp_path):
    file, there, back = two_way_street()
    found = lanelets_of(file, tmp_path)
    assert found[there].left.tolist() == [[0, 0], [100, 0]]
    assert found[there].right.tolist() == [[0, -3], [100, -3]]
    assert found[there].centre.tolist() == [[0, -1.5], [100, -1.5]]
    # Its line is drawn eastwards; what is left of it has to lead west
    assert found[back].left.tolist() == [[100, 0], [0, 0]]
    assert found[back].right.tolist() == [[100, 3], [0, 3]]


def test_the_middle_is_at_the_same_part_of_either_bound(tmp_path):
    file = MapFile()
    left = file.line((0, 2), (20, 2), (40, 6))
    right = file.line((0, -2), (40, -2))
    name = file.lanelet(left, right)
    lanelet = lanelets_of(file, tmp_path)[name]
    bend = 20 / (20 + math.hypot(20, 4))
    expected = [[0, 0], [(20 + 40 * bend) / 2, 0], [40, 2]]
    assert np.allclose(lanelet.centre, expected)


def test_points_that_repeat_are_one(tmp_path):
    file = MapFile()
    left = file.line((0, 2), (0, 2), (50, 2))
    name = file.lanelet(left, file.line((0, -2), (50, -2)))
    assert lanelets_of(file, tmp_path)[name].left.tolist() == [[0, 2], [50, 2]]


@pytest.mark.parametrize(
    ("begins", "goes_on", "said"),
    [
        ((50.1, 0.1), False, True),
        ((50.1, 0.1), True, True),
        ((50.0, 0.0), False, False),
        ((50.4, 0), False, False),
    ],
)
def test_lanelets_that_nearly_meet_are_named(tmp_path, begins, goes_on, said):
    """The second one begins a tenth of a metre beside, and nothing leads to it."""
    file = MapFile()
    x, y = begins
    first = file.lanelet(file.line((0, 2), (50, 2)), file.line((0, -2), (50, -2)))
    second = file.lanelet(file.line((x, y + 2), (x + 40, 2)), file.line((x, y - 2), (x + 40, -2)))
    if goes_on:
        file.lanelet(file.line((50, 2), (90, 9)), file.line((50, -2), (90, 5)))
    remarks = " ".join(read_map(file.write(tmp_path), 0.1).remarks)
    assert (f"`{first}` and `{second}`" in remarks) == said
    assert ("share no nodes" in remarks) == said


def test_what_shares_two_nodes_follows(tmp_path):
    file = MapFile()
    bounds = [(file.line((x, 2), (x + 50, 2)), file.line((x, -2), (x + 50, -2))) for x in (0, 50)]
    first, second = (file.lanelet(*pair) for pair in bounds)
    # This one begins where the others meet, but only with one side
    elsewhere = file.lanelet(file.line((50, 2), (90, 9)), file.line((50, 0), (90, 5)))
    found = lanelets_of(file, tmp_path)
    assert found[first].successors == (second,)
    assert found[second].predecessors == (first,)
    assert found[elsewhere].predecessors == ()


def test_what_shares_a_line_is_beside_if_it_leads_the_same_way(tmp_path):
    file, there, back = two_way_street()
    outer = file.lanelet(2, file.line((0, -6), (100, -6)))
    path = file.lanelet(
        file.line((0, -6), (100, -6)), file.line((0, -8), (100, -8)), subtype="walkway"
    )
    found = lanelets_of(file, tmp_path)
    assert (found[there].right_of, found[outer].left_of) == (outer, there)
    assert found[there].left_of is None
    assert found[back].left_of is found[back].right_of is None
    assert found[outer].right_of is found[path].left_of is None


def test_a_lane_for_both_ways_is_two_lanelets(tmp_path):
    file = MapFile()
    left, right = file.line((0, 2), (50, 2), type="virtual"), file.line((0, -2), (50, -2))
    name = file.lanelet(left, right, one_way="no")
    on = file.lanelet(file.line((50, 2), (90, 2)), file.line((50, -2), (90, -2)), one_way="no")
    found = lanelets_of(file, tmp_path)
    against = found[f"{name}_reversed"]
    assert against.left.tolist() == [[50, -2], [0, -2]]
    assert against.right.tolist() == [[50, 2], [0, 2]]
    assert against.centre.tolist() == [[50, 0], [0, 0]]
    assert (against.left_mark, against.right_mark) == (None, "none")
    assert found[name].successors == (on,)
    assert found[f"{on}_reversed"].successors == (against.id,)
    assert against.predecessors == (f"{on}_reversed",)


def test_walkers_go_both_ways_on_one_lanelet(tmp_path):
    file = MapFile()
    name = file.lanelet(
        file.line((0, 2), (9, 2)), file.line((0, 0), (9, 0)), subtype="crosswalk", one_way="no"
    )
    assert list(lanelets_of(file, tmp_path)) == [name]


@pytest.mark.parametrize(
    ("tags", "types"),
    [
        ({}, {"urban"}),
        ({"location": "nonurban"}, {"rural"}),
        ({"location": "city"}, {"urban"}),
        ({"location": ""}, set()),
        ({"subtype": "highway", "location": "nonurban"}, {"highway", "rural"}),
        ({"subtype": "bus_lane"}, {"busLane", "urban"}),
        ({"subtype": "bicycle_lane"}, {"bicycleLane", "urban"}),
        ({"subtype": "road_shoulder"}, {"shoulder", "urban"}),
        ({"subtype": "emergency_lane"}, {"shoulder", "urban"}),
        ({"subtype": "crosswalk"}, {"crosswalk", "urban"}),
        ({"subtype": "walkway"}, {"sidewalk", "urban"}),
        ({"subtype": "stairs"}, {"sidewalk", "urban"}),
        ({"subtype": "exit"}, {"driveWay", "urban"}),
        ({"subtype": "rail"}, {"rail", "restricted_area", "urban"}),
        ({"turn_direction": "left"}, {"intersection", "urban"}),
        ({"participant__vehicle": "yes"}, {"urban"}),
        ({"participant__bicycle": "yes"}, {"bicycleLane", "urban"}),
        ({"participant__bicycle": "yes", "participant__pedestrian": "yes"}, {"sidewalk", "urban"}),
        ({"participant__vehicle__bus": "yes"}, {"busLane", "busesOnly", "urban"}),
        (
            {"participant__vehicle__bus": "yes", "participant__bicycle": "yes"},
            {"busLane", "busesOnly", "cyclesAllowed", "urban"},
        ),
        (
            {"participant__vehicle__bus": "yes", "participant__vehicle__taxi": "yes"},
            {"busLane", "busesOnly", "taxisAllowed", "urban"},
        ),
        ({"participant__vehicle__emergency": "yes"}, {"restricted_area", "urban"}),
        ({"participant__vehicle": "no"}, {"restricted_area", "urban"}),
        ({"subtype": "bus_lane", "participant__vehicle": "yes"}, {"urban"}),
        ({"subtype": "crosswalk", "participant__pedestrian": "yes"}, {"crosswalk", "urban"}),
    ],
)
def test_types(tmp_path, tags, types):
    assert one_lane(tmp_path, **tags).types == types


@pytest.mark.parametrize(
    ("tags", "limit_kmh"),
    [
        ({}, None),
        ({"speed_limit": "50"}, 50),
        ({"speed_limit": "30 mph"}, 30 * 1.609344),
        ({"speed_limit": "10mps"}, 36),
        ({"speed_limit": "30", "speed_limit_mandatory": "no"}, None),
        ({"speed_limit": "30", "speed_limit__vehicle": "50 km/h"}, 50),
        ({"subtype": "crosswalk", "speed_limit": "10"}, None),
    ],
)
def test_limits(tmp_path, tags, limit_kmh):
    found = one_lane(tmp_path, **tags).limit_mps
    assert found == (None if limit_kmh is None else pytest.approx(limit_kmh / 3.6))


@pytest.mark.parametrize("text", ["", "fast", "km/h", "nan", "inf", "-5", "1e999", "30 knots"])
def test_what_is_no_speed(text):
    assert velocity(text) is None


THIN = {"type": "line_thin"}


@pytest.mark.parametrize(
    ("tags", "above", "below"),
    [
        ({"type": "line_thin", "subtype": "solid"}, "solid", "solid"),
        ({"type": "line_thick", "subtype": "dashed"}, "broken", "broken"),
        ({"type": "line_thin", "subtype": "solid_solid"}, "double_solid", "double_solid"),
        # Its left is above; who is there may cross it, who is below may not
        ({"type": "line_thin", "subtype": "dashed_solid"}, "broken", "solid"),
        ({"type": "line_thin", "subtype": "solid_dashed"}, "solid", "broken"),
        ({"type": "virtual"}, "none", "none"),
        ({"type": "curbstone", "subtype": "high"}, None, None),
        ({"type": "line_thin"}, None, None),
        ({"type": "line_thin", "lane_change": "no"}, "solid", "solid"),
        ({"type": "line_thin", "lane_change": "yes"}, "broken", "broken"),
        ({"type": "line_thin", "subtype": "solid", "lane_change": "no"}, "solid", "solid"),
        ({"type": "line_thin", "subtype": "solid", "lane_change": "yes"}, None, None),
        (
            {**THIN, "lane_change__left": "no", "lane_change__right": "yes"},
            "broken",
            "solid",
        ),
        ({"type": "line_thin", "subtype": "zigzag"}, None, None),
    ],
)
@pytest.mark.parametrize("drawn_back", [False, True])
def test_marks(tmp_path, tags, above, below, drawn_back):
    file = MapFile()
    places = [(0, 0), (50, 0)]
    line = file.line(*(places[::-1] if drawn_back else places), **tags)
    upper = file.lanelet(file.line((0, 3), (50, 3)), line)
    lower = file.lanelet(line, file.line((0, -3), (50, -3)))
    found = lanelets_of(file, tmp_path)
    if drawn_back and above != below:
        # What was drawn on its left lies below now
        above, below = below, above
        assert {above, below} in ({"solid", "broken"},)
    assert (found[upper].right_mark, found[lower].left_mark) == (above, below)
