"""Which lanelets lie in a file's intersections."""

import pytest

from rulec.recordings.commonroad.commonroad_surroundings import Intersection, junctions
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
