"""docs/commands.md and the fields of JSON: no verb, no format and no field is left out."""

import json
import re
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.cli.verb_table import COMMANDS
from rulec.report.findings.finding_formats import FORMATS
from rulec.report.findings.verdict_finding import FindingLine
from tools.schema_tables import schema_tables

PAGE = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")


def described():
    """The fields in the tables that are made from the schemas."""
    return set(re.findall(r"^\| `(\w+)` \|", schema_tables(), re.MULTILINE))


def fields(data):
    match data:
        case dict():
            return set(data) | {key for one in data.values() for key in fields(one)}
        case list():
            return {key for one in data for key in fields(one)}
        case _:
            return set()


@pytest.mark.parametrize("verb", COMMANDS)
def test_every_verb(verb):
    assert f"`rulec {verb}" in PAGE


def test_every_format():
    assert all(f"`{name}`" in PAGE for name in FORMATS)


def test_every_field_of_a_finding():
    fields = set(FindingLine.__struct_fields__) - {"version"}
    assert {f"`{name}`" for name in fields} <= set(re.findall(r"`\w+`", PAGE))


@pytest.mark.parametrize(
    "arguments",
    [
        ["test", "esterle2019", "--coverage", "--output-format", "json"],
        ["explain", "R0101", "--output-format", "json"],
        ["list", "scenarios", "--json"],
        ["show", "esterle2019", "R1", "--json"],
        ["show", "--audit", "esterle2019", "--compare", "esterle2019", "--output-format", "json"],
        ["show", "--tree", "esterle2019", "--json"],
        ["show", "--tree", "--json"],
    ],
)
def test_every_field_of_an_answer(arguments, capsys):
    assert main(arguments) == 0
    assert fields(json.loads(capsys.readouterr().out)) <= described()


def test_every_field_of_maneuvers(capsys):
    """Names of objects and variables are no fields."""
    asked = ["--list", "1", "--rank", "99", "--why", "--classes", "1"]
    main(["maneuvers", "s2", "-r", "esterle2019", "--json", *asked])
    found = fields(json.loads(capsys.readouterr().out)) - {"o1", "p1", "v"}
    assert {"satisfying", "penalty", "representatives", "envelope"} <= found
    assert found <= described()
