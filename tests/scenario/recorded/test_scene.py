"""Recordings made by hand as scenarios: who is where when, and what can be told."""

from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest

from rulec.diagnostics import RulecError
from rulec.partition import navigation_graph
from rulec.recordings.recording import Light, Participant
from rulec.scenario import Alternative, Box, Choice, ConstantAcceleration, Footprints
from rulec.scenario.motion import swept
from rulec.scenario.recorded.recorded_scene import seen_from_ego
from rulec.scenario.recorded.traffic_obstacles import GOES_ON_S
from support.builders.recordings import recording, rectangle, straight, vehicle

ROAD = straight(1, 0, 200, left_of=2)
BESIDE = straight(2, 0, 200, y=4, right_of=1)
CHOICE = Choice()


def scene(*participants, choice=CHOICE, lanelets=(ROAD, BESIDE), **more):
    made = recording(lanelets, participants, **{"ego": (20.0, 0.5), **more})
    return seen_from_ego(made, choice, "file.xml")


def drive(number, start, speed, steps=10, y=0.0, **more):
    """A vehicle that is recorded every half second."""
    places = {k: (start + speed * k / 2, y) for k in range(steps + 1)}
    return vehicle(number, places, speed=speed, **more)


def only(scenario):
    (obstacle,) = scenario.obstacles
    return obstacle


def test_ego_is_at_0_of_a_road_with_its_lanes():
    scenario = scene()
    assert (scenario.ego.s, scenario.ego.d) == pytest.approx((0, 0.5))
    assert scenario.road.s == pytest.approx((-20, 180))
    assert scenario.road.lanes == pytest.approx((-2, 2, 6))
    assert (scenario.name, scenario.horizon_s, scenario.step_s) == ("made by hand", 4, 0.5)


def test_ego_is_as_large_as_the_vehicle_whose_part_it_takes():
    """4.6 m long and 1.9 m wide, on a heading of 0.3; a planning problem alone has no size."""
    car = drive(7, 20, 0, y=0.5, length=4.6, width=1.9, heading=0.3)
    for choice in (CHOICE, replace(CHOICE, ego=7)):
        ego = scene(car, choice=choice).ego
        assert (ego.length, ego.width) == pytest.approx((4.6, 1.9))
    assert scene(car, choice=replace(CHOICE, ego_width_m=2.5)).ego.width == 2.5
    assert (scene().ego.length, scene().ego.width) == (0, 0)


def test_a_recorded_vehicle_is_where_it_was():
    obstacle = only(scene(drive(7, 40, 10)))
    assert (obstacle.id, obstacle.type, obstacle.broader[0]) == ("7", "car", "vehicle")
    assert isinstance(obstacle.motion, Footprints)
    for start, end in ((0, 0), (0.25, 1), (2, 5)):
        body = swept(obstacle, start, end)
        expected = Box(18 + 10 * start, 22 + 10 * end, -1, 1)
        assert body == pytest.approx(expected) or (
            [body.s_min, body.s_max, body.d_min, body.d_max]
            == pytest.approx([expected.s_min, expected.s_max, expected.d_min, expected.d_max])
        )


def test_who_turns_takes_more_room_across():
    turned = vehicle(7, {0: (60, 0), 1: (60, 0)}, heading=pi / 2)
    body = swept(only(scene(turned)), 0, 0)
    assert (body.s_max - body.s_min, body.d_max - body.d_min) == pytest.approx((2, 4))


def test_one_who_comes_later_and_leaves_is_there_meanwhile():
    here = vehicle(7, {2: (60, 0), 3: (65, 0), 4: (70, 0)})
    scenario = scene(here, drive(8, 100, 0, steps=8))
    obstacle = scenario.obstacles[0]
    assert swept(obstacle, 0, 0.9) is None
    assert swept(obstacle, 0, 1).s_max == pytest.approx(42)
    assert swept(obstacle, 2.1, 4) is None


def test_who_is_there_at_the_end_goes_on():
    """So is who is lost half a second before, but not who is 1.5 s before."""
    several = drive(7, 40, 10, steps=1), drive(8, 100, 4, steps=4), drive(9, 140, 4, steps=3)
    scenario = scene(*several)
    gone, stays, lost = scenario.obstacles
    assert scenario.account.until_s == 2
    assert swept(gone, 1.5, 2) is None
    for one, start in ((stays, 80), (lost, 120)):
        body = swept(one, 4, 4)
        assert (body.s_min + body.s_max) / 2 == pytest.approx(start + 4 * 4)
        assert swept(one, GOES_ON_S + 3, GOES_ON_S + 4) is None


@pytest.mark.parametrize(
    ("start", "y", "goes_on"), [(0, 0.0, False), (0, 4.0, True), (60, 0.0, True)]
)
def test_who_follows_ego_and_is_lost_does_not_go_on(start, y, goes_on):
    """Ego drives at 10 m/s from x = 20 on, and is at 55 m when the other one is lost, at 42 m."""
    ego = drive(1, 20, 10, steps=8)
    lost = drive(7, start, 12, steps=7, y=y)
    scenario = scene(ego, lost, choice=Choice(ego=1))
    assert scenario.account.until_s == 4
    assert (swept(only(scenario), 3.8, 4.0) is not None) == goes_on


@pytest.mark.parametrize(
    ("y", "kept"), [(0, True), (4, True), (6.6, True), (6.8, False), (-8, False), (-300, False)]
)
def test_only_who_touches_the_road_is_kept(y, kept):
    scenario = scene(drive(7, 40, 10, y=y))
    assert len(scenario.obstacles) == kept
    assert (scenario.account.recorded, scenario.account.left_out) == (1, not kept)


def test_who_stands_is_there_for_good():
    standing = replace(vehicle(7, {0: (60, 4)}, kind="parkedVehicle"), standing=True)
    off = replace(vehicle(8, {0: (60, 14)}), standing=True)
    scenario = scene(standing, off)
    obstacle = only(scenario)
    assert obstacle.motion == ConstantAcceleration(pytest.approx(40), pytest.approx(4))
    assert (obstacle.type, obstacle.signals["parked"]) == ("vehicle", True)
    assert scenario.account.left_out == 1


def test_constant_acceleration_instead_of_what_was_recorded():
    braking = drive(7, 40, 10, acceleration=-2.0)
    obstacle = only(scene(braking, choice=Choice(prediction="constant")))
    assert obstacle.motion == ConstantAcceleration(
        pytest.approx(20), pytest.approx(0), pytest.approx(10), pytest.approx(-2)
    )
    assert (obstacle.length, obstacle.width) == pytest.approx((4, 2))


def test_one_or_the_other_prediction():
    """Who is there later, or stands, has but one."""
    both = Choice(prediction={"recorded": Fraction(2, 5), "constant": Fraction(3, 5)})
    later = vehicle(8, {k: (60 + k, 4) for k in range(2, 9)})
    parked = replace(vehicle(9, {0: (90, 4)}, kind="parkedVehicle"), standing=True)
    first, *others = scene(drive(7, 40, 10), later, parked, choice=both).obstacles
    alone = [
        only(scene(drive(7, 40, 10), choice=Choice(prediction=kind))).motion
        for kind in ("constant", "recorded")
    ]
    assert (first.motion, first.weight) == (alone[0], Fraction(3, 5))
    assert first.alternatives == (Alternative(Fraction(2, 5), alone[1]),)
    assert [(one.id, one.weight, one.alternatives) for one in others] == [
        ("8", 1, ()),
        ("9", 1, ()),
    ]


def test_constant_acceleration_against_ego():
    oncoming = drive(7, 40, 0, y=4, heading=pi, acceleration=1.0)
    oncoming = replace(
        oncoming, states={k: replace(x, speed=8.0) for k, x in oncoming.states.items()}
    )
    motion = only(scene(oncoming, choice=Choice(prediction="constant"))).motion
    assert (motion.speed, motion.acceleration) == pytest.approx((-8, -1))


def test_one_known_state_is_predicted_in_any_case():
    obstacle = only(scene(vehicle(7, {0: (40, 0)}, speed=3.0)))
    assert (obstacle.motion.s, obstacle.motion.speed) == pytest.approx((20, 3))


def test_an_occupancy_without_states_is_one():
    outlines = {k: rectangle(40 + k, 0, 6 + k, 2) for k in range(3)}
    obstacle = only(scene(Participant(7, "unknown", False, {}, outlines)))
    body = swept(obstacle, 0.5, 0.5)
    assert (body.s_min, body.s_max) == pytest.approx((17.5, 24.5))
    assert obstacle.type == "road_user"


def test_a_pedestrian_who_stands_looks_where_it_is_turned():
    waiting = vehicle(7, {0: (60, 5), 1: (60, 5)}, kind="pedestrian", heading=-pi / 2)
    assert only(scene(waiting)).walking_direction == pytest.approx(-90)
    walking = vehicle(7, {0: (60, 5), 1: (60, 4)}, kind="pedestrian", heading=-pi / 2)
    assert only(scene(walking)).walking_direction is None


def test_egos_own_recording_is_no_obstacle():
    scenario = scene(drive(7, 20, 10, y=0.5), drive(8, 60, 10))
    assert [one.id for one in scenario.obstacles] == ["8"]
    assert (scenario.account.recorded, scenario.account.left_out) == (1, 0)


def test_a_recorded_vehicle_as_ego_from_a_moment_on():
    scenario = scene(drive(7, 40, 10, y=4), drive(8, 60, 10), choice=Choice(ego=7, at_s=2.0))
    assert (scenario.ego.s, scenario.ego.d) == (0, 0)
    assert scenario.account.reference == "2"
    assert scenario.road.lanes == pytest.approx((-6, -2, 2))
    body = swept(only(scenario), 0, 0)
    assert ((body.s_min + body.s_max) / 2, body.d_max) == pytest.approx((20, -3))


def test_another_reference_line():
    scenario = scene(drive(7, 40, 10), choice=Choice(reference=2))
    assert scenario.ego.d == pytest.approx(-3.5)
    assert scenario.road.lanes == pytest.approx((-6, -2, 2))


@pytest.mark.parametrize(
    ("choice", "says"),
    [
        (Choice(ego=5), "no planning problem and no moving obstacle 5"),
        (Choice(ego=7, at_s=9.0), "obstacle 7 has no state at 9 s"),
        (Choice(ego=7, at_s=0.3), "no states at 0.3 s"),
        (Choice(at_s=1.0), "planning problem 99 defines ego at 0 s"),
        (Choice(reference=5), "there is no lanelet 5"),
    ],
)
def test_what_is_not_there_cannot_be_chosen(choice, says):
    with pytest.raises(RulecError) as caught:
        scene(drive(7, 40, 10), choice=choice)
    (found,) = caught.value.diagnostics
    assert (found.code, found.place.file) == ("R0612", "file.xml")
    assert says in found.message
    assert found.help


def test_ego_off_every_lane_is_refused():
    with pytest.raises(RulecError, match="on no lanelet"):
        scene(ego=(20.0, 12.0))


def test_without_a_planning_problem_ego_has_to_be_chosen():
    made = replace(recording([ROAD], [drive(7, 40, 10)]), problems=())
    with pytest.raises(RulecError, match="no planning problem") as caught:
        seen_from_ego(made, CHOICE, "f")
    assert "`ego`: `7`" in caught.value.diagnostics[0].help
    assert seen_from_ego(made, Choice(ego=7), "f").ego.s == 0


def crosswalk(x, low, high):
    """Three metres wide, across the road from right to left."""
    return replace(
        straight(5, 0, 1),
        right=np.array([(x + 3, low), (x + 3, high)], dtype=float),
        left=np.array([(x, low), (x, high)], dtype=float),
        types=frozenset({"crosswalk"}),
    )


def test_a_crosswalk_is_a_crossing_where_it_meets_the_road():
    scenario = scene(lanelets=[ROAD, BESIDE, crosswalk(60, -10, 10)])
    (stretch,) = scenario.road.surfaces
    assert (stretch.surface, stretch.s) == ("crossing", pytest.approx((40, 43)))
    assert scene(lanelets=[ROAD, BESIDE, crosswalk(60, 6.5, 20)]).road.surfaces == ()


@pytest.mark.parametrize(
    ("speeds", "below", "expected"),
    [
        ([8, 8, 8.4], 30, True),  # 8 m/s are 28.8 km/h
        ([8, 8.4, 8.4], 30, False),  # 8.4 m/s are 30.24 km/h
        ([8, 8], 30, False),  # two are too few
        ([8, 8, 8.4], 28, False),
        ([0, 0, 0], 0, False),
    ],
)
def test_congestion(speeds, below, expected):
    cars = [drive(k, 40 + 30 * k, speed) for k, speed in enumerate(speeds)]
    scenario = scene(*cars, choice=Choice(congested_below_kmh=below))
    assert scenario.signals["CONGESTED"] is scenario.signals["congested"] is expected
    assert scenario.account.derived["CONGESTED"]


def test_congestion_counts_vehicles_that_go_egos_way_on_its_road():
    oncoming = drive(5, 150, -8, y=4)
    bicycle = drive(6, 90, 4, kind="bicycle")
    elsewhere = drive(7, 90, 8, y=30)
    scenario = scene(drive(1, 40, 8), drive(2, 60, 8), oncoming, bicycle, elsewhere)
    assert scenario.signals["CONGESTED"] is False
    assert "here 2" in scenario.account.derived["CONGESTED"]


def test_what_the_map_tells():
    own = replace(
        ROAD,
        limit_mps=50 / 3.6,
        signs=frozenset({"MAX_SPEED", "YIELD"}),
        types=frozenset({"interstate"}),
        lights=(Light(0, (("red", 200),)),),
    )
    signals = scene(lanelets=[own, BESIDE]).signals
    assert signals == {
        "CONGESTED": False,
        "congested": False,
        "limit": 50,
        "give_way_sign": True,
        "road_class": "motorway",
        "lanes": "two_lanes",
        "light": "red_light",
    }


@pytest.mark.parametrize(
    ("phases", "expected"),
    [
        ((("green", 30),), "green_light"),
        ((("green", 20), ("red", 20)), None),  # changes within 10 s, 20 steps
        ((("green", 21), ("red", 20)), "green_light"),
        ((("redYellow", 30),), None),  # the vocabulary has no word for it
    ],
)
def test_a_light_is_told_if_it_does_not_change(phases, expected):
    own = replace(ROAD, lights=(Light(0, phases),))
    assert scene(lanelets=[own, BESIDE]).signals.get("light") == expected


def test_lights_that_differ_are_not_told():
    own = replace(ROAD, lights=(Light(0, (("green", 9),)), Light(0, (("red", 9),))))
    assert "light" not in scene(lanelets=[own, BESIDE]).signals


def test_a_programme_repeats_itself():
    light = Light(5, (("green", 3), ("red", 2)))
    assert [light.colour_at(k) for k in (5, 7, 8, 9, 10, 4, 0)] == [
        "green", "green", "red", "red", "green", "red", "green",
    ]  # fmt: skip


def test_what_is_not_known_is_not_said():
    signals = scene().signals
    assert set(signals) == {"CONGESTED", "congested", "lanes"}


ENDING = straight(1, 0, 200, left_of=2)
GOING_ON = straight(2, 0, 200, y=4, right_of=1)


def leading_on(lanelet):
    return replace(lanelet, successors=("3",))


@pytest.mark.parametrize(
    ("speed", "lanelets", "horizon", "step"),
    [
        # 180 m are left: 4.5 s at 40 m/s, 3.6 s at 50 m/s, 0.36 s at 500 m/s
        (40.0, (ENDING, GOING_ON), 4.0, 0.5),
        (50.0, (ENDING, GOING_ON), 3.5, 0.5),
        (500.0, (ENDING, GOING_ON), 0.25, 0.25),
        (0.0, (ENDING, GOING_ON), 4.0, 0.5),
        # A lane that ends beside one that goes on is no end of the map
        (50.0, (ENDING, leading_on(GOING_ON), straight(3, 200, 400, y=4)), 4.0, 0.5),
        (50.0, (leading_on(ENDING), GOING_ON, straight(3, 200, 400)), 4.0, 0.5),
    ],
)
def test_nothing_is_looked_at_beyond_the_end_of_the_map(speed, lanelets, horizon, step):
    scenario = scene(drive(7, 20, speed, steps=1), choice=Choice(ego=7), lanelets=lanelets)
    assert (scenario.horizon_s, scenario.step_s) == (horizon, step)
    ends = any("the map ends 180.0 m ahead of ego" in one for one in scenario.account.remarks)
    assert ends == scenario.account.map_ends == (horizon < 4.0)


@pytest.mark.parametrize(
    ("options", "layers"), [({}, 8), ({"step_s": 1.0}, 4), ({"horizon_s": 4.0}, 9)]
)
def test_at_the_end_of_the_map_a_step_need_not_fit(options, layers):
    """3.5 s in steps of 0.5 s, 3 s in steps of 1 s, and 4 s, on a road that ends, if asked for."""
    scenario = scene(drive(7, 20, 50.0, steps=1), choice=Choice(ego=7))
    assert len(navigation_graph(scenario, bounds="none", **options).layers) == layers
