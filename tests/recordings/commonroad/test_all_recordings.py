"""Every recording that is at hand: it loads, and its maneuvers are counted and judged."""

import time
from functools import cache

import pytest

from rulec import compile_rulebook, find_maneuvers, navigation_graph
from rulec.diagnostics import RulecError
from rulec.planning.product.graph_product import count_paths
from rulec.scenario import load_scenario
from rulec.scenario.recorded.recorded_scene import seen_from_ego
from rulec.scenario.scenario_model import Choice
from support.builders.recordings import RECORDINGS

FILES = sorted(RECORDINGS.glob("*.xml"))
if not FILES:
    pytest.skip(
        "CommonRoad's scenarios are not here: set RULEC_RECORDINGS", allow_module_level=True
    )
PAPER = compile_rulebook("esterle2019")


@cache
def scene(file):
    """A file's scene, read once for all that is asked about it."""
    return load_scenario(file)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_its_maneuvers(file):
    scenario = scene(file)
    found = find_maneuvers(scenario, PAPER)
    assert found.traces >= found.satisfying
    assert found.traces == count_paths(found.graph.trace_graph())
    # Cells grow with the gaps, not as 4^N: in lane-wide strips each obstacle adds a few at most
    most = max(len(layer.cells) for layer in found.graph.layers)
    assert most <= 4 * (len(scenario.obstacles) + len(scenario.road.lanes))
    account = scenario.account
    assert len(scenario.obstacles) == account.recorded - account.left_out


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_with_eight_regions_too(file):
    graph = navigation_graph(scene(file), partition="fine")
    assert graph.start in range(len(graph.layers[0].cells))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_vehicle_can_be_ego(file):
    """From its first moment on; who walks beside the road or is off the map is refused."""
    recording = scene(file).account.origin.recording
    refused = []
    for one in recording.participants:
        try:
            scenario = seen_from_ego(recording, Choice(ego=one.id), file.name)
        except RulecError as error:
            refused += [x.code for x in error.diagnostics]
            continue
        assert str(one.id) not in {other.id for other in scenario.obstacles}
        assert scenario.road.outline.covers(scenario.ego.s, scenario.ego.d)
    assert refused in ([], ["R0612"])


BUSIEST = RECORDINGS / "USA_US101-24_2_T-1.xml"


def test_the_busiest_one_is_quick():
    """52 cars, six lanes, 4 s at 0.5 s: generous bounds, for a machine with much else to do."""
    if not BUSIEST.exists():
        pytest.skip(f"CommonRoad's {BUSIEST.name} is not here")
    scenario = load_scenario(BUSIEST)
    assert len(scenario.obstacles) == 52
    begin = time.process_time()
    graph = navigation_graph(scenario, step_s=0.5, horizon_s=4.0)
    assert time.process_time() - begin < 1.5
    assert max(len(layer.cells) for layer in graph.layers) < 70
