"""What ego can drive is kept; sets of places and speeds hold what was sampled."""

import random
from dataclasses import replace
from itertools import product

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec import RulecError, load_scenario, navigation_graph
from rulec.partition.motion import reachable_graph
from rulec.scenario import Box, ConstantAcceleration, Ego, MotionBounds, Obstacle, Road, Scenario
from support.builders.recorded_data import RECORDINGS
from support.generators.driven_motions import driven, is_free, paths_of
from support.generators.random_scenarios import scenarios

EMPTY = Scenario("empty", Road((-50.0, 500.0), (-2.0, 2.0, 6.0)), Ego(0.0, 0.0, speed=10.0))


def holds(interval, value):
    return interval[0] - 1e-6 <= value <= interval[1] + 1e-6


def check_kept(scenario, bounds, partition, chance, number):
    """Each motion's cells are kept, and its places and speeds in their sets: how many were."""
    extent = "lane" if scenario.account is None else "clearance"
    whole = navigation_graph(scenario, partition=partition, bounds="none", extent=extent)
    kept = navigation_graph(
        scenario,
        partition=partition,
        bounds=bounds,
        extent=extent,
        step_s=whole.step_s,
        horizon_s=whole.step_s * (len(whole.layers) - 1),
    )
    found = 0
    for _ in range(number):
        states = driven(scenario.ego, bounds, whole.step_s, len(whole.layers), chance)
        path = paths_of(whole, states)
        if path is None:
            continue
        found += 1
        for p, (cells, (s, v, d, w)) in enumerate(zip(path, states, strict=True)):
            own = kept.layers[p].cells
            for cell in (whole.layers[p].cells[i] for i in cells):
                assert cell in own, (p, s, v, d, w)
                reach = kept.reach[p][own.index(cell)]
                assert holds(reach.s, s), (p, s, reach)
                assert holds(reach.d, d), (p, d, reach)
                assert holds(reach.speed, v), (p, v, reach)
                assert holds(reach.lateral_speed, w), (p, w, reach)
    return found


def standing(name, s):
    return Obstacle(name, "vehicle", 5.0, 1.8, ConstantAcceleration(s, 0.0))


def with_ego(scenario, bounds, speed, sideways):
    ego = Ego(scenario.ego.s, scenario.ego.d, speed=speed, lateral_speed=sideways, bounds=bounds)
    return Scenario(
        scenario.name, scenario.road, ego, scenario.obstacles, goal=scenario.goal, step_s=0.5,
        horizon_s=2.0,
    )  # fmt: skip


@given(
    scenarios(most=3),
    st.sampled_from(["paper", "fine"]),
    st.floats(0, 15),
    st.floats(-1, 1),
    st.integers(0, 10**6),
)
def test_motions_in_random_scenarios(scenario, partition, speed, sideways, seed):
    bounds = MotionBounds(speed=20.0, acceleration=4.0, braking=8.0)
    start = with_ego(scenario, bounds, speed, min(max(sideways, -speed), speed))
    try:
        navigation_graph(start, partition=partition)
    except RulecError:
        assume(False)
    check_kept(start, bounds, partition, random.Random(seed), 5)


FILES = sorted(RECORDINGS.glob("*.xml"))


@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize("number", [20, pytest.param(5000, marks=pytest.mark.long)])
@pytest.mark.parametrize("file", FILES[:3] or [""], ids=lambda file: getattr(file, "stem", ""))
def test_motions_in_recorded_scenes(file, number):
    scenario = load_scenario(file)
    check_kept(scenario, scenario.ego.bounds, "fine", random.Random(17), number)


@pytest.mark.long
@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
def test_motions_in_all_recorded_scenes():
    found = 0
    for file in FILES:
        scenario = load_scenario(file)
        for partition in ("paper", "fine"):
            chance = random.Random(file.stem)
            found += check_kept(scenario, scenario.ego.bounds, partition, chance, 2000)
    assert found > 1000


BESIDE = list(product((-12.0, -2.0, 8.0), (17.0, 23.0), (-4.0, 6.0, 20.0), (14.0, 17.0, 20.0)))


@pytest.mark.parametrize(("right", "slower", "left", "other"), BESIDE)
def test_who_drives_on_beside_others_is_kept(right, slower, left, other):
    """Nobody is in ego's lane; in a step it passes borders on both sides."""
    beside = [
        Obstacle(name, "vehicle", 4.5, 1.8, ConstantAcceleration(s, d, speed))
        for name, s, d, speed in (("r", right, -3.5, slower), ("l", left, 3.5, other))
    ]
    ego = Ego(0.0, 0.0, 4.5, 1.8, speed=20.0, bounds=MotionBounds())
    road = Road((-200.0, 600.0), (-5.25, -1.75, 1.75, 5.25))
    scene = Scenario("beside", road, ego, tuple(beside), step_s=0.5, horizon_s=4.0)
    graph = navigation_graph(scene, partition="fine", extent="clearance")
    states = [(20.0 * 0.5 * p, 20.0, 0.0, 0.0) for p in range(9)]
    assert paths_of(graph, states) is not None


@given(scenarios(most=6), st.floats(0, 25), st.integers(0, 10**6))
def test_nothing_is_lost_by_leaving_out_what_is_far_from_ego(scenario, speed, seed):
    """The graph is the same if edges from all cells are made first."""
    sideways = random.Random(seed).uniform(-1, 1)
    scenario = with_ego(scenario, MotionBounds(), speed, sideways)
    partition = random.Random(seed).choice(["fine", "paper"])
    try:
        near = navigation_graph(scenario, partition=partition)
    except RulecError:
        assume(False)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            reachable_graph,
            "cells_within_reach",
            lambda layers, *_: [range(len(layer.cells)) for layer in layers],
        )
        whole = navigation_graph(scenario, partition=partition)
    assert near == whole


@given(scenarios(most=6), st.floats(0, 25), st.integers(0, 10**6))
def test_motions_that_are_never_in_anybodys_way_are_kept(scenario, speed, seed):
    """In each step they are only where nobody comes meanwhile: every one is a path."""
    bounds, pieces = MotionBounds(speed=30.0, acceleration=4.0, braking=8.0), 10
    start = replace(with_ego(scenario, bounds, speed, 0.0), goal=None)
    try:
        graph = navigation_graph(start, partition="fine")
    except RulecError:
        assume(False)
    layers, chance = len(graph.layers), random.Random(seed)
    for _ in range(5):
        step = graph.step_s / pieces
        states = driven(start.ego, bounds, step, pieces * (layers - 1) + 1, chance, pieces=1)
        if all(is_free(graph, k, pieces, s, d) for k, (s, _, d, _) in enumerate(states)):
            assert paths_of(graph, states[::pieces]) is not None


def test_a_motion_on_an_empty_road_is_bounded_by_hand():
    # From 10 m/s, after 1 s: from 10 - 8 / 2 to 10 + 4 / 2 m, at 2 to 14 m/s.
    bounds = MotionBounds(acceleration=4.0, braking=8.0)
    graph = navigation_graph(EMPTY, bounds=bounds)
    (reach,) = graph.reach[1]
    assert reach.s == pytest.approx((6.0, 12.0), abs=1e-5)
    assert reach.speed == pytest.approx((2.0, 14.0), abs=1e-5)
    assert reach.d == pytest.approx((-1.0, 1.0), abs=1e-5)
    # It stands after 1.25 s, at 6.25 m, and does not reverse.
    assert graph.reach[2][0].s[0] == pytest.approx(6.25, abs=0.3)
    assert graph.reach[4][0].speed[0] == 0.0
    # Four seconds of it: 40 + 4 * 16 / 2.
    assert graph.reach[4][0].s[1] == pytest.approx(72.0, abs=1e-4)


def test_what_nobody_can_drive_is_gone():
    # One stands 30 m ahead; in front of it in 1 s one would have to do 32 m.
    blocked = Scenario("b", EMPTY.road, EMPTY.ego, (standing("car", 30.0),), step_s=1.0)
    whole = navigation_graph(blocked)
    kept = navigation_graph(blocked, bounds="car")
    assert {cell.signature["car"] for cell in whole.layers[2].cells} == {"b", "f", "l"}
    assert {cell.signature["car"] for cell in kept.layers[1].cells} == {"b"}
    assert "f" not in {cell.signature["car"] for cell in kept.layers[2].cells}
    assert kept.bounds == MotionBounds()
    assert whole.bounds is None


@pytest.mark.parametrize(
    ("goal_s", "reached"),
    [
        # From 10 m/s ego comes to a stand 50 / 11.5 = 4.3 m on, or by 8 m/s² 40 + 64 m within 4 s
        ((-40.0, -20.0), False),
        ((-40.0, 4.0), False),
        ((-40.0, 5.0), True),
        ((103.0, 120.0), True),
        ((105.0, 120.0), False),
    ],
)
def test_a_goal_is_reached_if_ego_can_be_in_it_at_the_end(goal_s, reached):
    """On an empty road the goal's cell is ego's own, wherever the goal is."""
    scene = Scenario("g", EMPTY.road, EMPTY.ego, goal=Box(*goal_s, -2.0, 2.0))
    assert navigation_graph(scene).leads_to_a_goal
    graph = navigation_graph(scene, bounds="car")
    assert graph.leads_to_a_goal == reached
    if reached:
        low, high = graph.reach[-1][0].s
        assert (max(low, goal_s[0]), min(high, goal_s[1])) == pytest.approx((low, high), abs=1e-4)


def test_a_goal_behind_one_that_stands_cannot_be_reached():
    stopped = Ego(0.0, 0.0, speed=0.0)
    car, goal = (standing("car", -10.0),), Box(-40, -20, -2, 2)
    beyond = Scenario("g", EMPTY.road, stopped, car, goal=goal)
    assert not navigation_graph(beyond, bounds="car").leads_to_a_goal


def test_who_stands_and_cannot_drive_off_stays():
    stopped = Scenario("s", EMPTY.road, Ego(0.0, 0.0, speed=0.0), step_s=0.5)
    graph = navigation_graph(stopped, bounds=MotionBounds(acceleration=0.001))
    assert graph.reach[-1][0].s == pytest.approx((0.0, 0.008), abs=1e-4)
    # Sideways no farther than ahead, which may have been all at once in any of the 8 layers.
    assert graph.reach[-1][0].d == pytest.approx((0.0, 0.0), abs=0.064)


@pytest.mark.parametrize(
    "text", ["", "spaceship", "braking", "braking=0", "braking=nan", "weight=3", "braking=6,car"]
)
def test_bounds_that_make_no_sense(text):
    with pytest.raises(RulecError) as caught:
        navigation_graph(EMPTY, bounds=text)
    assert caught.value.diagnostics[0].code == "R0770"


def test_bounds_as_written():
    graph = navigation_graph(EMPTY, bounds="truck, braking=6")
    assert graph.bounds == MotionBounds(speed=22.22, braking=6.0, length=5.1, width=2.55)
    assert navigation_graph(EMPTY, bounds="none").bounds is None


def test_bounds_of_a_file(tmp_path):
    file = tmp_path / "own.toml"
    road = "[road]\ns = [0, 99]\nlanes = [-2, 2]\n[ego]\ns = 0\nd = 0\nspeed = 8\n"
    file.write_text(road + 'bounds = "braking=6"\n')
    assert navigation_graph(file).bounds == MotionBounds(braking=6.0)
    file.write_text(road + 'bounds = "braking=-6"\n')
    with pytest.raises(RulecError) as caught:
        load_scenario(file)
    (mistake,) = caught.value.diagnostics
    assert (mistake.code, mistake.place.line) == ("R0770", 8)
