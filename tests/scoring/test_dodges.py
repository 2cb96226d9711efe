"""What trackers of single rules are evaded by does not pay."""

from dataclasses import replace

import numpy as np
import pytest

from rulec.api.rulebook_compilation import machines
from rulec.recordings.building import build_lanelet, build_participant, build_recording
from rulec.recordings.recording import Light
from rulec.scoring.score import score
from rulec.scoring.traffic_world import TrafficWorld
from support.builders.scored_worlds import STEP_S, along, car, lit_junction, street

GERMAN = machines("de")
AHEAD = STEP_S * np.arange(1, 21)


def braking_to(stop, speed=10.0):
    """Places along the x axis from 0 on, at a constant speed and then braked evenly to a stop."""
    gained = 2.0
    begins = (stop - speed**2 / 2 / gained) / speed
    for_s = np.clip(AHEAD - begins, 0.0, speed / gained)
    return speed * np.minimum(AHEAD, begins) + speed * for_s - gained * for_s**2 / 2


def scored(world, *paths):
    start = world.past[-1]
    return score(np.array([along(path, start) for path in paths]), world, GERMAN, world.past)


def on_axis(x):
    return np.column_stack((x, 0 * x))


def test_at_a_red_light_waiting_is_best():
    world = lit_junction()
    straight = 10.0 * AHEAD
    found = scored(
        world,
        on_axis(braking_to(55.0)),
        on_axis(straight),  # the bumper is at the line, 60, after 5.8 s
        on_axis(braking_to(68.0)),  # it waits in the junction
        np.column_stack((straight, -15 * np.exp(-(((straight - 65) / 18) ** 2)))),  # around it
    )
    assert found.outcomes("red_light")[:3] == ["kept", "violated", "violated"]
    assert found.off_road.tolist()[:3] == [0, 0, 0]
    assert found.off_road[3] > 0
    assert found.allowed.tolist() == [True, False, False, False]
    assert found.best == 0
    # Whether anything makes one brake that waits in the junction nobody knows
    assert found.places.tolist() == [1, 2, 3, 4]
    assert found.reward().argmax() == 0
    assert found.reward().argmin() == 3
    assert [found.nearest_allowed(number) for number in range(4)] == [0, 0, 0, 0]


@pytest.mark.parametrize(("after_s", "blocks"), [(np.inf, "open"), (10.5, "violated")])
def test_before_a_junction_without_room_behind_it_waiting_is_best(after_s, blocks):
    """The light is green; the rear of a queue is at 81.75, 1.75 m behind the junction.

    It stands for as long as is predicted, so that ego may yet drive round it, or sets off when ego
    has come. Ego, 4.5 m long, stops with its front 0.75 m before the line, or on the road across.
    """
    t = STEP_S * np.arange(30)
    x = 84 + 2 * np.clip(t - after_s, 0, None)
    queue = [
        build_participant(f"q{k}", "car", t, x + 6 * k, 0 * t, heading=0 * t, step_s=STEP_S)
        for k in range(3)
    ]
    world = lit_junction(colour="green", others=queue)
    found = scored(world, on_axis(braking_to(68.0)), on_axis(braking_to(57.0)))
    assert found.outcomes("no_blocking") == [blocks, "kept"]
    assert found.outcomes("no_stopping")[1] == "kept"
    assert found.places.tolist() == [2, 1]
    assert found.allowed.tolist() == [False, True]
    assert found.reward().argmax() == 1


@pytest.mark.parametrize(
    "aside",
    [
        lambda x: 3.5 * (x > 57.0),  # it jumps into the other lane while it crosses the line
        lambda x: 2.0 * ((x > 57.0) & (x < 61.0)),  # it is there in one state
        lambda x: np.interp(x, (35, 45, 70, 80), (0, 1.8, 1.8, 0)),  # on the mark, hardly beyond
    ],
)
def test_the_green_light_of_the_next_lane_is_no_way_past_a_red_one(aside):
    """Who crosses the line at x = 60 between two lights; one has changed lanes before."""
    world, straight = lit_junction(beside="green"), 10.0 * AHEAD
    changes = np.interp(straight, (10, 40), (0, 3.5))
    paths = [straight * 0 + aside(straight), straight * 0, changes]
    ways = [np.column_stack((straight, y)) for y in paths]
    found = scored(world, *ways, on_axis(braking_to(55.0)))
    assert found.outcomes("red_light") == ["open", "violated", "kept", "kept"]
    assert found.best == 3


def test_straddling_two_lanes_is_no_way_past_a_slow_vehicle():
    # 8 m/s of 12 behind, 40 m away: at 12 m/s ego would be level with it after 10 s
    world = street([car("slow", 8.0, x=40.0)], speed=12.0)
    straight, eased = 12.0 * AHEAD, 12.0 * AHEAD - 4.0 * np.clip(AHEAD - 2, 0, 4) ** 2 / 8
    eased -= 4.0 * np.clip(AHEAD - 6, 0, None)
    straddling = np.column_stack((straight, 1.75 * np.minimum(AHEAD, 2.0) / 2))
    found = scored(world, on_axis(eased), on_axis(straight), straddling)
    assert found.outcomes("following_distance") == ["kept", "violated", "open"]
    assert found.best == 0
    assert found.allowed.tolist() == [True, False, False]
    assert found.reward()[0] > max(found.reward()[1:])
    assert found.nearest_allowed(2) == 0


def test_speed_is_what_places_say():
    world = street()
    steady, fast = 13.0 * AHEAD, 18.0 * AHEAD
    pulsing = np.cumsum(STEP_S * np.where(np.arange(20) % 2, 22.0, 2.0))
    paths = np.array([along(on_axis(x), world.past[-1]) for x in (steady, fast, pulsing)])
    paths[:, :, 3] = 13.0  # all say so
    found = score(paths, world, GERMAN, world.past)
    assert found.outcomes("speed_limit") == ["kept", "violated", "open"]
    assert found.allowed.tolist() == [True, False, False]
    assert found.reward().argmax() == 0


def test_who_is_nowhere_judged_keeps_nothing():
    """Far off the map, and across the road, which leads nobody there."""
    world = lit_junction()
    straight = along(on_axis(10.0 * AHEAD), world.past[-1])
    away, across = straight.copy(), straight.copy()
    away[:, 1] += 1e5
    across[:, 2] = np.pi / 2
    found = score(np.array([straight, away, across]), world, GERMAN, None)
    assert found.outcomes("red_light") == ["violated", "not judged", "not judged"]
    assert found.off_road.tolist() == [0, 20, 20]


@pytest.mark.parametrize("with_past", [True, False])
@pytest.mark.parametrize("says", ["its way", "its heading"])
def test_sliding_is_no_way_to_be_slower(with_past, says):
    """Straight on at 17 m/s, turned aside by 40° in the end: 13 m/s are along the heading."""
    world = street(speed=13.0)
    turned = np.radians(40) * np.minimum(AHEAD / 8.0, 1.0)
    speed = 13.0 / np.cos(turned)
    slides = along(on_axis(np.cumsum(speed * STEP_S)), world.past[-1])
    slides[:, 2] = turned
    slides[:, 3] = speed if says == "its way" else 13.0
    steady = along(on_axis(13.0 * AHEAD), world.past[-1])
    after = world.past if with_past else None
    found = score(np.array([slides, steady]), world, GERMAN, after)
    assert found.outcomes("speed_limit") == ["open", "kept"]
    assert found.allowed.tolist() == [False, True]
    assert found.reward().argmax() == 1


@pytest.mark.parametrize("with_past", [True, False])
def test_nobody_is_believed_to_be_slower_than_its_places(with_past):
    """Not even among vehicles of SUMO, whose own speeds count."""
    recording = replace(street(speed=13.0).recording, form="SUMO data")
    world = TrafficWorld(recording, "ego")
    paths = np.array([along(on_axis(x * AHEAD), world.past[-1]) for x in (14.5, 13.5)])
    paths[:, :, 3] = 13.8
    found = score(paths, world, GERMAN, world.past if with_past else None)
    assert found.outcomes("speed_limit") == ["violated", "kept"]


def test_who_jumps_to_the_next_lane_is_no_faster():
    """At 13.6 of 13.9 m/s, as a simulator puts it there: the heading stays along the road."""
    world = street(speed=13.6)
    jumps = along(on_axis(13.6 * AHEAD), world.past[-1])
    jumps[8:, 1] = 3.5
    found = score(jumps[None], world, GERMAN, world.past)
    assert found.outcomes("speed_limit") == ["kept"]


def test_what_the_past_has_violated_is_judged_anew():
    # At 20 m/s in a town. One goes on so, one brakes with 4 m/s² to 12 m/s, and one does and then
    # is at 20 m/s again for the last four of its twenty states
    world = street(speed=20.0)
    braked = 20 * AHEAD - 2 * np.minimum(AHEAD, 2.0) ** 2 - 8 * np.clip(AHEAD - 2, 0, None)
    again = braked + 8 * np.clip(AHEAD - 8, 0, None)
    found = scored(world, on_axis(20 * AHEAD), on_axis(braked), on_axis(again))
    assert "speed_limit" in {violation.rule for violation in found.violated_before}
    assert found.outcomes("speed_limit") == ["violated", "kept", "violated"]
    steps = {
        found.number: [one.step for one in found.violations if one.rule == "speed_limit"]
        for found in found.candidates
    }
    # In state 15 it is not known: nobody gains 8 m/s in half a second, so the track slips there
    assert steps == {0: [10], 1: [], 2: [16]}
    assert found.best == 1


def test_putting_off_what_is_violated_does_not_pay():
    """At 20 m/s in a town both brake by 4 m/s² to 12 m/s, one 2 s (4 states) later.

    Else whoever plans anew after every step would go on braking later.
    """
    world = street(speed=20.0)
    at_once, later = (
        20 * AHEAD - 2 * np.minimum(own, 2.0) ** 2 - 8 * np.clip(own - 2, 0, None)
        for own in (AHEAD, np.maximum(AHEAD - 2, 0))
    )
    found = scored(world, on_axis(later), on_axis(at_once))
    assert found.outcomes("speed_limit") == ["kept", "kept"]
    assert found.allowed.tolist() == [True, True]
    after, before = (one.late for one in found.candidates)
    assert after - before == 4
    assert found.places.tolist() == [2, 1]
    # 4 of 20 states, and one more so that the share is below 1
    assert np.diff(found.reward()).tolist() == pytest.approx([4 / 21])


def test_who_has_remedied_it_does_not_violate_it_again_for_free():
    """From 20 m/s in a town both brake to 12 m/s; one is at 15 m/s again within the first half."""
    world = street(speed=20.0)
    speeds = np.maximum(20 - 2 * np.arange(1, 21.0), 12)
    burst = speeds.copy()
    burst[5:9] = [13, 14, 15, 13.5]
    found = scored(world, *(on_axis(np.cumsum(own) * STEP_S) for own in (burst, speeds)))
    assert found.outcomes("speed_limit") == ["violated", "kept"]
    ((again,),) = [
        [one.step for one in candidate.violations if one.rule == "speed_limit"]
        for candidate in found.candidates[:1]
    ]
    # 50 km/h are 13.9 m/s
    assert again in (6, 7)
    assert found.allowed.tolist() == [False, True]


@pytest.mark.parametrize("drawn", ["", "sidewalk", "border", "parking"])
def test_a_verge_is_no_way_past_a_slow_vehicle(drawn):
    # The right lane ends at y = -1.75; the middle of the last one is 0.85 m beyond it, the body not
    line = [(-100, -3.25), (500, -3.25)]
    beside = [build_lanelet("beside", line, 3.0, types=[drawn])] if drawn else []
    world = street([car("slow", 4.0, x=45.0)], speed=12.0, beside=beside)
    eased = 12 * AHEAD - 2 * np.clip(AHEAD - 1, 0, 2) ** 2 - 8 * np.clip(AHEAD - 3, 0, None)
    straight = 12 * AHEAD
    by_it = np.column_stack((straight, -2.6 * np.clip(AHEAD - 1, 0, 1)))
    found = scored(world, on_axis(eased), on_axis(straight), by_it)
    # It is 2.6 m aside from the fourth of its 20 states on
    assert found.off_road.tolist() == [0, 0, 17]
    assert found.allowed.tolist() == [True, False, False]
    assert found.best == 0
    assert found.reward().argmin() == 2


def test_looking_back_is_no_way_past_a_red_light():
    """The lanes of the other direction, on which who looks back is judged, have no light."""
    ways = {
        "right": [("in", -100, 60), ("across", 60, 80), ("out", 80, 400)],
        "left": [("back in", 400, 80), ("back across", 80, 60), ("back", 60, -100)],
    }
    lanes = []
    for y, own in zip((0.0, 3.5), ways.values(), strict=True):
        for k, (name, begin, end) in enumerate(own):
            more = {"lights": [Light(0, (("red", 1000),))]} if name == "in" else {}
            onward = [own[k + 1][0]] if k < 2 else []
            inside = {"junction": "j"} if k == 1 else {}
            line = [(begin, y), (end, y)]
            town = {"types": ["urban"], "limit_mps": 50 / 3.6, **more, **inside}
            lanes.append(build_lanelet(name, line, successors=onward, **town))
    ego = car("ego", 10.0, x=-15.0, count=4)
    made = build_recording(lanes, [ego], step_s=STEP_S, side="right", complete={"light"})
    world = TrafficWorld(made, "ego")
    ahead, slowly = on_axis(10.0 * AHEAD), on_axis(-2.0 * AHEAD)
    paths = np.array([along(path, world.past[-1]) for path in (ahead, ahead, ahead, slowly)])
    paths[1, :, 2], paths[2, 10:, 2], paths[3, :, 2] = np.pi, 1.8, 0.0
    found = score(paths, world, GERMAN, world.past)
    assert found.outcomes("red_light")[0] == "violated"
    # 2 m/s are 7.2 km/h, as slow as one walks
    assert found.off_road.tolist() == [0, 20, 10, 0]
    assert found.allowed.tolist()[:3] == [False] * 3
    assert found.reward()[1:3].max() < found.reward()[0]
