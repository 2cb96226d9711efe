"""The graph as it is handed out: paths, states, costs, networkx."""

from fractions import Fraction
from math import lcm

import networkx
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.partition import navigation_graph
from rulec.partition.cells.occupancy import scene as scene_over_time
from rulec.scenario import (
    Box,
    ConstantAcceleration,
    Ego,
    Obstacle,
    Road,
    Scenario,
    Trajectory,
    load_scenario,
)
from rulec.scenario.time_grid import timing
from support.generators.random_scenarios import scenarios

partitions = st.sampled_from(["paper", "fine"])


def all_paths(graph):
    paths = [(graph.start,)]
    for rows in graph.successors:
        paths = [(*path, j) for path in paths for j in rows[path[-1]]]
    return [path for path in paths if path[-1] in graph.goals]


def paths_to_goals(graph):
    ways = [int(i in graph.goals) for i in range(len(graph.layers[-1].cells))]
    for rows in reversed(graph.successors):
        ways = [sum(ways[j] for j in followers) for followers in rows]
    return ways[graph.start]


@given(scenarios(most=2), partitions)
def test_counting_paths_equals_listing_them(scenario, partition):
    try:
        graph = navigation_graph(scenario, partition=partition, step_s=1.0)
    except RulecError as error:
        assume([d.code for d in error.diagnostics] != ["R0607"])
        raise
    assert paths_to_goals(graph) == len(all_paths(graph))


@given(scenarios(), partitions)
def test_networkx_has_the_same_graph(scenario, partition):
    try:
        graph = navigation_graph(scenario, partition=partition)
    except RulecError as error:
        assume([d.code for d in error.diagnostics] != ["R0607"])
        raise
    traces = graph.trace_graph()
    handed = graph.to_networkx()
    assert isinstance(handed, networkx.DiGraph)
    assert handed.number_of_nodes() == graph.nodes
    assert handed.number_of_edges() == graph.edges
    for (p, i), data in handed.nodes(data=True):
        assert data["cell"] is graph.layers[p].cells[i]
        assert data["state"] == traces.states[p][i]
        assert data["start"] == ((p, i) == (0, graph.start))
    goals = {i for (p, i), data in handed.nodes(data=True) if data["goal"]}
    assert goals == set(graph.goals)
    for (p, i), (q, j), data in handed.edges(data=True):
        assert q == p + 1
        at = graph.successors[p][i].index(j)
        margin = graph.margins[p][i][at]
        if margin is None:
            assert (data["margin_s"], data["cost"], data["weight"]) == (None, 0, 0)
        else:
            assert data["margin_s"] == pytest.approx(margin * graph.step_s)
            assert data["cost"] == pytest.approx(1 / data["margin_s"])


def test_costs_are_whole_multiples_of_the_unit():
    graph = navigation_graph(load_scenario("s1"), step_s=0.5)
    traces = graph.trace_graph()
    assert traces.cost_unit == Fraction(1) / (lcm(1, 2, 3, 4, 5, 6, 7, 8, 9) * Fraction(1, 2))
    for p, rows in enumerate(traces.margins):
        for i, margins in enumerate(rows):
            for margin, weight in zip(margins, traces.weights[p][i], strict=True):
                cost = 0 if margin is None else Fraction(2, margin)
                assert weight * traces.cost_unit == cost


def test_states_of_the_paper_partition():
    traces = navigation_graph(load_scenario("s2")).trace_graph()
    assert traces.objects == {"o1": "vehicle"}
    assert traces.present == {}
    start = traces.states[0][traces.start]
    assert start == {"position": {"o1": "b"}, "surface": "R_cw"}
    assert {state["surface"] for state in traces.states[0]} == {"R_cw", "R_pc"}


def test_states_of_the_fine_partition():
    """S2, layer 0: before, beside, and in front of o1, three pieces of road, less o1 itself.

    Left lane: behind, beside, in front (before, on, after the crossing): 5. Right: the same less
    beside: 4.
    """
    traces = navigation_graph(load_scenario("s2"), partition="fine").trace_graph()
    assert traces.states[0][traces.start] == {
        "station": {"o1": "behind"},
        "lateral": {"o1": "same_lane"},
        "surface": "carriageway",
    }
    assert len(traces.states[0]) == 9
    seen = {(s["station"]["o1"], s["lateral"]["o1"]) for s in traces.states[0]}
    assert len(seen) == 5
    assert ("beside", "left_of") in seen
    assert {state["surface"] for state in traces.states[0]} == {"carriageway", "crossing"}


ROAD = Road((0.0, 100.0), (0.0, 3.0, 6.0))


def scene(*obstacles, **more):
    return Scenario("x", ROAD, Ego(5.0, 1.5), obstacles, **more)


def test_an_object_that_leaves_is_present_up_to_then():
    """Its rear, at 92 + 5 t, is off the road from t = 1.6 s on: layers 0 and 1 of five."""
    leaving = Obstacle(
        "o", "vehicle", 4.0, 1.8, ConstantAcceleration(94.0, 1.5, 5.0), None, {"braking": True}
    )
    traces = navigation_graph(scene(leaving)).trace_graph()
    assert traces.present == {"o": (0, 1)}
    assert [set(states[0]["position"]) for states in traces.states] == [
        {"o"},
        {"o"},
        set(),
        set(),
        set(),
    ]
    assert traces.states[1][0]["braking"] == {"o": True}
    assert "braking" not in traces.states[2][0]


def test_an_object_that_comes_back_is_another_one():
    there_and_back = Trajectory(
        ((0.0, 50.0, 1.5), (1.0, 50.0, -5.0), (3.5, 50.0, -5.0), (4.0, 50.0, 1.5))
    )
    walker = Obstacle("p", "pedestrian", 0.5, 0.5, there_and_back, 90.0)
    other = Obstacle("p_2", "vehicle", 4.0, 1.8, ConstantAcceleration(80.0, 4.5))
    graph = navigation_graph(scene(walker, other), step_s=1.0)
    assert graph.present == {"p": (0, 0), "p_2": (0, 4), "p_3": (3, 4)}
    assert graph.trace_graph().objects == {"p": "pedestrian", "p_2": "vehicle", "p_3": "pedestrian"}


def test_being_away_for_one_layer_is_enough():
    """Below d = 0 by more than its half width from 0.36 s to 2.63 s: all of layer 1."""
    dip = Trajectory(((0.0, 50.0, 1.5), (1.0, 50.0, -5.0), (2.0, 50.0, -5.0), (3.0, 50.0, 1.5)))
    walker = Obstacle("p", "pedestrian", 0.5, 0.5, dip, 90.0)
    graph = navigation_graph(scene(walker), step_s=1.0)
    assert graph.present == {"p": (0, 0), "p_2": (2, 3)}


def test_a_pedestrian_that_turns_looks_where_it_goes_next():
    """Along the right lane for a second, then to the left: at 1 s it is as wide as itself."""
    walk = Trajectory(((0.0, 50.0, 1.5), (1.0, 51.0, 1.5), (3.0, 51.0, 4.5)))
    walker = Obstacle("p", "pedestrian", 0.5, 0.5, walk)
    places = scene_over_time(scene(walker), timing(2.0, 1.0), "paper")
    assert [region.extent for region in places.instants[0]] == [Box(50.75, 51.25, 1.25, 1.75)]
    assert places.swept[0][0].extent == Box(49.75, 51.25, 0.0, 3.0)
    assert places.swept[1][0].extent == Box(50.75, 51.25, 1.25, 3.25)


def test_an_object_that_never_comes_is_left_out():
    far = Obstacle("far", "vehicle", 4.0, 1.8, ConstantAcceleration(500.0, 1.5))
    graph = navigation_graph(scene(far))
    assert graph.objects == {}
    assert [len(layer.cells) for layer in graph.layers] == [1] * 5


def test_goals_are_the_cells_that_meet_the_goal_region():
    """The left lane alone: a standing car in the right lane makes behind, in front and left."""
    car = Obstacle("o", "vehicle", 4.0, 1.8, ConstantAcceleration(50.0, 1.5))
    everywhere = navigation_graph(scene(car))
    left_only = navigation_graph(scene(car, goal=Box(0.0, 100.0, 3.0, 6.0)))
    assert len(everywhere.goals) == 3
    letters = [left_only.layers[-1].cells[i].signature["o"] for i in left_only.goals]
    assert letters == ["l"]


def test_a_pedestrian_on_a_crossing_in_its_own_frame():
    """It walks to the left: ahead of it is more d, to its left the way that ego comes from."""
    road = Road((0.0, 100.0), (0.0, 3.0, 6.0), load_scenario("s2").road.surfaces)  # 50 to 54
    walker = Obstacle("p", "pedestrian", 0.5, 0.5, ConstantAcceleration(51.0, 3.0, 0, 0, 1.0))
    graph = navigation_graph(Scenario("x", road, Ego(5.0, 1.5), (walker,), horizon_s=1.0))
    where = {cell.signature["p"]: (cell.surface, cell.bounds) for cell in graph.layers[0].cells}
    # in the first second its body sweeps d from 2.75 to 4.25
    assert where == {
        "l": ("carriageway", Box(0.0, 50.0, 0.0, 6.0)),
        "r": ("carriageway", Box(54.0, 100.0, 0.0, 6.0)),
        "b": ("crossing", Box(50.0, 54.0, 0.0, 2.75)),
        "f": ("crossing", Box(50.0, 54.0, 4.25, 6.0)),
    }


def test_rounding_makes_no_slivers():
    """A car that ends where another begins is one wall, although floating point leaves a gap."""
    first, second = 14.1, 16.1
    assert first + 1 < second - 1
    cars = [
        Obstacle(name, "vehicle", 2.0, 1.0, ConstantAcceleration(s, 1.5))
        for name, s in (("a", first), ("b", second))
    ]
    graph = navigation_graph(scene(*cars))
    assert {tuple(c.signature.values()) for c in graph.layers[0].cells} == {
        ("b", "b"),
        ("f", "f"),
        ("l", "l"),
    }


def test_a_narrow_gap_is_not_lost():
    first = Obstacle("a", "vehicle", 2.0, 1.0, ConstantAcceleration(20.0, 1.5))
    second = Obstacle("b", "vehicle", 2.0, 1.0, ConstantAcceleration(22.0001, 1.5))
    graph = navigation_graph(scene(first, second))
    gap = [c for c in graph.layers[0].cells if tuple(c.signature.values()) == ("f", "b")]
    assert [round(c.bounds.s_max - c.bounds.s_min, 6) for c in gap] == [0.0001]
