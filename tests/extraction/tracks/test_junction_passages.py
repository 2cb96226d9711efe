"""When somebody is where ways through a junction meet."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.tracks.at_junctions.junction_passages import junction_passages
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


RAILS = {"junction": "j", "types": frozenset({"intersection", "rail"})}


def ways_taken(lanes, *bodies, step_s=0.5):
    """By participant the ways it takes and whether they are sure; and who is on none."""
    found = recording(lanes, bodies, step_s=step_s)
    passages = junction_passages(found, tracks_of(found, USUAL))
    taken = {
        body.id: [(set(passages.way(x).names), x.sure) for x in passages.of_row.get(row, ())]
        for row, body in enumerate(found.participants)
    }
    return taken, passages.astray


def on_a_line(y, kind, speed=10.0, length=4.0):
    places = {k: (-60.0 + speed * k / 2, y) for k in range(int(240 / speed))}
    return vehicle(7, places, kind, speed=speed, length=length)


@pytest.mark.parametrize(
    ("y", "kind", "way"),
    [
        (0.0, "train", {"1"}),
        (4.0, "train", {"2"}),
        (0.3, "train", {"1"}),
        (2.1, "train", {"2"}),
        (0.0, "car", {"1"}),
        (1.5, "car", {"1"}),
    ],
)
def test_trams_also_run_on_lanes_that_others_share_and_cars_on_no_rails(y, kind, way):
    """The lane is at y = 0, the track at y = 4; a little off between them a tram is on rails."""
    lanes = [straight(1, -12, 12, **INSIDE), straight(2, -12, 12, 4.0, **RAILS)]
    taken, astray = ways_taken(lanes, on_a_line(y, kind, length=30.0 if kind == "train" else 4.0))
    assert taken == {"7": [(way, True)]}
    assert not astray


def test_a_car_on_rails_alone_is_on_no_way():
    taken, astray = ways_taken([straight(2, -12, 12, **RAILS)], on_a_line(0.0, "car"))
    assert taken == {"7": []}
    assert list(astray) == [0]


@pytest.mark.parametrize("speed", [6.0, 15.0, 31.0, 41.0])
@pytest.mark.parametrize(("kind", "length"), [("train", 80.0), ("train", 200.0), ("car", 4.0)])
def test_who_passes_through_a_small_junction_in_a_step_or_two(speed, kind, length):
    """At the highest speeds the middle is never in it; a train's moves there but a few metres."""
    way = straight(1, -4, 4, **RAILS) if kind == "train" else straight(1, -4, 4, **INSIDE)
    taken, astray = ways_taken([way], on_a_line(0.0, kind, speed, length))
    assert taken == {"7": [({"1"}, True)]}
    assert not astray


def test_how_one_turned_between_two_states_is_not_sure():
    lanes = [
        lanelet(1, [(-3, 0), (3, 0)], **INSIDE),
        lanelet(2, [(-3, 0), (0, 0.5), (3, 3)], **INSIDE),
    ]
    places = {0: (-14, 0), 1: (-4, 0), 2: (5.5, 4.5), 3: (12, 11)}
    turning = vehicle(7, places, speed=20.0, heading=0.0)
    states = {k: replace(x, heading=(0.0, 0.0, 0.8, 0.8)[k]) for k, x in turning.states.items()}
    taken, _ = ways_taken(lanes, replace(turning, states=states))
    assert [sure for _, sure in taken["7"]] == [False]


def test_when_one_is_at_the_meeting_of_ways_that_it_passes_in_a_step():
    """Interpolated: 15 m in a step, its front 40 m ahead of its middle, at x = -3 and 3 + 80."""
    lanes = [straight(1, -4, 4, **RAILS), lanelet(2, [(0, -4), (0, 4)], **INSIDE)]
    found = recording(lanes, [on_a_line(0.0, "train", 30.0, 80.0)], step_s=0.5)
    passages = junction_passages(found, tracks_of(found, USUAL))
    (passage,) = passages.of_row[0]
    expected = (-3 - 40 + 60) / 15, (3 + 40 + 60) / 15
    assert passages.occupied(passage, (1.0, 7.0)) == pytest.approx(expected)


def test_who_is_put_elsewhere_between_two_states_has_passed_nothing():
    """As simulators put vehicles that are stuck behind their obstacle, or at their way's end."""
    places = {0: (-300, 0), 1: (-290, 0), 2: (290, 0), 3: (300, 0)}
    taken, astray = ways_taken([straight(1, -4, 4, **INSIDE)], vehicle(7, places, speed=20.0))
    assert taken == {"7": []}
    assert not astray
