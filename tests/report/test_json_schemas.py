"""Every JSON output has a version and keeps to its published schema."""

import json
from functools import cache
from pathlib import Path

import click
import pytest
from jsonschema import Draft202012Validator

from rulec.cli.main import main, rulec
from rulec.cli.verb_table import COMMANDS, called
from support.builders.road_scenes import CHILD_AT_THE_KERB
from tools.json_schemas import SCHEMAS

ROOT = Path(__file__).resolve().parents[2]
PUBLISHED = ROOT / "docs" / "schemas"
TRACES = "docs/samples/traces.jsonl"
RECORDING = "docs/samples/passing.fcd.xml"

WRONG = "rulebook wrong\nuse paper\nhard rule r { require always (nowhere) }\n"
CONFLICT = """\
rulebook conflict
signal p, q default false
hard rule keep { require always (p implies always q) }
hard rule leave { require always (p implies eventually not q) }
hard rule idle { require always (p or not p) }
"""
WRONG_EXAMPLE = """\
rulebook failing
use paper
hard rule r { require never CONGESTED accept { CONGESTED } }
"""
STATES = '{"state": {"CONGESTED": true}}\n{"state": 3}\n'
BROKEN = '{"id": "a", "states": [{"nowhere": 3}]}\n{"id": 3\n'
PAST = (
    '{"step_s": 0.5, "objects": {"o1": "vehicle", "o2": "vehicle"}, '
    '"states": [{"position": {"o1": "b", "o2": "b"}, "CONGESTED": true}]}\n'
)

FOUND = (
    '{"kind": "drive", "vehicle": "v", "duration_s": 60}\n'
    '{"kind": "rule", "vehicle": "v", "rule": "stop_sign", "opportunities": 3, "violated": 1}\n'
)

DOCUMENTS = [
    ("findings", ["check", "WRONG", "--output-format", "json"]),
    ("findings", ["check", "esterle2019", "--output-format", "json"]),
    ("findings", ["analyze", "CONFLICT", "--output-format", "json"]),
    ("audit", ["show", "--audit", "de", "--output-format", "json"]),
    (
        "audit",
        ["show", "--audit", "esterle2019", "--compare", "esterle2019", "--output-format", "json"],
    ),
    ("codes", ["explain", "R0101", "--output-format", "json"]),
    ("diff", ["diff", "de", "fr", "--rule", "rail*", "--output-format", "json"]),
    ("matrix", ["diff", "--all", "de", "fr", "--rule", "rail*", "--output-format", "json"]),
    ("formats", ["list", "formats", "--json"]),
    ("list", ["list", "--json"]),
    ("list", ["list", "codes", "--json"]),
    ("rules", ["list", "rules", "esterle2019", "--json"]),
    ("maneuvers", ["maneuvers", "s1", "-r", "esterle2019", "--json", "--list", "2"]),
    ("maneuvers", ["maneuvers", "s2", "-r", "esterle2019", "--json", "--rank", "9", "--why"]),
    ("maneuvers", ["maneuvers", "s1", "-r", "esterle2019", "--json", "--classes", "2"]),
    (
        "maneuvers",
        ["maneuvers", "s1", "--step", "0.5", "-r", "esterle2019", "--json", "--after", "PAST"],
    ),
    ("maneuvers", ["maneuvers", "KERB", "-r", "esterle2019", "--json", "--list", "9", "--worlds"]),
    ("maneuvers", ["maneuvers", RECORDING, "--ego", "g.0", "-r", "esterle2019", "--json"]),
    ("proofs", ["compile", "--check", "COMPILED", "--json"]),
    ("rates", ["rates", "FOUND", "--by", "country", "--json"]),
    ("show", ["show", "esterle2019", "--json"]),
    ("show", ["show", "esterle2019", "R1", "--json"]),
    ("test", ["test", "esterle2019", "--output-format", "json"]),
    ("test", ["test", "FAILING", "--coverage", "--output-format", "json"]),
    ("tree", ["show", "--tree", "de", "--json"]),
    ("tree", ["show", "--tree", "--json"]),
    ("words", ["explain", "beside", "vehicle", "near_lane_is_free", "--json"]),
]
LINES = [
    ("verdict", ["verify", TRACES, "-r", "esterle2019", "--json", "--explain", "1"]),
    ("finding", ["verify", RECORDING, "-r", "de", "--output-format", "jsonl"]),
    ("exposure", ["verify", RECORDING, "-r", "de", "--output-format", "jsonl", "--exposure"]),
    ("moment", ["find", "(v: vehicle) behind(v)", RECORDING, "--json"]),
    ("verdict", ["verify", "BROKEN", "-r", "esterle2019", "--json"]),
    ("verdict", ["verify", RECORDING, "-r", "de", "--json", "--explain", "1"]),
    ("state", ["monitor", "esterle2019", "--json"]),
    (
        "envelope",
        ["maneuvers", "--envelopes", "s1", "-r", "esterle2019", "-o", "-", "--format", "jsonl"],
    ),
    ("trace", ["maneuvers", "--traces", "s1", "--first", "5", "-o", "-", "--format", "jsonl"]),
]


def closed(schema):
    """The schema, with every object refusing a field that it does not name."""
    if isinstance(schema, list):
        return [closed(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    inner = {key: closed(value) for key, value in schema.items()}
    return {"additionalProperties": False, **inner} if "properties" in inner else inner


@cache
def validator(name):
    schema = json.loads((PUBLISHED / f"{name}.json").read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(closed(schema))


@pytest.fixture
def run(tmp_path, monkeypatch, capfdbinary):
    """Run a command in the repository, with files of these names in its place."""
    monkeypatch.chdir(ROOT)
    files = {
        "WRONG": ("wrong.rules", WRONG),
        "FAILING": ("failing.rules", WRONG_EXAMPLE),
        "CONFLICT": ("conflict.rules", CONFLICT),
        "BROKEN": ("broken.jsonl", BROKEN),
        "FOUND": ("found.jsonl", FOUND),
        "PAST": ("past.jsonl", PAST),
        "KERB": ("kerb.toml", CHILD_AT_THE_KERB),
    }
    paths = {name: tmp_path / file for name, (file, _) in files.items()}
    for name, (_, text) in files.items():
        paths[name].write_text(text)
    paths["COMPILED"] = tmp_path / "esterle2019.json"

    def answer(arguments):
        if "COMPILED" in arguments:
            main(["compile", "esterle2019", "-o", str(tmp_path)])
            capfdbinary.readouterr()
        main([str(paths.get(argument, argument)) for argument in arguments])
        return capfdbinary.readouterr().out.decode()

    return answer


def answers_of(run, monkeypatch, tmp_path, arguments):
    states = tmp_path / "states"
    states.write_text(STATES)
    with states.open() as stream:
        monkeypatch.setattr("sys.stdin", stream)
        return run(arguments)


@pytest.mark.parametrize(("name", "arguments"), DOCUMENTS)
def test_a_document_keeps_to_its_schema(name, arguments, run):
    document = json.loads(run(arguments))
    validator(name).validate(document)
    assert all(
        part["version"] == 1 for part in (document if isinstance(document, list) else [document])
    )


@pytest.mark.parametrize(("name", "arguments"), LINES)
def test_lines_keep_to_their_schema(name, arguments, run, monkeypatch, tmp_path):
    lines = [
        json.loads(line) for line in answers_of(run, monkeypatch, tmp_path, arguments).splitlines()
    ]
    assert lines
    for line in lines:
        validator(name).validate(line)
        assert line.get("version") == (None if name == "trace" else 1)


def test_a_compiled_rulebook_and_a_saved_monitor_keep_to_theirs(run, monkeypatch, tmp_path):
    run(["compile", "esterle2019", "-o", str(tmp_path / "out")])
    compiled = json.loads((tmp_path / "out" / "esterle2019.json").read_text())
    validator("compiled").validate(compiled)
    assert compiled["version"] == 7
    path = str(tmp_path / "out" / "esterle2019.json")
    proofs = json.loads(run(["compile", "--check", path, "--json"]))
    validator("proofs").validate(proofs)
    assert [rule["proved"] for rule in proofs["files"][0]["rules"]] == [True] * 3
    saved = tmp_path / "saved.json"
    answers_of(run, monkeypatch, tmp_path, ["monitor", "esterle2019", "--save", str(saved)])
    monitor = json.loads(saved.read_text())
    validator("monitor").validate(monitor)
    assert monitor["version"] == 1


def writes_json(verb):
    command = rulec.get_command(click.Context(rulec), verb)
    for option in command.params:
        if option.name == "json_output":
            return True
        if isinstance(option.type, click.Choice) and {"json", "jsonl"} & set(option.type.choices):
            return True
    return False


def test_no_verb_is_forgotten():
    validated = {called(arguments)[0] for _, arguments in [*DOCUMENTS, *LINES]}
    assert {command for command in COMMANDS if writes_json(command)} == validated


def test_no_schema_is_forgotten():
    page = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
    tried = {name for name, _ in [*DOCUMENTS, *LINES]} | {"compiled", "monitor"}
    assert tried == set(SCHEMAS) == {path.stem for path in PUBLISHED.glob("*.json")}
    assert all(f"(schemas/{name}.json)" in page for name in SCHEMAS)


@pytest.mark.parametrize("name", sorted(SCHEMAS))
def test_another_output_does_not_keep_to_a_schema(name):
    assert list(validator(name).iter_errors({"something": "else"}))
