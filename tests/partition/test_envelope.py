"""Envelopes: the bounds of a maneuver's cells."""

import pytest

from rulec.diagnostics import RulecError
from rulec.partition import Envelope, envelope, navigation_graph
from rulec.scenario import (
    ConstantAcceleration,
    Ego,
    MissingLane,
    Obstacle,
    Road,
    Scenario,
    load_scenario,
)


def test_staying_behind_a_standing_car():
    car = Obstacle("o", "vehicle", 4.0, 1.8, ConstantAcceleration(50.0, 1.5))
    graph = navigation_graph(
        Scenario("x", Road((0.0, 100.0), (0.0, 3.0, 6.0)), Ego(5.0, 1.0), (car,))
    )
    bounds = envelope(graph, [graph.start] * 5)
    assert bounds == (Envelope(48.0, 0.0, ((0.0, 3.0),), ((0.0, 0.0),)),) * 5


def test_a_lane_that_ends_narrows_the_profile():
    """Three lanes up to 40, the left one ends; from 60 on the right one is missing too."""
    road = Road(
        (0.0, 100.0),
        (0.0, 3.0, 6.0, 9.0),
        (),
        (MissingLane(3, (40.0, 100.0)), MissingLane(1, (60.0, 100.0))),
    )
    graph = navigation_graph(Scenario("x", road, Ego(5.0, 1.0)))
    assert graph.nodes == 5
    assert envelope(graph, [0])[0] == Envelope(
        100.0, 0.0, ((0.0, 9.0), (40.0, 6.0)), ((0.0, 0.0), (60.0, 3.0))
    )


def test_a_missing_stretch_splits_a_lane_into_two_cells():
    """The only lane is missing from 40 to 60: two cells of the same signature, no way across."""
    road = Road((0.0, 100.0), (0.0, 3.0), (), (MissingLane(1, (40.0, 60.0)),))
    graph = navigation_graph(Scenario("x", road, Ego(5.0, 1.0)))
    assert [cell.bounds.s_max for cell in graph.layers[0].cells] == [40.0, 100.0]
    assert graph.layers[0].neighbours == ((), ())


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ([99], "layer 0 has no cell 99"),
        ([-1], "layer 0 has no cell -1"),
        ([0] * 6, "the path has 6 cells"),
    ],
)
def test_a_path_that_is_none(path, words):
    graph = navigation_graph(load_scenario("s2"))
    with pytest.raises(RulecError) as caught:
        envelope(graph, path)
    (problem,) = caught.value.diagnostics
    assert problem.code == "R0609"
    assert words in problem.message


def test_a_path_that_jumps():
    graph = navigation_graph(load_scenario("s2"))
    stray = next(j for j in range(7) if j not in graph.successors[0][graph.start])
    with pytest.raises(RulecError) as caught:
        envelope(graph, [graph.start, stray])
    (problem,) = caught.value.diagnostics
    assert problem.code == "R0609"
    assert f"no edge leads from cell {graph.start} of layer 0 to cell {stray}" in problem.message
