"""What the first maneuver costs: nothing that is looked at is cheaper, and ego goes on again."""

from itertools import islice

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rulec import RulecError, compile_rulebook, find_maneuvers, parse_rulebook
from rulec.planning.ranking import proven
from rulec.planning.ranking.cheapest import cheapest
from rulec.planning.ranking.proven import ALIKE, GuidedSearch, with_trajectory
from rulec.scenario import (
    ConstantAcceleration,
    Ego,
    MotionBounds,
    Obstacle,
    Road,
    Scenario,
    Trajectory,
)

PAPER = compile_rulebook("esterle2019")


def car(name, s, speed, d=0.0):
    return Obstacle(name, "vehicle", 4.0, 1.8, ConstantAcceleration(s, d, speed))


@st.composite
def scenes(draw):
    """Ego at 10 m/s on one of two lanes, and up to three others."""
    others = [
        car(
            f"c{k}", draw(st.floats(-30, 50)), draw(st.floats(0, 15)), draw(st.sampled_from([0, 4]))
        )
        for k in range(draw(st.integers(0, 3)))
    ]
    return scene(*others)


def scene(*others):
    ego = Ego(0.0, 0.0, 4.0, 1.8, speed=10.0, bounds=MotionBounds())
    road = Road((-50.0, 500.0), (-2.0, 2.0, 6.0))
    return Scenario("h", road, ego, others, step_s=1.0, horizon_s=3.0)


def found_in(scene):
    """The maneuvers of a scene; None where ego has no place to start from."""
    try:
        return find_maneuvers(scene, PAPER)
    except RulecError:
        return None


@given(scenes())
@example(scene(car("c0", 0.0, 7.0, d=4)))  # ego's middle is behind it, at the mark between lanes
@settings(max_examples=20)
def test_no_path_is_cheaper_than_it_promises(scene):
    found = found_in(scene)
    if found is None:
        return
    search, graph = found.witness_search, found.graph
    ways = islice(GuidedSearch(found.product, graph, search.bounds).guided(10_000), 400)
    promises = {way.maneuver.nodes: way.promises for way in ways}
    for one in islice(cheapest(found.product), 400):
        driven = with_trajectory(one, graph, search)
        if driven is not None:
            assert driven.cost >= promises[one.nodes] - 1e-6


@given(scenes())
@settings(max_examples=20)
def test_the_first_one_is_the_cheapest(scene):
    found = found_in(scene)
    if found is None:
        return
    every = [
        with_trajectory(one, found.graph, found.witness_search) for one in cheapest(found.product)
    ]
    costs = [one.cost for one in every if one is not None]
    first = found.cheapest(1)
    assert bool(first) == bool(costs)
    assert not first or first[0].cost <= min(costs) + ALIKE


@given(scenes())
@settings(max_examples=20)
def test_a_beam_as_wide_as_the_graph_loses_nothing(scene):
    found = found_in(scene)
    if found is None:
        return
    every, bounds = found.product, found.witness_search.bounds
    ways = GuidedSearch(every, found.graph, bounds)
    guided = {way.maneuver.nodes for way in ways.guided(10_000)}
    beam = list(ways.beam(10_000))
    assert {way.maneuver.nodes for way in beam} == guided
    assert [way.promises for way in beam] == sorted(way.promises for way in beam)


@given(scenes())
@settings(max_examples=20)
def test_where_beginnings_are_too_many_a_way_is_found_all_the_same(scene):
    found = found_in(scene)
    if found is None:
        return
    (best,) = found.cheapest(1) or (None,)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(proven, "MOST_BOUNDS", 1)
        patch.setattr(proven, "MORE_BOUNDS", 0)
        patch.setattr(proven, "cheapest", lambda product: iter(()))
        (other,) = proven.proven(found.product, 1, found.graph, found.witness_search) or (None,)
    assert (other is None) == (best is None)
    assert best is None or other.cost >= best.cost - ALIKE


def test_who_waited_goes_on():
    # Somebody crosses ego's lane between 1 and 3 s, about where ego would be at 2.5 s
    crossing = Obstacle("x", "vehicle", 2.0, 2.0, Trajectory(((0, 25, 6), (4, 25, -6))))
    ego = Ego(0.0, 0.0, 4.0, 1.8, speed=10.0, bounds=MotionBounds())
    road = Road((-50.0, 500.0), (-2.0, 2.0))
    found = find_maneuvers(Scenario("h", road, ego, (crossing,), step_s=0.5), PAPER)
    (first,) = found.cheapest(1)
    states = first.trajectory.states
    # It also moves aside a little, so that less slowing is enough
    assert min(v for _, _, v, _, _ in states) < 9.5
    assert states[-1][2] == pytest.approx(10.0, abs=1.0)


def test_who_stands_in_another_lane_is_passed_at_speed():
    """A queue beside ego's lane, 20 to 40 m ahead, costs nothing to pass: no reason to brake."""
    queue = [car(f"c{k}", 20.0 + 8 * k, 0.0, d=4.0) for k in range(3)]
    book = parse_rulebook("rulebook free signal p default false hard rule r { require true }")
    (first,) = find_maneuvers(scene(*queue), book, partition="fine", step_s=0.5).cheapest(1)
    assert first.changes == 0
    assert {round(v, 2) for _, _, v, _, _ in first.trajectory.states} == {10.0}


def test_fast_vehicles_beside_are_no_reason_to_change_speed():
    """One on either side is faster, and gets past ego or level with it; ego's lane is empty.

    What one sweeps in a step is longer than itself: ego gets across its borders and is beside it
    again when the step ends, which costs nothing.
    """
    others = (car("right", -13.0, 26.1, d=-3.5), car("left", -8.2, 22.7, d=3.5))
    ego = Ego(0.0, 0.0, 4.5, 1.8, speed=20.8, bounds=MotionBounds())
    road = Road((-200.0, 500.0), (-5.25, -1.75, 1.75, 5.25))
    made = Scenario("f", road, ego, others, step_s=0.5)
    book = parse_rulebook("rulebook free signal p default false hard rule r { require true }")
    (first,) = find_maneuvers(made, book, partition="fine", extent="clearance").cheapest(1)
    assert first.cost == pytest.approx(0.0, abs=ALIKE)
    assert first.trajectory.states[-1][1] == pytest.approx(4 * 20.8, abs=0.1)


def test_who_stands_in_egos_lane_is_not_passed_for_nothing():
    book = parse_rulebook("rulebook free signal p default false hard rule r { require true }")
    found = find_maneuvers(scene(car("c", 20.0, 0.0)), book, partition="fine", step_s=0.5)
    passing = [one for one in found.cheapest(5) if one.trajectory.states[-1][1] > 24.0]
    assert passing
    assert all(one.changes > 0 for one in passing)
