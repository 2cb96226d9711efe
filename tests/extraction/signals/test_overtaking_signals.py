"""Signals of overtaking: ego others, and others ego."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals import flow_signals
from rulec.extraction.signals.conduct import being_overtaken, overtaking_signals
from rulec.extraction.tracks.mirror import mirrored_recording
from support.builders.drive_contexts import along, context_of, line, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import possible_in, unknown_in, values_of
from support.words import words_of


@pytest.mark.parametrize(
    ("mps", "ago_s", "known"), [(0, 9, False), (0, 11, True), (5, 9, False), (6, 9, True)]
)
def test_who_sets_off_beside_others_is_not_told_to_be_overtaken(mps, ago_s, known):
    """Ego creeps (at 18 km/h, not at 21.6) for 2 s, and goes at 10 m/s until 15 m/s pass it."""
    last = 2 * (2 + ago_s)
    ego = vehicle(7, {k: (min(k, 4) * mps / 2 + max(k - 4, 0) * 5.0, 0) for k in range(last + 6)})
    place = ego.states[last].x
    other = vehicle(8, {k: (place + (k - last) * 7.5, 4.0) for k in range(last - 4, last + 6)})
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(lanes(2), [ego, other]))
    )
    assert possible_in(found, "being_overtaken")[last]
    assert found.whom["being_overtaken"][last] == ("8",)
    assert unknown_in(found, "being_overtaken")[last] == (not known)


@pytest.mark.parametrize(("slowest", "known"), [(15, True), (11, True), (8, False)])
def test_who_falls_back_before_it_gets_past_may_have_given_up(slowest, known):
    """It comes at 15 m/s, ego goes at 10 m/s; for 2 s it is slower than before."""
    speeds = [15, 15] + [slowest] * 4 + [15] * 14
    x = np.cumsum([-12.0] + [mps / 2 for mps in speeds])
    ego = steady(7, 0, 0, 10, steps=20)
    other = vehicle(8, {k: (float(x[k]), 4.0) for k in range(20)})
    whole = replace(recording(lanes(2), [ego, other]), complete=frozenset({"arrivals"}))
    found = words_of(overtaking_signals, being_overtaken)(context_of(whole))
    assert values_of(found, "being_overtaken")[0] == known
    assert unknown_in(found, "being_overtaken")[0] == (not known)


def runs(speeds):
    """Ego's places, and its speeds at most of them, from x = 0; half a second apart."""
    places = np.concatenate(([0.0], np.cumsum(np.array(speeds[:-1]) * 0.5)))
    return {k: (x, 0.0) for k, x in enumerate(places.tolist())}


CRAWLED = [4.0] * 10 + [12.0] * 24


GAINING = [0.0] * 4 + [0.4 * k for k in range(30)]


@pytest.mark.parametrize(
    ("speeds", "at", "known"),
    [(CRAWLED, 20, False), (CRAWLED, 31, True), (GAINING, 33, False)],
    ids=["5 s after it crawled", "10.5 s after", "still gaining speed after 15 s"],
)
def test_who_gets_up_speed_from_a_crawl_sets_off(speeds, at, known):
    places = runs(speeds)
    passes = {k: (places[at][0] + (k - at) * 9.0, 4.0) for k in range(at - 4, at + 8)}
    ego = vehicle(7, places | {at + k: (places[at][0] + 6.0 * k, 0.0) for k in range(1, 8)})
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(lanes(2), [ego, vehicle(8, passes)]))
    )
    assert possible_in(found, "being_overtaken")[at]
    assert unknown_in(found, "being_overtaken")[at] == (not known)


@pytest.mark.parametrize(("steady_for", "known"), [(0, False), (6, True)])
def test_who_has_gained_speed_since_its_drive_began_may_be_getting_it_up(steady_for, known):
    """Whoever a simulator sets on the road at 10 m/s gains 1 m/s2, beside one at 18 m/s."""
    speeds = [10.0] * steady_for + [10.0 + 0.5 * k for k in range(16)]
    places, at = runs(speeds), steady_for + 8
    passes = {k: (places[at][0] + (k - at) * 9.0, 4.0) for k in range(at - 4, at + 6)}
    found = recording(lanes(2), [vehicle(7, places), vehicle(8, passes)])
    # All traffic is in it, so that nobody who is as fast at first has stood just before
    signals = words_of(overtaking_signals, being_overtaken)(
        context_of(replace(found, complete=frozenset({"arrivals"})))
    )
    assert possible_in(signals, "being_overtaken")[at]
    assert unknown_in(signals, "being_overtaken")[at] == (not known)


@pytest.mark.parametrize(("gained", "known"), [(0.5, False), (0.0, True)])
def test_a_drive_that_begins_beside_one_that_overtakes_may_begin_in_gaining_speed(gained, known):
    """In its first state nothing before it says whether it is getting up speed."""
    ego = vehicle(7, runs([10.0 + gained * k for k in range(16)]))
    other = vehicle(8, {k: (9.0 * k, 4.0) for k in range(16)})
    found = replace(recording(lanes(2), [ego, other]), complete=frozenset({"arrivals"}))
    signals = words_of(overtaking_signals, being_overtaken)(context_of(found))
    assert possible_in(signals, "being_overtaken")[0]
    assert unknown_in(signals, "being_overtaken")[0] == (not known)


@pytest.mark.parametrize(("before", "known"), [(24.0, False), (20.0, True), (16.0, True)])
def test_who_had_to_brake_regains_its_speed(before, known):
    """Ego is at 20 m/s or a little more, and was at another speed up to 4 s before."""
    speeds = [before] * 10 + [20.0 + 0.02 * k for k in range(16)]
    places, at = runs(speeds), 18
    passes = {k: (places[at][0] + (k - at) * 13.0, 4.0) for k in range(at - 4, at + 6)}
    ego = vehicle(7, places)
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(lanes(2), [ego, vehicle(8, passes)]))
    )
    assert possible_in(found, "being_overtaken")[at]
    assert unknown_in(found, "being_overtaken")[at] == (not known)


@pytest.mark.parametrize("complete", [(), ("arrivals",)])
@pytest.mark.parametrize(
    ("first_s", "gained", "known"), [(4, 0.5, False), (12, 0.5, True), (4, 0.0, True)]
)
def test_who_gains_speed_may_have_braked_before_it_was_seen(first_s, gained, known, complete):
    """Ego goes at 16 m/s for so long, and gains 1 m/s2 then, or nothing."""
    at = 2 * first_s + 2
    places = runs([16.0] * (at - 2) + [16.0 + gained * k for k in range(8)])
    passes = {k: (places[at][0] + (k - at) * 11.0, 4.0) for k in range(at - 4, at + 6)}
    found = recording(lanes(2), [vehicle(7, places), vehicle(8, passes)])
    signals = words_of(overtaking_signals, being_overtaken)(
        context_of(replace(found, complete=frozenset(complete)))
    )
    assert possible_in(signals, "being_overtaken")[at]
    assert unknown_in(signals, "being_overtaken")[at] == (not (known or complete))


@pytest.mark.parametrize(("ago_s", "known"), [(4, False), (12, True)])
def test_who_has_turned_into_a_road_gets_up_speed_yet(ago_s, known):
    """Ego turns right at 8 m/s, and drives on beside one at 15 m/s."""
    angles = np.radians(np.linspace(90, 0, 19))
    turn = np.stack((100 + 14 * np.cos(angles), -14 + 14 * np.sin(angles)), axis=1)
    inside = frozenset({"intersection"})
    road = [
        straight(1, -100, 100, successors=(2,)),
        lanelet(2, turn, predecessors=(1,), successors=(3,), types=inside, junction="x"),
        lanelet(3, [(114, -14), (114, -300)], predecessors=(2,), left_of=4),
        lanelet(4, [(118, -14), (118, -300)], right_of=3),
    ]
    line = np.concatenate(([(-100.0, 0.0)], turn, [(114.0, -300.0)]))
    out_m = 200 + 22 + 8.0 * ago_s
    last = 2 * ago_s + 10
    ego = along(7, line, out_m + 4.0 * (np.arange(last + 6) - last))
    beside = along(
        8,
        np.array([(118.0, 100.0), (118.0, -300.0)]),
        114 + 8.0 * ago_s + 7.5 * (np.arange(last + 6) - last),
    )
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(road, [ego, beside]), ("1", "2", "3"))
    )
    assert possible_in(found, "being_overtaken")[last]
    assert unknown_in(found, "being_overtaken")[last] == (not known)


@pytest.mark.parametrize("types", [(), ("accessRamp",), ("exitRamp",)])
def test_who_gets_up_speed_on_a_lane_that_joins_is_not_overtaken(types):
    road = [
        straight(1, -100, 300, left_of=2, types=frozenset(types)),
        straight(2, -100, 300, 4.0, right_of=1),
    ]
    bodies = [steady(7, 0, 0, 21, steps=12), steady(8, 0, 4.0, 26, steps=12)]
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(road, bodies), route=("1",))
    )
    assert values_of(found, "being_overtaken")[0] == (not types)
    assert not unknown_in(found, "being_overtaken").any() or not types


@pytest.mark.parametrize(("ago_s", "known"), [(4, False), (11, True)])
def test_who_has_joined_gets_up_speed_yet(ago_s, known):
    """Ego comes at 21 m/s from a lane that joins, and leaves it so long before it is overtaken."""
    road = [
        straight(1, -100, 600, left_of=2, types=frozenset({"accessRamp"})),
        straight(2, -100, 600, 4.0, right_of=1, left_of=3),
        straight(3, -100, 600, 8.0, right_of=2),
    ]
    last = 2 * ago_s + 2
    ego = vehicle(7, {k: (10.5 * k, 0.0 if k < 2 else 4.0) for k in range(last + 4)}, speed=21)
    passes = {k: (10.5 * last + 13.0 * (k - last), 8.0) for k in range(last + 4)}
    other = vehicle(8, passes, speed=26)
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(road, [ego, other]), route=("1",))
    )
    assert possible_in(found, "being_overtaken")[last]
    assert unknown_in(found, "being_overtaken")[last] == (not known)


@pytest.mark.parametrize(("ago_s", "known"), [(4, False), (11, True)])
def test_who_has_come_onto_a_larger_road_gets_up_speed_yet(ago_s, known):
    """Ego comes at 21 m/s from a road of one lane beside the two of another one.

    Who drove on those, beside which that lane comes, has joined nothing.
    """
    road = [
        straight(1, -100, 10, successors=(4,)),
        straight(2, -100, 10, 4.0, successors=(5,), left_of=3),
        straight(3, -100, 10, 8.0, successors=(6,), right_of=2),
        straight(4, 10, 600, predecessors=(1,), left_of=5),
        straight(5, 10, 600, 4.0, predecessors=(2,), right_of=4, left_of=6),
        straight(6, 10, 600, 8.0, predecessors=(3,), right_of=5),
    ]
    last = 2 * ago_s
    passes = {k: (10.5 * last + 13.0 * (k - last), 8.0) for k in range(last + 4)}
    other = vehicle(8, passes, speed=26)
    for y, route, told in ((0.0, ("1", "4"), known), (4.0, ("2", "5"), True)):
        ego = vehicle(7, {k: (10.5 * k, y if k < 3 else 4.0) for k in range(last + 4)}, speed=21)
        context = context_of(recording(road, [ego, other]), route=route)
        found = words_of(overtaking_signals, being_overtaken)(context)
        assert possible_in(found, "being_overtaken")[last]
        assert unknown_in(found, "being_overtaken")[last] == (not told)


@pytest.mark.parametrize(("speed", "known"), [(9, False), (21, True)])
def test_who_may_have_stood_before_anybody_saw_it_may_set_off(speed, known):
    """To 9 m/s it takes 4.5 s, to 21 m/s 10.5 s."""
    ego, other = steady(7, 0, 0, speed, steps=12), steady(8, 0, 4.0, speed + 5, steps=12)
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(lanes(2), [ego, other]))
    )
    assert possible_in(found, "being_overtaken")[0]
    assert unknown_in(found, "being_overtaken")[0] == (not known)


@pytest.mark.parametrize(("speed", "known"), [(4, False), (9, True)])
def test_who_is_put_into_all_traffic_slowly_sets_off(speed, known):
    """Simulators begin drives amid the road, at any speed: who is slow then gets going."""
    ego, other = steady(7, 0, 0, speed, steps=12), steady(8, 0, 4.0, speed + 5, steps=12)
    whole = replace(recording(lanes(2), [ego, other]), complete=frozenset({"arrivals"}))
    found = words_of(overtaking_signals, being_overtaken)(context_of(whole))
    assert possible_in(found, "being_overtaken")[0]
    assert unknown_in(found, "being_overtaken")[0] == (not known)


def overtakes(x, speed, y=0.0, **more):
    """Is ego, at 20 m/s on the left one of two lanes, overtaking a vehicle?"""
    found = recording(lanes(2), [steady(7, 0, 4, speed=20), steady(8, x, y, speed=speed)])
    return bool(
        values_of(
            words_of(overtaking_signals, being_overtaken)(context_of(found, ("1",), **more)),
            "overtaking",
        )[0]
    )


def test_overtaking_is_passing_a_slower_vehicle_on_its_far_side():
    assert overtakes(0, 10)
    assert overtakes(100, 10)  # 96 m of gap at 10 m/s are 9.6 s
    assert not overtakes(110, 10)
    assert overtakes(-40, 10)  # 36 m past it at 20 m/s are 1.8 s
    assert not overtakes(-46, 10)
    assert not overtakes(0, 20)
    assert not overtakes(0, 10, y=4.0)
    # Where traffic keeps left, the right side is the far one
    assert not overtakes(0, 10, side="left")


def coming(*others, y=4.0, side="right", count=2, steps=12, **thresholds):
    """Is ego being overtaken in the first state, by one of those on the far lane? None: unknown."""
    ego = steady(7, 0, 0, steps=steps)
    bodies = [steady(8 + k, x, y, speed, steps) for k, (x, speed) in enumerate(others)]
    found = replace(recording(lanes(count), [ego, *bodies]), complete=frozenset({"arrivals"}))
    found = words_of(overtaking_signals, being_overtaken)(
        context_of(found, ("1",), side, **thresholds)
    )
    return (
        None
        if unknown_in(found, "being_overtaken")[0]
        else bool(values_of(found, "being_overtaken")[0])
    )


def test_being_overtaken_is_having_a_faster_vehicle_on_the_far_side():
    # To get past 4 m of ego and its own 4 m at 5 m/s more takes 1.6 s from beside
    assert coming((0, 15)) is True
    assert coming((-13, 15)) is True  # 9 m behind at 5 m/s more: 1.8 s
    assert coming((-15, 15)) is False
    assert coming((20, 15)) is False
    assert coming((0, 10)) is False
    assert coming((0, 15), side="left") is False


def test_who_is_hardly_faster_does_not_overtake():
    assert coming((0, 11.3)) is False  # 4.7 km/h
    assert coming((3, 11.5)) is True  # 5.4 km/h: past in 3.4 s
    assert coming((0, 11.3), clearly_faster_kmh=4) is True


def test_who_overtakes_is_on_the_next_lane():
    assert coming((0, 15), y=8.0, count=3) is False


@pytest.mark.parametrize(("y", "overtaken"), [(4.0, True), (2.8, True), (2.2, False)])
def test_on_the_mark_the_next_lane_is_the_one_that_ego_moves_into(y, overtaken):
    """Ego, 2 m wide, comes from the lane up to y = 2; one passes two lanes farther, at y = 8."""
    bodies = [steady(7, 0, y, 10, 40), steady(8, 0, 8, 15, 40)]
    context = context_of(recording(lanes(3), bodies), near_m=200)
    assert (
        bool(
            possible_in(words_of(overtaking_signals, being_overtaken)(context), "being_overtaken")[
                0
            ]
        )
        == overtaken
    )


def test_who_gets_past_overtakes_and_the_recording_may_end_before():
    # Faster for a second, then as fast as ego: it stays beside
    places = {k: (-3 + 2 * min(k, 2) + 5.0 * k, 4.0) for k in range(40)}
    ego, other = steady(7, 0, 0, steps=40), vehicle(8, places)
    context = context_of(recording(lanes(2), [ego, other]), near_m=200)
    found = words_of(overtaking_signals, being_overtaken)(context)
    # And so it does 10 s later
    assert not values_of(found, "being_overtaken").any()
    assert not unknown_in(found, "being_overtaken")[0]
    assert coming((-13, 15), steps=4) is None


@pytest.mark.parametrize(("pauses", "known"), [(False, False), (True, True)])
def test_who_regains_its_speed_after_a_jam_may_be_overtaken_meanwhile(pauses, known):
    """From 30 m/s it brakes to 15 by 5 s, and gains 0.5 m/s² to 25 at 25 s; passed at 20 s.

    The 10 s in which having been faster counts are over by then. One that has driven evenly in
    between has got used to its speed.
    """
    times = np.arange(0, 30, 0.5)
    speeds = np.where(times < 2, 30.0, np.maximum(30 - 5 * (times - 2), 15.0))
    speeds = np.where(times < 5, speeds, 15 + 0.5 * (times - 5))
    if pauses:
        speeds = np.where((times >= 14) & (times < 18), 19.5, speeds)
        speeds = np.where(times >= 18, 19.5 + 0.5 * (times - 18), speeds)
    way = np.concatenate(([0], np.cumsum(speeds[:-1] * 0.5)))
    ego = along(7, np.array([(0.0, 0.0), (900.0, 0.0)]), way)
    passes = way[40] + 32 * (times - 20)
    other = along(8, np.array([(-900.0, 4.0), (1900.0, 4.0)]), 900 + passes)
    road = [straight(1, 0, 900, left_of=2), straight(2, 0, 900, 4.0, right_of=1)]
    found = replace(recording(road, [ego, other]), complete=frozenset({"arrivals"}))
    told = words_of(overtaking_signals, being_overtaken)(
        context_of(found, near_m=300), frozenset({"being_overtaken"})
    )
    assert possible_in(told, "being_overtaken")[40]
    assert bool(unknown_in(told, "being_overtaken")[40]) != known


def test_nobody_is_overtaken_where_all_lanes_queue():
    # All drive at 10 m/s, but those beside ego are a little faster
    queues = [*line(10, 2), *line(12, 3, y=4.0, start=0.0, number=30)]
    context = context_of(recording(lanes(2), [steady(7, 0, 0), *queues]), ("1",))
    assert possible_in(words_of(flow_signals)(context), "dense_all_lanes")[0]
    assert not values_of(words_of(overtaking_signals, being_overtaken)(context), "being_overtaken")[
        0
    ]
    assert coming((0, 12)) is True


def test_overtaking_looks_as_far_as_ten_seconds_of_the_difference_need():
    # 200 m at 25 m/s more are 8 s, and farther than what counts for anything else
    ego, slow = steady(7, -90, 4.0, speed=40), steady(8, 114, 0, speed=15)
    context = context_of(recording(lanes(2), [ego, slow]), ("2",))
    assert values_of(words_of(overtaking_signals, being_overtaken)(context), "overtaking")[0]
    assert not context.relevant[0, 0]


def test_overtaking_begins_when_ego_pulls_out():
    """Ego, at 20 m/s, goes to the left lane from 2 to 3 s; one at 10 m/s was 90 m ahead at 0 s."""
    ways = {k: (10.0 * k, min(max(k - 4, 0) * 2.0, 4.0)) for k in range(12)}
    slow = vehicle(8, {k: (90 + 5.0 * k, 0) for k in range(12)}, speed=10)
    context = context_of(recording(lanes(2), [vehicle(7, ways, speed=20), slow]))
    signals = words_of(overtaking_signals, being_overtaken)(context)
    overtakes = values_of(signals, "overtaking").tolist()
    begins = values_of(signals, "begins_to_overtake").tolist()
    assert not overtakes[3]
    assert overtakes[8]
    assert begins[: overtakes.index(True)] == [True] * overtakes.index(True)
    # Who stays behind does not
    stays = context_of(recording(lanes(2), [steady(7, 0, 0, speed=20), slow]))
    assert not values_of(
        words_of(overtaking_signals, being_overtaken)(stays), "begins_to_overtake"
    ).any()


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("slow", "past"),
    [
        # 14 m/s behind one at 10, 50 m ahead: beside it within 10 s only later, but out for that
        (range(50, 130, 5), "FFFTTTTTTTTTTTTF"),
        # It gets up speed and is not reached: ego goes back, and may have given up
        (np.cumsum([50, *[9] * 15]), "FFF????????????F"),
        # Whom ego has not come near to it does not mean to pass
        (range(180, 260, 5), "FFFFFFFFFFFFFFFF"),
    ],
)
def test_who_overtakes_beyond_the_middle_does_so_from_going_there_until_it_is_back(
    slow, past, side
):
    ys = [0, 0, 1, *[3.5] * 12, 0]
    ego = vehicle(7, {k: (7.0 * k, y) for k, y in enumerate(ys)}, speed=14)
    other = vehicle(8, {k: (float(x), 0.0) for k, x in enumerate(slow)}, speed=10)
    found = recording([straight(1, 0, 500), lanelet(2, [(500, 4), (0, 4)])], [ego, other])
    found = mirrored_recording(found) if side == "left" else found
    signals = words_of(overtaking_signals, being_overtaken)(
        context_of(found, side=side), frozenset({"overtaking"})
    )
    told = zip(values_of(signals, "overtaking"), unknown_in(signals, "overtaking"), strict=True)
    assert "".join("?" if dark else "FT"[int(value)] for value, dark in told) == past


@pytest.mark.parametrize(("before", "told"), [(0, "????????????FFFF"), (3, "FFFFFFFFFFFFFFFF")])
def test_whose_drive_begins_beyond_the_middle_may_have_overtaken(before, told):
    """Nobody else is there. 6 s, as long as overtaking takes, are 12 states."""
    ys = [*[0] * before, *[3.5] * (14 - before), 0, 0]
    ego = vehicle(7, {k: (7.0 * k, y) for k, y in enumerate(ys)}, speed=14)
    found = recording([straight(1, 0, 500), lanelet(2, [(500, 4), (0, 4)])], [ego])
    signals = words_of(overtaking_signals, being_overtaken)(
        context_of(found), frozenset({"overtaking"})
    )
    words = zip(values_of(signals, "overtaking"), unknown_in(signals, "overtaking"), strict=True)
    assert "".join("?" if dark else "FT"[int(value)] for value, dark in words) == told


def test_who_overtakes_and_is_back_for_half_a_second_overtakes_meanwhile():
    """`driving_side` takes so short a time for noise, and would say that ego drives on the left."""
    ys = [0, 0, 1, *[3.5] * 5, 0, *[3.5] * 6, 0]
    ego = vehicle(7, {k: (7.0 * k, y) for k, y in enumerate(ys)}, speed=14)
    other = vehicle(8, {k: (50 + 5.0 * k, 0.0) for k in range(len(ys))}, speed=10)
    found = recording([straight(1, 0, 500), lanelet(2, [(500, 4), (0, 4)])], [ego, other])
    told = values_of(
        words_of(overtaking_signals, being_overtaken)(context_of(found), frozenset({"overtaking"})),
        "overtaking",
    )
    assert "".join("FT"[int(value)] for value in told) == "FFFTTTTTTTTTTTTF"


@pytest.mark.parametrize(
    ("kind", "past"), [("urban", "TTTTTTTTTTTTTTTF"), ("bicycleLane", "FFFFFFFFFFFFFFFF")]
)
def test_a_cycle_is_overtaken_but_on_a_lane_of_its_own(kind, past):
    """Ego, 10 m/s faster, comes up to it in 4 s, and is 2 s past it in the last state."""
    ys = [0, 0, 1, *[3.5] * 12, 0]
    ego = vehicle(7, {k: (7.0 * k, y) for k, y in enumerate(ys)}, speed=14)
    places = {k: (40 + 2.0 * k, -3.0) for k in range(len(ys))}
    cycle = replace(vehicle(8, places, speed=4), type="bicycle")
    roads = [
        straight(1, 0, 500, left_of=None, right_of=3),
        lanelet(2, [(500, 4), (0, 4)]),
        straight(3, 0, 500, -3, 2.0, left_of=1, types=frozenset({kind})),
    ]
    told = words_of(overtaking_signals, being_overtaken)(
        context_of(recording(roads, [ego, cycle])), frozenset({"overtaking"})
    )
    assert "".join("FT"[int(value)] for value in values_of(told, "overtaking")) == past
    assert not unknown_in(told, "overtaking").any()


@pytest.mark.parametrize("side", ["right", "left"])
def test_who_overtakes_over_the_middle_does_so_as_soon_as_its_side_is_over_it(side):
    """Ego is 2 m wide: at y = 1.6 its side is 0.6 m beyond the middle of the road."""
    ys = [0, 1.2, 1.6, 1.6, 3.5, 3.5, 3.5, 3.5, 3.5, 3.5, 1.6, 1.6, 1.2, 0]
    ego = vehicle(7, {k: (7.0 * k, y) for k, y in enumerate(ys)}, speed=14)
    slow = vehicle(8, {k: (30 + 2.5 * k, 0.0) for k in range(len(ys))}, speed=5)
    found = recording([straight(1, 0, 500), lanelet(2, [(500, 4), (0, 4)])], [ego, slow])
    found = mirrored_recording(found) if side == "left" else found
    signals = words_of(overtaking_signals, being_overtaken)(
        context_of(found, side=side), frozenset({"overtaking"})
    )
    assert (
        "".join("FT"[int(value)] for value in values_of(signals, "overtaking")) == "FFTTTTTTTTTTFF"
    )


def test_who_goes_out_behind_another_one_may_have_meant_to_pass_whom_that_one_passes():
    """Both drive 14 m/s, 30 m apart, and the one that they would pass is 180 m ahead of ego."""
    ys = [0, 0, 1, *[3.5] * 12, 0]
    ego, first = (
        vehicle(number, {k: (ahead + 7.0 * k, y) for k, y in enumerate(ys)}, speed=14)
        for number, ahead in ((7, 0.0), (9, 30.0))
    )
    slow = vehicle(8, {k: (180 + 5.0 * k, 0.0) for k in range(len(ys))}, speed=10)
    roads = [straight(1, 0, 500), lanelet(2, [(500, 4), (0, 4)])]
    for others, perhaps in (([slow], False), ([first, slow], True)):
        signals = words_of(overtaking_signals, being_overtaken)(
            context_of(recording(roads, [ego, *others])), frozenset({"overtaking"})
        )
        assert not values_of(signals, "overtaking").any()
        assert bool(unknown_in(signals, "overtaking")[8]) == perhaps
