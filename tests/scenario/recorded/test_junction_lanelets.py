"""The lanelets in junctions: those that a map marks, else those whose ways cross."""

from math import cos, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.tracks.at_junctions.junctions import junctions_of
from rulec.scenario.recorded.junction_lanelets import junction_lanelets
from support.builders.recordings import lanelet, recording, straight


def across(number, degrees, **more):
    """A lanelet through the origin, at an angle to the x axis."""
    x, y = 50 * cos(radians(degrees)), 50 * sin(radians(degrees))
    return lanelet(number, [(-x, -y), (x, y)], **more)


ALONG = straight(1, -60, 60)


@given(st.integers(1, 179))
def test_ways_cross_at_more_than_30_degrees(degrees):
    if degrees in (30, 150):
        return
    crossing = 30 < degrees < 150
    found = junction_lanelets(recording([ALONG, across(2, degrees)]))
    assert found == ({"1", "2"} if crossing else frozenset())


def test_ways_that_do_not_meet_or_are_no_lanes_make_no_junction():
    far = lanelet(2, [(90, -50), (90, 50)])
    assert junction_lanelets(recording([ALONG, far])) == frozenset()
    zebra = across(2, 90, types=frozenset({"crosswalk"}))
    assert junction_lanelets(recording([ALONG, zebra])) == frozenset()
    assert junction_lanelets(recording([])) == frozenset()


def test_where_a_map_marks_junctions_only_those_count():
    marked = straight(3, 60, 80, types=frozenset({"intersection"}))
    assert junction_lanelets(recording([ALONG, across(2, 90), marked])) == {"3"}


@pytest.mark.parametrize(
    ("far", "beside", "inside"),
    [(8, False, True), (8, True, True), (60, False, False)],
    ids=("a corner", "from a lane of its own", "a slip road"),
)
def test_a_turn_that_crosses_nobody_is_in_the_junction_beside_which_it_leads(far, beside, inside):
    """To the near side, from the road along the x axis to that along the y axis."""
    turn_from = 5 if beside else 1
    lanes = [
        lanelet(1, [(-200, 0), (-far, 0)], successors=(7,) if beside else (7, 3), right_of=5),
        lanelet(5, [(-200, -4), (-far, -4)], successors=(3,) if beside else (), left_of=1),
        lanelet(7, [(-far, 0), (-6, 0)], predecessors=(1,), successors=(2,)),
        lanelet(2, [(-6, 0), (90, 0)], predecessors=(7,)),
        lanelet(3, [(-far, -4), (0, -far)], predecessors=(turn_from,), successors=(4,)),
        lanelet(4, [(0, -far), (0, -90)], predecessors=(3, 8)),
        lanelet(6, [(0, 90), (0, -6)], successors=(8,)),
        lanelet(8, [(0, -6), (0, -far)], predecessors=(6,), successors=(4,)),
    ]
    found = junction_lanelets(recording(lanes))
    assert found == {"2", "6", *({"3"} if inside else ())}


def test_a_turn_is_found_though_only_one_of_two_lanelets_names_the_other():
    lanes = [
        lanelet(1, [(-90, 0), (-8, 0)], successors=(2, 3)),
        lanelet(2, [(-8, 0), (90, 0)]),
        lanelet(3, [(-8, 0), (-2, -2), (0, -8)]),
        lanelet(4, [(0, -8), (0, -90)], predecessors=(3, 6)),
        lanelet(6, [(0, 90), (0, -8)]),
    ]
    assert junction_lanelets(recording(lanes)) == {"2", "3", "6"}


@pytest.mark.parametrize(
    ("sign", "far", "found"),
    [
        ("YIELD", 12, {"2", "4", "6"}),
        ("STOP", 12, {"2", "4", "6"}),
        ("YIELD", 90, set()),
        ("PRIORITY", 12, set()),
    ],
)
def test_ways_that_join_behind_a_sign_are_in_a_junction_with_those_that_part(sign, far, found):
    """Onto a ring, which a third way leaves: their middles do not cross. Ramps are longer."""
    signs = frozenset({sign})
    lanes = [
        lanelet(1, [(-99, -9), (-far, -9)], successors=(2,), signs=signs),
        lanelet(2, [(-far, -9), (0, 0)], predecessors=(1,), successors=(5,)),
        lanelet(3, [(-99, 0), (-far, 0)], successors=(4, 6)),
        lanelet(4, [(-far, 0), (0, 0)], predecessors=(3,), successors=(5,)),
        lanelet(5, [(0, 0), (99, 0)], predecessors=(2, 4)),
        lanelet(6, [(-far, 0), (0, 9)], predecessors=(3,), successors=(7,)),
        lanelet(7, [(0, 9), (99, 9)], predecessors=(6,)),
    ]
    assert junction_lanelets(recording(lanes)) == found


def test_a_level_crossing_is_no_junction_but_has_its_ways():
    """Which of them a train comes on is told; that cars do not block the junction there, not."""
    road = straight(1, -20, 20, types=frozenset({"level_crossing"}))
    rails = across(2, 90, types=frozenset({"rail"}))
    found = recording([road, rails])
    assert junction_lanelets(found) == frozenset()
    (junction,) = junctions_of(found)
    assert {x.id for way in junction.ways for x in way.lanelets} == {"1", "2"}
    # On one that marks junctions others are none, as before
    marked = straight(3, 60, 80, types=frozenset({"intersection"}))
    (junction,) = junctions_of(recording([road, rails, marked]))
    assert {x.id for way in junction.ways for x in way.lanelets} == {"3"}
