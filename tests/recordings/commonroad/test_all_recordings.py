"""Every recording that is at hand: it loads, and its maneuvers are counted and judged."""

from functools import cache
from operator import attrgetter

import pytest

from rulec import compile_rulebook, find_maneuvers, navigation_graph, read_recording
from rulec.diagnostics import RulecError
from rulec.extraction.recording_parts import egos_of
from rulec.planning.product.graph_product import count_paths
from rulec.scenario import load_scenario
from rulec.scenario.recorded.recorded_scene import seen_from_ego
from rulec.scenario.scenario_model import Choice
from support.builders.recorded_data import RECORDINGS

FILES = sorted(RECORDINGS.glob("*.xml"))
stem = attrgetter("stem")
if not FILES:
    pytest.skip(
        "CommonRoad's scenarios are not here: set RULEC_RECORDINGS", allow_module_level=True
    )
PAPER = compile_rulebook("esterle2019")


@cache
def recorded(file):
    return read_recording(file)


@cache
def scene(file):
    """A file's scene, read once for all that is asked about it.

    As its planning problem has it, or of its first vehicle that drives.
    """
    ego = None if recorded(file).problems else egos_of(recorded(file))[0]
    return seen_from_ego(recorded(file), Choice(ego=ego), file.name)


SCENES = [file for file in FILES if recorded(file).problems or egos_of(recorded(file))]


def test_a_map_without_traffic_is_no_scene():
    for file in set(FILES) - set(SCENES):
        with pytest.raises(RulecError, match="no moving participant and no planning problem"):
            load_scenario(file)


@pytest.mark.parametrize("file", SCENES, ids=stem)
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


@pytest.mark.parametrize("file", SCENES, ids=stem)
def test_with_eight_regions_too(file):
    graph = navigation_graph(scene(file), partition="fine")
    assert graph.start in range(len(graph.layers[0].cells))


@pytest.mark.parametrize("file", FILES, ids=stem)
def test_every_vehicle_can_be_ego(file):
    """From its first moment on; who walks beside the road or is off the map is refused."""
    recording = recorded(file)
    refused = {}
    for one in recording.participants:
        try:
            scenario = seen_from_ego(recording, Choice(ego=one.id), file.name)
        except RulecError as error:
            refused[one.id] = error.diagnostics[0].code
            continue
        assert str(one.id) not in {other.id for other in scenario.obstacles}
        assert scenario.road.outline.covers(scenario.ego.s, scenario.ego.d)
    assert set(refused.values()) <= {"R0612"}
    assert len(refused.keys() & set(egos_of(recording))) <= 1


BUSIEST = RECORDINGS / "USA_US101-24_2_T-1.xml"


def test_the_busiest_one_has_few_cells():
    """52 cars, six lanes, 4 s at 0.5 s."""
    if not BUSIEST.exists():
        pytest.skip(f"CommonRoad's {BUSIEST.name} is not here")
    scenario = load_scenario(BUSIEST)
    assert len(scenario.obstacles) == 52
    graph = navigation_graph(scenario, step_s=0.5, horizon_s=4.0)
    assert max(len(layer.cells) for layer in graph.layers) < 70
