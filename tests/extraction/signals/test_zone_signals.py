"""What ego drives through: the room behind it, and who directs a crossing.

The junction reaches from x = 100 to 120; bodies are 4 m long, so room for ego are 5 m.
"""

from dataclasses import replace

import pytest

from rulec.extraction.signals.map import exit_room, zone_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.recordings.recording import Light
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import said, unknown_in, values_of
from support.words import words_of

INSIDE = frozenset({"intersection"})
RED = (Light(0, (("red", 9),)),)


def road(before=None, inside=None, *more):
    return [
        straight(1, 0, 100, successors=(2,), **(before or {})),
        straight(2, 100, 120, predecessors=(1,), successors=(3,), **(inside or {"types": INSIDE})),
        straight(3, 120, 300, predecessors=(2,)),
        *more,
    ]


def zebra(x, number=9, kinds=(), **more):
    types = frozenset({"crosswalk", *kinds})
    return lanelet(number, [(x, -6), (x, 6)], width=4, types=types, **more)


def going(number, xs, y=0.0, **more):
    return vehicle(number, {k: (x, y) for k, x in enumerate(xs)}, **more)


def told(lanes, *bodies, complete=(), **more):
    """The signals, which are the same in the mirror."""
    found = replace(recording(lanes, bodies), complete=frozenset(complete), **more)
    right = words_of(zone_signals, exit_room)(context_of(found, ("1", "2", "3")))
    left = words_of(zone_signals, exit_room)(
        context_of(mirrored_recording(found), ("1", "2", "3"), "left")
    )
    for name in right.world:
        assert said(right, name).tolist() == said(left, name).tolist(), name
    return right


def queueing(number, x):
    """One that has moved over before it stands."""
    return vehicle(number, {0: (x, 1.6)} | dict.fromkeys(range(1, 7), (x, 0)))


def exit_clear(lanes, ego, *others):
    body = going(7, ego) if isinstance(ego, tuple) else ego
    found = told(lanes, body, *others)
    unknown = unknown_in(found, "exit_clear").tolist()
    values = values_of(found, "exit_clear").tolist()
    return ["?" if u else v for u, v in zip(unknown, values, strict=True)]


# Fronts are 2 m ahead: ego is in the junction from state 1 on, and stands in it in state 3, speeds
# being means over a second
STOPS = (90, 105, 112, 112, 112, 120, 140)


def test_ego_stands_behind_one_that_leaves_no_room():
    # Its rear is at 123, 3 m behind the junction
    queue = going(8, (125, 125, 125, 125, 125, 140, 160))
    assert exit_clear(road(), STOPS, queue) == [False] * 4 + [True] * 3
    # The one farther ahead is not whom ego waits for
    beyond = going(9, [140] * 5 + [155, 170])
    found = told(road(), going(7, STOPS), beyond, queue)
    assert found.whom["exit_clear"].tolist() == [("8",)] * 4 + [()] * 3


def test_one_that_moves_on_in_time_leaves_room():
    queue = going(8, (125, 125, 130, 140, 150, 160))
    assert exit_clear(road(), (90, 100, 110, 120, 130, 140), queue) == [True] * 6


def test_ego_stands_in_the_junction_for_another_reason():
    """The one ahead was near behind the junction, and is far away when ego stands."""
    ahead = going(8, (115, 125, 145, 165, 185, 205, 225))
    assert exit_clear(road(), STOPS, ahead) == [True] * 7


def test_one_that_leaves_room_when_ego_enters_does_not_make_it_stand():
    """The one ahead is near behind the junction in state 1, and far away when ego stands.

    Another one has come there from the side by state 2, and does make it stand.
    """
    ahead = going(8, (115, 125, 145, 165, 185, 205, 225))
    comes = vehicle(9, {k: (125, y) for k, y in enumerate((8, 4, 0, 0, 0, 0, 0))})
    assert exit_clear(road(), STOPS, ahead, comes) == [True, "?", False, False] + [True] * 3


@pytest.mark.parametrize(("metres", "clear"), [(1.25, False), (1.75, True)])
def test_one_that_drives_on_makes_nobody_stand(metres, clear):
    """At 9 or 12.6 km/h, in steps of 0.5 s; it leaves 1.75 or 3.25 m where ego stands."""
    ahead = going(8, [120 + metres * k for k in range(7)])
    assert exit_clear(road(), STOPS, ahead) == [clear] * 4 + [True] * 3


def test_a_queue_within_the_junction_takes_the_room_behind_it():
    # Room behind the junction: 131 - 120 = 11 m, less 5 m for each of the two that are in it
    queue = [queueing(8, 133), queueing(9, 118), queueing(10, 113)]
    ego = (90, 103, 108, 108, 108, 108)
    assert exit_clear(road(), ego, *queue) == [False] * 6
    # With one of them only there is room enough, whatever ego waits for
    assert exit_clear(road(), ego, queue[0], queue[1]) == [True] * 6


def test_ego_waits_before_the_road_that_it_would_block():
    # The road across is 4 m wide, from x = 113 to 117; ego's front is at 112, and then at 114
    across = [
        lanelet(5, [(115, -40), (115, -10)], successors=(6,)),
        lanelet(6, [(115, -10), (115, 10)], predecessors=(5,), successors=(7,), types=INSIDE),
        lanelet(7, [(115, 10), (115, 40)], predecessors=(6,)),
    ]
    queue = queueing(8, 125)
    before, within = ((90, 105, x, x, x, 120, 140) for x in (110, 112))
    assert exit_clear(road(None, None, *across), before, queue) == [True] * 7
    assert False in exit_clear(road(None, None, *across), within, queue)


def test_a_queue_on_the_lane_beside_is_not_ahead():
    lanes = road()
    lanes[2] = replace(lanes[2], left_of="5")
    lanes.append(straight(5, 120, 300, 4, right_of=3))
    assert exit_clear(lanes, STOPS, going(8, (125,) * 7, 4.0)) == [True] * 7


@pytest.mark.parametrize(("y", "word"), [(-2.5, True), (-1.0, "?")])
def test_one_that_stands_at_the_edge_leaves_room_beside_it(y, word):
    """Of the 4 m of ego's lane it takes 0.5 m, or 2 m: ego, which is 2 m wide, wants 2.4 m.

    One that never moves may be parked there, and ego wait for others before it drives round it.
    """
    found = exit_clear(road(), STOPS, going(8, (125,) * 7, y))
    assert found[0] == word


def test_whether_ego_stands_in_the_junction_within_the_tolerance_or_by_a_corner():
    # Fronts in state 3 are at 99.98, 100.03 and 100.06, places are known to 0.05 m
    for x, word in ((97.98, "?"), (98.03, "?"), (98.06, False), (97.94, True)):
        ego = (78, 90, x, x, x, 120, 140)
        assert exit_clear(road(), ego, queueing(8, 125))[0] == word, x
    # Turned by 30° its right corner is 0.5 m farther ahead than the middle of its front
    turned = vehicle(7, {k: (x, 0) for k, x in enumerate((78, 90, 97.8, 97.8, 97.8))}, heading=0.52)
    assert exit_clear(road(), turned, queueing(8, 125))[0] == "?"


def test_a_recording_that_ends_before_ego_is_through():
    queue = going(8, (125, 125))
    assert exit_clear(road(), (90, 105), queue) == ["?", "?"]
    assert exit_clear(road(), (90, 105)) == [True, True]
    assert exit_clear(road(), (90,), going(8, (125,))) == ["?"]


def test_what_ego_enters_is_not_the_crossing_behind_it():
    """Ego stands on the crossing at 124 to 128, and has left the junction by then."""
    lanes = road(None, None, zebra(126))
    queue = queueing(8, 133)
    # Fronts are at 92, 107, 120 and 129: what ego enters is the crossing when it gets to it
    found = exit_clear(lanes, (90, 105, 118, 127, 127, 127), queue)
    assert found == [True, True, True, False, False, False]


def test_a_crossing_before_the_junction_is_another_place():
    """Ego stands with its front in the junction and its rear on the crossing at 94 to 98."""
    lanes = road(None, None, zebra(96))
    inside = going(8, (104,) * 6 + (120,))
    # Fronts are at 82, 92, 99, 99, 99, 101 and 107. The room behind the crossing is 4 m, less than
    # ego needs; then the junction is what it has got to
    found = exit_clear(lanes, (80, 90, 97, 97, 97, 99, 105), inside)
    assert found[:6] == [False] * 4 + [True] * 2


def kind(lanes, *, complete=(), x=40.0):
    (word,) = set(values_of(told(lanes, going(7, (x, x)), complete=complete), "crossing_kind"))
    return str(word)


@pytest.mark.parametrize(
    ("lanes", "word"),
    [
        (road(None, None, zebra(60)), "zebra"),
        (road(None, None, zebra(60, lights=RED)), "directed_crossing"),
        (road(None, None, zebra(60, kinds=["directed"])), "directed_crossing"),
        # Ego's light is at 100: a crossing in the lanelet's last metres, behind the line, and at
        # the far end of the junction are directed, one long before it is not
        (road({"lights": RED}, None, zebra(60)), "zebra"),
        (road({"lights": RED}, None, zebra(95)), "directed_crossing"),
        (road({"lights": RED}, None, zebra(110)), "directed_crossing"),
        (road({"lights": RED}, None, zebra(130)), "directed_crossing"),
        (road({"lights": RED}, None, zebra(160)), "zebra"),
    ],
)
def test_who_directs_a_crossing(lanes, word):
    assert kind(lanes) == word


def test_a_line_drawn_before_the_crossing_tells_where_the_light_s_reach_begins():
    line = [(80, -2), (80, 2)]
    before = {"lights": RED, "stop_line": lanelet(0, line).centre}
    assert kind(road(before, None, zebra(85))) == "directed_crossing"
    assert kind(road(before, None, zebra(75))) == "zebra"


def test_a_net_says_which_crossings_have_lights():
    lanes = road({"lights": RED}, None, zebra(110))
    assert kind(lanes, complete=["light"]) == "zebra"


def lit_from_the_side(lights):
    """The junction with a road across it, from y = -100, whose traffic has these lights or none."""
    return road(
        None,
        None,
        lanelet(4, [(110, -100), (110, -10)], successors=(5,), lights=lights),
        lanelet(5, [(110, -10), (110, 10)], predecessors=(4,), successors=(6,), types=INSIDE),
        lanelet(6, [(110, 10), (110, 100)], predecessors=(5,)),
        # Elsewhere there are lights
        straight(8, 0, 100, y=500, lights=RED),
    )


@pytest.mark.parametrize(
    ("more", "word"),
    [
        # Nothing tells of any light: at the junction, and up to 15 m from it, there may be some
        (road(None, None, zebra(60)), "zebra"),
        (road(None, None, zebra(95)), "unknown"),
        (road(None, None, zebra(110)), "unknown"),
        (road(None, None, zebra(145)), "zebra"),
        # Others have lights there
        ([*lit_from_the_side(RED), zebra(95)], "unknown"),
        # Nobody has any there, but somebody elsewhere
        ([*lit_from_the_side(()), zebra(95)], "zebra"),
    ],
)
def test_lights_that_nobody_tells_may_direct_a_crossing_at_a_junction(more, word):
    found = told(more, going(7, (40.0, 40.0)))
    unknown = unknown_in(found, "crossing_kind").any()
    assert word == ("unknown" if unknown else values_of(found, "crossing_kind")[0])
    assert kind(more, complete=["light"]) == "zebra"


@pytest.mark.parametrize(("far_end", "word"), [(26, "unknown"), (6, "zebra")])
def test_a_crossing_that_lanes_with_lights_lead_over_may_have_lights_for_all_lanes(far_end, word):
    """Ego is on a lane aside of a junction, as one for who turns off is; lights are for another."""
    across = lanelet(9, [(95, -6), (95, far_end)], width=4, types=frozenset({"crosswalk"}))
    onward = {"types": frozenset()}
    lanes = road(None, onward, straight(8, 0, 100, y=20, lights=RED), across)
    found = told(lanes, going(7, (40.0, 40.0)))
    unknown = unknown_in(found, "crossing_kind").any()
    assert word == ("unknown" if unknown else values_of(found, "crossing_kind")[0])


def test_without_a_crossing_the_kind_is_the_usual_one():
    assert kind(road()) == "zebra"
