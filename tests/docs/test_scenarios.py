"""docs/scenarios.md: its sample loads, no field is left out."""

import re
from pathlib import Path

import msgspec
import pytest

from rulec import find_maneuvers
from rulec.partition import navigation_graph
from rulec.scenario import available_scenarios, load_scenario
from rulec.scenario.scenario_model import SURFACES
from rulec.scenario.toml import schema

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "scenarios.md").read_text(encoding="utf-8")


def block(language):
    return re.search(rf"^```{language}\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE).group(1)


@pytest.mark.parametrize("partition", ["paper", "fine"])
def test_the_sample_is_a_scenario(tmp_path, partition):
    file = tmp_path / "sample.toml"
    file.write_text(block("toml"), encoding="utf-8")
    graph = navigation_graph(load_scenario(file), partition=partition)
    assert set(graph.objects) == {"bus", "child", "bike"}
    assert graph.goals


def test_the_sample_is_judged_by_what_ships(tmp_path):
    file = tmp_path / "sample.toml"
    file.write_text(block("toml"), encoding="utf-8")
    assert find_maneuvers(file, "esterle2019").satisfying > 0


@pytest.mark.parametrize(
    "table", [t for name, t in vars(schema).items() if name.startswith("Raw")], ids=str
)
def test_every_field_is_explained(table):
    explained = set(re.findall(r"`([a-z_]+)`", PAGE)) | {"road", "ego", "goal", "obstacle"}
    explained |= {"surface", "missing", "prediction"}  # headings of their own
    assert {field.name for field in msgspec.structs.fields(table)} <= explained


def test_every_name_is_mentioned():
    for name in (*available_scenarios(), *SURFACES):
        assert f"`{name}`" in PAGE
