"""Two lanes that become one 100 m along the road, and what merely looks so.

Lanes are 4 m wide; the right one has its middle at y = 0, the left one at y = 4.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import merge_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

RIGHT, LEFT, ON = "1", "2", "3"


def lanes(right=(3,), left=(3,), *more, right_types=(), right_width=4.0):
    """Two lanes with their successors, and a lane behind the left one."""
    return [
        lanelet(
            1,
            [(0, 0), (50, 0), (100, 0)],
            right_width,
            left_of=2,
            successors=right,
            types=frozenset(right_types),
        ),
        straight(2, 0, 100, 4, right_of=1, successors=left),
        straight(3, 100, 250, 4, predecessors=(2,)),
        *more,
    ]


def signals(
    road, *others, xs=(40, 60, 90, 97, 99, 120, 147, 152), y=0.0, route=(LEFT, ON), step_s=0.5
):
    """Ego's front is 2 m ahead of its middle; the same in the mirror."""
    ego = vehicle(7, {k: (x, 4.0 if x > 100 else y) for k, x in enumerate(xs)})
    found = recording(road, [ego, *others], step_s=step_s)
    right = words_of(merge_signals)(context_of(found, route))
    left = words_of(merge_signals)(context_of(mirrored_recording(found), route, "left"))
    for name in ("narrowing", "merged"):
        assert values_of(right, name).tolist() == values_of(left, name).tolist()
        assert unknown_in(right, name).tolist() == unknown_in(left, name).tolist()
    abreast = (right, left)
    assert len({str(values_of(one, "abreast_at_narrowing").tolist()) for one in abreast}) == 1
    return right


BEFORE = [False, True, True, True, False, False, False, False]
AFTER = [False, False, False, False, True, True, True, False]


@pytest.mark.parametrize("y", [0.0, 4.0], ids=["right", "left"])
def test_two_lanes_that_lead_to_one(y):
    # Fronts are at 42, 62, 92, 99, 101, 122, 149 and 154: 50 m before and beyond 100
    found = signals(lanes(), y=y)
    assert values_of(found, "narrowing").tolist() == BEFORE
    assert values_of(found, "merged").tolist() == AFTER
    assert not unknown_in(found, "narrowing").any()


def test_a_lane_that_gets_narrow_and_ends():
    found = signals(lanes(right=(), right_width=[4.0, 4.0, 0.5]), y=4.0)
    assert values_of(found, "narrowing").tolist() == BEFORE
    assert values_of(found, "merged").tolist() == AFTER


def test_a_lane_that_may_go_on_beyond_the_map():
    # It is as wide at the map's end as before: it may lead to a ramp that nobody has drawn
    found = signals(lanes(right=()), y=4.0)
    assert not values_of(found, "narrowing").any()
    near = [False, True, True, True, True, True, True, False]
    assert unknown_in(found, "narrowing").tolist() == near
    assert unknown_in(found, "merged").tolist() == near


def test_where_a_net_has_all_lanes_that_one_ends():
    road = lanes(right=())
    ego = vehicle(7, {0: (80, 4), 1: (90, 4)})
    found = replace(recording(road, [ego]), complete=frozenset({"lanes"}))
    told = words_of(merge_signals)(context_of(found, (LEFT, ON)))
    assert values_of(told, "narrowing").all()
    assert not unknown_in(told, "narrowing").any()


def test_where_the_whole_road_ends_and_vehicles_can_only_turn_around():
    road = [
        straight(1, 0, 100, 0, left_of=2),
        straight(2, 0, 100, 4, right_of=1, successors=(9,)),
        lanelet(9, [(100, 4), (102, 6), (100, 8)], predecessors=(2,), successors=(10,)),
        lanelet(10, [(100, 8), (0, 8)], predecessors=(9,)),
    ]
    ego = vehicle(7, {0: (80, 4), 1: (95, 4), 2: (97, 8), 3: (80, 8)})
    found = replace(recording(road, [ego]), complete=frozenset({"lanes"}))
    told = words_of(merge_signals)(context_of(found, ("2", "9", "10")))
    for name in ("narrowing", "merged"):
        assert not values_of(told, name).any()
        assert not unknown_in(told, name).any()


@pytest.mark.parametrize(
    "road",
    [
        # The right lane leads off the road
        lanes(
            (9,),
            (3,),
            lanelet(9, [(100, 0), (150, -40)], predecessors=(1,)),
        ),
        # From either lane one gets to both
        [
            straight(1, 0, 100, 0, left_of=2, successors=(3, 9)),
            straight(2, 0, 100, 4, right_of=1, successors=(3, 9)),
            straight(3, 100, 250, 4, predecessors=(1, 2), right_of=9),
            straight(9, 100, 250, 0, predecessors=(1, 2), left_of=3),
        ],
        # Both may leave, one alone goes on
        lanes((9,), (3, 9), lanelet(9, [(100, 0), (150, -40)], predecessors=(1, 2))),
        # The right one is a short way from a lane that goes on beside them
        [
            straight(8, 0, 80, 0, left_of=9, successors=(1, 10)),
            straight(9, 0, 80, 4, right_of=8, successors=(2,)),
            straight(1, 80, 100, 0, left_of=2, successors=(3,), predecessors=(8,)),
            straight(2, 80, 100, 4, right_of=1, successors=(3,), predecessors=(9,)),
            straight(3, 100, 250, 4, predecessors=(1, 2), right_of=11),
            straight(10, 80, 100, 0, predecessors=(8,), successors=(11,)),
            straight(11, 100, 250, 0, predecessors=(10,), left_of=3),
        ],
        lanes(right_types=("accessRamp",)),
        lanes((), right_width=[4.0, 4.0, 0.5], right_types=("exitRamp",)),
    ],
    ids=["a ramp", "all to all", "exits", "a way beside", "an entry", "an exit that ends"],
)
def test_no_narrowing(road):
    found = signals(road, y=4.0)
    assert not values_of(found, "narrowing").any()
    assert not values_of(found, "merged").any()
    assert not unknown_in(found, "narrowing").any()


def test_a_third_lane_has_nothing_to_do_with_it():
    road = [
        *lanes()[:1],
        straight(2, 0, 100, 4, right_of=1, left_of=4, successors=(3,)),
        straight(4, 0, 100, 8, right_of=2, successors=(5,)),
        straight(3, 100, 250, 4, predecessors=(1, 2), left_of=5),
        straight(5, 100, 250, 8, predecessors=(4,), right_of=3),
    ]
    ego = vehicle(7, {0: (80, 8), 1: (90, 8), 2: (110, 8)})
    told = words_of(merge_signals)(context_of(recording(road, [ego]), ("4", "5")))
    assert not values_of(told, "narrowing").any()
    assert not values_of(told, "merged").any()


def test_who_is_abreast():
    beside = steady(1, 62, 4, 0, steps=8)
    ahead = steady(2, 97, 4, 0, steps=8)
    same = steady(3, 92, 0, 0, steps=8)
    found = signals(lanes(), beside, ahead, same)
    # Middles of 4 m long bodies: ego is at 60 in state 1, at 97 and 99 in states 3 and 4, and from
    # there on beyond the narrowing, which is 36 m ahead of the one that it left behind
    abreast = values_of(found, "abreast_at_narrowing")
    assert [np.flatnonzero(row).tolist() for row in abreast] == [[], [3], []]


@pytest.mark.parametrize(
    ("xs", "told"),
    [
        ((60, 82, 83, 83), "T"),
        ((60, 82, 82, 82), "F"),
        ((60, 82), "?"),
        ((60, 82, 92, 97), "T"),
        ((60, 82, 98, 106), "T"),
        ((60, 82, 100, 113), "?"),
        ((60, 82, 100, 115), "F"),
        ((81, 82, 83, 83), "?"),
    ],
)
def test_who_is_abreast_comes_to_the_narrowing_with_ego(xs, told):
    """Beside ego in state 1; 15 or 16 m before the narrowing as ego gets there, gone, or ahead.

    It may still be level with ego then, its front before the narrowing, or through behind ego's
    or ahead of it, which is 112 m along the road.
    Ego drives at 17.5 m/s. Behind one at 1 m/s it would get by braking with 3 m/s² over 50 m.
    """
    other = vehicle(1, {k: (x, 4) for k, x in enumerate(xs)})
    found = signals(lanes(), other, xs=(60, 80, 95, 110), step_s=1.0)
    abreast = values_of(found, "abreast_at_narrowing")[0]
    unknown = unknown_in(found, "abreast_at_narrowing")[0]
    assert ("?" if unknown[1] else "FT"[int(abreast[1])]) == told


def test_who_is_beside_ego_beyond_the_narrowing_is_on_another_lane():
    """The two left lanes of three become one, beside which the right one goes on, moved left."""
    road = [
        straight(1, 0, 100, 0, left_of=2, successors=(6,)),
        straight(2, 0, 100, 4, right_of=1, left_of=4, successors=(3,)),
        straight(4, 0, 100, 8, right_of=2, successors=(3,)),
        straight(3, 100, 250, 8, predecessors=(2, 4), right_of=6),
        straight(6, 100, 250, 4, predecessors=(1,), left_of=3),
    ]
    ego = vehicle(7, {0: (95, 8), 1: (97, 8), 2: (104, 8)})
    other = vehicle(1, {0: (97, 0), 1: (100, 4), 2: (106, 4)})
    told = words_of(merge_signals)(context_of(recording(road, [ego, other]), ("4", "3")))
    assert values_of(told, "narrowing").tolist() == [True, True, False]
    assert not values_of(told, "abreast_at_narrowing").any()


def test_a_drive_of_one_state_and_one_that_begins_beyond():
    assert values_of(signals(lanes(), xs=(90,)), "narrowing").tolist() == [True]
    found = signals(lanes(), xs=(120, 152))
    assert values_of(found, "merged").tolist() == [True, False]
    assert not values_of(found, "narrowing").any()
