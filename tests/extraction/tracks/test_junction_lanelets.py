"""The lanelets in junctions: those that a map marks, else those whose ways cross."""

from math import cos, radians, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.tracks.driven_road import junction_lanelets
from rulec.extraction.tracks.junctions import junctions_of
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
