"""Where lines are that have a place on the map, what holds up to them, and rails that cross.

Ego comes along y = 0 on a lanelet that ends at x = 100, before a junction up to 120.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map.junction_signals import junction_signals, stop_line
from rulec.extraction.signals.map.map_signals import map_signals
from rulec.extraction.signals.map.priority_signals import priority_signals
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle

INSIDE = frozenset({"intersection"})


def road(drawn=None, signs=(), *more):
    line = None if drawn is None else np.array([(drawn, -2.0), (drawn, 2.0)])
    return [
        straight(1, 0, 100, successors=(2,), signs=frozenset(signs), stop_line=line),
        straight(2, 100, 120, predecessors=(1,), successors=(3,), types=INSIDE, junction="x"),
        straight(3, 120, 300, predecessors=(2,)),
        *more,
    ]


def context(lanes, *xs, y=0.0, route=("1", "2", "3")):
    return context_of(recording(lanes, [vehicle(7, {k: (x, y) for k, x in enumerate(xs)})]), route)


@pytest.mark.parametrize(
    ("drawn", "first"),
    [(95.0, 95.0), (110.0, 110.0), (None, 100.0), (30.0, 100.0)],
    ids=["before the end", "beyond it", "not drawn", "too far away to be this one"],
)
def test_where_a_line_is(drawn, first):
    begins, ends = stop_line(context(road(drawn), 50, 60), 0, 0)
    assert begins == pytest.approx(first, abs=0.05)
    # Whose front is beyond a line by a hand's breadth stands at it
    assert ends == pytest.approx(first + 0.3, abs=0.05)


@pytest.mark.parametrize(
    ("xs", "crosses"),
    [
        ((88, 92, 94), [False, False, True]),  # fronts at 90, 94 and 96
        ((92, 93.2, 93.2), [False, False, False]),  # 95.2: at the line
        ((92, 93.2, 94), [False, False, True]),
        ((94, 96, 98), [False, False, False]),  # over it from the start
    ],
)
def test_a_line_before_the_lanelet_s_end(xs, crosses):
    found = junction_signals(context(road(95.0, ["STOP"]), *xs))
    assert found.world["crosses_stop_line"].tolist() == crosses


def test_signs_hold_up_to_the_drawn_line():
    # By where the front was one state before, so that they hold while it crosses
    signs = ["STOP", "GREEN_ARROW", "NO_TURN_ON_RED"]
    found = map_signals(context(road(110.0, signs), 95, 106, 109, 112)).world
    for name in ("stop_sign", "turn_on_red_sign", "no_turn_on_red_sign"):
        assert found[name].tolist() == [True, True, True, False], name
    near = map_signals(context(road(95.0, signs), 88, 92, 95, 99)).world
    assert near["turn_on_red_sign"].tolist() == [True, True, True, False]


def test_a_sign_of_the_lane_beside_is_not_ego_s():
    lanes = road(None, ["GREEN_ARROW"])
    lanes[0] = replace(lanes[0], left_of="4")
    lanes.append(straight(4, 0, 100, 4, right_of=1))
    assert map_signals(context(lanes, 50, 60)).world["turn_on_red_sign"].all()
    beside = map_signals(context(lanes, 50, 60, y=4.0)).world["turn_on_red_sign"]
    assert not beside.any()
    assert "turn_on_red_sign" not in map_signals(context(road(), 50, 60)).world


def rails():
    rail = {"types": frozenset({"rail", "restricted_area"})}
    inside = lanelet(
        6, [(110, -10), (110, 10)], predecessors=(5,), successors=(8,), junction="x", **rail
    )
    return [
        lanelet(5, [(110, -90), (110, -10)], successors=(6,), **rail),
        inside,
        lanelet(8, [(110, 10), (110, 90)], predecessors=(6,), **rail),
    ]


@pytest.mark.parametrize(("comes_s", "conflict"), [(3.0, True), (8.0, False), (0.5, False)])
def test_a_train_whose_way_crosses_ego_s(comes_s, conflict):
    # Ego's front is on the rails at 2.3 s, its rear has left them at 3.3 s
    ego = vehicle(7, {k: (83 + 5 * k, 0) for k in range(24)})
    places = {k: (110.0, -10 + 10 * (k / 2 - comes_s)) for k in range(24)}
    train = vehicle(9, places, "train", heading=np.pi / 2, length=12)
    found = recording(road(None, (), *rails()), [ego, train])
    signals = priority_signals(context_of(found, ("1", "2", "3")))
    assert bool(signals.world["conflict_with_rail"].any()) == conflict
    assert not signals.world["conflict_from_right"].any()
