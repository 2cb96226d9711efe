"""Lanes of traces as lanelets: their direction, bounds, marks, connections and intersections."""

import numpy as np
import pytest

from rulec import read_recording
from support.builders import osi_traces as osi
from support.builders.wire_bytes import counted, double, whole


@pytest.fixture
def read(tmp_path):
    def reading(*parts, **more):
        file = tmp_path / "some.osi"
        body = osi.vehicle(7, 10, 0)
        file.write_bytes(osi.trace([osi.ground_truth(0, body, *parts, **more)]))
        return read_recording(file)

    return reading


def both(number, y, **more):
    """A lane of 100 m along the x axis, 4 m wide, with its boundaries; then what more it has."""
    forward = more.pop("forward", True)
    lines = {"left_line": [number * 10 + 1], "right_line": [number * 10 + 2]}
    kinds = more.pop("kinds", (3, 3))
    parts = osi.lane(number, [(0, y), (100, y)], forward, **lines, **more)
    for one, side, kind in ((1, 2, kinds[0]), (2, -2, kinds[1])):
        parts += osi.boundary(number * 10 + one, [(0, y + side), (100, y + side)], kind)
    return parts


def test_a_lane_against_the_order_of_its_points(read):
    # Points run along x, and traffic on lane 1 against them: its left is where y is lower
    found = read(
        both(1, 4, forward=False, right=[2], kinds=(6, 4)), both(2, 0, left=[1], kinds=(4, 3))
    )
    own, other = found.lanelets["1"], found.lanelets["2"]
    np.testing.assert_allclose(own.centre, [(100, 4), (0, 4)])
    np.testing.assert_allclose(own.left, [(100, 2), (0, 2)])
    np.testing.assert_allclose(own.right, [(100, 6), (0, 6)])
    assert (own.left_mark, own.right_mark) == ("broken", None)
    assert (other.left_mark, other.right_mark) == ("broken", "solid")
    # They lead different ways, and pass each other on the right
    assert (own.left_of, other.left_of) == (None, None)
    assert found.side == "right"


def test_lanes_that_lead_the_same_way_are_neighbours(read):
    found = read(both(1, 4, right=[2]), both(2, 0, left=[1]), country=826)
    assert (found.lanelets["1"].right_of, found.lanelets["2"].left_of) == ("2", "1")
    assert (found.side, found.country) == ("left", "GBR")


def test_without_a_country_and_oncoming_traffic_the_side_is_the_usual_one(read):
    assert read(both(1, 0)).side == "right"


def test_a_lane_beside_a_part_of_another_is_no_neighbour(read):
    short = osi.lane(2, [(0, 4), (50, 4)], right=[1])
    found = read(both(1, 0, left=[2]), short)
    assert found.lanelets["1"].left_of is None
    assert found.lanelets["2"].right_of is None


def test_two_solid_lines_of_two_lanes_are_a_double_line(read):
    left = osi.lane(2, [(0, 4.2), (100, 4.2)], right=[1], left_line=[21], right_line=[22])
    left += osi.boundary(21, [(0, 6.2), (100, 6.2)]) + osi.boundary(22, [(0, 2.2), (100, 2.2)])
    found = read(both(1, 0, left=[2]), left).lanelets
    assert (found["1"].left_mark, found["1"].right_mark) == ("double_solid", "solid")
    assert (found["2"].left_mark, found["2"].right_mark) == ("solid", "double_solid")


@pytest.mark.parametrize(
    ("kind", "mark"),
    [(2, "none"), (3, "solid"), (4, "broken"), (5, "broken"), (6, None), (12, None), (99, None)],
)
def test_marks(read, kind, mark):
    assert read(both(1, 0, kinds=(kind, 2))).lanelets["1"].left_mark == mark


def test_boundaries_of_several_parts_that_begin_and_end_at_dashes(read):
    road = osi.lane(1, [(0, 0), (100, 0)], left_line=[12, 11], right_line=[13])
    # Two parts in the wrong order; the line widens from 2 m to 3 m, and ends at a dash
    road += osi.boundary(11, [(4, 2), (50, 2)], 4) + osi.boundary(12, [(60, 3), (94, 3)], 4)
    road += osi.boundary(13, [(-5, -2), (105, -2)])
    lanelet = read(road).lanelets["1"]
    np.testing.assert_allclose(
        lanelet.left, [(0, 2), (4, 2), (50, 2), (60, 3), (94, 3), (100, 3)], atol=1e-9
    )
    np.testing.assert_allclose(lanelet.right[[0, -1]], [(0, -2), (100, -2)], atol=1e-9)
    assert len(lanelet.left) == len(lanelet.right) == len(lanelet.centre)
    assert lanelet.left_mark == "broken"


def test_a_mark_that_changes_on_the_way_is_not_told(read):
    road = osi.lane(1, [(0, 0), (100, 0)], left_line=[11, 12], right_line=[13])
    road += osi.boundary(11, [(0, 2), (50, 2)], 3) + osi.boundary(12, [(50, 2), (100, 2)], 4)
    road += osi.boundary(13, [(0, -2), (100, -2)])
    assert read(road).lanelets["1"].left_mark is None


def test_a_bend_is_as_wide_as_its_boundaries(read):
    angle = np.linspace(0, np.pi / 2, 46)
    circle = np.stack((np.sin(angle), 1 - np.cos(angle)), axis=1)
    # Around (0, 50): the middle has a radius of 50 m, bounds of 48 m and 52 m
    lines = {r: [(x * r, 50 - r + y * r) for x, y in circle] for r in (48, 50, 52)}
    road = osi.lane(1, lines[50], left_line=[11], right_line=[12])
    road += osi.boundary(11, lines[48]) + osi.boundary(12, lines[52])
    lanelet = read(road).lanelets["1"]
    for bound, radius in ((lanelet.left, 48), (lanelet.centre, 50), (lanelet.right, 52)):
        np.testing.assert_allclose(np.hypot(*(bound - (0, 50)).T), radius, atol=0.02)


def test_a_lane_without_a_middle_has_that_of_its_boundaries(read):
    road = osi.lane(1, forward=None, left_line=[11], right_line=[12])
    road += osi.boundary(11, [(0, 2), (100, 4)]) + osi.boundary(12, [(0, -2), (100, -2)])
    found = read(road)
    # Across the longer one, of which the other's ends are 4 cm and 6 cm off
    ends = found.lanelets["1"].centre[[0, -1]]
    np.testing.assert_allclose(ends, [(0, 0), (100, 1)], atol=0.1)
    assert "traffic is assumed to follow the points of lanes" in found.remarks[0]


def test_lanes_without_boundaries_reach_half_way_to_those_beside_them(read):
    found = read(
        osi.lane(1, [(0, 0), (100, 0)], left=[2]),
        osi.lane(2, [(0, 3), (100, 3)], right=[1]),
        osi.lane(3, [(0, 90), (100, 90)]),
    )
    for name, half in (("1", 1.5), ("2", 1.5), ("3", 1.75)):
        lanelet = found.lanelets[name]
        assert (lanelet.left - lanelet.right)[:, 1] == pytest.approx([2 * half] * 2)
    assert found.remarks == ("lanes without boundaries are assumed to have the usual width: 3",)


def test_lanes_follow_each_other_where_they_meet(read):
    """Whichever of the two says so, and whatever it calls the other: ends decide."""
    found = read(
        osi.lane(1, [(0, 0), (100, 0)], pairs=[(None, 2)]),
        osi.lane(2, [(100, 0), (200, 0)]),
        # Its points run against traffic, and its antecessor lies before its first point
        osi.lane(3, [(100, 4), (200, 4)], forward=False, pairs=[(4, None)]),
        osi.lane(4, [(0, 4), (100, 4)], forward=False),
        osi.lane(5, [(200, 0), (300, 0)], pairs=[(1, None), (2, None)]),
    )
    after = {name: lanelet.successors for name, lanelet in found.lanelets.items()}
    assert after == {"1": ("2",), "2": ("5",), "3": ("4",), "4": (), "5": ()}
    assert found.lanelets["5"].predecessors == ("2",)
    assert found.remarks[-1] == ("lanes that are declared connected but do not meet: 5 and 1")


def test_types(read):
    kinds = [(2, 2), (3, 4), (3, 8), (3, 9), (2, 10), (2, 11), (2, 3), (4, 0), (3, 7)]
    lanes = [
        osi.lane(k, [(0, 9 * k), (100, 9 * k)], kind=kind, subtype=subtype)
        for k, (kind, subtype) in enumerate(kinds)
    ]
    assert [set(x.types) for x in read(*lanes).lanelets.values()] == [
        set(),
        {"sidewalk"},
        {"border"},
        {"shoulder"},
        {"exitRamp"},
        {"accessRamp"},
        {"bicycleLane"},
        {"intersection"},
        {"restricted", "restricted_area"},
    ]


def test_an_area_has_a_way_for_each_pair_of_lanes(read):
    """From the west to the east, and to the left towards the north."""
    found = read(
        osi.lane(1, [(-50, 0), (0, 0)]),
        osi.lane(2, [(20, 0), (60, 0)]),
        osi.lane(3, [(10, 50), (10, 10)], forward=False),
        osi.lane(60, kind=4, forward=None, pairs=[(1, 2), (1, 3), (1, 99)]),
    ).lanelets
    assert set(found) == {"1", "2", "3", "60_1_2", "60_1_3"}
    assert found["1"].successors == ("60_1_2", "60_1_3")
    straight, left = found["60_1_2"], found["60_1_3"]
    assert (straight.successors, left.predecessors) == (("2",), ("1",))
    assert (left.types, left.junction) == ({"intersection"}, "60")
    np.testing.assert_allclose(straight.centre[:, 1], 0, atol=1e-9)
    np.testing.assert_allclose(left.centre[[0, -1]], [(0, 0), (10, 10)], atol=1e-9)
    # It begins eastwards and ends northwards, and stays as wide as the lanes are
    np.testing.assert_allclose(np.diff(left.centre, axis=0)[0, 1], 0, atol=0.2)
    np.testing.assert_allclose(left.right[-1] - left.left[-1], (3.5, 0), atol=1e-9)


def logical_lane(number, boundaries, move=2, road=3, limit=None, physical=()):
    said = [osi.identifier(1, number), whole(2, 2), whole(8, move)]
    said += [counted(4, osi.identifier(1, one)) for one in physical]
    said += [osi.identifier(12, boundaries[1]), osi.identifier(13, boundaries[0])]
    if limit is not None:
        value = counted(1, double(1, limit), whole(2, 3))
        said.append(counted(17, whole(1, 0), counted(3, value)))
    said.append(whole(18, road))
    return counted(19, *said)


def logical_boundary(number, points, physical):
    bounds = b"".join(counted(2, osi.vector(1, x, y)) for x, y in points)
    return counted(18, osi.identifier(1, number), bounds, osi.identifier(4, physical))


def test_logical_lanes_alone(read):
    found = read(
        logical_lane(14, (21, 22), limit=130),
        logical_lane(15, (22, 23), move=3),
        logical_boundary(21, [(0, 4), (99, 4)], 5),
        logical_boundary(22, [(0, 0), (99, 0)], 6),
        logical_boundary(23, [(0, -4), (99, -4)], 7),
        osi.boundary(5, [(0, 4), (99, 4)], 3),
        osi.boundary(6, [(0, 0), (99, 0)], 4),
    ).lanelets
    np.testing.assert_allclose(found["14"].centre, [(0, 2), (99, 2)])
    np.testing.assert_allclose(found["15"].centre, [(99, -2), (0, -2)])
    assert (found["14"].left_mark, found["14"].right_mark) == ("solid", "broken")
    assert found["14"].limit_mps == pytest.approx(130 / 3.6)
    assert (found["14"].types, found["15"].limit_mps) == ({"highway"}, None)


def test_logical_lanes_tell_more_of_lanes(read):
    found = read(both(1, 0), logical_lane(14, (0, 0), road=12, limit=50, physical=[1]))
    assert list(found.lanelets) == ["1"]
    assert found.lanelets["1"].limit_mps == pytest.approx(50 / 3.6)
    assert found.lanelets["1"].types == {"urban"}
