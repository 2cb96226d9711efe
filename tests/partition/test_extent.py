"""A cyclist at the right side of one lane, and what room is left to pass it.

The lane runs from d = -2 to 2. The cyclist takes -1.8 to -1.2, so 3.2 m are free to its left.
"""

from dataclasses import replace

import pytest

from rulec.diagnostics import RulecError
from rulec.partition import navigation_graph
from rulec.planning.product.graph_product import count_paths
from rulec.scenario import (
    Account,
    Box,
    ConstantAcceleration,
    Ego,
    Obstacle,
    Road,
    Scenario,
    Stretch,
)

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


CAR = Obstacle("c", "car", 4.0, 1.8, ConstantAcceleration(20.0, -2.6))
PARKED = replace(SCENE, obstacles=(CAR,), goal=Box(30.0, 40.0, -2.0, 2.0))
"""Beside the lane, which it reaches 0.3 m into: 3.7 m are free."""


def left_of_it(scene, extent="clearance", **options):
    """Where ego's centre may be beside it, by the bounds of that cell; None if there is none."""
    layers = navigation_graph(scene, partition="fine", extent=extent, **options).layers
    cells = [cell for layer in layers for cell in layer.cells]
    found = [cell for cell in cells if cell.signature == {"c": ("beside", "left_of")}]
    return (found[0].bounds.d_min, found[0].bounds.d_max) if found else None


def of_car(d, **changes):
    car = replace(CAR, motion=ConstantAcceleration(20.0, d), **changes)
    return replace(PARKED, ego=Ego(5.0, 0.0, 4.0, 1.8), obstacles=(car,))


def test_ego_passes_with_clearance_in_a_lane_that_another_reaches_into():
    assert left_of_it(of_car(-2.6), "lane") is None
    # From half of ego's width and 0.25 m beside its side at -1.7 to half of that from the verge
    assert left_of_it(of_car(-2.6)) == pytest.approx((-0.55, 1.1))
    # 2.3 m are free beside its side at -0.3: twice 0.25 more than ego's width; then no longer
    assert left_of_it(of_car(-2.5, width=4.399)) == pytest.approx((0.8495, 1.1))
    assert left_of_it(of_car(-2.5, width=4.401)) is None


def test_ego_does_not_pass_within_the_lane_of_another():
    """Its middle is on the lane, however near to the edge."""
    assert left_of_it(of_car(-2.01)) is not None
    assert left_of_it(of_car(-1.99)) is None


def test_with_clearance_ego_is_as_wide_as_its_bounds_say_if_nobody_says_how_wide_it_is():
    nobody = replace(of_car(-2.6), ego=Ego(5.0, 0.0, speed=14.0))
    assert left_of_it(nobody) == pytest.approx((-1.45, 2.0))
    assert left_of_it(nobody, bounds="car")[0] == pytest.approx(-1.45 + 1.61 / 2)
    assert left_of_it(nobody, bounds="truck")[0] == pytest.approx(-1.45 + 2.55 / 2)


def test_ego_keeps_to_the_road_with_clearance_but_not_to_its_lane():
    """Its centre may be at a mark between lanes, as with whole lanes."""
    two = replace(of_car(-2.6), road=Road((0.0, 40.0), (-2.0, 2.0, 6.0)))
    assert left_of_it(two) == pytest.approx((-0.55, 5.1))


def test_only_recorded_scenes_within_bounds_have_clearance_unless_it_is_asked_for():
    assert navigation_graph(of_car(-2.6)).extent == "lane"
    assert navigation_graph(of_car(-2.6), bounds="car").extent == "lane"
    recorded = replace(of_car(-2.6), account=Account("1", 1, 0, 4.0, {}))
    assert navigation_graph(recorded, bounds="car").extent == "clearance"
    assert navigation_graph(recorded, bounds="none").extent == "lane"
    assert navigation_graph(recorded, bounds="car", extent="lane").extent == "lane"
