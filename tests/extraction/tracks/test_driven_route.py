"""The cheapest chain of lanelets: what a hop costs, and how many there may be."""

import pytest

from rulec.extraction.tracks.map_matching import driven_stretches, match_to_map
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.recordings import recording, straight, vehicle


def stretches(lanes, *xs):
    found = recording(lanes, [vehicle(7, {k: (x, 0) for k, x in enumerate(xs)})])
    matches = match_to_map(found, tracks_of(found, USUAL))[0]
    return [(part.first, part.last, part.route) for part in driven_stretches(found, matches)]


@pytest.mark.parametrize(("first", "second"), [(1, 2), (2, 1)])
def test_where_lanelets_overlap_ego_stays_on_its_own(first, second):
    lanes = [
        straight(first, 0, 100, successors=(second,)),
        straight(second, 50, 150, predecessors=(first,)),
    ]
    # At 60 m ego is on both; going over would be a hop for nothing
    assert stretches(lanes, 20, 60) == [(0, 1, (str(first),))]
    assert stretches(lanes, 20, 60, 120) == [(0, 2, (str(first), str(second)))]


def test_at_most_four_lanelets_lie_between_two_states():
    lanes = [
        straight(k, 10 * k, 10 * k + 10, successors=(k + 1,), predecessors=(k - 1,))
        for k in range(8)
    ]
    assert stretches(lanes, 5, 45) == [(0, 1, ("0", "1", "2", "3", "4"))]
    assert stretches(lanes, 5, 55) == [(0, 0, ("0",)), (1, 1, ("5",))]
