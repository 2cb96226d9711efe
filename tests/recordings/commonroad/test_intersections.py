"""Which lanelets lie in a file's intersections."""

import pytest

from rulec.recordings.commonroad.commonroad_surroundings import (
    Intersection,
    junctions,
    leading_away,
)
from support.builders.recordings import lanelet


@pytest.mark.parametrize(
    ("types", "inside"), [({"intersection"}, {"1", "2", "3"}), ({"urban"}, {"2", "3"})]
)
def test_what_leads_to_where_ways_cross_lies_within_if_its_type_says_so(types, inside):
    """Nobody crosses the first lanelet of a way to the left, on which one waits for the others."""
    lanelets = [
        lanelet(1, [(0, -8), (0, -4)], successors=(2,), types=frozenset(types)),
        lanelet(2, [(0, -4), (0, 0), (-6, 2)], predecessors=(1,)),
        lanelet(3, [(-2, 8), (-2, -8)]),
    ]
    found = junctions([Intersection("9", ("1", "3"))], {x.id: x for x in lanelets})
    assert found == dict.fromkeys(inside, "9")


@pytest.mark.parametrize(
    ("predecessors", "crossing", "away"),
    [((1, 2), False, True), ((1,), False, False), ((1, 4), False, False), ((1, 2), True, False)],
    ids=("ways have joined", "one way goes on", "one comes from elsewhere", "another crosses"),
)
def test_a_road_behind_an_intersection_is_no_part_of_it_whatever_its_type_says(
    predecessors, crossing, away
):
    marked = frozenset({"intersection"})
    lanelets = [
        lanelet(1, [(-9, 0), (0, 0)], successors=(3,), types=marked),
        lanelet(2, [(-9, 9), (0, 0)], successors=(3,), types=marked),
        lanelet(3, [(0, 0), (300, 0)], predecessors=predecessors, types=marked),
        lanelet(4, [(50, 20), (50, -20 if crossing else 5)]),
    ]
    found = leading_away({"1": "9", "2": "9"}, {x.id: x for x in lanelets})
    assert found == ({"3"} if away else set())
