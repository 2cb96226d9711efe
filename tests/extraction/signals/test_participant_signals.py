"""Signals of other participants, measured against ego on a straight road of two lanes."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import lanes_ahead
from rulec.extraction.signals.map.lanes_ahead import junctions_ahead
from rulec.extraction.signals.measured_numbers import LONGEST_S, safe_distances
from rulec.extraction.signals.participants import (
    following_signals,
    participant_conduct,
    participant_signals,
)
from rulec.trace.cells import Cells
from support.builders.drive_contexts import along, context_of, steady
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.generators.random_recordings import lanes
from support.signal_arrays import bounds_of, letters, possibly_said, said, unknown_in, values_of
from support.words import words_of

STEP_S = 0.5


def context(*others, ego_speed=10.0, **thresholds):
    ego = steady(7, 0, 0, speed=ego_speed)
    return context_of(recording(lanes(2), [ego, *others]), **thresholds)


def about(*others, **more):
    """The first state of each signal, of the first of the others."""
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(*others, **more)
    )
    return {name: possibly_said(signals, name).flat[0] for name in signals.about}


def safe_distance(drive):
    """The safe distances (m) from the first of the others, by state."""
    found, _ = safe_distances(drive, Cells.at(np.ones_like(drive.relevant)))
    return found.reshape(drive.relevant.shape)[0]


def test_relations_and_distances():
    found = about(steady(8, 30, 4))
    assert (found["station"], found["lateral"], found["position"]) == ("behind", "right_of", "r")
    # From 2 to 28 m along the road; from 1 to 3 m across it
    assert (found["gap"], found["lateral_gap"]) == (26.0, 2.0)
    ahead = about(steady(8, -30, 0))
    assert (ahead["station"], ahead["lateral"], ahead["position"]) == (
        "in_front_of",
        "same_lane",
        "f",
    )
    beside = about(steady(8, 1, 4))
    assert (beside["station"], beside["gap"]) == ("beside", 0.0)


@pytest.mark.parametrize(
    ("other", "unknown"),
    [
        (steady(8, 1, 4), [True, False, False, False]),
        (steady(8, 30, 4, speed=-58), [False, False, False, False]),
        (steady(8, 6, 4, steps=3, first=1), [False, True, False, False]),
    ],
    ids=["at first", "later", "comes into sight"],
)
def test_ego_may_be_passing_who_is_beside_it_at_first(other, unknown):
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(other)
    )
    assert unknown_in(signals, "station")[0].tolist() == unknown
    assert not unknown_in(signals, "lateral").any()


def test_the_papers_side_of_who_is_behind_on_another_lane_at_first_says_as_little():
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(steady(8, 20, 4), steady(9, 20, 0))
    )
    assert values_of(signals, "position")[:, 1].tolist() == ["r", "b"]
    assert unknown_in(signals, "position").tolist() == [[True] + [False] * 3, [False] * 4]


@pytest.mark.parametrize("angle", [0.0, 0.4, 0.8, 1.2])
def test_who_stays_is_the_same_however_axes_lie(angle):
    """Boxes wander to three corners that are 1.3 m from each other, or to two 1.6 m apart."""
    cos, sin = np.cos(angle), np.sin(angle)

    def box(number, *places):
        moved = [(20 * number + cos * x - sin * y, sin * x + cos * y) for x, y in places]
        return vehicle(number, dict(enumerate(moved)))

    wanders = box(1, (0.0, 0.0), (1.3, 0.0), (0.65, 1.126))
    boxes = [wanders, box(2, (0.0, 0.0), (1.6, 0.0), (0.8, 0.0))]
    found = context_of(recording(lanes(2), [steady(7, 0, 0, steps=3), *boxes]))
    assert [body.id for body in found.tracks.participants] == ["1", "2"]
    assert found.stays.tolist() == [True, False]


def test_headway_is_the_time_for_the_gap():
    assert about(steady(8, 30, 0))["time_headway"] == 2.6
    assert about(steady(8, 30, 0), ego_speed=0.1)["time_headway"] == LONGEST_S
    assert about(steady(8, 130, 0), ego_speed=0.3)["time_headway"] == 420.0


def test_speed_difference_is_positive_for_a_faster_ego():
    assert about(steady(8, 30, 0, speed=5))["speed_difference"] == 18.0
    assert about(steady(8, 30, 0, speed=15))["speed_difference"] == -18.0
    # Drift below 1 km/h is standing
    assert about(steady(8, 30, 0, speed=0.2))["speed_difference"] == 36.0


def test_the_safe_distance_is_that_of_two_emergency_brakings():
    # 10 m in the second of reaction, and (100 - 25) / 16 m
    assert safe_distance(context(steady(8, 30, 0, speed=5)))[0] == pytest.approx(14.6875)
    # Somebody oncoming counts as standing: 10 + 100 / 16
    assert safe_distance(context(steady(8, 30, 0, speed=-5)))[0] == pytest.approx(16.25)

    def kept(x):
        return letters(
            words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
                context(steady(8, x, 0, speed=5))
            ),
            "safe_gap",
        )[0]

    # The gap is 4 m less than x; speeds and places are known within a metre's worth of it
    assert (kept(20.5), kept(18.7), kept(17.0)) == ("T", "?", "F")
    assert not about(steady(8, 18.7, 0, speed=5), reaction_s=1.3)["safe_gap"]


def test_a_tram_ahead_brakes_less_hard():
    # 10 m in the second of reaction, and 100 / 16 - 25 / 6 m
    tram = steady(8, 30, 0, speed=5, kind="train")
    assert safe_distance(context(tram))[0] == pytest.approx(12.083333)
    soft = {"rail_braking_mps2": 2.0}
    assert safe_distance(context(tram, **soft))[0] == pytest.approx(10.0)
    car = steady(8, 30, 0, speed=5)
    assert safe_distance(context(car, **soft))[0] == pytest.approx(14.6875)


def test_a_cycle_ahead_brakes_less_hard():
    # 10 m in the second of reaction, and 100 / 16 - 25 / 12 m
    cycle = steady(8, 30, 0, speed=5, kind="bicycle")
    assert safe_distance(context(cycle))[0] == pytest.approx(14.166667)
    soft = {"cycle_braking_mps2": 4.0}
    assert safe_distance(context(cycle, **soft))[0] == pytest.approx(13.125)


@pytest.mark.parametrize(("degrees", "needed"), [(0, 10.0), (45, 10.0), (70, 10.0), (90, 16.25)])
def test_who_turns_off_is_as_fast_as_it_is(degrees, needed):
    """Both drive at 10 m/s; who drives across ego's way does not take itself out of it."""
    way = np.radians(degrees)
    places = {
        k: (30 + 10 * STEP_S * k * np.cos(way), 10 * STEP_S * k * np.sin(way)) for k in range(4)
    }
    other = vehicle(8, places, speed=10.0, heading=float(way))
    assert safe_distance(context(other))[0] == pytest.approx(needed)


def test_a_safe_gap_is_asked_for_in_egos_lane_only():
    assert not about(steady(8, 10, 0, speed=5))["safe_gap"]
    assert about(steady(8, 10, 4, speed=5))["safe_gap"]
    assert about(steady(8, -10, 0, speed=5))["safe_gap"]


@pytest.mark.parametrize(
    ("ahead", "brakes", "word"),
    [(18.0, True, "?"), (9.0, True, False), (18.0, False, "?"), (25.0, True, True)],
)
def test_ego_has_seen_one_stand_that_it_can_stop_behind(ahead, brakes, word):
    """From 10 m/s it stops within 6.25 m, and reacts within 10 m more; bodies are 4 m long."""
    way = [-5.25, 0.0, 4.25, 7.5, 9.75, 11.0] if brakes else [-5.0, 0.0, 5.0, 10.0, 15.0, 20.0]
    ego = vehicle(7, {k: (x, 0) for k, x in enumerate(way)}, speed=9.5)
    stands = vehicle(8, dict.fromkeys(range(6), (ahead, 0)), speed=0)
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(1), [ego, stands]))
    )
    # At 0 m, where a second's mean is of 9.5 m/s, or 10
    unknown = bool(unknown_in(signals, "safe_gap")[0, 1])
    assert ("?" if unknown else bool(values_of(signals, "safe_gap")[0, 1])) == word


@pytest.mark.parametrize(
    ("short_m", "states", "unknown"),
    [(0.3, 1, True), (0.3, 2, False), (1.5, 1, False)],
)
def test_what_is_briefly_and_slightly_too_near_may_be_what_boxes_err(short_m, states, unknown):
    """Both drive at 10 m/s, so ego needs 10 m; distances are known to 5 cm, speeds to 0.1 m/s.

    By the speeds the safe distance may be off by 2.25 and 1.25 m a m/s, 0.26 m, with places 0.27.
    States are of 0.5 s: one is less than a second.
    """
    near = [k in range(4, 4 + states) for k in range(10)]
    ahead, longer = (steady(8, 14.5, 0, steps=10, length=4.0 + m) for m in (0, 1 + 2 * short_m))
    drawn = {k: (longer if near[k] else ahead).outlines[k] for k in range(10)}
    bodies = [steady(7, 0, 0, steps=10), replace(ahead, outlines=drawn)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(1), bodies))
    )
    told = letters(signals, "safe_gap")[1:-1]
    assert told == "".join(("?" if unknown else "F") if short else "T" for short in near)[1:-1]


@pytest.mark.parametrize(("leaves_at", "unknown"), [(8, True), (9, False)])
def test_the_gap_to_one_that_ego_parts_from_soon_is_moot(leaves_at, unknown):
    """Steps are of 0.5 s, and in the state 4 s later it is in the other lane, or not yet."""
    places = {k: (10 + 2.5 * k, 4.0 if k >= leaves_at else 0.0) for k in range(10)}
    bodies = [steady(7, 0, 0, speed=10.0, steps=10), vehicle(8, places, speed=5.0)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(2), bodies))
    )
    assert not values_of(signals, "safe_gap")[0, 0]
    assert unknown_in(signals, "safe_gap")[0, 0] == unknown


@pytest.mark.parametrize(("speed", "unknown"), [(5.0, False), (20.0, True)])
def test_one_that_leaves_in_a_junction_may_stop_before(speed, unknown):
    """It is clear of ego's way 10 m ahead; did it brake, it would stop within 1.6 m, or 25 m."""
    step_m = speed / 2
    places = {k: (10 + step_m * k, 4.0 if step_m * k >= 10 else 0.0) for k in range(10)}
    ego = vehicle(7, {k: (2 * step_m * k, 0.0) for k in range(10)}, speed=2 * speed)
    there = [straight("1", -100, 15, successors=(2,), width=12.0)]
    inside = frozenset({"intersection"})
    there += [straight("2", 15, 300, predecessors=(1,), types=inside, junction="x", width=12.0)]
    found = recording(there, [ego, vehicle(8, places, speed=speed)])
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found, route=("1", "2"))
    )
    assert not values_of(signals, "safe_gap")[0, 0]
    assert unknown_in(signals, "safe_gap")[0, 0] == unknown


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize(("across", "unknown"), [(0.4, True), (0.1, False)])
def test_the_gap_to_one_that_ego_swings_out_from_is_moot(across, unknown, way):
    """It is lost from sight 0.6 m short of being clear, after 1.5 s of 4 s that ego has."""
    ahead = vehicle(8, {k: (12 + 2.5 * k, 0.0) for k in range(4)}, speed=5.0)
    places = {k: (5 * k, way * (1.4 - across * 1.5 + across * k / 2)) for k in range(10)}
    bodies = [vehicle(7, places, speed=10.0), ahead]
    road = [straight("1", -100, 300, width=6.0)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(road, bodies))
    )
    assert not values_of(signals, "safe_gap")[0, 0]
    assert unknown_in(signals, "safe_gap")[0, 0] == unknown


@pytest.mark.parametrize(("leaves_at", "unknown"), [(8, True), (9, False), (40, False)])
def test_whether_one_that_leaves_within_four_seconds_is_followed_is_unknown(leaves_at, unknown):
    places = {k: (40 + 5 * k, 4.0 if k >= leaves_at else 0.0) for k in range(20)}
    bodies = [steady(7, 0, 0, speed=10.0, steps=20), vehicle(8, places, speed=10.0)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(2), bodies))
    )
    assert not values_of(signals, "parts_soon").any()
    assert unknown_in(signals, "parts_soon")[0, 0] == unknown
    # And nobody else's lane matters
    beside = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(steady(8, 30, 4))
    )
    assert not unknown_in(beside, "parts_soon").any()


@pytest.mark.parametrize(
    ("aside_m", "error_m", "unknown"), [(2.27, 0.0, True), (2.23, 0.0, False), (1.4, 0.5, True)]
)
def test_one_that_may_be_clear_of_ego_within_four_seconds_may_have_left(aside_m, error_m, unknown):
    """Both are 2 m wide; clear by 0.3 m it has left, and places are good to 0.05 m, or 1 m."""
    places = {k: (40 + 5 * k, aside_m if k >= 6 else 0.0) for k in range(12)}
    bodies = [steady(7, 0, 0, speed=10.0, steps=12), vehicle(8, places, speed=10.0)]
    found = recording([straight("1", -100, 300, width=8.0)], bodies)
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found, place_error_m=error_m)
    )
    assert unknown_in(signals, "parts_soon")[0, 0] == unknown


@pytest.mark.parametrize(("seconds", "expected"), [(1.0, False), (30.0, True)])
def test_who_leaves_the_lane_of_another_one_does_so_as_measured(seconds, expected):
    """Ego moves over by 4 m; if slowly, it is a little in the way of the other one for long."""
    places = {k: (k, min(4.0, max(0.0, (k - 10) * 0.8 / seconds))) for k in range(170)}
    bodies = [vehicle(7, places, speed=5.0)]
    bodies.append(vehicle(8, {k: (30 + k, 0.0) for k in range(170)}, speed=5.0))
    found = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(2), bodies, step_s=0.2))
    )
    assert said(found, "lateral")[0, 0] == "same_lane"
    assert said(found, "lateral")[0, -1] == "left_of"
    assert unknown_in(found, "lateral").any() == expected


def test_only_the_next_one_ahead_precedes():
    others = [steady(8, 40, 0), steady(9, 20, 0), steady(10, 12, 4), steady(11, -20, 0)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(*others)
    )
    assert values_of(signals, "precedes")[:, 0].tolist() == [False, True, False, False]
    oncoming = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(steady(8, 30, 0, speed=-5), steady(9, 50, 0))
    )
    assert values_of(oncoming, "precedes")[:, 0].tolist() == [False, True]


def test_oncoming_moves_against_ego_or_waits_beside_its_lanes():
    assert about(steady(8, 60, 4, speed=-5))["oncoming"]
    assert not about(steady(8, 60, 4, speed=5))["oncoming"]
    waiting = {"speed": -0.01, "heading": float(np.pi)}
    # On ego's own lanes one that stands the wrong way round is an obstacle
    assert not about(steady(8, 60, 4, **waiting))["oncoming"]
    # It has moved at some time, so that it is relevant beside the road
    places = steady(8, 60, 8, speed=-5, steps=3)
    stopped = steady(8, 40, 8, **waiting)
    found = context(steady(8, 60, 8, speed=-5))
    assert found.relevant[0].all()
    assert values_of(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(found),
        "oncoming",
    )[0].all()
    assert places.states.keys() <= stopped.states.keys()
    # Nor is it overtaken where it backs a little there, or its box drifts, as of one that waits
    backs = context(steady(8, 60, 8, speed=0.5, heading=float(np.pi)))
    assert backs.relevant[0].all()
    assert values_of(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(backs),
        "oncoming",
    )[0].all()
    # Reversing is not coming: it faces ego's way
    assert not about(steady(8, 60, 4, speed=-5, heading=0.0))["oncoming"]


def test_one_that_swerves_as_it_gets_beside_ego_still_comes():
    """Round an island, across the road by 65° for a moment. One that never faced ego does not."""
    swerve = np.array([(20, 4), (10.5, 4), (9.2, 6.8), (-40, 6.8)])
    found = context(along(8, swerve, 5.0 * np.arange(4)))
    angles = np.degrees(np.abs(found.extents.turned[0]))
    assert np.count_nonzero(angles < 120) == 1
    assert values_of(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(found),
        "oncoming",
    )[0].all()
    slants = np.array([(30, 4), (24, 17)])
    never = context(along(8, slants, 1.0 * np.arange(4)))
    assert not values_of(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(never),
        "oncoming",
    )[0].any()


@pytest.mark.parametrize("kind", ["car", "bicycle", "train"])
def test_one_that_has_come_on_another_road_waits_for_its_turn(kind):
    """It stands in a junction, facing ego: nobody follows it."""
    elsewhere = np.array([[False] * 4, [True] * 4])
    ego = steady(7, 0, 0, speed=10)
    turning = steady(8, 60, 0, speed=-0.01, heading=float(np.pi), kind=kind)
    comes = steady(8, 65, 0, speed=-10, steps=2)
    turning = replace(
        turning,
        states={**turning.states, **comes.states},
        outlines={**turning.outlines, **comes.outlines},
    )
    junction = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(2), [ego, turning]), elsewhere=elsewhere)
    )
    assert values_of(junction, "oncoming").all()
    assert not values_of(junction, "precedes").any()


def test_what_holds_for_good():
    found = about(steady(8, 30, 0, kind="motorcycle", speed=0))
    assert (found["stopped"], found["two_wheeled"], found["parked"]) == (True, True, False)
    parked = about(steady(8, 30, 0, steps=1, standing=True))
    assert (parked["stopped"], parked["two_wheeled"], parked["parked"]) == (True, False, True)


def test_in_the_road_is_about_vulnerable_users():
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(steady(8, 30, 0), steady(9, 30, 1, speed=0, kind="pedestrian"))
    )
    assert values_of(signals, "in_the_road")[:, 0].tolist() == [False, True]
    assert signals.only["in_the_road"].tolist() == [False, True]


@pytest.mark.parametrize(
    ("y", "told"), [(-2.1, "F"), (-1.9, "?"), (-1.6, "T"), (2, "T"), (5.9, "?"), (6.1, "F")]
)
def test_people_wait_at_the_outer_edges_of_lanes_which_are_at_2_m_and_6_m(y, told):
    walker = steady(9, 30, y, speed=0, kind="pedestrian", length=0.4, width=0.4)
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(walker)
    )
    unknown = unknown_in(signals, "in_the_road")[0, 0]
    assert told == ("?" if unknown else "FT"[int(values_of(signals, "in_the_road")[0, 0])])


@pytest.mark.parametrize(
    ("x", "y", "told"),
    [
        (130, -6.1, "F"),
        (130, -5.9, "?"),
        (130, -2.1, "T"),
        (130, 1.9, "?"),
        # On a way that only another road has, before the same edge
        (95, -5.9, "?"),
        (95, -4.0, "T"),
    ],
)
def test_people_wait_at_the_edges_of_the_lanes_beside_them_not_beside_ego(x, y, told):
    road = [
        straight(1, 0, 100, successors=(2,)),
        straight(2, 100, 200, predecessors=(1,), right_of=3),
        straight(3, 100, 200, -4, left_of=2),
        straight(4, 60, 100, -4, successors=(3,)),
    ]
    walker = steady(9, x, y, speed=0, kind="pedestrian", length=0.4, width=0.4)
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(road, [steady(7, 30, 0), walker]), ("1", "2"))
    )
    unknown = unknown_in(signals, "in_the_road")[0, 0]
    assert told == ("?" if unknown else "FT"[int(values_of(signals, "in_the_road")[0, 0])])


@pytest.mark.parametrize(
    ("kind", "types", "told"),
    [
        ("bicycle", {"bicycleLane"}, "?"),
        ("bicycle", set(), "T"),
        ("pedestrian", {"bicycleLane"}, "T"),
    ],
)
def test_a_lane_for_cycles_alone_may_be_a_path_beside_the_road(kind, types, told):
    both = [
        straight(1, 0, 200, left_of=2, types=frozenset(types)),
        straight(2, 0, 200, y=4, right_of=1),
    ]
    rider = steady(8, 30, 0, kind=kind, length=0.6, width=0.6)
    ego = steady(7, 0, 4)
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(both, [ego, rider]), ("2",))
    )
    unknown = unknown_in(signals, "in_the_road")[0, 0]
    assert told == ("?" if unknown else "FT"[int(values_of(signals, "in_the_road")[0, 0])])


@pytest.mark.parametrize(
    ("along", "across", "goes"), [(0, 1.5, True), (1, -1.5, True), (1.5, 1, False), (0, 0, False)]
)
def test_who_goes_across_the_road(along, across, goes):
    places = {k: (30 + along * 0.5 * k, across * 0.5 * k) for k in range(3)}
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    context = context_of(recording(lanes(2), [steady(7, 0, 0, steps=3), walker]))
    assert (
        values_of(
            words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
                context
            ),
            "goes_across",
        )[0].tolist()
        == [goes] * 3
    )


@pytest.mark.parametrize(
    ("ways", "goes"),
    [
        # Each tenth of a second: across, then still
        ([(0, 0.15)] * 8 + [(0, 0)] * 22, True),
        # Pushed 1 m along the road at once, and back again, while it crosses
        ([(0, 0.15)] * 8 + [(1, 0)] + [(0, 0)] * 9 + [(-1, 0)] + [(0, 0)] * 11, True),
        # Across, then along the road for 1.5 s
        ([(0, 0.15)] * 8 + [(0.15, 0)] * 15, False),
        # Along the road, then still
        ([(0.15, 0)] * 15 + [(0, 0)] * 15, False),
        # Off the road on the other side of its lane of 4 m, then still
        ([(0, 0.15)] * 24 + [(0, 0)] * 15, False),
    ],
)
def test_who_crosses_goes_on_crossing(ways, goes):
    x, y = np.cumsum([(30.0, -1.0), *ways], axis=0).T
    walker = vehicle(
        8, dict(enumerate(zip(x, y, strict=True))), "pedestrian", length=0.4, width=0.4
    )
    ego = steady(7, 0, 0, steps=len(x), step_s=0.1)
    context = context_of(recording(lanes(1), [ego, walker], step_s=0.1))
    told = values_of(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(context),
        "goes_across",
    )[0]
    assert told[-1] == goes
    # A car that has crossed and stands blocks the way: it does not cross any more
    car = replace(walker, type="car")
    context = context_of(recording(lanes(1), [ego, car], step_s=0.1))
    assert not values_of(
        words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(context),
        "goes_across",
    )[0, -1]


@pytest.mark.parametrize(
    ("way", "begins", "told"),
    [
        # Each tenth of a second, with speeds good to 0.1 m/s: a difference of them to 0.14 m/s
        ((0.1, 0.11), 0, "?"),
        ((0.1, 0.12), 0, "T"),
        ((0.12, 0.1), 0, "F"),
        # Who stands in the road may have gone across under another name, but not from the start
        ((0, 0), 0, "F"),
        ((0, 0), 3, "?"),
        ((0.12, 0), 3, "F"),
        ((0, 0.1), 3, "T"),
    ],
)
def test_when_it_is_not_told_whether_one_goes_across(way, begins, told):
    x, y = np.cumsum([(30.0, -1.5), *[way] * 20], axis=0).T
    places = dict(enumerate(zip(x, y, strict=True), begins))
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    ego = steady(7, 0, 0, steps=begins + len(x), step_s=0.1)
    found = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(1), [ego, walker], step_s=0.1))
    )
    unknown = unknown_in(found, "goes_across")[0, -6]
    assert told == ("?" if unknown else "FT"[int(values_of(found, "goes_across")[0, -6])])


@pytest.mark.parametrize(("hole", "told"), [(0, "T"), (15, "?")])
def test_who_crosses_is_not_known_to_stand_after_a_hole_in_its_track(hole, told):
    """It crosses for a second, and stands in the middle of the lane from then on."""
    y = np.concatenate((np.linspace(-1.5, 0.0, 11), np.zeros(30)))
    there = [k for k in range(len(y)) if not 9 <= k < 9 + hole]
    places = {k: (30.0, float(y[k])) for k in there}
    walker = vehicle(8, places, "pedestrian", length=0.4, width=0.4)
    ego = steady(7, 0, 0, speed=0.5, steps=len(y), step_s=0.1)
    found = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(1), [ego, walker], step_s=0.1))
    )
    unknown = unknown_in(found, "goes_across")[0, -6]
    assert told == ("?" if unknown else "FT"[int(values_of(found, "goes_across")[0, -6])])


def test_who_is_behind_another_one_is_not_followed():
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(steady(8, 30, 0), steady(9, 15, 0), steady(6, 20, 4))
    )
    assert values_of(signals, "one_between")[:, 0].tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("y", "more", "parked"),
    [
        (-1.7, {}, True),
        (1.7, {}, True),
        (-1.3, {}, False),
        (-1.3, {"width": 2.8}, False),
        (-1.7, {"kind": "motorcycle"}, False),
    ],
    ids=["at the right edge", "at the left one", "off it", "too little room", "on two wheels"],
)
def test_who_stands_at_the_edge_of_a_wide_lane_all_the_time_is_parked(y, more, parked):
    """The lane is 6 m wide, the other one 2 m or 2.8 m; it leaves 3.7 m at the edge, or 2.9 m."""
    road = [straight(1, 0, 200, width=6.0)]
    ways = dict.fromkeys(range(4), (30, y))
    found = recording(road, [steady(7, 0, 0, steps=4), vehicle(8, ways, **more)])
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found)
    )
    assert said(signals, "parked")[0].all() == parked


@pytest.mark.parametrize(
    ("lamps", "speed", "known"),
    [
        ({"left_indicator", "right_indicator"}, 0, False),
        ({"hazard_lights"}, 0, False),
        ({"left_indicator"}, 0, True),
        ({"left_indicator", "right_indicator"}, 5, True),
    ],
    ids=["both indicators", "hazard lights", "about to pull out", "it drives"],
)
def test_who_stands_in_a_lane_with_hazard_lights_may_have_broken_down(lamps, speed, known):
    shows = frozenset({"left_indicator", "right_indicator", "hazard_lights"})
    body = steady(8, 30, 4, speed=speed)
    body = replace(body, lamps=dict.fromkeys(range(4), frozenset(lamps)), shows=shows)
    found = recording(
        [straight(1, 0, 200, left_of=2), straight(2, 0, 200, 4, right_of=1)],
        [steady(7, 0, 0), body],
    )
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found)
    )
    assert not said(signals, "parked")[0].any()
    assert unknown_in(signals, "parked")[0].all() == (not known)


@pytest.mark.parametrize(
    ("y", "moves_on", "parked"), [(-2.6, False, True), (-2.6, True, False), (-1.4, False, False)]
)
def test_who_stands_beside_the_lanes_all_the_time_is_parked(y, moves_on, parked):
    """Its middle is 0.6 m outside of a lane, or within it, where one may wait."""
    ways = [20.0 + (10.0 * max(k - 4, 0) if moves_on else 0.0) for k in range(8)]
    other = vehicle(8, {k: (x, y) for k, x in enumerate(ways)}, speed=0)
    assert about(other)["parked"] == parked


@pytest.mark.parametrize(
    ("x", "goes_on", "elsewhere"),
    [(90, False, True), (90, True, False), (40, False, False), (113, False, True)],
)
def test_a_lane_that_ends_at_the_junction_leads_elsewhere(x, goes_on, elsewhere):
    """The junction begins at 112 m: near it is who is 50 m before it, or stands at its edge."""
    inside = frozenset({"intersection"})
    road = [
        straight(1, 0, 112, successors=(2,), left_of=5),
        straight(2, 112, 132, predecessors=(1,), successors=(3,), types=inside, left_of=4),
        straight(3, 132, 300, predecessors=(2,), left_of=6 if goes_on else None),
        straight(4, 112, 132, 4, predecessors=(5,), types=inside, right_of=2),
        straight(5, 0, 112, 4, successors=(4,), right_of=1),
        *([straight(6, 132, 300, 4, right_of=3)] if goes_on else []),
    ]
    other = vehicle(8, dict.fromkeys(range(8), (x, 4)), speed=0)
    found = recording(road, [steady(7, 0, 0, speed=10, steps=8), other])
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found, ("1", "2", "3"))
    )
    assert values_of(signals, "leads_elsewhere")[0, 0] == elsewhere


@pytest.mark.parametrize("angle", np.linspace(0, 6, 9))
def test_before_a_junction_in_which_the_map_begins_no_lane_leads_anywhere(angle):
    """Wherever the world lies: the road begins at 0, but for the last digit."""
    inside, cos, sin = frozenset({"intersection"}), np.cos(angle), np.sin(angle)
    (x, y), ahead = (1000.1, 333.3), np.array([(0.0, 0.0), (37.0, 0.0), (200.0, 0.0)])

    def at(places):
        return np.array(places) @ np.array([(cos, sin), (-sin, cos)]) + (x, y)

    road = [
        lanelet(1, at(ahead[:2]), successors=(2,), types=inside),
        lanelet(2, at(ahead[1:]), predecessors=(1,)),
    ]
    places = dict(enumerate(at([(60.0 + 5 * k, 0.0) for k in range(4)]).tolist()))
    ego = vehicle(7, {k: tuple(place) for k, place in places.items()}, heading=angle)
    assert junctions_ahead(context_of(recording(road, [ego]), ("1", "2"))) == ()


@pytest.mark.parametrize("y", [-8, -1.5])
def test_who_waits_in_a_junction_having_come_on_another_road_is_not_on_ego_s_way(y):
    """It rides from the south into the junction and stands there, beside ego's lane or in it."""
    inside = frozenset({"intersection"})
    road = [
        straight(1, 0, 112, successors=(2,)),
        straight(2, 112, 142, predecessors=(1,), successors=(3,), types=inside),
        straight(3, 142, 300, predecessors=(2,)),
        lanelet(4, [(120, -80), (120, -20)], successors=(5, 6)),
        lanelet(5, [(120, -20), (120, 20)], predecessors=(4,), successors=(7,), types=inside),
        lanelet(6, [(120, -20), (121.5, -6), (142, 0)], predecessors=(4,), types=inside),
        lanelet(7, [(120, 20), (120, 80)], predecessors=(5,)),
    ]
    places = {k: (120.0, -60.0 + 15 * k) if k < 4 else (120.6, y) for k in range(8)}
    other = vehicle(8, places, "bicycle", length=2, width=0.6, heading=np.pi / 2)
    found = recording(road, [steady(7, 60, 0, speed=10, steps=8), other])
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found, ("1", "2", "3"))
    )
    assert not unknown_in(signals, "leads_elsewhere")[0, -1]
    assert values_of(signals, "leads_elsewhere")[0, -1]


@pytest.mark.parametrize(
    ("mark", "x", "complete", "unknown"),
    [
        ("solid", 260, (), True),
        # 100 m before the end of the map
        ("solid", 200, (), False),
        ("broken", 260, (), False),
        # Nothing comes after a net's end
        ("solid", 260, ("lanes",), False),
    ],
)
def test_a_lane_behind_a_solid_line_may_lead_elsewhere_beyond_the_map(mark, x, complete, unknown):
    road = lanes(2)
    road[0] = replace(road[0], left_mark=mark)
    bodies = [steady(7, x - 20, 0, steps=4), vehicle(8, dict.fromkeys(range(4), (x, 4)), speed=0)]
    found = replace(recording(road, bodies), complete=frozenset(complete))
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found)
    )
    assert unknown_in(signals, "leads_elsewhere")[0, 0] == unknown
    assert not values_of(signals, "leads_elsewhere")[0, 0]


@pytest.mark.parametrize(
    ("y", "speed", "expected"),
    [(0, 5.0, 5.2), (0, 10.0, LONGEST_S), (0, 15.0, LONGEST_S), (4, 5.0, LONGEST_S)],
    ids=["slower", "as fast", "faster", "in another lane"],
)
def test_the_time_to_a_collision_is_of_who_is_ahead_and_slower(y, speed, expected):
    # Ego at 10 m/s, 26 m behind
    assert about(steady(8, 30, y, speed=speed))["time_to_collision"] == expected


def test_the_bounds_of_the_time_to_a_collision():
    # 26 m to 5 cm, and 5 m/s to 0.14 m/s, the root of the sum of two squares of 0.1
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context(steady(8, 30, 0, speed=5.0))
    )
    low, high = (bound[1] for bound in bounds_of(signals, "time_to_collision"))
    now = values_of(signals, "time_to_collision")[1]
    assert low < now < high
    gap = 26 - 5 * STEP_S
    assert (low, high) == (
        pytest.approx((gap - 0.05) / 5.1414, abs=0.011),
        pytest.approx((gap + 0.05) / 4.8586, abs=0.011),
    )


@pytest.mark.parametrize(
    ("ways", "goes", "word"),
    [
        ("left", None, True),
        ("straight", None, False),
        # Of a lane to both its own way decides, and without one nobody knows
        ("both", None, "?"),
        ("both", "left", True),
        ("both", "straight", False),
    ],
)
def test_where_a_lane_leads_that_others_beyond_have_the_number_of(ways, goes, word):
    """Ego drives straight on beside it; the road beyond has two lanes as well."""
    inside = frozenset({"intersection"})
    onward = {"left": (7,), "straight": (6,), "both": (6, 7)}[ways]
    left = [(112, 4), (120, 6), (124, 24)]
    road = [
        straight(1, 0, 112, successors=(2,), left_of=5),
        straight(2, 112, 132, predecessors=(1,), successors=(3,), types=inside),
        straight(3, 132, 300, predecessors=(2,), left_of=8),
        straight(5, 0, 112, 4, right_of=1, successors=onward),
        straight(8, 132, 300, 4, right_of=3),
        lanelet(9, [(124, 24), (124, 200)]),
    ]
    if 6 in onward:
        road.append(straight(6, 112, 132, 4, predecessors=(5,), successors=(8,), types=inside))
    if 7 in onward:
        road.append(lanelet(7, left, predecessors=(5,), successors=(9,), types=inside))
    path = {"left": [(90, 4), *left, (124, 60)], "straight": [(90, 4), (300, 4)]}.get(goes)
    way = np.array([0, 5, 10, 15, 20, 25, 30, 40, 60, 70], dtype=float)
    waits = vehicle(8, dict.fromkeys(range(8), (90, 4)), speed=0)
    other = waits if path is None else along(8, np.array(path), way)
    found = recording(road, [steady(7, 0, 0, speed=10, steps=10), other])
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(found, ("1", "2", "3"))
    )
    unknown = bool(unknown_in(signals, "leads_elsewhere")[0, 0])
    assert ("?" if unknown else bool(values_of(signals, "leads_elsewhere")[0, 0])) == word


@pytest.mark.parametrize(("drift", "unknown"), [(0.2, True), (0.0, False)])
def test_the_gap_to_one_that_is_lost_as_it_goes_aside_is_moot(drift, unknown):
    """Steps are of 0.5 s: 0.2 m are 0.4 m/s. It is recorded for six states, ego for ten."""
    places = {k: (10 + 2.5 * k, drift * k) for k in range(6)}
    bodies = [steady(7, 0, 0, speed=10.0, steps=10), vehicle(8, places, speed=5.0)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(2), bodies))
    )
    assert not values_of(signals, "safe_gap")[0, 2]
    assert unknown_in(signals, "safe_gap")[0, 2] == unknown


@pytest.mark.parametrize(("drift", "unknown"), [(0.5, True), (-0.5, True), (0.05, False)])
def test_the_gap_to_one_that_begins_to_go_aside_and_is_lost_is_moot(drift, unknown):
    """It is seen up to 2.5 s, 1 m farther aside, and has 2.5 s more for the second metre."""
    places = {k: (10 + 2.5 * k, drift * max(k - 3, 0)) for k in range(6)}
    bodies = [steady(7, 0, 0, speed=10.0, steps=10), vehicle(8, places, speed=5.0)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording([straight(1, -100, 300, 0, 8.0)], bodies))
    )
    assert not values_of(signals, "safe_gap")[0, 2]
    assert unknown_in(signals, "safe_gap")[0, 2] == unknown


@pytest.mark.parametrize(
    ("across", "other_mps", "lost", "unknown"),
    [
        (0.25, 5.0, "other", True),
        (0.25, 5.0, "both", True),
        (0.25, 10.0, "other", False),
        (0.1, 5.0, "other", False),
    ],
)
def test_who_closes_in_and_goes_aside_may_have_changed_lanes_unseen(
    across, other_mps, lost, unknown
):
    """Ego is at 10 m/s; they are seen together for 1 s of the 4 s in which they may part."""
    last = 2
    ego = {k: (5 * k, across * k / 2) for k in range(last + 1 if lost == "both" else 10)}
    ahead = {k: (10 + other_mps / 2 * k, 0.0) for k in range(last + 1)}
    bodies = [vehicle(7, ego, speed=10.0), vehicle(8, ahead, speed=other_mps)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(lanes(2), bodies))
    )
    assert not values_of(signals, "safe_gap")[0, 0]
    assert unknown_in(signals, "safe_gap")[0, 0] == unknown


@pytest.mark.parametrize(("aside", "unknown"), [(1.5, True), (1.1, False)])
def test_the_gap_to_one_that_ego_goes_past_on_a_broad_lane_is_moot(aside, unknown):
    """Bodies are 2 m wide; 3.5 s later ego is to that side of its lane, the other as far away."""
    road = [straight(1, 0, 300, width=8)]
    drifts = [min(k, 7) / 7 * aside for k in range(10)]
    ego, other = (
        vehicle(number, {k: (x + 5 * k, sign * y) for k, y in enumerate(drifts)}, speed=mps)
        for number, x, sign, mps in ((7, 0, -1, 10.0), (8, 8, 1, 10.0))
    )
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(road, [ego, other]), ("1",))
    )
    assert not values_of(signals, "safe_gap")[0, 0]
    assert unknown_in(signals, "safe_gap")[0, 0] == unknown


@pytest.mark.parametrize(("end", "elsewhere"), [((180, -30), True), ((200, -1), False)])
def test_lanes_that_part_outside_of_a_junction_lead_elsewhere(end, elsewhere):
    """Ego's lane bends off to the right at 112 m; the one beside it goes straight on."""
    road = [
        straight(1, 0, 112, successors=(2,), left_of=5),
        lanelet(2, [(112, 0), (140, 0 if end[1] > -2 else -5), end], predecessors=(1,)),
        straight(5, 0, 112, 4, right_of=1, successors=(6,)),
        straight(6, 112, 300, 4, predecessors=(5,)),
    ]
    bodies = [steady(7, 60, 0, steps=4), steady(8, 80, 4, steps=4)]
    signals = words_of(participant_signals, participant_conduct, lanes_ahead, following_signals)(
        context_of(recording(road, bodies), ("1", "2"))
    )
    assert values_of(signals, "leads_elsewhere")[0, 0] == elsewhere
