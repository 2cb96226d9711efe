"""Lanes of OpenDRIVE maps: kinds, marks, limits, neighbours, directions, and what they lead to."""

from math import pi

import numpy as np
import pytest

from rulec.recordings.map_files import read_map
from support.builders.opendrive_files import (
    cubic,
    document,
    geometry,
    lane,
    road,
    section,
    shared_map,
    two_way,
    written,
)


def lanelets(folder, *parts):
    return read_map(written(folder, document(*parts)), 0.1).lanelets


def test_right_hand_traffic(tmp_path):
    """Lanes right of the line lead along it, those left of it back."""
    lanes = section(lane(2), lane(1), lane(-1), lane(-2))
    file = written(tmp_path, document(road(7, lanes)))
    found = read_map(file, 0.1)
    assert (found.form, found.side) == ("OpenDRIVE map", "right")
    there = found.lanelets
    assert there.keys() == {"7.0.2", "7.0.1", "7.0.-1", "7.0.-2"}
    assert there["7.0.-1"].left[[0, -1]] == pytest.approx(np.array([(0, 0), (100, 0)]))
    assert there["7.0.-1"].right[[0, -1]] == pytest.approx(np.array([(0, -3.5), (100, -3.5)]))
    assert there["7.0.2"].left[[0, -1]] == pytest.approx(np.array([(100, 3.5), (0, 3.5)]))
    assert there["7.0.2"].right[[0, -1]] == pytest.approx(np.array([(100, 7), (0, 7)]))
    beside = {name: (x.left_of, x.right_of) for name, x in there.items()}
    assert beside == {
        "7.0.-1": (None, "7.0.-2"),
        "7.0.-2": ("7.0.-1", None),
        "7.0.1": (None, "7.0.2"),
        "7.0.2": ("7.0.1", None),
    }


def test_a_lane_that_narrows_within_a_micrometre(tmp_path):
    """Such a piece, as tools write it, has huge coefficients, though its widths are none."""
    step, width = 1e-6, 3.5
    narrows = cubic("width", "sOffset", 0, width, 0, -3 * width / step**2, 2 * width / step**3)
    parts = (
        section(lane(-1), lane(-2)),
        section(lane(-1), lane(-2, width=narrows), start=60),
        section(lane(-1), start=60 + step),
    )
    there = lanelets(tmp_path, road(1, *parts))
    assert there["1.0.-2"].centre[[0, -1]] == pytest.approx(np.array([(0, -5.25), (60, -5.25)]))
    assert there["1.2.-1"].centre[[0, -1]] == pytest.approx(np.array([(60, -1.75), (100, -1.75)]))


def test_left_hand_traffic(tmp_path):
    """Lanes left of the line lead along it; the outer lane is on the left."""
    lanes = section(lane(2), lane(1, mark="broken"), lane(-1))
    found = read_map(written(tmp_path, document(road(7, lanes, attributes='rule="LHT"'))), 0.1)
    assert found.side == "left"
    own, outer, back = (found.lanelets[f"7.0.{number}"] for number in (1, 2, -1))
    assert own.centre[[0, -1]] == pytest.approx(np.array([(0, 1.75), (100, 1.75)]))
    assert back.centre[0] == pytest.approx((100, -1.75))
    assert (own.left_of, own.right_of, outer.right_of) == ("7.0.2", None, "7.0.1")
    assert (own.left_mark, outer.right_mark) == ("broken", "broken")


def test_sides_that_differ(tmp_path):
    parts = road(1, two_way()), road(2, two_way(), attributes='rule="LHT"')
    found = read_map(written(tmp_path, document(*parts)), 0.1)
    assert found.side is None
    assert "to the left on some roads" in found.remarks[0]


@pytest.mark.parametrize(
    ("kind", "types"),
    [
        ("driving", set()),
        ("entry", {"accessRamp"}),
        ("onRamp", {"accessRamp"}),
        ("exit", {"exitRamp"}),
        ("offRamp", {"exitRamp"}),
        ("stop", {"shoulder"}),
        ("shoulder", {"border"}),
        ("bus", {"busLane"}),
        ("biking", {"bicycleLane"}),
        ("sidewalk", {"sidewalk"}),
        ("parking", {"parking"}),
        ("restricted", {"restricted_area"}),
        ("tram", {"restricted_area", "rail"}),
    ],
)
def test_kinds(tmp_path, kind, types):
    assert lanelets(tmp_path, road(1, section(lane(-1, kind=kind))))["1.0.-1"].types == types


def test_unknown_kinds_are_said(tmp_path):
    lanes = section(lane(-1), lane(-2, kind="moat"), lane(-3, kind="none"))
    found = read_map(written(tmp_path, document(road(1, lanes))), 0.1)
    assert found.lanelets.keys() == {"1.0.-1", "1.0.-2"}
    assert found.lanelets["1.0.-2"].types == {"border"}
    assert found.remarks == ("lanes of these types are treated as beside the carriageway: `moat`",)


def test_a_lane_for_buses_by_access(tmp_path):
    access = '<access sOffset="0" rule="allow" restriction="bus"/>'
    since_1_8 = '<access sOffset="0" rule="allow"><restriction type="bus"/></access>'
    deny = '<access sOffset="0" rule="deny" restriction="bus"/>'
    shared = access + access.replace("bus", "bicycle")
    taxis = access + access.replace("bus", "taxi")
    kinds = enumerate((access, since_1_8, deny, shared, taxis), 1)
    lanes = section(*(lane(-number, more=more) for number, more in kinds))
    found = lanelets(tmp_path, road(1, lanes))
    types = [found[f"1.0.-{number}"].types for number in range(1, 6)]
    buses = {"busLane", "busesOnly"}
    assert types[:4] == [buses, buses, set(), buses | {"cyclesAllowed"}]
    assert types[4] == buses | {"taxisAllowed"}


def test_a_lane_for_both_directions(tmp_path):
    lanes = section(lane(1), lane(-1, kind="bidirectional"), lane(-2))
    found = lanelets(tmp_path, road(1, lanes))
    there, back = found["1.0.-1"], found["1.0.-1.r"]
    assert there.centre == pytest.approx(back.centre[::-1])
    assert (found["1.0.-2"].left_of, found["1.0.1"].left_of) == ("1.0.-1", "1.0.-1.r")
    assert (there.right_of, back.right_of) == ("1.0.-2", "1.0.1")


def test_a_lane_that_is_reversed(tmp_path):
    lanes = section(lane(-1, attributes='direction="reversed"'), lane(-2))
    found = lanelets(tmp_path, road(1, lanes))
    assert found["1.0.-1"].centre[0] == pytest.approx((100, -1.75))
    assert found["1.0.-2"].left_of is None


@pytest.mark.parametrize(
    ("mark", "inner", "outer"),
    [
        ("solid", "solid", "solid"),
        ("broken", "broken", "broken"),
        ("solid solid", "double_solid", "double_solid"),
        ("solid broken", "solid", "broken"),
        ("broken solid", "broken", "solid"),
        ("none", "none", "none"),
        ("curb", None, None),
        ("", None, None),
    ],
)
def test_marks(tmp_path, mark, inner, outer):
    """From inside to outside; the centre lane's from left to right."""
    lanes = section(lane(2), lane(1, mark=mark), lane(0, mark=mark), lane(-1, mark=mark), lane(-2))
    found = lanelets(tmp_path, road(1, lanes))
    assert (found["1.0.-1"].right_mark, found["1.0.-2"].left_mark) == (inner, outer)
    assert (found["1.0.1"].right_mark, found["1.0.2"].left_mark) == (inner, outer)
    assert (found["1.0.1"].left_mark, found["1.0.-1"].left_mark) == (inner, outer)


def test_marks_that_change(tmp_path):
    """A lane section is cut there, for all its lanes."""
    marks = "".join(
        f'<roadMark sOffset="{s}" type="{kind}"/>'
        for s, kind in ((0, "solid"), (30, "broken"), (60, "broken"), (99.5, "solid"))
    )
    found = lanelets(tmp_path, road(1, section(lane(1), lane(-1, more=marks), lane(-2))))
    assert sorted(found) == ["1.0.-1", "1.0.-2", "1.0.1", "1.1.-1", "1.1.-2", "1.1.1"]
    assert (found["1.0.-1"].right_mark, found["1.1.-1"].right_mark) == ("solid", "broken")
    assert found["1.0.-1"].centre[-1] == pytest.approx((30, -1.75))
    assert found["1.0.-1"].successors == ("1.1.-1",)
    assert found["1.1.1"].successors == ("1.0.1",)
    assert found["1.1.-2"].predecessors == ("1.0.-2",)
    assert found["1.1.-2"].left_of == "1.1.-1"


def test_limits(tmp_path):
    """Of the lane, else of the road; in miles, kilometres, and m/s without a unit."""
    of_road = '<type s="0" type="town"><speed max="30" unit="mph"/></type>'
    of_road += '<type s="50" type="rural"><speed max="no limit"/></type>'
    own = '<speed sOffset="0" max="72" unit="km/h"/>'
    plain = '<speed sOffset="0" max="10"/>'
    lanes = section(lane(-1), lane(-2, more=own), lane(-3, more=plain))
    found = lanelets(tmp_path, road(1, lanes, more=of_road))
    assert found["1.0.-1"].limit_mps == pytest.approx(30 * 1609.344 / 3600)
    assert found["1.1.-1"].limit_mps == np.inf
    assert [found[f"1.0.{n}"].limit_mps for n in (-2, -3)] == pytest.approx([20, 10])
    assert found["1.0.-1"].types == {"urban"}
    assert found["1.1.-1"].types == {"country"}


def test_a_motorway_with_ramps(tmp_path):
    kind = '<type s="0" type="motorway"/>'
    more = f'{kind}<objects><tunnel s="40" length="60" id="t" type="standard"/></objects>'
    lanes = section(lane(-1), lane(-2, kind="entry"))
    found = lanelets(tmp_path, road(1, lanes, more=more))
    assert found["1.0.-1"].types == {"highway", "mainCarriageWay"}
    assert found["1.0.-2"].types == {"highway", "accessRamp"}
    assert found["1.1.-1"].types == {"highway", "mainCarriageWay", "tunnel"}


def test_lane_sections(tmp_path):
    """A second lane begins between them; links of either side will do."""
    first = section(lane(-1, links="successor=-2"))
    wider = cubic("width", "sOffset", 0, 0, 0.1)
    second = section(lane(-1, width=wider), lane(-2), start=40)
    found = lanelets(tmp_path, road(1, first, second))
    assert found["1.0.-1"].successors == ("1.1.-2",)
    assert found["1.1.-2"].predecessors == ("1.0.-1",)
    assert found["1.1.-1"].predecessors == ()
    assert found["1.1.-1"].right[0] == pytest.approx((40, 0))
    assert found["1.1.-1"].right[-1] == pytest.approx((100, -6))


def test_a_section_of_one_side_only(tmp_path):
    """The other side goes on: a lane that widens by 0.1 m in 10 m does so throughout."""
    width = cubic("width", "sOffset", 0, 3, 0.01)
    first = section(lane(1, width=width), lane(-1, links="successor=-2"))
    second = section(lane(-1), lane(-2), start=40, attributes='singleSide="true"')
    found = lanelets(tmp_path, road(1, first, second))
    assert found["1.1.1"].successors == ("1.0.1",)
    assert found["1.0.-1"].successors == ("1.1.-2",)
    assert found["1.1.1"].right[0] == pytest.approx((100, 4))
    assert found["1.1.1"].right[-1] == pytest.approx((40, 3.4))


def test_a_section_without_a_length_is_passed_over(tmp_path):
    sections = [section(lane(-1, links="successor=-1"), start=s) for s in (0, 50, 50.001)]
    found = lanelets(tmp_path, road(1, *sections))
    assert found.keys() == {"1.0.-1", "1.2.-1"}
    assert found["1.0.-1"].successors == ("1.2.-1",)
    assert found["1.2.-1"].predecessors == ("1.0.-1",)


def test_roads_end_to_end_that_are_drawn_towards_each_other(tmp_path):
    """Two roads meet with their ends: right lanes of the one are left lanes of the other."""
    lanes = section(lane(1, links="successor=-1"), lane(-1, links="successor=1"))
    turned = geometry(x=200, hdg=np.pi)
    one = road(1, lanes, links="successor=road:2:end")
    other = road(2, lanes, plan=turned, links="successor=road:1:end")
    found = lanelets(tmp_path, one, other)
    assert found["1.0.-1"].successors == ("2.0.1",)
    assert found["2.0.-1"].successors == ("1.0.1",)
    assert found["1.0.1"].successors == ()
    assert found["1.0.-1"].centre[-1] == pytest.approx(found["2.0.1"].centre[0])


def test_a_long_road_is_cut(tmp_path):
    plan = geometry(length=12_000)
    found = lanelets(tmp_path, road(1, section(lane(-1)), plan=plan, length=12_000))
    assert list(found) == ["1.0.-1", "1.1.-1", "1.2.-1"]
    assert found["1.1.-1"].successors == ("1.2.-1",)


@pytest.mark.skipif(shared_map("e6mini-lht") is None, reason="OpenDRIVE's maps are not here")
def test_left_hand_traffic_of_a_real_map():
    found = read_map(shared_map("e6mini-lht"), 0.1)
    other = read_map(shared_map("e6mini"), 0.1)
    assert (found.side, other.side) == ("left", "right")
    # The same road: where it is driven along here, it is driven back there
    for name, lanelet in found.lanelets.items():
        assert lanelet.centre == pytest.approx(other.lanelets[name].centre[::-1], abs=1e-6)


@pytest.mark.parametrize(
    ("y", "rule", "side"),
    [(-7, "", "left"), (0, "", "right"), (-7, 'rule="RHT"', "right"), (-30, "", "right")],
)
def test_the_side_that_lanes_show_where_no_road_tells_it(tmp_path, y, rule, side):
    """A lane leads east, right of y = 0; another back, right of its own line, which is north of it.

    Those from y = -7 on have the border at -3.5 in common, on the right of both.
    """
    there = road(1, section(lane(-1)), attributes=rule)
    back = road(2, section(lane(-1)), plan=geometry(x=100, y=y, hdg=pi), attributes=rule)
    found = read_map(written(tmp_path, document(there, back)), 0.1)
    assert found.side == side
    assert any("as its lanes show" in x for x in found.remarks) == (side == "left")


@pytest.mark.parametrize(
    ("minor", "lanes", "side"),
    [(4, (-1,), None), (6, (-1,), "right"), (4, (1, -1), "right"), (5, (-1,), "right")],
)
def test_the_side_of_a_version_in_which_no_road_can_tell_it(tmp_path, minor, lanes, side):
    text = document(road(1, section(*map(lane, lanes))))
    text = text.replace('revMinor="6"', f'revMinor="{minor}"')
    found = read_map(written(tmp_path, text), 0.1)
    assert found.side == side
    assert any("does not give the side" in x for x in found.remarks) == (side is None)


def test_a_lane_is_on_the_side_that_its_number_says(tmp_path):
    """SUMO's netconvert writes lanes of ways on which traffic keeps left among those of `left`."""
    text = document(road(1, section(lane(-1))))
    as_written = read_map(written(tmp_path, text), 0.1).lanelets["1.0.-1"]
    moved = text.replace("right>", "left>")
    found = read_map(written(tmp_path, moved), 0.1).lanelets["1.0.-1"]
    assert found.centre.tolist() == as_written.centre.tolist()
