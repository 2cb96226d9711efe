"""Expected statistics of nuPlan's own tests of metrics, and what rulec says of the same.

Source: motional/nuplan-devkit, nuplan/planning/metrics/evaluation_metrics/common/test/json/:
speed_limit_compliance/speed_limit_violation.json, driving_direction_compliance/
ego_drives_backward.json, drivable_area_compliance/drivable_area_violation.json and
no_drivable_area_violation.json. The roads are straight ones drawn here, since the map of the scenes
is not public, and places follow from the speeds, which in the first of these scenes they do not.
"""

import numpy as np
import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.drives import Drives
from rulec.recordings.building import build_lanelet, build_participant, build_recording
from rulec.scoring.score import score
from rulec.scoring.traffic_world import TrafficWorld

STEP_S = 0.1
LIMIT_MPS = 30 * 0.44704  # 30 mph

# Ego's speeds (m/s), and by how much they are over the limit: the scene's "values"
SPEEDS = [20.0, 22.27, 24.69, 10.0, 10.0]
OVER = [6.59, 8.86, 11.28, 0, 0]


def world(speed):
    lane = build_lanelet("road", [(-50, 0), (400, 0)], limit_mps=LIMIT_MPS)
    t = STEP_S * np.arange(2)
    ego = build_participant("ego", "car", t, speed * t, 0 * t, step_s=STEP_S)
    return TrafficWorld(build_recording([lane], [ego], step_s=STEP_S, side="right"), "ego")


@pytest.mark.parametrize(("speed", "over"), [*zip(SPEEDS, OVER, strict=True)])
def test_speed_limit(speed, over):
    own, ahead = world(speed), STEP_S * np.arange(2, 32)
    steady = np.column_stack((speed * ahead, 0 * ahead, 0 * ahead, 0 * ahead + speed))
    found = score(steady[None], own, machines("de"))
    assert found.outcomes("speed_limit") == ["violated" if over else "kept"]
    margins = [one.margin for one in found.margins(0) if one.rule == "speed_limit"]
    # Limits and speeds are km/h, to a hundredth
    by = min(one.by for one in margins if one.limit < 200) / 3.6
    assert by == pytest.approx(over or LIMIT_MPS - speed, abs=0.01)


def test_driving_against_its_heading():
    # "MIN" -12.99: so far (m) does ego drive backwards in one second, and "VALUE" 0: not compliant
    lane = build_lanelet("road", [(-100, 0), (100, 0)])
    t = STEP_S * np.arange(2)
    own = build_participant("ego", "car", t, 0 * t, 0 * t, step_s=STEP_S, heading=0 * t)
    own = TrafficWorld(build_recording([lane], [own], step_s=STEP_S, side="right"), "ego")
    found = []
    for speed in (-12.99, 12.99):
        x = speed * STEP_S * np.arange(1, 21)
        whole = own.recording_of(np.column_stack((x, 0 * x, 0 * x, 0 * x + speed)))
        (drive,) = Drives(whole, "right").of("ego")
        found.append({state["reversing"] for state in drive.trace.states})
    assert found == [{True}, {False}]


# Ego's poses (m, m, rad), one a second; the scene without violation has the first two of them.
# Coordinates are from 664700, 3999400.
POSES = [
    (51.662199684, 61.989363281, -2.0085689660475055),
    (45.7648709918, 56.8245754833, -2.110825581755435),
    (37.5883774936, 52.2951032147, -2.0894044289663976),
    (36.0983882715, 41.208863881, -2.2235551885626497),
    (27.3146130748, 42.052379835, -2.894766277197636),
    (19.6775568399, 37.0747503983, 3.119544135682711),
]


def two_lanes():
    """A straight road of two lanes, as wide as the first two poses take.

    It leads where these look, and its middle is 1.4 m to the right of the first one.
    """
    along = -2.0597
    ahead, left = (
        np.array([np.cos(along), np.sin(along)]),
        np.array([-np.sin(along), np.cos(along)]),
    )
    first = np.array(POSES[0][:2])
    centres = [first + (aside - 1.4) * left for aside in (1.8, -1.8)]
    ways = [[centre - 40 * ahead, centre + 80 * ahead] for centre in centres]
    return [
        build_lanelet("left", ways[0], 3.6, right_of="right"),
        build_lanelet("right", ways[1], 3.6, left_of="left"),
    ]


@pytest.mark.parametrize(("states", "compliant"), [(2, True), (6, False)])
def test_drivable_area(states, compliant):
    x, y, heading = np.array(POSES[:states]).T
    t = np.arange(2.0)
    stands = [np.full(2, values[0]) for values in (x, y, heading)]
    own = build_participant("ego", "car", t, stands[0], stands[1], step_s=1.0, heading=stands[2])
    own = TrafficWorld(build_recording(two_lanes(), [own], step_s=1.0, side="right"), "ego")
    speed = np.hypot(np.diff(x), np.diff(y))
    ahead = np.column_stack((x[1:], y[1:], heading[1:], speed))
    found = score(ahead[None], own, machines("de"), own.past)
    assert (found.off_road[0] == 0) == compliant
    assert bool(found.perhaps_allowed[0]) == compliant
