"""S3's figures against the recorded scene that they were taken from, by the real reader.

It is one of CommonRoad's, and not part of this project: RULEC_RECORDINGS names the folder it is in.
"""

import pytest

from rulec import find_maneuvers
from rulec.scenario import Choice, load_scenario
from rulec.scenario.motion import swept
from support.builders.recorded_data import RECORDINGS

FILE = RECORDINGS / "USA_US101-1_1_T-1.xml"
RECORDED = {"o1": "489", "o2": "484"}


@pytest.fixture(scope="module")
def recorded():
    if not FILE.exists():
        pytest.skip(f"CommonRoad's {FILE.name} is not here: set RULEC_RECORDINGS")
    return load_scenario(FILE)


@pytest.mark.parametrize(
    ("step_s", "counts"), [(1.0, (20, 40, 76, 61)), (0.5, (36, 80, 4240, 1840))]
)
def test_it_gives_the_papers_counts(recorded, step_s, counts):
    found = find_maneuvers(recorded, "esterle2019", step_s=step_s, horizon_s=4.0, bounds="none")
    assert (found.graph.nodes, found.graph.edges, found.traces, found.satisfying) == counts


@pytest.mark.parametrize("step_s", [1.0, 0.5])
def test_constant_acceleration_gives_the_same(recorded, step_s):
    predicted = load_scenario(FILE, Choice(prediction="constant"))
    one, other = (
        find_maneuvers(each, "esterle2019", step_s=step_s) for each in (recorded, predicted)
    )
    assert (one.graph.nodes, one.traces, one.satisfying) == (
        other.graph.nodes,
        other.traces,
        other.satisfying,
    )


def test_ego_and_the_lanes_beside_it(recorded):
    builtin = load_scenario("s3")
    assert (recorded.ego.s, recorded.ego.d) == pytest.approx((0, builtin.ego.d), abs=0.01)
    assert recorded.road.s == pytest.approx(builtin.road.s, abs=0.05)
    # d is measured along interpolated directions, there at a right angle to the lane at ego
    assert recorded.road.lanes == pytest.approx(builtin.road.lanes, abs=0.03)


@pytest.mark.parametrize("name", RECORDED)
def test_the_obstacles(recorded, name):
    predicted = load_scenario(FILE, Choice(prediction="constant"))
    (builtin,) = (x for x in load_scenario("s3").obstacles if x.id == name)
    (motion,) = (x.motion for x in predicted.obstacles if x.id == RECORDED[name])
    assert (motion.s, motion.speed) == pytest.approx(
        (builtin.motion.s, builtin.motion.speed), abs=0.05
    )
    assert motion.acceleration == pytest.approx(builtin.motion.acceleration, abs=0.01)
    # o1 is on the lane to the left, which is wider where it is than where ego is
    assert motion.d == pytest.approx(builtin.motion.d, abs=0.15)
    (there,) = (swept(x, 0, 0) for x in recorded.obstacles if x.id == RECORDED[name])
    assert there.s_max - there.s_min == pytest.approx(builtin.length, abs=0.1)


def test_nothing_else_is_on_the_road(recorded):
    assert {x.id for x in recorded.obstacles} == set(RECORDED.values())
    assert recorded.account.left_out == 0
