"""When somebody is where ways through a junction meet."""

import numpy as np
import pytest

from rulec.extraction.tracks.junction_passages import junction_passages
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from support.builders.drive_contexts import along
from support.builders.recordings import lanelet, recording, straight, vehicle

INSIDE = {"junction": "j", "types": frozenset({"intersection"})}


def passage_of_a_car(own, across):
    """The passage of way 1 by a car of 4 m, whose middle drives 2 m in each step, from x = -9."""
    car = vehicle(7, {k: (-9.0 + 2 * k, 0.0) for k in range(10)}, speed=4.0)
    found = recording([own, across], [car])
    passages = junction_passages(found, tracks_of(found, USUAL))
    (passage,) = passages.of_row[0]
    assert passages.way(passage).names == {"1"}
    return passages, passage


@pytest.mark.parametrize("start", [0, -12])
def test_who_is_in_a_junction_before_its_way_begins(start):
    """Some files have it that a way begins within the junction: here at x = 0, where others cross.

    Its front is at x = 1 after four steps, its rear is past x = 5 after eight: wherever it begins.
    """
    across = lanelet(2, [(-4, -20), (-4, 20)], width=8.0, **INSIDE)
    passages, passage = passage_of_a_car(straight(1, start, 10, **INSIDE), across)
    assert passages.occupied(passage, (1.0 - start, 5.0 - start)) == pytest.approx((4.0, 8.0))


@pytest.mark.parametrize("end", [0, 12])
def test_who_is_in_a_junction_after_its_way_has_ended(end):
    """Its front is at x = -3 after two steps, its rear is past x = 0 after five and a half."""
    across = lanelet(2, [(6, -20), (6, 20)], width=12.0, **INSIDE)
    passages, passage = passage_of_a_car(straight(1, -12, end, **INSIDE), across)
    assert passages.occupied(passage, (9.0, 12.0)) == pytest.approx((2.0, 5.5))


def test_who_drives_on_along_a_way_that_is_much_shorter_than_the_junction():
    """Ways of a large junction may be drawn only where they cross others, here from x = 3 to 5."""
    across = lanelet(2, [(0, -20), (0, 20)], width=16.0, **INSIDE)
    passages, passage = passage_of_a_car(straight(1, 3, 5, **INSIDE), across)
    assert passages.occupied(passage, (-2.0, 2.0)) == pytest.approx((4.0, 8.0))


@pytest.mark.parametrize("seen_from", [0, 3], ids=["before", "in the junction"])
def test_the_direction_in_which_one_comes_that_turns_round_at_once(seen_from):
    """It has turned by 57° when its middle is in the junction; its front was there before that."""
    angles = np.radians(np.arange(-90, 91, 15))
    line = [(3 * np.cos(a), 3 + 3 * np.sin(a)) for a in angles]
    ways = [
        straight(1, -50, 0, successors=(2,)),
        lanelet(2, line, predecessors=(1,), successors=(3,), **INSIDE),
        lanelet(3, [(0, 6), (-50, 6)], predecessors=(2,)),
        lanelet(4, [(2, -20), (2, 20)], **INSIDE),
    ]
    places = 42.5 + 3.5 * np.arange(seen_from, 7)
    car = along(7, np.array([(-50, 0), *line, (-50, 6)]), places)
    found = recording(ways, [car])
    passages = junction_passages(found, tracks_of(found, USUAL))
    (passage,) = passages.of_row[0]
    assert abs(passages.tracks.heading[0, passage.first]) > 0.5
    assert passage.heading == pytest.approx(0.0, abs=0.2)
