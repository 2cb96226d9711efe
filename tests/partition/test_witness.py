"""Trajectories of listed maneuvers: within bounds, in their cells, and overlapping nobody."""

from itertools import pairwise
from math import ceil, inf

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec import RulecError, compile_rulebook, find_maneuvers, load_scenario
from rulec.scenario import Box, ConstantAcceleration, Ego, MotionBounds, Obstacle, Road, Scenario
from rulec.scenario.motion import swept
from support.builders.recorded_data import RECORDINGS
from support.generators.driven_motions import cells_of
from support.generators.random_scenarios import scenarios

PAPER = compile_rulebook("esterle2019")
ROAD = Road((-50.0, 500.0), (-2.0, 2.0, 6.0))
MOVING = Ego(0.0, 0.0, 4.0, 1.8, speed=10.0, bounds=MotionBounds())
ROUNDING_M = 1e-3
"""States are rounded."""


def at(states, time):
    """Place at a time, by the accelerations of the piece that it is in."""
    for (t0, s0, v0, d0, w0), (t1, _, v1, _, w1) in pairwise(states):
        if time <= t1 + 1e-9:
            x, piece = time - t0, t1 - t0
            return (
                s0 + v0 * x + (v1 - v0) / piece * x * x / 2,
                d0 + w0 * x + (w1 - w0) / piece * x * x / 2,
            )
    raise AssertionError(time)


def check_driven(graph, maneuver):
    scenario, bounds = graph.scenario, graph.bounds
    states = maneuver.trajectory.states
    ego = scenario.ego
    assert states[0][1:] == pytest.approx((ego.s, states[0][2], ego.d, ego.lateral_speed), abs=1e-5)
    for (t0, _, v0, _, w0), (t1, _, v1, _, w1) in pairwise(states):
        assert -bounds.braking - 1e-3 <= (v1 - v0) / (t1 - t0) <= bounds.acceleration + 1e-3
        assert abs(w1 - w0) / (t1 - t0) <= bounds.lateral_acceleration + 1e-3
        assert -1e-5 <= v1 <= max(bounds.speed, v0) + 1e-5
    for layer, node in zip(graph.layers, maneuver.nodes, strict=True):
        s, d = at(states, layer.start_s)
        cell = layer.cells[node]
        assert any(
            b.s_min - 1e-4 <= s <= b.s_max + 1e-4 and b.d_min - 1e-4 <= d <= b.d_max + 1e-4
            for b in cell.boxes
        )
    until = states[-1][0]
    for k in range(ceil(until / 0.05 + 1e-9)):
        s, d = at(states, k * 0.05)
        # What is recorded of ego's body, which may be a point
        half, side = ego.length / 2, ego.width / 2
        body = Box(s - half, s + half, d - side, d + side)
        for obstacle in scenario.obstacles:
            there = swept(obstacle, k * 0.05, k * 0.05)
            assert there is None or not less(there, ROUNDING_M).overlaps(body), (k, obstacle.id)


def less(box, margin):
    return Box(box.s_min + margin, box.s_max - margin, box.d_min + margin, box.d_max - margin)


@given(scenarios(most=2), st.floats(0, 15))
def test_random_scenarios(scenario, speed):
    ego = Ego(scenario.ego.s, scenario.ego.d, speed=speed, bounds=MotionBounds())
    start = Scenario("r", scenario.road, ego, scenario.obstacles, horizon_s=2.0, step_s=0.5)
    try:
        found = find_maneuvers(start, PAPER)
    except RulecError:
        assume(False)
    least = found.least_braking or 0.0
    for maneuver in found.cheapest(1):
        check_driven(found.graph, maneuver)
        braked = maneuver.trajectory.greatest_braking
        assert least <= braked + 1e-3
        later = max(braked, braking_after(found.graph, maneuver.trajectory.states[-1]))
        assert (found.least_braking_later or 0.0) <= later + 1e-3


def braking_after(graph, end):
    """What is needed (m/s²) to become as slow as everything that is then ahead in ego's way."""
    time, s, v, d, _ = end
    ego, bounds, most = graph.scenario.ego, graph.bounds, 0.0
    length, width = ego.length or bounds.length, ego.width or bounds.width
    for obstacle in graph.scenario.obstacles:
        before, box = swept(obstacle, time - 0.01, time - 0.01), swept(obstacle, time, time)
        if box is None or before is None:
            continue
        u = max((box.s_min - before.s_min) / 0.01, 0.0)
        beside = d + width / 2 <= box.d_min or d - width / 2 >= box.d_max
        if not beside and s < box.s_max and v > u:
            gap = box.s_min - s - length / 2
            most = max(most, (v - u) ** 2 / 2 / gap if gap > 0 else inf)
    return most


FILES = sorted(RECORDINGS.glob("*.xml"))


@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize(
    "file",
    [*FILES[:2], *(pytest.param(file, marks=pytest.mark.long) for file in FILES[2:])] or [""],
    ids=lambda file: getattr(file, "stem", ""),
)
def test_recorded_scenes(file):
    found = find_maneuvers(load_scenario(file), PAPER)
    for maneuver in found.cheapest(3):
        check_driven(found.graph, maneuver)
        assert maneuver.trajectory.greatest_braking <= found.graph.bounds.braking + 1e-6


def car(name, s, speed, d=0.0):
    return Obstacle(name, "vehicle", 4.0, 1.8, ConstantAcceleration(s, d, speed))


def test_who_goes_on_at_its_speed_costs_nothing():
    found = find_maneuvers(Scenario("e", ROAD, MOVING, step_s=0.5), PAPER)
    (first,) = found.cheapest(1)
    assert first.cost == pytest.approx(0.0, abs=1e-6)
    assert first.trajectory.states[-1][:3] == pytest.approx((4.0, 40.0, 10.0), abs=1e-4)


@pytest.mark.parametrize(
    ("goal", "end"),
    [
        # At 10 m/s it is at 40 m after 4 s
        (Box(45.0, 60.0, -1.75, 5.25), (45.0, 0.0)),
        (Box(20.0, 35.0, -1.75, 5.25), (35.0, 0.0)),
        (Box(0.0, 100.0, 2.0, 5.25), (40.0, 3.5)),
    ],
)
def test_a_trajectory_ends_in_the_goal(goal, end):
    """Behind one that passes on the left, so that ego's cells have several rectangles."""
    road = Road((-20.0, 200.0), (-1.75, 1.75, 5.25))
    ego = Ego(0.0, 0.0, length=4.5, width=1.8, speed=10.0, bounds=MotionBounds())
    scene = Scenario("g", road, ego, (car("c", 60.0, 10.0, 3.5),), goal=goal, step_s=0.5)
    found = find_maneuvers(scene, PAPER)
    (first,) = found.cheapest(1)
    _, s, _, d, _ = first.trajectory.states[-1]
    assert (s, d) == pytest.approx(end, abs=0.8)
    assert goal.s_min - 1e-3 <= s <= goal.s_max + 1e-3
    assert goal.d_min - 1e-3 <= d <= goal.d_max + 1e-3
    check_driven(found.graph, first)


def test_who_cannot_quite_reach_its_lanes_middle_is_not_drawn_to_another_lane():
    """One beside ego reaches to 0.1 m from it: its lane's middle, at 3.5 m, is not free."""
    road = Road((-20.0, 200.0), (-1.75, 1.75, 5.25))
    ego = Ego(0.0, 3.2, length=4.5, width=1.8, speed=10.0, bounds=MotionBounds())
    beside = Obstacle("b", "vehicle", 4.5, 1.8, ConstantAcceleration(0.0, 5.1, 10.0))
    scene = Scenario("s", road, ego, (beside,), step_s=0.5)
    (first,) = find_maneuvers(scene, PAPER, extent="body").cheapest(1)
    assert [state[3] for state in first.trajectory.states] == pytest.approx([3.2] * 41, abs=0.1)


def test_it_brakes_behind_one_that_stands():
    # 20 m from ego's nose to its rear on a single lane: 10 m/s are gone with 2.5 m/s².
    road = Road((-50.0, 500.0), (-2.0, 2.0))
    scene = Scenario("b", road, MOVING, (car("c", 24.0, 0.0),), step_s=0.5)
    found = find_maneuvers(scene, PAPER)
    (first,) = found.cheapest(1)
    assert 2.4 <= first.trajectory.greatest_braking <= 4.0
    assert first.trajectory.states[-1][1] <= 24.0 - 4.0
    check_driven(found.graph, first)


def test_nothing_is_listed_that_nobody_can_drive():
    # 1 m to the rear of one that stands, at 10 m/s: the point-like cells have a way, no car has.
    road = Road((-50.0, 500.0), (-2.0, 2.0))
    scene = Scenario("n", road, MOVING, (car("c", 5.5, 0.0),), step_s=0.5)
    found = find_maneuvers(scene, PAPER, bounds="none")
    assert found.cheapest(1)
    assert find_maneuvers(scene, PAPER).cheapest(1) == []


def test_costs_come_nearer_than_the_least_that_was_known():
    scene = Scenario("l", ROAD, MOVING, (car("c", 30.0, 4.0),), step_s=0.5)
    found = find_maneuvers(scene, PAPER)
    listed = found.cheapest(5)
    assert [one.cost for one in listed] == sorted(one.cost for one in listed)
    unit, weights = found.paths.cost_unit, found.paths.weights
    for one in listed:
        least = 0
        for p, (i, j) in enumerate(pairwise(one.nodes)):
            least += weights[p][i][found.paths.successors[p][i].index(j)]
        assert float(least * unit) <= one.cost + 1e-9
        assert one.cost == pytest.approx(one.changes + one.trajectory.cost.total)


@pytest.mark.parametrize("side", [-1, 1])
def test_it_stays_on_the_road_between_layers(side):
    """Ego drifts to the edge, 0.25 m away: by 1.3 m/s² it would be back on the road after 1 s.

    It has to be slower by 0.9 m/s within 0.25 m: with 0.9² / 2 / 0.25 = 1.62 m/s² at least.
    """
    road = Road((-20.0, 200.0), (-1.75, 1.75))
    ego = Ego(0.0, 1.5 * side, 4.5, 1.8, 10.0, lateral_speed=0.9 * side, bounds=MotionBounds())
    found = find_maneuvers(Scenario("e", road, ego, horizon_s=2.0, step_s=1.0), PAPER)
    (first,) = found.cheapest(1)
    places = [abs(at(first.trajectory.states, 0.05 * k)[1]) for k in range(41)]
    assert max(places) <= 1.75 + 1e-5
    assert first.trajectory.greatest_acceleration <= 4.0


def test_the_same_cells_hold_it():
    found = find_maneuvers(Scenario("e", ROAD, MOVING, step_s=0.5), PAPER)
    (first,) = found.cheapest(1)
    s, d = at(first.trajectory.states, 2.0)
    assert first.nodes[4] in cells_of(found.graph.layers[4], s, d)


def test_it_ends_so_that_it_can_still_stop_with_ease():
    # After 4 s at 10 m/s its front would be 4 m behind the rear of one that stands, at 46 m
    road = Road((-50.0, 500.0), (-2.0, 2.0))
    found = find_maneuvers(Scenario("o", road, MOVING, (car("c", 48.0, 0.0),), step_s=0.5), PAPER)
    (first,) = found.cheapest(1)
    _, s, speed, _, _ = first.trajectory.states[-1]
    assert speed**2 / 2 / 4.0 <= 44.0 - s + 0.1
    assert first.trajectory.greatest_braking < 2.0
    check_driven(found.graph, first)


def test_an_emergency_is_called_one():
    # Ego's front stops at the rear of one that stands, 12 m ahead, with 12² / 2 / 12 = 6 m/s²
    road = Road((-50.0, 500.0), (-1.7, 1.7))
    ego = Ego(0.0, 0.0, 4.0, 1.8, speed=12.0, bounds=MotionBounds())
    found = find_maneuvers(Scenario("h", road, ego, (car("c", 16.0, 0.0),), step_s=0.5), PAPER)
    assert 5.98 <= found.least_braking <= 6.0
    (first,) = found.cheapest(1)
    # With 2 m of it before its middle: 12² / 2 / 12
    assert first.trajectory.greatest_braking >= 6.0
    eased = find_maneuvers(Scenario("e", road, ego, (car("c", 40.0, 0.0),), step_s=0.5), PAPER)
    assert eased.least_braking is None


def test_who_has_to_go_on_braking_hard_brakes_evenly():
    """At 30 m/s, 60 m behind one at 10 m/s: 20² / 2 / 60 = 3.33 m/s², at 45 m 4.44.

    After 2 s they are not level yet, so that ego could leave what is hard to later.
    """
    road, ego = Road((-50.0, 500.0), (-1.7, 1.7)), Ego(0.0, 0.0, 4.0, 1.8, speed=30.0)
    for gap, least in ((60.0, None), (45.0, 20**2 / 2 / 45)):
        scene = Scenario("h", road, ego, (car("c", 4.0 + gap, 10.0),), step_s=0.5, horizon_s=2.0)
        found = find_maneuvers(scene, PAPER, bounds="car")
        (first,) = found.cheapest(1)
        braked = first.trajectory.greatest_braking
        after = braking_after(found.graph, first.trajectory.states[-1])
        assert found.least_braking is None
        if least is None:
            assert found.least_braking_later is None
            assert max(braked, after) <= 4.01
        else:
            assert least - 0.15 < found.least_braking_later <= least
            assert least - 0.01 <= max(braked, after) <= least + 0.2
        check_driven(found.graph, first)


def test_who_swerves_first_brakes_less():
    """One comes over from the left, with its rear 2 m before ego's middle and 4 m/s slower.

    For a moment ego's front is beside it: ego has to keep right until then, and be behind it after.
    A motion made by hand, sideways by 2 m/s² for some time and back, brakes by 8.5 m/s².
    """
    motion = ConstantAcceleration(4.6, 4.0, 10.9, lateral_speed=-3.0, until_d=0.0)
    comes = Obstacle("c", "vehicle", 5.0, 2.2, motion)
    road = Road((-80.0, 200.0), (-1.75, 1.75, 5.25))
    ego = Ego(0.0, 0.0, 4.5, 1.6, speed=15.0, bounds=MotionBounds())
    scene = Scenario("z", road, ego, (comes,), step_s=0.5)
    found = find_maneuvers(scene, PAPER, extent="clearance")
    (first,) = found.cheapest(1)
    assert first.trajectory.greatest_braking < 8.6
    check_driven(found.graph, first)


def test_who_moves_out_just_in_time_need_not_brake_hard():
    # Ego moves to the right anyway: until it is beside the one that stands, it has to stay behind
    road = Road((-80.0, 120.0), (-5.25, -1.75, 1.75, 5.25))
    ego = Ego(0.0, 0.0, 5.2, 1.6, speed=14.59, lateral_speed=-1.32, bounds=MotionBounds())
    stands = Obstacle("o", "vehicle", 1.8, 1.8, ConstantAcceleration(14.0, 0.0, 0.0, 0.0))
    scene = Scenario("m", road, ego, (stands,), horizon_s=2.0, step_s=0.5)
    found = find_maneuvers(scene, PAPER, extent="clearance")
    (first,) = found.cheapest(1)
    check_driven(found.graph, first)
    # A search with other means, at every 0.05 s, finds 3.8 m/s² and a cost of 2.8
    assert first.trajectory.greatest_braking < 4.0
    assert first.cost < 3.0


def test_who_is_behind_another_may_have_its_front_beside_it():
    # On a road this wide ego's middle may be 1.9 m beside the other's, and stop 2 m later for it
    road = Road((-50.0, 500.0), (-2.0, 2.0))
    ego = Ego(0.0, 0.0, 4.0, 1.8, speed=12.0, bounds=MotionBounds())
    found = find_maneuvers(Scenario("h", road, ego, (car("c", 16.0, 0.0),), step_s=0.5), PAPER)
    assert 12**2 / 2 / 14 - 0.02 <= found.least_braking <= 12**2 / 2 / 14


def test_one_that_has_braked_hard_goes_on_behind_who_cut_in():
    # It comes from the left lane, 3 m before ego's front and 5 m/s slower
    motion = ConstantAcceleration(7.0, 4.0, 10.0, lateral_speed=-3.0, until_d=0.0)
    cuts = Obstacle("c", "vehicle", 4.0, 1.8, motion)
    ego = Ego(0.0, 0.0, 4.0, 1.8, speed=15.0, bounds=MotionBounds())
    found = find_maneuvers(Scenario("z", ROAD, ego, (cuts,), step_s=0.25), PAPER)
    (first,) = found.cheapest(1)
    assert min(state[2] for state in first.trajectory.states) > 3.0
    check_driven(found.graph, first)
