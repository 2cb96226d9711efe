"""S3's figures against the recorded scene that they were taken from.

It is one of CommonRoad's, and not part of this project: RULEC_RECORDINGS names the folder it is in.
"""

import math
import os
import xml.etree.ElementTree as ElementTree
from itertools import pairwise
from pathlib import Path

import pytest

from rulec.scenario import load_scenario

BESIDE = Path(__file__).resolve().parents[3] / "shared/data/commonroad"
RECORDING = Path(os.environ.get("RULEC_RECORDINGS", BESIDE)) / "USA_US101-1_1_T-1.xml"
EGO_LANE = "536"
LANES_FROM_THE_RIGHT = ("544", "542", "540", "538", "536", "534")
RECORDED = {"o1": "489", "o2": "484"}


@pytest.fixture(scope="module")
def recording():
    if not RECORDING.exists():
        pytest.skip(f"CommonRoad's {RECORDING.name} is not here: set RULEC_RECORDINGS")
    return ElementTree.parse(RECORDING).getroot()


def points(bound):
    return [(float(p.findtext("x")), float(p.findtext("y"))) for p in bound.findall("point")]


def bounds_of(recording, lane):
    (lanelet,) = (x for x in recording.findall("lanelet") if x.get("id") == lane)
    return points(lanelet.find("leftBound")), points(lanelet.find("rightBound"))


def projected(line, place):
    """Arc length, offset and direction of the nearest point of a polyline."""
    best = None
    along = 0.0
    for (x0, y0), (x1, y1) in pairwise(line):
        length = math.hypot(x1 - x0, y1 - y0)
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        vx, vy = place[0] - x0, place[1] - y0
        part = min(max(vx * ux + vy * uy, 0.0), length)
        far = math.hypot(vx - part * ux, vy - part * uy)
        if best is None or far < best[0]:
            best = far, along + part, ux * vy - uy * vx, (ux, uy)
        along += length
    return best[1:]


@pytest.fixture(scope="module")
def street(recording):
    left, right = bounds_of(recording, EGO_LANE)
    return [((a + c) / 2, (b + d) / 2) for (a, b), (c, d) in zip(left, right, strict=True)]


def state(element):
    point = element.find("initialState/position/point")
    return float(point.findtext("x")), float(point.findtext("y"))


def test_ego_and_the_lanes_beside_it(recording, street):
    scenario = load_scenario("s3")
    ego = state(recording.find("planningProblem"))
    start, offset, (ux, uy) = projected(street, ego)
    assert (scenario.ego.s, scenario.ego.d) == pytest.approx((0.0, offset), abs=0.01)
    length = sum(math.dist(a, b) for a, b in pairwise(street))
    assert scenario.road.s == pytest.approx((-start, length - start), abs=0.01)
    foot = ego[0] + offset * uy, ego[1] - offset * ux

    def crossed(line):
        """Offset at which a bound crosses the perpendicular of the street at ego."""
        for (x0, y0), (x1, y1) in pairwise(line):
            a = (x0 - foot[0]) * ux + (y0 - foot[1]) * uy
            b = (x1 - foot[0]) * ux + (y1 - foot[1]) * uy
            if a <= 0 < b:
                x, y = x0 + (x1 - x0) * a / (a - b), y0 + (y1 - y0) * a / (a - b)
                return ux * (y - foot[1]) - uy * (x - foot[0])
        raise AssertionError("the bound does not pass ego")

    bounds = [crossed(bounds_of(recording, lane)[1]) for lane in LANES_FROM_THE_RIGHT]
    bounds.append(crossed(bounds_of(recording, LANES_FROM_THE_RIGHT[-1])[0]))
    assert scenario.road.lanes == pytest.approx(bounds, abs=0.01)


@pytest.mark.parametrize("name", RECORDED)
def test_the_obstacles(recording, street, name):
    (obstacle,) = (x for x in load_scenario("s3").obstacles if x.id == name)
    (recorded,) = (x for x in recording.findall("dynamicObstacle") if x.get("id") == RECORDED[name])
    shape = recorded.find("shape/rectangle")
    assert obstacle.length == float(shape.findtext("length"))
    assert obstacle.width == float(shape.findtext("width"))
    at_ego, _, _ = projected(street, state(recording.find("planningProblem")))
    s, d, _ = projected(street, state(recorded))
    assert (obstacle.motion.s, obstacle.motion.d) == pytest.approx((s - at_ego, d), abs=0.01)
    first = recorded.find("initialState")
    assert obstacle.motion.speed == float(first.findtext("velocity/exact"))
    assert obstacle.motion.acceleration == float(first.findtext("acceleration/exact"))


def test_nothing_else_is_on_the_road(recording):
    assert len(recording.findall("dynamicObstacle")) == len(load_scenario("s3").obstacles)
