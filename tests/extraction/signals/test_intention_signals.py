"""What others show and do next: turning, overtaking, leaving a stop, being on call, coming up.

Ego drives along y = 0 to a junction from x = 100 to 120; states are half a second apart.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.participants import intention_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import along, context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import unknown_in, values_of
from support.words import words_of

INSIDE = {"types": frozenset({"intersection"}), "junction": "x"}
INDICATORS = {"left_indicator", "right_indicator"}


def arc(x, y, radius, first, last):
    angles = np.radians(np.linspace(first, last, 19))
    return np.stack((x + radius * np.cos(angles), y + radius * np.sin(angles)), axis=1)


LEFT_TURN, RIGHT_TURN = arc(100, 14, 14, -90, 0), arc(100, -14, 14, 90, 0)


def crossroads():
    return [
        straight(1, -200, 100, successors=(2, 3, 4)),
        straight(2, 100, 120, predecessors=(1,), successors=(5,), **INSIDE),
        lanelet(3, LEFT_TURN, predecessors=(1,), successors=(6,), **INSIDE),
        lanelet(4, RIGHT_TURN, predecessors=(1,), successors=(7,), **INSIDE),
        straight(5, 120, 300, predecessors=(2,)),
        lanelet(6, [(114, 14), (114, 200)], predecessors=(3,)),
        lanelet(7, [(114, -14), (114, -200)], predecessors=(4,)),
    ]


def told(word, road, *bodies, side="right", complete=(), route=("1", "2", "5")):
    """A word's rows of those beside ego, or its values, with "?" where it is unknown."""
    found = replace(recording(road, bodies, step_s=0.5), complete=frozenset(complete))
    if side == "left":
        found = mirrored_recording(found)
    signals = words_of(intention_signals)(context_of(found, route, side))
    values = np.where(unknown_in(signals, word), "?", values_of(signals, word)).tolist()
    return values[0] if values and isinstance(values[0], list) else values


STEPS = 40
EGO = steady(7, -60, 0, 2.5, STEPS)
# At 5 m/s from x = -50: the middle is in the junction, 150 m along, from 30 s on
WAY = -50 + 200 + 2.5 * np.arange(STEPS) - 50


def other(turn, lamps=None, way=WAY):
    line = {"left": LEFT_TURN, "right": RIGHT_TURN, "on": np.array([(100.0, 0.0), (130.0, 0.0)])}
    ends = {"left": (114.0, 200.0), "right": (114.0, -200.0), "on": (300.0, 0.0)}
    points = np.concatenate(([(-50.0, 0.0)], line[turn], [ends[turn]]))
    if lamps is None:
        return along(8, points, way)
    shown = {k: frozenset(lamps.get(k, ())) for k in range(len(way))}
    return along(8, points, way, lamps=shown, shows=frozenset(INDICATORS))


def lit(lamp, first=0, last=STEPS):
    return {k: {lamp} for k in range(first, last)}


# It begins 50 m before the junction and is in it from state 20 to 28 if it turns left
def test_who_signals_and_turns_to_the_far_side():
    found = told("turning_far", crossroads(), EGO, other("left", lit("left_indicator")))
    first = found.index("True")
    assert first == 0 or found[:first] == ["False"] * first
    assert found[20:28] == ["True"] * 8
    # 10 s are 20 states: from the beginning on; what it does after the drive is not known
    assert first == 0
    assert found[-1] == "?"
    # In a simulation who is still there at the end may turn later, too
    silent = told("turning_far", crossroads(), EGO, other("left", {}))
    assert set(silent) == {"False"}


def test_the_near_side_is_the_far_one_where_traffic_keeps_to_the_other():
    near = other("right", lit("right_indicator"))
    assert "True" not in told("turning_far", crossroads(), EGO, near)
    assert "True" not in told("turning_far", crossroads(), EGO, near, side="left")
    far = other("left", lit("left_indicator"))
    assert "True" in told("turning_far", crossroads(), EGO, far, side="left")


def test_without_lamps_who_turns_may_have_signalled():
    found = told("turning_far", crossroads(), EGO, other("left"))
    assert found[20:28] == ["?"] * 8
    assert "True" not in found
    assert set(told("turning_far", crossroads(), EGO, other("on"))[:20]) == {"False"}


def waits_to_turn(lamps, until=60):
    """It stands 3 m before the junction, and turns left from state 40 on, 20 s after it began."""
    way = np.concatenate((np.full(40, 145.0), 145.0 + 2.5 * np.arange(30)))[:until]
    return other("left", lamps, way=way)


def test_who_waits_for_longer_with_its_indicator_on_is_still_about_to_turn():
    ego = steady(7, -60, 0, 2.5, 60)
    signals = lit("left_indicator", 10, 60)
    found = told("turning_far", crossroads(), ego, waits_to_turn(signals))
    assert found[:10] == ["False"] * 10
    assert found[10:42] == ["True"] * 32
    # It signals all the time, but nobody sees it turn
    stays = told("turning_far", crossroads(), ego, waits_to_turn(signals, until=36))
    assert stays[10:36] == ["?"] * 26
    # Signals that went out meanwhile were for something else
    earlier = waits_to_turn(lit("left_indicator", 2, 8) | signals)
    assert told("turning_far", crossroads(), ego, earlier)[2:8] == ["False"] * 6


def test_whose_track_ends_before_the_junction():
    # It ends in state 15, 12.5 m before the junction
    ends = other("left", lit("left_indicator"), way=WAY[:16])
    assert told("turning_far", crossroads(), EGO, ends)[:16] == ["?"] * 16
    dark = other("left", {}, way=WAY[:16])
    assert told("turning_far", crossroads(), EGO, dark)[:16] == ["False"] * 16
    unlit = other("left", None, way=WAY[:16])
    assert told("turning_far", crossroads(), EGO, unlit)[:16] == ["?"] * 16
    # In a simulation it has arrived where it was going
    road = [straight(1, -200, 300)]
    gone = told("turning_far", road, EGO, ends, complete=["arrivals"], route=("1",))
    assert gone[:16] == ["False"] * 16


def lanes():
    return [
        straight(1, -200, 300, left_of=2),
        straight(2, -200, 300, 4, right_of=1),
    ]


def pulling_out(lamps, steps=STEPS, at=30):
    places = {k: (10 + 5.0 * k, 0.0 if k < at else 4.0) for k in range(steps)}
    body = vehicle(8, places, speed=10)
    lamps = None if lamps is None else {k: frozenset(lamps.get(k, ())) for k in range(steps)}
    return replace(body, lamps=lamps or {}, shows=frozenset(INDICATORS if lamps else ()))


def test_who_signals_and_pulls_out():
    # Ego gains 2 m a state on it: it is beside it in 10 s at most from 40 m behind
    ego = steady(7, -50, 0, 14, STEPS)
    body = pulling_out(lit("left_indicator"))
    found = told("about_to_overtake", lanes(), ego, body, route=("1",))
    # It is in the other lane from state 30 on, and 5 s are 10 states
    assert found[:19] == ["False"] * 19
    assert found[19:30] == ["True"] * 11
    # Nobody knows what comes after the drive, only that it still signals
    assert found[31:] == ["?"] * 9
    silent = told("about_to_overtake", lanes(), ego, pulling_out({}), route=("1",))
    assert set(silent) == {"False"} or set(silent) == {"False", "?"}
    unlit = told("about_to_overtake", lanes(), ego, pulling_out(None), route=("1",))
    assert unlit[:19] == ["False"] * 19
    assert unlit[19:30] == ["?"] * 11


@pytest.mark.parametrize(("behind_m", "speed"), [(20, 10), (130, 12), (20, 6)])
def test_who_pulls_out_ahead_of_one_that_does_not_catch_up_with_it_may_just_change_lanes(
    behind_m, speed
):
    ego = steady(7, 10 - behind_m, 0, speed, STEPS)
    found = told(
        "about_to_overtake", lanes(), ego, pulling_out(lit("left_indicator")), route=("1",)
    )
    assert found[:19] == ["False"] * 19
    assert found[19:30] == ["?"] * 11


def test_who_joins_from_a_lane_that_ends_is_not_about_to_overtake():
    ego, body = steady(7, 0, 0, 10, STEPS), pulling_out(lit("left_indicator"))
    right, left = lanes()
    road = [replace(right, types=frozenset({"accessRamp"})), left]
    assert set(told("about_to_overtake", road, ego, body, route=("1",))[:30]) == {"False"}


def bus(lamps, starts=30, steps=STEPS, shows=(*INDICATORS, "doors")):
    places = {k: (0 + max(0, k - starts) * 2.0, 0.0) for k in range(steps)}
    body = vehicle(8, places, "bus", length=12)
    return replace(
        body,
        lamps={k: frozenset(lamps.get(k, ())) for k in range(steps)},
        shows=frozenset(shows),
    )


def three_lanes():
    return [
        straight(1, -200, 300, left_of=2),
        straight(2, -200, 300, 4, right_of=1, left_of=3),
        straight(3, -200, 300, 8, right_of=2),
    ]


def lamps_of_a_stop(signals_from=24, doors_until=20):
    return {
        k: ({"doors"} if k < doors_until else set())
        | ({"left_indicator"} if k >= signals_from else set())
        for k in range(STEPS)
    }


def test_a_bus_that_signals_and_leaves_its_stop():
    ego = steady(7, -100, 0, 2, STEPS)
    leaves = told("leaving_stop", lanes(), ego, bus(lamps_of_a_stop()), route=("1",))
    assert leaves[:24] == ["False"] * 24
    assert leaves[24:30] == ["True"] * 6
    assert leaves[32:] == ["False"] * 8
    boards = told("boarding", lanes(), ego, bus(lamps_of_a_stop()), route=("1",))
    assert boards == ["True"] * 20 + ["False"] * 20


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("heading", [0.0, np.pi], ids=["along", "against"])
@pytest.mark.parametrize("lane", [0, 1], ids=["at its right", "at its left"])
@pytest.mark.parametrize("doors", ["left_doors", "right_doors", "both", "untold"])
def test_passengers_board_where_ego_passes_only_if_the_doors_there_are_open(
    doors, lane, heading, side
):
    """The tram stands in the middle one of three lanes, from x = -10 to 10."""
    road = three_lanes()
    ego = steady(7, -100, 8.0 * lane, 5, STEPS)
    lit = {"both": {"left_doors", "right_doors"}, "untold": set()}.get(doors, {doors})
    body = vehicle(8, dict.fromkeys(range(STEPS), (0.0, 4.0)), "train", length=20, heading=heading)
    tram = replace(
        body,
        lamps=dict.fromkeys(range(STEPS), frozenset({"doors", *lit})),
        shows=frozenset({"doors"} if doors == "untold" else {"doors", "left_doors", "right_doors"}),
    )
    own = {0: "right_doors", 1: "left_doors"}[lane if heading == 0 else 1 - lane]
    boards = told("boarding", road, ego, tram, side=side, route=("1",))
    beside = (np.abs(-100 + 2.5 * np.arange(STEPS)) < 12).tolist()
    is_open = doors in ("both", "untold", own)
    assert boards == [str(is_open or not near) for near in beside]


def test_a_bus_that_has_not_left_when_the_drive_ends():
    ego = steady(7, -100, 0, 2, STEPS)
    stays = told("leaving_stop", lanes(), ego, bus(lamps_of_a_stop(), starts=90), route=("1",))
    assert stays[24:] == ["?"] * 16
    unlit = told("leaving_stop", lanes(), ego, bus(lamps_of_a_stop(90), starts=90), route=("1",))
    assert set(unlit) == {"False"}


@pytest.mark.parametrize(
    ("signals_from", "x", "expected"),
    # When it begins to signal its rear, at x = -6, is 12, 10 or 0 m ahead of ego, who needs
    # 5 + 25 / 4 m. The last one begins 15 s before it leaves, 34 m ahead; after 5 s it is 9 m
    [(24, -80.0, "True"), (24, -78.0, "?"), (24, -66.0, "?"), (0, -42.0, "True")],
    ids=["can wait", "too near", "beside", "could wait long ago"],
)
def test_who_is_too_near_to_wait_for_a_bus_in_comfort_may_go_on(signals_from, x, expected):
    ego = steady(7, x, 0, 5, STEPS)
    lamps = lamps_of_a_stop(signals_from)
    leaves = told("leaving_stop", lanes(), ego, bus(lamps), route=("1",))
    assert (set(leaves[:10]), set(leaves[24:30])) == ({"False"}, {expected})


def test_a_bus_at_a_red_light_leaves_no_stop():
    ego = steady(7, -100, 0, 2, STEPS)
    lamps = {k: {"left_indicator"} for k in range(STEPS)}
    assert set(told("leaving_stop", lanes(), ego, bus(lamps), route=("1",))) == {"False"}


def rider(places):
    return vehicle(8, places, "bicycle", length=2, width=0.6)


WAITS = vehicle(7, dict.fromkeys(range(12), (95.0, 0.0)))


def came(places, ego=WAITS, road=None, route=("1", "2", "5")):
    return told("came_up_beside", road or crossroads(), ego, rider(places), route=route)


def test_a_rider_who_comes_up_beside_one_that_waits():
    # Its front is level with ego's rear, at 93, in state 3
    places = {k: (80 + 4.0 * k, -1.5) for k in range(4)}
    places |= dict.fromkeys(range(4, 12), (95.0, -1.5))
    found = came(places)
    assert found == ["False"] * 4 + ["True"] * 8


def test_a_rider_whom_ego_came_up_beside():
    stands = dict.fromkeys(range(12), (95.0, -1.5))
    ego = vehicle(7, {k: (75 + 2.0 * min(k, 10), 0.0) for k in range(12)})
    assert set(came(stands, ego)) == {"False"}


def test_a_rider_who_is_beside_ego_when_first_seen():
    assert came(dict.fromkeys(range(12), (95.0, -1.5))) == ["?"] * 12
    # It appears midway
    late = came(dict.fromkeys(range(5, 12), (95.0, -1.5)))
    assert late[5:] == ["?"] * 7
    # Far from any junction nobody waits at one
    far = vehicle(7, dict.fromkeys(range(12), (0.0, 0.0)))
    assert set(came(dict.fromkeys(range(12), (0.0, -1.5)), far)) == {"False"}


def test_hazard_lights_are_not_blue_ones():
    lamps = {k: frozenset({"hazard_lights"} if k < 2 else {"blue_light"}) for k in range(4)}
    shows = frozenset({"hazard_lights", "blue_light"})
    car = replace(steady(8, 20, 0, steps=5), lamps=lamps, shows=shows)
    ego = steady(7, 0, 0, steps=5)
    assert told("hazard_lights", [straight(1, -50, 300)], ego, car, route=("1",)) == [
        *("True", "True", "False", "False", "?")
    ]
    assert told("warning_lights", [straight(1, -50, 300)], ego, car, route=("1",)) == [
        *["True"] * 5
    ]
