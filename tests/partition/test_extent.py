"""A cyclist at the right side of one lane, and what room is left to pass it.

The lane runs from d = -2 to 2. The cyclist takes -1.8 to -1.2, so 3.2 m are free to its left.
"""

from dataclasses import replace

import pytest

from rulec.diagnostics import RulecError
from rulec.partition import navigation_graph
from rulec.planning.product.graph_product import count_paths
from rulec.scenario import Box, ConstantAcceleration, Ego, Obstacle, Road, Scenario, Stretch

CYCLIST = Obstacle("c", "cyclist", 2.0, 0.6, ConstantAcceleration(20.0, -1.5))
ROAD = Road((0.0, 40.0), (-2.0, 2.0))
SCENE = Scenario("lane", ROAD, Ego(5.0, 0.0), (CYCLIST,), goal=Box(30.0, 40.0, -2.0, 2.0))


def of_width(width, d=0.0):
    return replace(SCENE, ego=Ego(5.0, d, 4.0, width))


def beside(scene, letter):
    """The bounds of the cell with this letter; None if there is none."""
    cells = navigation_graph(scene, extent="body").layers[0].cells
    found = [cell.bounds for cell in cells if cell.signature == {"c": letter}]
    assert len(found) <= 1
    return found[0] if found else None


def ways_past(scene, extent):
    return count_paths(navigation_graph(scene, extent=extent).trace_graph())


def test_there_is_no_way_past_within_a_lane_that_is_taken_whole():
    assert ways_past(of_width(1.8), "lane") == 0
    assert ways_past(of_width(1.8), "body") > 0


@pytest.mark.parametrize(
    ("width", "left"),
    [
        (0.0, Box(0.0, 40.0, -1.2, 2.0)),
        (1.8, Box(0.0, 40.0, -0.3, 1.1)),
        (3.0, Box(0.0, 40.0, 0.3, 0.5)),
    ],
)
def test_the_cell_beside_it_is_where_the_centre_of_ego_has_room(width, left):
    found = beside(of_width(width), "l")
    assert (found.s_min, found.s_max) == (left.s_min, left.s_max)
    assert (found.d_min, found.d_max) == pytest.approx((left.d_min, left.d_max))


def test_a_gap_that_is_narrower_than_ego_is_no_cell():
    assert beside(of_width(3.3), "l") is None
    assert ways_past(of_width(3.3), "body") == 0


def test_who_starts_close_to_the_verge_may_stay_as_close():
    assert beside(of_width(1.8, d=1.7), "l").d_max == pytest.approx(1.7)
    assert beside(of_width(1.8, d=-1.9), "l").d_max == pytest.approx(1.1)


def test_who_is_off_the_road_takes_nothing_however_close():
    """Its side is 0.1 m beyond the verge: ego, on the road, cannot touch it."""
    off = replace(CYCLIST, motion=ConstantAcceleration(20.0, -2.4))
    graph = navigation_graph(replace(of_width(1.8), obstacles=(off,)), extent="body")
    assert graph.objects == {}


def test_a_crossing_does_not_widen_a_pedestrian():
    """It takes s = 19.7 to 20.3, and not all of the crossing; what is in front of it is as wide."""
    walker = Obstacle("c", "pedestrian", 0.6, 0.6, ConstantAcceleration(20.0, -1.7), 90)
    road = replace(ROAD, surfaces=(Stretch("crossing", (18.0, 22.0)),))
    scene = replace(of_width(1.8), road=road, obstacles=(walker,))
    cells = navigation_graph(scene, extent="body").layers[0].cells
    (ahead,) = (cell for cell in cells if cell.signature == {"c": "f"})
    assert ahead.surface == "crossing"
    assert (ahead.bounds.s_min, ahead.bounds.s_max) == pytest.approx((19.7, 20.3))
    assert (ahead.bounds.d_min, ahead.bounds.d_max) == pytest.approx((-0.5, 1.1))


@pytest.mark.parametrize("width", [4.0, 4.5])
def test_an_ego_for_which_the_road_has_no_room(width):
    assert navigation_graph(of_width(width)).nodes > 0
    with pytest.raises(RulecError) as caught:
        navigation_graph(of_width(width), extent="body")
    (problem,) = caught.value.diagnostics
    assert problem.code == "R0607"
    assert problem.message == f"ego is {width:g} m wide, and the road is no wider"
