"""Where ego starts, and what is said if it cannot."""

import pytest

from rulec.diagnostics import RulecError
from rulec.partition import navigation_graph
from rulec.scenario import ConstantAcceleration, Ego, Obstacle, Road, Scenario, load_scenario
from rulec.scenario.scenario_model import MissingLane

ROAD = Road((0.0, 100.0), (0.0, 3.0, 6.0))


def car(name, s, d, speed=0.0):
    return Obstacle(name, "vehicle", 4.0, 1.8, ConstantAcceleration(s, d, speed))


def complaint(scenario, **options):
    with pytest.raises(RulecError) as caught:
        navigation_graph(scenario, **options)
    (diagnostic,) = caught.value.diagnostics
    return diagnostic


def test_an_obstacle_that_sweeps_the_place_is_named_and_a_step_is_found():
    """Its front, at 5 + 12 t, comes to ego's place at 20 after 1.25 s: 1 s is free, 2 s is not."""
    scenario = Scenario("x", ROAD, Ego(20.0, 1.5), (car("fast", 3.0, 1.5, 12.0),))
    problem = complaint(scenario, step_s=2.0)
    assert problem.code == "R0607"
    assert "`fast` sweeps ego's place (s = 20, d = 1.5) between 0 s and 2 s" in problem.message
    assert problem.help == "a step of 1 s would do"
    assert navigation_graph(scenario, step_s=1.0).nodes > 0


def test_ego_s_place_is_said_to_the_centimetre():
    """Where ego was recorded is the result of sums, and 1e-05 m from the middle of its lane."""
    scenario = Scenario("x", ROAD, Ego(20.0, 1.50001), (car("fast", 3.0, 1.5, 12.0),))
    assert "(s = 20, d = 1.5)" in complaint(scenario, step_s=2.0).message


def test_two_obstacles_are_both_named():
    both = (car("a", 3.0, 1.5, 12.0), car("b", 37.0, 1.5, -12.0))
    problem = complaint(Scenario("x", ROAD, Ego(20.0, 1.5), both), step_s=2.0)
    assert "`a` and `b` sweep ego's place" in problem.message


def test_no_step_helps_beside_a_narrow_obstacle_in_the_same_lane():
    scenario = Scenario("x", ROAD, Ego(20.0, 0.3), (car("o", 20.0, 2.0),))
    problem = complaint(scenario)
    assert problem.code == "R0607"
    assert "a smaller step does not help" in problem.help


def test_a_place_without_a_lane():
    road = Road((0.0, 100.0), (0.0, 3.0, 6.0), (), (MissingLane(1, (10.0, 30.0)),))
    problem = complaint(Scenario("x", road, Ego(20.0, 1.5)))
    assert problem.code == "R0607"
    assert "off the road" in problem.message


def test_on_a_border_ego_starts_in_the_free_cell_to_the_left_and_ahead():
    """At (50, 3): the car's front left corner, where in front of it and left of it meet."""
    graph = navigation_graph(Scenario("x", ROAD, Ego(50.0, 3.0), (car("o", 48.0, 1.5),)))
    assert graph.layers[0].cells[graph.start].signature == {"o": "l"}
    graph = navigation_graph(Scenario("x", ROAD, Ego(50.0, 3.0), (car("o", 48.0, 4.5),)))
    assert graph.layers[0].cells[graph.start].signature == {"o": "f"}


@pytest.mark.parametrize(
    ("options", "expected", "help_text"),
    [
        ({"partition": "papier"}, "expected one of `paper`, `fine`", "did you mean `paper`?"),
        ({"adjacency": "corner"}, "expected one of `touch`, `edge`, `forward`", ""),
        (
            {"adjacency": "Edge"},
            "expected one of `touch`, `edge`, `forward`",
            "did you mean `edge`?",
        ),
        (
            {"extent": "bodies"},
            "expected one of `lane`, `clearance`, `body`",
            "did you mean `body`?",
        ),
    ],
)
def test_an_unknown_choice(options, expected, help_text):
    problem = complaint(load_scenario("s1"), **options)
    assert (problem.code, problem.expected, problem.help) == ("R0608", expected, help_text)


def test_a_step_that_does_not_divide_the_horizon():
    problem = complaint(load_scenario("s1"), step_s=0.3)
    assert problem.code == "R0606"
    assert "4 s is not a whole number of steps of 0.3 s" in problem.message
