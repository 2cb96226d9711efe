"""Words in cells hold for every drive through them, and so do the verdicts on maneuvers."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from rulec import RulecError, compile_rulebook, find_maneuvers, verify
from rulec.scenario import Choice
from rulec.scenario.recorded.recorded_scene import seen_from_ego
from support.builders.recordings import RECORDINGS, recording, straight, vehicle
from support.oracles.witness_drives import (
    contradicting,
    drives_of,
    in_layers,
    on_an_edge,
    witnesses,
)

FILES = sorted(RECORDINGS.glob("*.xml"))
LANES = (straight(1, 0, 300, left_of=2), straight(2, 0, 300, y=4, right_of=1))


@pytest.fixture(scope="module")
def german():
    return compile_rulebook("de")


def check(found, most):
    """Compare some maneuvers with the drives of their trajectories."""
    pairs = witnesses(found, most) if found.traces else []
    if not pairs:
        return 0
    compared = 0
    drives = drives_of(found, [trajectory for _, trajectory in pairs])
    for (nodes, trajectory), drive in zip(pairs, drives, strict=True):
        trace = None if drive is None else in_layers(found, drive)
        if trace is None or on_an_edge(found, nodes, trajectory):
            continue
        assert list(contradicting(found, nodes, trace)) == []
        of_drive = verify(trace, found.rules)
        mine = found.verdict(SimpleNamespace(nodes=nodes))
        violated, doubtful = keys(mine.violations), keys(mine.open)
        own, own_doubtful = keys(of_drive.violations), keys(of_drive.open)
        dark = {rule.rule for rule in mine.not_judged}
        assert {key for key in own - violated - doubtful if key[0] not in dark} == set()
        dark = {rule.rule for rule in of_drive.not_judged}
        assert {key for key in violated - own - own_doubtful if key[0] not in dark} == set()
        compared += 1
    return compared


def keys(results):
    return {(one.rule, tuple(sorted(one.binding.items()))) for one in results}


@st.composite
def scenes(draw):
    """Ego on one of two lanes among up to four vehicles of even speeds."""
    vehicles = []
    for number in range(draw(st.integers(0, 4))):
        y = draw(st.sampled_from([0.0, 4.0])) + draw(st.floats(-0.5, 0.5))
        start, speed = draw(st.floats(20, 160)), draw(st.floats(0, 20))
        places = {k: (start + speed * k / 2, y) for k in range(13)}
        vehicles.append(vehicle(number + 10, places, speed=speed))
    ego = 60.0, draw(st.sampled_from([0.0, 4.0]))
    made = recording(LANES, vehicles, ego=ego)
    (problem,) = made.problems
    start = replace(problem.start, speed=draw(st.floats(0, 20)))
    problem = replace(problem, start=start)
    return seen_from_ego(replace(made, problems=(problem,)), Choice(), "file.xml")


@given(scenes())
@settings(max_examples=12, suppress_health_check=list(HealthCheck))
def test_random_scenes(german, scene):
    try:
        found = find_maneuvers(scene, german, horizon_s=2.0)
    except RulecError:
        assume(False)
    check(found, 2)


@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize(
    ("file", "most"),
    [
        *((file, 2) for file in FILES[:2]),
        *(pytest.param(file, 12, marks=pytest.mark.long) for file in FILES),
    ]
    or [("", 0)],
    ids=lambda item: getattr(item, "stem", None),
)
def test_recordings(german, file, most):
    found = find_maneuvers(file, german)
    check(found, most)
