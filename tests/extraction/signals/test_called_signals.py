"""Emergency vehicles on call: who is, does one come near ego, and is ego in its way.

Ego drives along y = 0 at 10 m/s from x = 0; bodies are 4 m long, states half a second apart.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.conduct import called_signals
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

STEPS = 40


def lanes():
    return [
        straight(1, -200, 300, left_of=2),
        straight(2, -200, 300, 4, right_of=1),
    ]


def told(word, road, *bodies):
    """The word's values, with "?" where it is unknown."""
    signals = words_of(called_signals)(context_of(recording(road, bodies, step_s=0.5)))
    column = values_of(signals, word)
    unknown = unknown_in(signals, word)
    return np.where(unknown, "?", column).tolist()


def ambulance(x, mps=15.0, y=0.0, lamps=(True,), kind="priorityVehicle", steps=STEPS):
    heading = np.pi if mps < 0 else 0.0
    places = {k: (x + mps * 0.5 * k, y) for k in range(steps)}
    body = vehicle(8, places, kind, heading=heading, speed=abs(mps))
    shown = {k: {"blue_light"} if lamps and lamps[k % len(lamps)] else set() for k in range(steps)}
    return replace(
        body,
        lamps={k: frozenset(x) for k, x in shown.items()} if lamps is not None else {},
        shows=frozenset({"blue_light"}) if lamps is not None else frozenset(),
    )


def near(*bodies, road=None, ego=None):
    ego = ego or steady(7, 0, 0, 10, STEPS)
    return told("emergency_vehicle_near", road or lanes(), ego, *bodies)


def cleared(*bodies, road=None, ego=None):
    ego = ego or steady(7, 0, 0, 10, STEPS)
    return told("way_cleared", road or lanes(), ego, *bodies)


def test_one_that_comes_from_behind_with_blue_lights():
    assert near(ambulance(-30))[0] == "True"
    # A flash that is dark for half a second is still a flash
    assert near(ambulance(-30, lamps=(True, False)))[1] == "True"
    assert set(near(ambulance(-30, lamps=()))) == {"False"}
    assert near(ambulance(-30, kind="car"))[0] == "False"
    assert near(ambulance(-200))[0] == "False"


def test_one_that_comes_from_farther_behind_does_not_need_the_way_yet():
    """At 15 m/s behind 10 it is held up from 30 m, two seconds, on, and there in 4 s from 20 m."""
    found = near(ambulance(-60))
    # The gap is 56 m, and 5 m less each second: 31 m after five, 28.5 m in the state after that
    assert found[:10] == ["?"] * 10
    assert found[11:20] == ["True"] * 9
    # At 30 m/s it is 76 m behind, and beside ego within four seconds
    assert near(ambulance(-80, 30.0))[0] == "True"
    # One that is no faster than ego, and 56 m behind, may never come
    assert set(near(ambulance(-60, 10.0))) == {"?"}
    # At 16 m it has caught up, and is held up
    assert set(near(ambulance(-20, 10.0))) == {"True"}


def test_one_on_call_itself_may_go_first():
    ego = replace(ambulance(0, 10.0), id="7")
    assert near(ambulance(-20, 10.0), ego=ego)[0] == "?"
    # Off duty it is like any other
    idle = replace(ambulance(0, 10.0, lamps=()), id="7")
    assert near(ambulance(-20, 10.0), ego=idle)[0] == "True"


def test_whose_lane_ego_is_in_decides_whether_it_is_in_the_way():
    # Behind ego, which is in the middle of its lane, 1 m from either edge
    assert cleared(ambulance(-20))[0] == "False"
    # In the lane beside it may pass: ego may have left it that lane, or a law want more
    assert cleared(ambulance(-20, y=4.0))[0] == "?"
    assert near(ambulance(-20, y=4.0))[0] == "True"
    # It reaches into ego's lane, 0.4 m clear of ego's side, or 0.2 m
    assert cleared(ambulance(-20, y=2.4))[0] == "?"
    assert cleared(ambulance(-20, y=2.2))[0] == "False"
    # Two of them, one in ego's lane
    second = replace(ambulance(-30), id="9")
    assert cleared(ambulance(-20, y=4.0), second)[0] == "False"
    # At the edge of its lane, 0.2 m from it, ego is out of the way
    aside = steady(7, 0, -0.8, 10, STEPS)
    assert cleared(ambulance(-20), ego=aside)[0] == "True"
    assert cleared(ambulance(-20), ego=steady(7, 0, 0, 0, STEPS))[0] == "True"
    assert set(cleared()) == {"False"}


def test_one_that_comes_towards_ego_in_its_own_lane_is_not_stopped_by_it():
    against = [straight(1, -200, 300), lanelet(2, [(300, 4), (-200, 4)])]
    assert cleared(ambulance(100, -15, 4), road=against)[0] == "?"
    # Past a queue it comes in ego's lane
    assert cleared(ambulance(100, -15, 0), road=against)[0] == "False"


def crossing(y, mps, lamps=(True,)):
    """One that drives along x = 60, towards greater y."""
    places = {k: (60.0, y + mps * 0.5 * k) for k in range(STEPS)}
    body = vehicle(8, places, "priorityVehicle", heading=np.pi / 2, speed=mps)
    lit = {k: frozenset({"blue_light"} if lamps else ()) for k in range(STEPS)}
    return replace(body, lamps=lit, shows=frozenset({"blue_light"}))


def test_one_that_comes_on_a_road_across():
    """Who goes first there no source tells, so that nobody knows whether it needs the way."""
    road = [*lanes(), lanelet(5, [(60, -200), (60, 200)])]
    found = near(crossing(-60, 10), road=road)
    # 85 m away at first; after two seconds 40 m along both, 57 m; after three 30 m, 42 m
    assert found[:4] == ["False"] * 4
    assert found[6:10] == ["?"] * 4
    # Once both are through it drives away
    assert set(found[20:]) == {"False"}
    assert set(near(crossing(-60, 10, lamps=()), road=road)) == {"False"}


@pytest.mark.parametrize(
    ("brakes_s", "mps2", "held_up"),
    [(4.0, 4.0, True), (5.0, 3.0, True), (4.0, 1.0, False), (9.0, 4.0, False)],
    ids=["hard", "as ego goes past", "gently", "once ego is gone"],
)
def test_one_that_brakes_on_a_road_across_may_be_held_up_by_ego(brakes_s, mps2, held_up):
    """Ego goes over its road at 6 s; it would be there at 6.5 s if it did not brake."""
    road = [*lanes(), lanelet(5, [(60, -200), (60, 200)])]
    times = 0.5 * np.arange(STEPS)
    speeds = np.clip(10 - mps2 * np.clip(times - brakes_s, 0, None), 2, None)
    ys = -65 + np.concatenate(([0.0], np.cumsum(speeds[:-1] * 0.5)))
    body = crossing(-65, 10)
    moved = vehicle(8, {k: (60.0, y) for k, y in enumerate(ys)}, "priorityVehicle", heading=1.5708)
    states = {k: replace(x, speed=float(speeds[k])) for k, x in moved.states.items()}
    found = near(replace(body, states=states, outlines=moved.outlines), road=road)
    assert "True" not in found
    # From when ego is past it, for longer than laws give to clear the way
    assert found[18:24] == ["?" if held_up else "False"] * 6
    assert found[36:] == ["False"] * 4


def test_one_that_is_ahead_and_drives_away_needs_nobody_s_way():
    assert near(ambulance(30))[0] == "False"


def test_one_that_comes_towards_ego():
    against = [straight(1, -200, 300), lanelet(2, [(300, 4), (-200, 4)])]
    found = near(ambulance(100, -15, 4), road=against)
    # They meet after 4 s: then it drives away behind ego
    assert found[:7] == ["True"] * 7
    assert found[10:] == ["False"] * 30
    # On the other carriageway of a divided road it has its own way
    divided = [straight(1, -200, 300), lanelet(2, [(300, 7), (-200, 7)])]
    assert set(near(ambulance(100, -15, 7), road=divided)) == {"False"}


def test_one_that_comes_from_far_away_does_not_need_the_way_yet():
    """At 10 m/s each they meet within 4 s from 80 m on, and 50 m are near however slow it is."""
    against = [straight(1, -200, 300), lanelet(2, [(300, 4), (-200, 4)])]
    found = near(ambulance(134, -10, 4), road=against)
    # The gap is 130 m, and 10 m less in each state
    assert found[:5] == ["?"] * 5
    assert found[6:13] == ["True"] * 7


def test_one_that_stands_with_its_lights_on():
    # At an accident, or held up for as long: nobody knows
    stands = ambulance(20, 0.0)
    found = near(stands)
    assert "True" not in found
    assert found[20] == "?"

    # Behind ego in a queue for some seconds it does need the way, once ego could give it
    def sets_off(x):
        return {k: (x + 5 * max(0, k - 10), 0.0) for k in range(STEPS)}

    moving = vehicle(8, sets_off(-20), "priorityVehicle")
    body = replace(ambulance(-20, 0.0), states=moving.states, outlines=moving.outlines)
    found = near(body, ego=vehicle(7, sets_off(0)))
    assert found[5] == "?"
    # Both drive at 10 m/s from the eleventh state on, 16 m apart
    assert found[13:] == ["True"] * (STEPS - 13)


def test_one_that_waits_at_lights_having_come_towards_ego():
    """Behind ego, its back to it, it needs nobody's way there, and before that ego's."""
    against = [straight(1, -200, 300), lanelet(2, [(300, 4), (-200, 4)])]
    places = {k: (max(40 - 7.5 * k, -20.0), 4.0) for k in range(STEPS)}
    moving = vehicle(8, places, "priorityVehicle", heading=np.pi)
    body = replace(ambulance(40), states=moving.states, outlines=moving.outlines)
    found = near(body, road=against)
    assert found[:3] == ["True"] * 3
    # Ego is 15 m ahead of it after five states, and it stands from the eighth on
    assert set(found[6:]) == {"False"}
    ahead = near(body, road=against, ego=steady(7, -70, 0, 1, STEPS))
    # It stands 36 m ahead
    assert ahead[20] == "True"


@pytest.mark.parametrize(("sounds", "expected"), [(True, "True"), (False, "?")])
def test_lights_without_a_horn_that_is_told(sounds, expected):
    """Most laws ask for both, some for either."""
    body = ambulance(-30)
    lamps = {k: lit_then | ({"horn"} if sounds else set()) for k, lit_then in body.lamps.items()}
    assert near(replace(body, lamps=lamps, shows=body.shows | {"horn"}))[0] == expected


def test_lights_that_a_file_does_not_tell():
    assert near(ambulance(-60, lamps=None))[0] == "?"
    assert set(near(ambulance(30, lamps=None))[:4]) == {"False"}
    assert near()[0] == "False"
