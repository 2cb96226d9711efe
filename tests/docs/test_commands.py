"""docs/commands.md: no verb, option or field of JSON is left out."""

import json
import re
from pathlib import Path

import pytest

from rulec.cli.main import main, rulec
from rulec.cli.verb_table import VERBS
from rulec.report.findings.diagnostics_json import FindingData
from rulec.report.findings.finding_formats import FORMATS

PAGE = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")


def fields(data):
    match data:
        case dict():
            return set(data) | {key for one in data.values() for key in fields(one)}
        case list():
            return {key for one in data for key in fields(one)}
        case _:
            return set()


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_and_its_options(verb):
    assert f"`rulec {verb}" in PAGE
    command = rulec.get_command(None, verb)
    for parameter in command.params:
        if parameter.name != "json_output":
            assert any(name in PAGE for name in parameter.opts if name.startswith("-")) or (
                parameter.param_type_name == "argument"
            ), parameter.opts


def test_every_format():
    assert all(f"`{name}`" in PAGE for name in FORMATS)


def test_every_field_of_a_finding():
    assert {f"`{name}`" for name in FindingData.__struct_fields__} <= set(
        re.findall(r"`\w+`", PAGE)
    )


@pytest.mark.parametrize(
    "arguments",
    [
        ["test", "esterle2019", "--coverage", "--output-format", "json"],
        ["explain", "R0101", "--output-format", "json"],
        ["list", "scenarios", "--json"],
        ["show", "esterle2019", "R1", "--json"],
        ["audit", "esterle2019", "--compare", "esterle2019", "--output-format", "json"],
        ["tree", "esterle2019", "--json"],
        ["tree", "--json"],
    ],
)
def test_every_field_of_an_answer(arguments, capsys):
    assert main(arguments) == 0
    named = set(re.findall(r"`\"?(\w+)\"?`", PAGE))
    assert fields(json.loads(capsys.readouterr().out)) <= named


def test_every_field_of_maneuvers(capsys):
    """Names of objects and variables are no fields."""
    asked = ["--list", "1", "--rank", "99", "--why", "--classes", "1"]
    main(["maneuvers", "s2", "-r", "esterle2019", "--json", *asked])
    found = fields(json.loads(capsys.readouterr().out)) - {"o1", "p1", "v"}
    assert {"satisfying", "penalty", "representatives", "envelope"} <= found
    assert found <= set(re.findall(r"`\"?(\w+)\"?`", PAGE))
