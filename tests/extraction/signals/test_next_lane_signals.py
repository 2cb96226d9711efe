"""The lanes next to ego's: who is there or may be unseen, and whether they lead where ego goes."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals import ego_signals
from rulec.extraction.signals.conduct import next_lane_signals
from rulec.recordings.recording import Light
from support.builders.drive_contexts import context_of, steady, told_on_both_sides
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

STEP_S = 0.5


def signals(lanes, *bodies, route=("1",), **thresholds):
    """The words, unknown ones as "?", which are the same in the mirror."""
    found = recording(lanes, bodies, step_s=STEP_S)
    return told_on_both_sides(words_of(next_lane_signals), found, route, **thresholds)


def lanes_of(lanes, *bodies):
    """Which lane ego is in, and how many there are."""
    found = told_on_both_sides(
        words_of(ego_signals), recording(lanes, bodies, step_s=STEP_S), ("1",)
    )
    return found["lane"][0], found["lanes"][0]


def ego(x=0.0, mps=10.0, steps=4, y=0.0):
    return steady(7, x, y, mps, steps)


@pytest.mark.parametrize(
    ("x", "mps", "free"),
    [
        (0, 10, "False"),  # beside
        (-10, 10, "False"),  # 6 m behind
        (-20, 10, "True"),  # 16 m
        (-30, 20, "False"),  # 26 m, and 10 m/s faster: 20 m nearer in 2 s, and then within 10 m
        (-40, 20, "True"),
        (20, 5, "True"),  # it is ahead
    ],
)
def test_the_other_lane(x, mps, free):
    lanes = [straight(1, 0, 600, left_of=3), straight(3, 0, 600, 4, right_of=1)]
    found = signals(lanes, ego(100), steady(9, 100 + x, 4, mps))
    assert found["other_lane_available"][0] == free
    assert (
        signals([straight(1, 0, 600), lanelet(2, [(600, 4), (0, 4)])], ego(100))[
            "other_lane_available"
        ][0]
        == "False"
    )


@pytest.mark.parametrize(("x", "unknown"), [(120.0, "?"), (170.0, "True")])
def test_one_whose_track_ends_may_still_be_on_the_near_lane(x, unknown):
    """It drives 20 or 70 m ahead of ego at its speed, and is recorded for two states."""
    lanes = [straight(1, 0, 600, left_of=2), straight(2, 0, 600, 4, right_of=1)]
    others = [steady(8, x, 0, 10.0, steps=2), steady(9, 0, 4, 10.0)]
    assert signals(lanes, ego(100, y=4), *others)["near_lane_is_free"][2] == unknown


@pytest.mark.parametrize(
    ("ahead", "behind", "free"),
    [
        (None, None, True),
        # 10 m at 10 m/s, if the other one is as fast; (100 - 64) / 16 m more if it is slower
        ((23.0, 10.0), None, True),
        # At less than 1.8 s it would have to brake for somebody who does
        ((15.0, 10.0), None, "?"),
        ((13.0, 10.0), None, False),
        ((15.0, 8.0), None, False),
        # 12 m and (144 - 100) / 16 m for one behind at 12 m/s, and its error 0.6 m
        (None, (-19.5, 12.0), True),
        (None, (-18.0, 12.0), False),
        (None, (0.0, 10.0), False),
    ],
)
def test_a_place_in_the_near_lane(ahead, behind, free):
    """Ego's middle is at y = 4, in the left one of two lanes."""
    lanes = [straight(1, 0, 600, left_of=2), straight(2, 0, 600, 4, right_of=1)]
    places = [(number, *at) for number, at in ((8, ahead), (9, behind)) if at]
    others = [steady(number, 100 + x, 0, mps) for number, x, mps in places]
    others.append(steady(6, 0, 4, 10.0))
    assert signals(lanes, ego(100, y=4), *others)["near_lane_is_free"][0] == str(free)
    # At the kerb nothing keeps it away
    assert signals(lanes, ego(100), *others)["near_lane_is_free"][0] == "True"


@pytest.mark.parametrize(
    ("x", "free"), [(-15.0, "True"), (-14.04, "?"), (-13.96, "?"), (-13.0, "False")]
)
def test_a_place_that_only_errors_of_measurement_make_wide_enough(x, free):
    """One behind at 10 m/s needs 10 m, from middle to middle 14 m; places are good to 5 cm."""
    lanes = [straight(1, 0, 600, left_of=2), straight(2, 0, 600, 4, right_of=1)]
    others = [steady(9, 100 + x, 0, 10.0), steady(6, 0, 4, 10.0)]
    assert signals(lanes, ego(100, y=4), *others)["near_lane_is_free"][0] == free
    # One that lies beside ego keeps it away all the same
    beside = steady(8, 100, 0, 10.0)
    assert signals(lanes, ego(100, y=4), beside, *others)["near_lane_is_free"][0] == "False"


@pytest.mark.parametrize(
    ("gap_m", "mps", "free"),
    # Ego gains 5 m/s, which is 100 m in 20 s
    [(60, 5.0, "?"), (95, 5.0, "?"), (110, 5.0, "True"), (95, 9.0, "True"), (95, 12.0, "True")],
)
def test_nobody_has_to_go_where_it_would_soon_have_to_come_out_again(gap_m, mps, free):
    lanes = [straight(1, 0, 600, left_of=2), straight(2, 0, 600, 4, right_of=1)]
    # From middle to middle it is 4 m more
    others = [steady(8, 100 + gap_m + 4, 0, mps), steady(9, 0, 4, 10.0)]
    assert signals(lanes, ego(100, y=4), *others)["near_lane_is_free"][0] == free


def test_nobody_sees_what_comes_behind_the_last_one():
    lanes = [straight(1, 0, 600, left_of=2), straight(2, 0, 600, 4, right_of=1)]
    assert signals(lanes, ego(100, y=4))["near_lane_is_free"][0] == "?"
    # But who is there is there
    beside = steady(8, 100, 0, 10.0)
    assert signals(lanes, ego(100, y=4), beside)["near_lane_is_free"][0] == "False"


@pytest.mark.parametrize(("mark", "free"), [("solid", "False"), ("broken", "True")])
def test_nobody_goes_to_the_near_lane_across_a_solid_line(mark, free):
    lanes = [
        straight(1, 0, 600, left_of=2),
        replace(straight(2, 0, 600, 4, right_of=1), right_mark=mark),
    ]
    behind = steady(9, 0, 4, 10.0)
    assert signals(lanes, ego(100, y=4), behind)["near_lane_is_free"][0] == free


@pytest.mark.parametrize(
    ("mps", "beside", "free"), [(10.0, True, "?"), (10.0, False, "True"), (20.0, True, "True")]
)
def test_who_is_in_a_slow_queue_need_not_use_a_hole_beside_it(mps, beside, free):
    """Two are ahead of ego in its lane, 11 m apart, and one on the other lane, far enough away."""
    queue = [steady(number, x, 4, mps) for number, x in ((8, 115), (6, 130), (9, 0))]
    others = [*queue, *([steady(5, 160, 0, mps)] if beside else [])]
    assert signals(two_lanes(), ego(100, mps, y=4), *others)["near_lane_is_free"][0] == free


@pytest.mark.parametrize(("kind", "free"), [("busLane", "False"), ("urban", "True")])
def test_nobody_goes_to_a_lane_for_buses(kind, free):
    lanes = [
        replace(straight(1, 0, 600, left_of=2), types=frozenset({kind})),
        straight(2, 0, 600, 4, right_of=1),
    ]
    behind = steady(9, 0, 4, 10.0)
    assert signals(lanes, ego(100, y=4), behind)["near_lane_is_free"][0] == free


@pytest.mark.parametrize(("kind", "free"), [("busLane", "False"), ("urban", "True")])
def test_a_bus_stays_on_its_own_lane(kind, free):
    lanes = [
        straight(1, 0, 600, left_of=2),
        replace(straight(2, 0, 600, 4, right_of=1), types=frozenset({kind})),
    ]
    bus, behind = replace(ego(100, y=4), type="bus"), steady(9, 0, 4, 10.0)
    assert signals(lanes, bus, behind)["near_lane_is_free"][0] == free


@pytest.mark.parametrize(("kind", "free"), [("busLane", "?"), ("urban", "True")])
def test_nobody_knows_whether_a_bus_has_to_use_a_lane_for_buses(kind, free):
    lanes = [straight(1, 0, 600, left_of=2, types=frozenset({kind})), two_lanes()[1]]
    bus, behind = replace(ego(100, y=4), type="bus"), steady(9, 0, 4, 10.0)
    assert signals(lanes, bus, behind)["near_lane_is_free"][0] == free


@pytest.mark.parametrize(
    ("kind", "own", "free"),
    [
        ("exitRamp", "mainCarriageWay", "False"),
        ("accessRamp", "mainCarriageWay", "False"),
        ("exitRamp", "exitRamp", "True"),
        ("mainCarriageWay", "exitRamp", "True"),
    ],
)
def test_a_lane_for_who_leaves_is_none_for_who_drives_on(kind, own, free):
    """Of two lanes of a ramp each is as good as the other."""
    lanes = [
        straight(1, 0, 600, left_of=2, types=frozenset({kind})),
        straight(2, 0, 600, 4, right_of=1, types=frozenset({own})),
    ]
    behind = steady(9, 0, 4, 10.0)
    assert signals(lanes, ego(100, y=4), behind)["near_lane_is_free"][0] == free


def test_a_hard_shoulder_is_no_lane_beside_ego():
    road = [
        replace(straight(1, 0, 600, left_of=2), types=frozenset({"shoulder"})),
        straight(2, 0, 600, 4, right_of=1),
    ]
    found = signals(road, ego(100, y=4), steady(9, 0, 4, 10.0))
    # There is none to go to, so that nothing is in the way there
    assert found["near_lane_is_free"][0] == "True"
    slow = steady(8, 120, 4, 2.0)
    assert signals(two_lanes(), ego(100), slow)["other_lane_available"][0] == "True"
    left = [straight(1, 0, 600, left_of=2), replace(road[1], types=road[0].types)]
    assert signals(left, ego(100), slow)["other_lane_available"][0] == "False"


def test_a_lane_for_cycles_is_none_for_a_car():
    """Beside one lane ego's is the only one; between two there is none to go to at once."""
    cycles, behind = frozenset({"bicycleLane"}), steady(9, 0, 4, 10.0)
    one = [straight(1, 0, 600, left_of=2, types=cycles), straight(2, 0, 600, 4, right_of=1)]
    assert lanes_of(one, ego(100, y=4), behind) == ("kerb_lane", "one_lane")
    rider = replace(ego(100, y=4), type="bicycle")
    assert lanes_of(one, rider, behind) == ("far_lane", "two_lanes")
    assert signals(one, rider, behind)["near_lane_is_free"][0] == "True"
    turning = [
        straight(1, 0, 600, left_of=2),
        straight(2, 0, 600, 4, right_of=1, left_of=3, types=cycles),
        straight(3, 0, 600, 8, right_of=2),
    ]
    others = (ego(100, y=8), steady(9, 0, 8, 10.0))
    assert lanes_of(turning, *others) == ("far_lane", "two_lanes")
    assert signals(turning, *others)["near_lane_is_free"][0] == "False"


@pytest.mark.parametrize(("x", "free"), [(197, "True"), (199, "?")])
@pytest.mark.parametrize("kind", ["shoulder", "busLane"])
def test_nobody_has_to_go_to_a_lane_that_soon_is_one_for_others(kind, x, free):
    """It is from 300 m on; ego's front, 2 m ahead of its middle, gets there in 10 s from 200 m."""
    ends = straight(1, 0, 300, left_of=2, successors=(3,))
    lanes = [
        ends,
        straight(2, 0, 300, 4, right_of=1, successors=(4,)),
        straight(3, 300, 600, left_of=4, predecessors=(1,), types=frozenset({kind})),
        straight(4, 300, 600, 4, right_of=3, predecessors=(2,)),
    ]
    behind = steady(9, 97, 4, 10.0)
    told = signals(lanes, ego(x, y=4), behind, route=("2", "4"))
    assert told["near_lane_is_free"][0] == free


@pytest.mark.parametrize(("x", "free"), [(547, "True"), (549, "?")])
def test_before_the_map_s_end_nobody_knows_whether_drivers_sort_themselves(x, free):
    """It ends at 600 m, and ego's front is 2 m ahead of its middle: 51 and 49 m."""
    behind = steady(9, 400, 4, 10.0, steps=1)
    assert signals(two_lanes(), ego(x, y=4, steps=1), behind)["near_lane_is_free"] == [free]


def test_who_goes_back_already_is_not_told_to():
    """Its middle gets to the right lane in state 12, of 0.5 s each: from 2 s on it goes back."""
    places = {k: (100 + 5 * k, 4 if k < 12 else 1) for k in range(16)}
    told = signals(two_lanes(), vehicle(7, places, speed=10.0), steady(9, 0, 4, 10.0, steps=16))
    assert told["near_lane_is_free"] == ["True"] * 4 + ["?"] * 8 + ["True"] * 4


def two_lanes():
    return [straight(1, 0, 600, left_of=2), straight(2, 0, 600, 4, right_of=1)]


@pytest.mark.parametrize("unseen", [range(4, 7), range(1, 9)])
def test_one_whose_track_has_a_hole_may_be_on_the_near_lane_meanwhile(unseen):
    """It drives beside ego at its speed, seen before and after."""
    places = {k: (102 + 5 * k, 0) for k in range(10) if k not in unseen}
    others = [vehicle(8, places, speed=10.0), steady(9, 0, 4, 10.0, steps=10)]
    told = signals(two_lanes(), ego(100, y=4, steps=10), *others)["near_lane_is_free"]
    assert told == ["?" if k in unseen else "False" for k in range(10)]


@pytest.mark.parametrize(
    ("form", "first", "last"),
    # Of a recording of who is there at first nobody knows who has come since
    [
        ("CommonRoad scenario", 1, "True"),
        ("CommonRoad scenario", 0, "?"),
        ("Waymo scenario", 1, "?"),
    ],
)
def test_a_camera_that_stands_sees_what_ego_leaves_behind(form, first, last):
    """Who comes at 20 m/s while ego drives 10 needs 20 m and (400 - 100) / 16 m: 38.75 m.

    Ego's rear is 35 m from where it began in state 7, 40 m in state 8.
    """
    bodies = [ego(100, y=4, steps=10), steady(8, 400, 4, 10.0, steps=9, first=first)]
    found = replace(recording(two_lanes(), bodies, step_s=STEP_S), form=form)
    told = words_of(next_lane_signals)(context_of(found, ("1",)))
    words = np.where(
        unknown_in(told, "near_lane_is_free"), "?", values_of(told, "near_lane_is_free")
    )
    assert words.tolist() == ["?"] * 8 + [last] * 2


@pytest.mark.parametrize(("back", "free"), [(38, "?"), (39, "True")])
def test_one_behind_shows_how_far_behind_ego_is_seen(back, free):
    """As above: 38.75 m are needed, and rears are so far apart."""
    found = signals(two_lanes(), ego(100, y=4), steady(9, 100 - back, 4, 10.0))
    assert found["near_lane_is_free"][0] == free


@pytest.mark.parametrize(("end", "free"), [(250, "?"), (430, "True")])
def test_nobody_has_to_go_to_a_lane_that_ends_soon(end, free):
    """Ego is at 100 m, and lanes to join or to leave by begin or end within 300 m."""
    lanes = [
        straight(1, 0, end, left_of=2),
        straight(2, 0, end, 4, right_of=1, successors=(3,)),
        straight(3, end, 800, 4, predecessors=(2,)),
    ]
    behind = steady(9, 0, 4, 10.0)
    found = signals(lanes, ego(100, y=4), behind, route=("2", "3"))
    assert found["near_lane_is_free"][0] == free


@pytest.mark.parametrize(("gap", "free"), [(8, "?"), (30, "True")])
def test_lanes_that_each_go_through_a_junction_by_itself_stay_the_same_road_s(gap, free):
    """The lane at the kerb ends at 250 m; the next one begins beyond another such place."""
    far = 250 + gap
    lanes = [
        straight(1, 0, 250, left_of=2),
        straight(2, 0, 250, 4, right_of=1, left_of=3, successors=(12,)),
        straight(3, 0, 250, 8, right_of=2, successors=(13,)),
        straight(12, 250, far, 4, predecessors=(2,), successors=(22,)),
        straight(13, 250, far, 8, predecessors=(3,), successors=(23,)),
        straight(22, far, 400, 4, predecessors=(12,), left_of=23, successors=(32,)),
        straight(23, far, 400, 8, predecessors=(13,), right_of=22, successors=(33,)),
        straight(32, 400, 400 + gap, 4, predecessors=(22,), successors=(42,)),
        straight(33, 400, 400 + gap, 8, predecessors=(23,), successors=(43,)),
        straight(31, 400, 400 + gap, 0, predecessors=(22,), successors=(41,)),
        straight(41, 400 + gap, 800, 0, predecessors=(31,), left_of=42),
        straight(42, 400 + gap, 800, 4, predecessors=(32,), right_of=41, left_of=43),
        straight(43, 400 + gap, 800, 8, predecessors=(33,), right_of=42),
    ]
    behind = steady(9, 0, 4, 10.0)
    route = ("2", "12", "22", "32", "42")
    found = signals(lanes, ego(100, y=4), behind, route=route)
    assert found["near_lane_is_free"][0] == free


@pytest.mark.parametrize(("more", "free"), [((35, 60, 85), "?"), ((35,), "True")])
def test_nobody_has_to_go_to_a_hole_in_a_full_lane(more, free):
    """At 10 m/s 30 m may be a gap in a queue: two of the three here are of 21 m."""
    others = [steady(10 + x, 100 + x, 0, 10.0) for x in (-40, *more)]
    behind = steady(9, 0, 4, 10.0)
    found = signals(two_lanes(), ego(100, y=4), behind, *(others[1:] if more == (35,) else others))
    assert found["near_lane_is_free"][0] == free


INSIDE = frozenset({"intersection"})


def junction(straight_on=True, lights=()):
    """Two lanes up to 150 m; the one at the kerb turns right there, and may lead straight on."""
    lanes = [
        straight(1, 0, 150, left_of=2, successors=(3, 5) if straight_on else (5,), lights=lights),
        straight(2, 0, 150, 4, right_of=1, successors=(4,)),
        straight(4, 150, 170, 4, predecessors=(2,), successors=(7,), types=INSIDE),
        lanelet(
            5, [(150, 0), (160, -2), (164, -20)], predecessors=(1,), successors=(8,), types=INSIDE
        ),
        straight(6, 170, 600, left_of=7),
        straight(7, 170, 600, 4, predecessors=(4,), right_of=6),
        lanelet(8, [(164, -20), (164, -200)], predecessors=(5,)),
    ]
    if straight_on:
        lanes.append(straight(3, 150, 170, predecessors=(1,), successors=(6,), types=INSIDE))
    return lanes


@pytest.mark.parametrize(
    ("x", "straight_on", "free"),
    # At 10 m/s the junction is 10 s away from 48 m on, where the front is
    [(80, False, "False"), (80, True, "?"), (30, False, "True"), (30, True, "True")],
)
def test_drivers_sort_themselves_before_a_junction(x, straight_on, free):
    behind = steady(9, x - 80, 4, 10.0)
    lanes = junction(straight_on, (Light(0, (("green", 9),)),))
    found = signals(lanes, ego(x, y=4), behind, route=("2", "4", "7"))
    assert found["near_lane_is_free"][0] == free
