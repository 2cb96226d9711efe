"""Time margins: for how long a change of cell stays open."""

from fractions import Fraction

import pytest
from hypothesis import assume, given

from rulec.diagnostics import RulecError
from rulec.partition import Layer, navigation_graph
from rulec.partition.graph_edges import edges
from rulec.scenario import ConstantAcceleration, Ego, Obstacle, Road, Scenario, load_scenario
from support.generators.random_scenarios import scenarios


def names(layer):
    """Cells by signature, surface and place: the same at another layer if nobody changes lane."""
    return {
        (tuple(cell.signature.items()), cell.surface, rank): i
        for i, cell in enumerate(layer.cells)
        for rank in [sum(1 for other in layer.cells[:i] if other.code == cell.code)]
    }


def margins_by_run_count(graph):
    """The margin of every change, counted over whole rows of layers. None if signatures change."""
    tables = [names(layer) for layer in graph.layers]
    if any(table.keys() != tables[0].keys() for table in tables):
        return None
    expected = {}
    for a in tables[0]:
        for b in tables[0]:
            open_at = [
                table[b] in layer.neighbours[table[a]]
                for table, layer in zip(tables, graph.layers, strict=True)
            ]
            for p in range(len(tables) - 1):
                if open_at[p] and open_at[p + 1]:
                    first = p
                    while first > 0 and open_at[first - 1]:
                        first -= 1
                    last = p + 1
                    while last + 1 < len(tables) and open_at[last + 1]:
                        last += 1
                    expected[p, tables[p][a], tables[p + 1][b]] = last - first + 1
    return expected


def changes(graph):
    return {
        (p, i, j): margin
        for p, rows in enumerate(graph.successors)
        for i, followers in enumerate(rows)
        for j, margin in zip(followers, graph.margins[p][i], strict=True)
        if margin is not None
    }


@pytest.mark.parametrize("name", ["s1", "s2", "s3"])
@pytest.mark.parametrize("adjacency", ["touch", "edge", "forward"])
def test_with_fixed_signatures_a_margin_is_the_longest_run(name, adjacency):
    for step in (1.0, 0.5, 0.25):
        graph = navigation_graph(load_scenario(name), step_s=step, adjacency=adjacency)
        expected = margins_by_run_count(graph)
        assert expected
        assert changes(graph) == expected


@given(scenarios(most=3))
def test_margins_of_random_scenarios_without_a_lane_change(scenario):
    obstacles = tuple(
        Obstacle(
            o.id,
            "vehicle",
            o.length,
            o.width,
            ConstantAcceleration(o.motion.s, o.motion.d, o.motion.speed, o.motion.acceleration),
        )
        for o in scenario.obstacles
        if isinstance(o.motion, ConstantAcceleration)
    )
    # on a road of one piece a signature names one cell, as long as it exists
    road = Road(scenario.road.s, scenario.road.lanes)
    still = Scenario("x", road, scenario.ego, obstacles, horizon_s=2.0, step_s=0.5)
    try:
        graph = navigation_graph(still)
    except RulecError as error:
        assume([d.code for d in error.diagnostics] != ["R0607"])
        raise
    expected = margins_by_run_count(graph)
    assume(expected is not None)
    assert changes(graph) == expected


def test_s1_at_half_a_second_by_hand():
    """The gap between o1 and o2 is open in layers 0 to 3: four layers, 2 s, 0.5 per second."""
    graph = navigation_graph(load_scenario("s1"), step_s=0.5)
    traces = graph.trace_graph()
    letters = [["".join(c.signature.values()) for c in layer.cells] for layer in graph.layers]
    seen = 0
    for (p, i, j), margin in changes(graph).items():
        if {letters[p][i], letters[p + 1][j]} == {"fl", "rb"}:
            seen += 1
            assert p < 3
            assert margin == 4
            at = graph.successors[p][i].index(j)
            assert traces.weights[p][i][at] * traces.cost_unit == Fraction(1, 2)
        else:
            assert margin == 9  # the others stay open for all nine layers
    assert seen == 6  # three pairs of layers, both ways


def test_a_gap_follows_an_obstacle_that_changes_lane():
    """Ego beside a car that moves over: letters change, the way past it stays open throughout.

    Lanes 0..3 and 3..6, the car at d = 1.5, moving 1 m/s to the left. It touches the left lane from
    the first layer on (its left side is at 2.4 + 1) and leaves the right one at d - 0.9 = 3, after
    2.4 s: in layer 3 it sweeps the left lane only. Behind it is open in all four layers.
    """
    car = Obstacle("o", "vehicle", 4.0, 1.8, ConstantAcceleration(30.0, 1.5, 0.0, 0.0, 1.0))
    road = Road((0.0, 60.0), (0.0, 3.0, 6.0))
    graph = navigation_graph(Scenario("x", road, Ego(5.0, 1.0), (car,), horizon_s=3.0))
    letters = [sorted(c.signature["o"] for c in layer.cells) for layer in graph.layers]
    assert letters == [["b", "f"], ["b", "f"], ["b", "f"], ["b", "f", "r"]]
    behind = graph.start
    for p in range(3):
        follower = [
            j
            for j, margin in zip(graph.successors[p][behind], graph.margins[p][behind], strict=True)
            if graph.layers[p + 1].cells[j].signature["o"] == "b" and margin is None
        ]
        assert len(follower) == 1
        behind = follower[0]


def layer(*neighbours):
    """A layer of which only the adjacency matters here."""
    return Layer(0.0, (), (None,) * len(neighbours), neighbours)


@pytest.mark.parametrize("older", [1, 2])
def test_where_two_neighbours_become_one_the_longer_run_counts(older):
    """Cells a, b, c: a has been next to one of b and c for longer; then both become one."""
    first = layer(*[(older,) if i == 0 else (0,) if i == older else () for i in range(3)])
    second = layer((1, 2), (0,), (0,))
    third = layer((1,), (0,))
    stay = ({0}, {1}, {2})
    merge = ({0}, {1}, {1})
    successors, margins = edges([first, second, third], [stay, merge])
    assert successors[1][0] == (0, 1)
    # Open in the first, the second and the third layer, on the side of the older neighbour.
    assert margins[1][0] == (None, 3)


@pytest.mark.parametrize("longer", [1, 2])
def test_where_one_neighbour_becomes_two_the_longer_run_counts(longer):
    """Time turned round: a and b; b splits in two, of which a stays next to one."""
    first = layer((1,), (0,))
    second = layer((1, 2), (0,), (0,))
    third = layer(*[(longer,) if i == 0 else (0,) if i == longer else () for i in range(3)])
    successors, margins = edges([first, second, third], [({0}, {1, 2}), ({0}, {1}, {2})])
    assert successors[0][0] == (0, 1, 2)
    assert margins[0][0][longer] == 3
    assert margins[0][0][3 - longer] == 2
