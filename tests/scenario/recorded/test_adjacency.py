"""Lanelets side by side of which the map does not say that they are neighbours."""

import pytest

from rulec.recordings.adjacency import bordering, with_neighbours
from support.builders.recordings import lanelet, recording, straight


def neighbours(*lanes):
    found = with_neighbours(recording(lanes))
    known = {(one.id, one.left_of) for one in found.lanelets.values() if one.left_of is not None}
    known |= {(one.right_of, one.id) for one in found.lanelets.values() if one.right_of is not None}
    return known, found.remarks


@pytest.mark.parametrize(("y", "beside"), [(4.0, True), (4.4, True), (3.6, True), (4.6, False)])
def test_borders_within_half_a_metre_are_one(y, beside):
    known, remarks = neighbours(straight(1, 0, 100), straight(2, 0, 100, y=y))
    assert known == ({("1", "2")} if beside else set())
    assert len(remarks) == beside


def test_the_remark_names_them():
    _, (remark,) = neighbours(straight(1, 0, 100), straight(2, 0, 100, y=4))
    assert remark.endswith("neighbours, although the file does not say so: 1 and 2")
    lanes = [straight(k, 0, 100, y=4 * k) for k in range(6)]
    assert neighbours(*lanes)[1][0].endswith("0 and 1, 1 and 2, 2 and 3, and 2 more")


def test_who_leads_the_other_way_is_no_neighbour():
    assert neighbours(straight(1, 0, 100), straight(2, 100, 0, y=4))[0] == set()


def test_a_border_in_common_for_a_while_makes_no_neighbours():
    ramp = lanelet(2, [(0, -20), (60, -8), (90, -4), (100, -4)])
    assert neighbours(straight(1, 0, 100), ramp)[0] == set()
    (pair,) = bordering([straight(1, 0, 100), ramp])
    assert (pair.right.id, pair.left.id) == ("2", "1")
    assert 8 < pair.length < 20
    assert pair.part < 0.3


def test_borders_that_meet_at_their_ends_have_a_place_in_common():
    # Of 51 places, every 2 m, the last one
    (pair,) = bordering([straight(1, 0, 100), straight(2, 100, 200, y=4)])
    assert (pair.part, pair.length) == (pytest.approx(1 / 51), pytest.approx(100 / 51))


def test_what_the_map_says_stands():
    lanes = [straight(1, 0, 100, left_of=3), straight(2, 0, 100, y=4), straight(3, 0, 99, y=4)]
    assert neighbours(*lanes) == ({("1", "3")}, ())


def test_pavements_are_no_neighbours():
    pavement = straight(2, 0, 100, y=4, types=frozenset({"sidewalk"}))
    assert neighbours(straight(1, 0, 100), pavement)[0] == set()


def test_lanes_side_by_side_in_a_junction_lead_different_ways():
    across = lanelet(3, [(50, -30), (50, 30)])
    assert neighbours(straight(1, 0, 100), straight(2, 0, 100, y=4), across) == (set(), ())


def test_short_lanes_side_by_side_may_lead_different_ways():
    assert neighbours(straight(1, 0, 25), straight(2, 0, 25, y=4)) == (set(), ())
