"""The first maneuver of recorded scenes is one that a driver would drive."""

from itertools import pairwise

import pytest

from rulec import compile_rulebook, find_maneuvers
from rulec.scenario.motion import swept
from support.builders.recorded_data import RECORDINGS

NO_SCENES = {
    "DEU_Intersection",
    "DEU_TrafficLightTest-1",
    "T_intersection",
    "USA_t_intersection-1_1_T-2",
    "uncontrolled_intersection",
}
"""Files in which nobody moves, or none of whose vehicles is ego."""

FILES = sorted(
    file
    for folder in (RECORDINGS, RECORDINGS.with_name("commonroad_more"))
    for file in folder.glob("*.xml")
    if file.stem not in NO_SCENES
)


@pytest.fixture(scope="module")
def german():
    return compile_rulebook("de")


def has_reason_to_brake(scenario, trajectory):
    """Whether somebody would be met at ego's speed, or be nearer than a second's way.

    In the lane that the trajectory takes: at the ends of its pieces.
    """
    speed = scenario.ego.speed
    for time, _, _, d, _ in trajectory.states:
        s = scenario.ego.s + speed * time
        for obstacle in scenario.obstacles:
            box = swept(obstacle, time, time)
            beside = box is None or box.d_min > d + 1.2 or box.d_max < d - 1.2
            if not beside and box.s_min < s + speed + 5 and box.s_max > trajectory.states[0][1]:
                return True
    return False


@pytest.mark.long
@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize("adjacency", ["touch", "forward"])
@pytest.mark.parametrize("file", FILES or [None], ids=lambda file: getattr(file, "stem", ""))
def test_the_cheapest_one_is_driven_so(german, file, adjacency):
    found = find_maneuvers(file, german, adjacency=adjacency)
    listed = found.cheapest(1, perhaps=True) or [one.maneuver for one in found.best(1)]
    if not found.traces:
        assert found.dead_end is not None
        return
    (first,) = listed
    trajectory, start = first.trajectory, found.graph.scenario.ego.speed
    for (_, s0, *_), (_, s1, v1, *_) in pairwise(trajectory.states):
        assert v1 > -1e-4
        assert s1 >= s0 - 1e-4
    hardest = max(trajectory.greatest_acceleration, trajectory.greatest_braking)
    assert hardest <= 4.0 or (found.least_braking or found.least_braking_later) > 4.0
    if trajectory.greatest_braking > 1.0:
        assert has_reason_to_brake(found.graph.scenario, trajectory)
    slowest = min(v for _, _, v, _, _ in trajectory.states)
    if start > 1.0 and slowest < 0.5:
        # Who had to stop goes on, unless somebody is still there
        *_, (time, s, v, d, _) = trajectory.states
        boxes = [swept(obstacle, time, time) for obstacle in found.graph.scenario.obstacles]
        beside = [box for box in boxes if box and box.d_min < d + 1 and box.d_max > d - 1]
        assert v > 0.5 or any(s < box.s_min < s + 10 for box in beside)
