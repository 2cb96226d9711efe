"""Level crossings on ego's road and farther ahead, and tracks beside it.

The level crossing reaches from x = 1000 to 1010; ego is 4 m long.
"""

from dataclasses import replace

import pytest

from rulec.extraction.signals.map import level_crossing_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording, straight, vehicle
from support.signal_arrays import all_said, said, unknown_in, values_of
from support.words import words_of

RAILS = frozenset({"level_crossing"})


def road(before=None, inside=RAILS, *more):
    return [
        straight(1, 0, 1000, successors=(2,), **(before or {})),
        straight(2, 1000, 1010, predecessors=(1,), successors=(3,), types=inside),
        straight(3, 1010, 1500, predecessors=(2,)),
        *more,
    ]


def told(lanes, *xs, complete=("rail",), route=("1", "2", "3")):
    """The signals, which are the same in the mirror."""
    body = vehicle(7, {k: (x, 0) for k, x in enumerate(xs)})
    found = replace(recording(lanes, [body]), complete=frozenset(complete))
    right = words_of(level_crossing_signals)(context_of(found, route))
    left = words_of(level_crossing_signals)(context_of(mirrored_recording(found), route, "left"))
    for name in right.world:
        assert said(right, name).tolist() == said(left, name).tolist(), name
    return right


def test_they_are_those_of_the_map():
    xs = (992, 994, 997, 999, 1008, 1013)
    # Fronts are at 994, 996, 999, 1001, 1010 and 1015, rears 4 m behind; the zone is 5 m longer
    found = all_said(told(road(), *xs, complete=()))
    assert found["level_crossing_zone"].tolist() == [False, True, True, True, True, False]
    assert found["enters_level_crossing"].tolist() == [False, False, False, True, False, False]
    assert found["guarded"].tolist() == found["level_crossing_zone"].tolist()
    plain = road(None, frozenset())
    assert not told(plain, *xs, complete=()).world
    free = all_said(told(plain, *xs))
    assert not free["level_crossing_zone"].any()
    assert not free["enters_level_crossing"].any()


@pytest.mark.parametrize(("x", "unknown"), [(998.5, True), (1001.5, False)])
def test_where_a_drive_begins_ego_may_just_have_driven_onto_it(x, unknown):
    found = unknown_in(told(road(), *(x + k for k in range(4))), "enters_level_crossing")
    assert found.tolist() == [unknown, False, False, False]


def warned(lanes, *xs, **more):
    found = told(lanes, *xs, **more)
    assert not values_of(found, "past_level_crossing_sign").any()
    return unknown_in(found, "past_level_crossing_sign").tolist()


def test_whether_a_sign_warned_of_one_is_not_known_where_it_may_have():
    # The front is 301, 299 and 5 m before it, on it, and past it
    assert warned(road(), 697, 699, 993, 1003, 1020) == [False, True, True, True, False]
    assert not any(warned(road(None, frozenset()), 697, 993))
    assert not told(road(None, frozenset()), 697, complete=()).world


@pytest.mark.parametrize(("length", "unknown"), [(200.0, True), (400.0, False)])
def test_one_counts_that_another_lane_of_the_road_leads_to(length, unknown):
    """The left lane leads to a level crossing beyond ego's road, 100 m and a lane from ego."""
    lanes = [
        straight(1, 0, 500, left_of=4, successors=(2,)),
        straight(2, 500, 900, predecessors=(1,)),
        straight(4, 0, 500, 4, right_of=1, successors=(5,)),
        straight(5, 500, 500 + length, 4, predecessors=(4,), successors=(6,)),
        straight(6, 500 + length, 510 + length, 4, predecessors=(5,), types=RAILS),
    ]
    assert warned(lanes, 398, 520, route=("1", "2")) == [unknown, False]


def test_tracks_beside_the_lane_at_the_kerb():
    rail = frozenset({"rail", "restricted_area"})
    lanes = road({"right_of": 8})
    lanes.append(straight(8, 0, 1000, -4, left_of=1, types=rail))
    assert values_of(told(lanes, 990, 1005), "tracks_at_kerb").tolist() == [True, False]
    # On the far side they leave room to pass at the kerb's side
    lanes = road({"left_of": 8})
    lanes.append(straight(8, 0, 1000, 4, right_of=1, types=rail))
    assert not values_of(told(lanes, 990, 1005), "tracks_at_kerb").any()


@pytest.mark.parametrize(("y", "expected"), [(0, True), (4, False)])
def test_tracks_in_the_lane_at_the_kerb_where_a_tram_runs_there(y, expected):
    lanes = [straight(1, 0, 500, left_of=2), straight(2, 0, 500, 4, right_of=1)]
    ego, tram = steady(7, 0, 4 - y, 10, 4), vehicle(8, dict.fromkeys(range(4), (60, y)), "train")
    found = replace(recording(lanes, [ego, tram]), complete=frozenset({"rail"}))
    signals = words_of(level_crossing_signals)(context_of(found))
    assert values_of(signals, "tracks_at_kerb").tolist() == [expected] * 4
