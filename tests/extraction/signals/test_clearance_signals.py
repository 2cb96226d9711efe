"""What leaves ego room: who comes towards it, who stands in its lane, lanes beside, access.

Lanes are 4 m wide; ego's has its middle at y = 0, the one towards it at y = 4.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.clearance_signals import clearance_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.recording import Light
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle

STEP_S = 0.5


def two_ways():
    return [straight(1, 0, 600), lanelet(2, [(600, 4), (0, 4)])]


def signals(lanes, *bodies, route=("1",), **thresholds):
    """The words, unknown ones as "?", which are the same in the mirror."""
    found = recording(lanes, bodies, step_s=STEP_S)
    sides = [
        clearance_signals(context_of(found, route, **thresholds)),
        clearance_signals(context_of(mirrored_recording(found), route, "left", **thresholds)),
    ]
    told = []
    for side in sides:
        words = {}
        for name, column in {**side.world, **side.about}.items():
            unknown = side.unknown.get(name, np.zeros(column.shape, dtype=bool))
            words[name] = np.where(unknown, "?", column).tolist()
        told.append(words)
    assert told[0] == told[1]
    return told[0]


def ego(x=0.0, mps=10.0, steps=4, y=0.0):
    return steady(7, x, y, mps, steps)


def coming(x, mps=10.0, steps=4, first=0):
    return steady(8, x, 4, -mps, steps, first)


@pytest.mark.parametrize(("x", "clear"), [(100, "False"), (140, "True")])
def test_one_that_comes_within_six_seconds(x, clear):
    # 96 m and 136 m between them, at 20 m/s together: 4.8 s and 6.8 s
    assert signals(two_ways(), ego(), coming(x))["oncoming_clear"][0] == clear


def test_nobody_comes_and_the_lane_can_be_seen():
    # In 6 s two who drive 12 m/s are 144 m nearer, which is less than 150 m
    assert signals(two_ways(), ego(mps=12))["oncoming_clear"] == ["True"] * 4
    assert signals(two_ways(), ego(mps=13))["oncoming_clear"] == ["?"] * 4


def test_a_fast_one_s_way_is_known_from_who_came():
    """At 20 m/s ego drives 6 s, which are 12 states, without meeting anybody."""
    free = signals(two_ways(), ego(mps=20, steps=20))["oncoming_clear"]
    assert free == ["True"] * 8 + ["?"] * 12
    # It is 240 m ahead at first, and beside ego 5.9 s later
    meets = signals(two_ways(), ego(mps=20, steps=20), coming(240, 20, 20))["oncoming_clear"]
    assert meets[0] == "False"
    # Who has passed is in nobody's way
    assert meets[-1] == "?"


def test_one_that_appears_midway():
    found = signals(two_ways(), ego(mps=20, steps=20), coming(200, 20, 10, first=4))
    # At 2 s it is 160 m ahead: they meet at about 5.9 s
    assert found["oncoming_clear"][0] == "False"


def test_one_that_stands_or_comes_on_the_other_carriageway_is_in_nobodys_way():
    stands = replace(coming(60, 0), states=steady(8, 60, 4, 0, 4, heading=np.pi).states)
    assert signals(two_ways(), ego(), stands)["oncoming_clear"] == ["True"] * 4
    divided = [straight(1, 0, 600), lanelet(2, [(600, 8), (0, 8)])]
    comes = steady(8, 60, 8, -10, 4)
    assert signals(divided, ego(), comes)["oncoming_clear"] == ["True"] * 4


def test_a_lane_of_ego_s_direction_needs_no_room_among_those_who_come():
    lanes = [
        straight(1, 0, 600, left_of=3),
        straight(3, 0, 600, 4, right_of=1),
        lanelet(2, [(600, 8), (0, 8)]),
    ]
    comes = steady(8, 60, 8, -10, 4)
    assert signals(lanes, ego(), comes)["oncoming_clear"] == ["True"] * 4
    # Nor does one that is on the far lane of its direction already, unless it reaches over its edge
    assert signals(lanes, ego(y=4), comes)["oncoming_clear"] == ["True"] * 4
    assert signals(lanes, ego(y=5.5), comes)["oncoming_clear"][0] == "False"


@pytest.mark.parametrize(
    ("x", "y", "blocked"),
    [
        (30, 0.0, True),  # 26 m ahead
        (40, 0.0, False),  # 36 m
        (2, 0.0, True),  # beside
        (-25, 0.0, True),  # 21 m behind: ego may be on its way back
        (-40, 0.0, False),
        (30, -1.7, False),  # it reaches to y = -0.7: 2.7 m are free, and ego is 2 m wide
        (30, -1.4, True),  # 2.4 m are too few
        (30, 4.0, False),  # on the other lane
    ],
)
def test_who_stands_in_ego_s_lane(x, y, blocked):
    found = signals(two_ways(), ego(mps=0), vehicle(9, dict.fromkeys(range(4), (x, y))))
    assert found["obstructed"] == [str(blocked)] * 4


def test_ego_passes_an_obstacle_on_the_lane_beside():
    """Ego is over the mark with most of its body, and not yet past the one that stands."""
    lanes = [straight(1, 0, 600, left_of=3), straight(3, 0, 600, 4, right_of=1)]
    stands = vehicle(9, dict.fromkeys(range(4), (20.0, 0.0)))
    crossing = vehicle(7, dict.fromkeys(range(4), (18.0, 2.6)))
    assert signals(lanes, crossing, stands)["obstructed"] == ["True"] * 4
    beyond = vehicle(7, dict.fromkeys(range(4), (18.0, 4.0)))
    assert signals(lanes, beyond, stands)["obstructed"] == ["False"] * 4


def test_one_that_moves_is_no_obstacle():
    assert signals(two_ways(), ego(), steady(9, 20, 0, 5))["obstructed"] == ["False"] * 4


@pytest.mark.parametrize(("y", "room"), [(2.0, "True"), (1.4, "False"), (0.0, "False")])
def test_room_on_the_near_side(y, room):
    # From the lane's edge at -2 to the other's side at y - 1; ego needs 2.5 m
    lanes = [straight(1, 0, 600, left_of=3), straight(3, 0, 600, 4, right_of=1)]
    found = signals(lanes, ego(), steady(9, 30, y, 5))
    assert found["room_on_near_side"] == [[room] * 4]


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
    assert signals(two_ways(), ego(100))["other_lane_available"][0] == "False"


def bend():
    """Ego turns left at 50 m, with a radius of 6 m, into a road at x = 56."""
    angles = np.radians(np.linspace(-90, 0, 10))
    turn = np.stack((50 + 6 * np.cos(angles), 6 + 6 * np.sin(angles)), axis=1)
    inside = frozenset({"intersection"})
    lanes = [
        straight(1, -100, 50, successors=(2,)),
        lanelet(2, turn, predecessors=(1,), successors=(3,), types=inside),
        lanelet(3, [(56, 6), (56, 100)], predecessors=(2,)),
    ]
    return lanes, np.concatenate(([(12.0, 0.0)], turn, [(56.0, 100.0)]))


def test_access_is_what_ego_turns_to_within_five_seconds():
    # At 5 m/s: in the junction from 38 to 47.4 m on, which are the states 16 to 18
    lanes, line = bend()
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
    way = 2.5 * np.arange(35)
    x, y = (np.interp(way, along, line[:, axis]) for axis in (0, 1))
    heading = np.clip((way - 38) / 6, 0, np.pi / 2)
    bodies = [vehicle(7, {k: (x[k], y[k])}, heading=heading[k]) for k in range(35)]
    body = replace(
        bodies[0],
        states={k: one.states[k] for k, one in enumerate(bodies)},
        outlines={k: one.outlines[k] for k, one in enumerate(bodies)},
    )
    found = signals(lanes, body, route=("1", "2", "3"))["needs_access"]
    # 5 s are 10 states, and it is not known what ego does after the drive
    assert found == ["False"] * 6 + ["True"] * 13 + ["False"] * 6 + ["?"] * 10


def test_a_drive_of_one_state():
    found = signals(two_ways(), ego(mps=20, steps=1))
    assert found["oncoming_clear"] in (["?"], ["True"])
    assert found["obstructed"] == ["False"]


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
        ((15.0, 10.0), None, True),
        ((13.0, 10.0), None, False),
        ((15.0, 8.0), None, False),
        # 12 m and (144 - 100) / 16 m for one behind at 12 m/s
        (None, (-19.0, 12.0), True),
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
    told = clearance_signals(context_of(found, ("1",)))
    words = np.where(told.unknown["near_lane_is_free"], "?", told.world["near_lane_is_free"])
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
