"""Diagnostics for machines: nothing is lost, and nothing in them can break the format."""

import json
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.cli.output import findings_in
from rulec.diagnostics import Diagnostic, Label, Source, SourceLocation, Span
from rulec.report.findings.code_registry import all_codes
from rulec.report.findings.diagnostics_json import as_json
from rulec.report.findings.finding_formats import FORMATS, as_annotations, as_lines
from rulec.report.findings.sarif import as_sarif

TEXT = "one\ntwo 🚗 three\n"
PLACE = Span(Source("a b.rules", TEXT), 10, 15).place
WHOLE = Diagnostic(
    "R0202",
    "what, is: 100 % wrong",
    PLACE,
    expected="expected something",
    help="the way out",
    labels=(Label(Span(Source("b.rules", "x"), 0, 1).place, "first"),),
    notes=("by the way",),
)
BARE = Diagnostic("R0207", "a remark", None, severity="warning")
FILE_ONLY = Diagnostic("R0102", "too large", SourceLocation("/tmp/ü.rules"))
EVERY = [WHOLE, BARE, FILE_ONLY]


def test_concise():
    assert as_lines(EVERY).splitlines() == [
        "a b.rules:2:7: R0202 what, is: 100 % wrong",
        "R0207 a remark",
        "/tmp/ü.rules: R0102 too large",
    ]


def test_json_has_every_field():
    whole, bare, _ = json.loads(as_json(EVERY))
    place = {"file": "a b.rules", "line": 2, "column": 7, "end_line": 2, "end_column": 12}
    assert whole == {
        "version": 1,
        "code": "R0202",
        "severity": "error",
        "message": "what, is: 100 % wrong",
        "place": place,
        "expected": "expected something",
        "help": "the way out",
        "fix": None,
        "labels": [
            {
                "place": {
                    "file": "b.rules",
                    "line": 1,
                    "column": 1,
                    "end_line": 1,
                    "end_column": 2,
                },
                "message": "first",
            }
        ],
        "notes": ["by the way"],
    }
    # What editors may offer beside the fix is for the language server only
    assert set(whole) == {"version", *Diagnostic.__slots__} - {"offers"}
    assert (bare["place"], bare["severity"], bare["labels"]) == (None, "warning", [])


def test_github():
    whole, bare, file_only = as_annotations(EVERY).splitlines()
    assert whole == (
        "::error file=a b.rules,line=2,endLine=2,col=7,endColumn=12,"
        "title=R0202%3A what%2C is%3A 100 %25 wrong"
        "::expected something%0Ahelp: the way out%0Anote: by the way"
    )
    assert bare == "::warning title=R0207%3A a remark::a remark"
    assert file_only == "::error file=/tmp/ü.rules,title=R0102%3A too large::too large"


def test_github_takes_no_columns_of_a_place_over_several_lines():
    long = Diagnostic("R0202", "m", Span(Source("a", TEXT), 0, 8).place)
    assert as_annotations([long]) == "::error file=a,line=1,endLine=2,title=R0202%3A m::m"


def test_sarif():
    document = json.loads(as_sarif(EVERY))
    assert document["version"] == "2.1.0"
    assert document["$schema"].endswith("sarif-schema-2.1.0.json")
    (run,) = document["runs"]
    assert run["columnKind"] == "unicodeCodePoints"
    assert run["invocations"] == [{"executionSuccessful": True}]
    whole, bare, file_only = run["results"]
    assert whole["level"] == "error"
    assert whole["message"]["text"].startswith("what, is: 100 % wrong\n")
    assert whole["locations"] == [
        {
            "physicalLocation": {
                "artifactLocation": {"uri": "a%20b.rules"},
                "region": {"startLine": 2, "startColumn": 7, "endLine": 2, "endColumn": 12},
            }
        }
    ]
    (related,) = whole["relatedLocations"]
    assert related["message"] == {"text": "first"}
    assert related["physicalLocation"]["artifactLocation"] == {"uri": "b.rules"}
    assert bare["level"] == "warning"
    assert "locations" not in bare
    (place,) = file_only["locations"]
    assert place == {"physicalLocation": {"artifactLocation": {"uri": "file:///tmp/%C3%BC.rules"}}}


def test_sarif_rules_are_those_of_the_results():
    (run,) = json.loads(as_sarif([WHOLE, BARE, WHOLE]))["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == ["R0202", "R0207"]
    assert [result["ruleIndex"] for result in run["results"]] == [0, 1, 0]
    for rule in rules:
        assert rule["shortDescription"]["text"] == all_codes()[rule["id"]].title
        assert "Corrected:" in rule["help"]["text"]
        assert "```rulec corrected\n" in rule["help"]["markdown"]


def test_sarif_says_when_a_file_could_not_be_read():
    (run,) = json.loads(as_sarif([], complete=False))["runs"]
    assert run["invocations"] == [{"executionSuccessful": False}]
    assert run["results"] == run["tool"]["driver"]["rules"] == []


@pytest.mark.parametrize("wanted", FORMATS)
def test_every_format_of_something_and_of_nothing(wanted):
    assert "R0202" in findings_in(wanted, EVERY, color=False, complete=True)
    empty = findings_in(wanted, [], color=False, complete=True)
    assert (empty == "") == (wanted in ("full", "concise", "github"))


@pytest.mark.parametrize("wanted", FORMATS)
def test_colour_is_for_people(wanted):
    assert ("\x1b" in findings_in(wanted, EVERY, color=True, complete=True)) == (wanted == "full")


anything = st.text(max_size=30)
diagnostics = st.builds(
    Diagnostic,
    st.sampled_from(sorted(all_codes())),
    anything,
    st.none()
    | st.builds(
        SourceLocation,
        anything.filter(lambda name: "\0" not in name),
        st.none() | st.integers(1, 99),
        st.none() | st.integers(1, 99),
        st.none() | st.integers(1, 99),
        st.none() | st.integers(1, 99),
    ),
    anything,
    anything,
    st.just(()),
    st.lists(anything, max_size=2).map(tuple),
    st.sampled_from(["error", "warning"]),
)


def unescaped(text):
    for escape, character in (("%0A", "\n"), ("%0D", "\r"), ("%3A", ":"), ("%2C", ",")):
        text = text.replace(escape, character)
    return text.replace("%25", "%")


@given(st.lists(diagnostics, min_size=1, max_size=4))
def test_lines_stay_lines(found):
    assert len(as_lines(found).split("\n")) == len(found)
    commands = as_annotations(found).split("\n")
    assert len(commands) == len(found)
    for command, one in zip(commands, found, strict=True):
        severity, properties, data = re.fullmatch(r"::(\w+) ([^:]*)::(.*)", command).groups()
        assert severity == one.severity
        named = dict(part.split("=", 1) for part in properties.split(","))
        assert set(named) <= {"file", "line", "endLine", "col", "endColumn", "title"}
        assert unescaped(named["title"]).startswith(f"{one.code}: ")
        assert not {"\r", "\x1b"} & set(data)


@given(st.lists(diagnostics, max_size=3))
def test_json_and_sarif_come_back(found):
    listed = json.loads(as_json(found))
    assert [one["message"] for one in listed] == [one.message for one in found]
    assert [one["notes"] for one in listed] == [list(one.notes) for one in found]
    (run,) = json.loads(as_sarif(found))["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert [rules[one["ruleIndex"]]["id"] for one in run["results"]] == [d.code for d in found]
    for result, one in zip(run["results"], found, strict=True):
        for location in result.get("locations", []):
            uri = location["physicalLocation"]["artifactLocation"]["uri"]
            assert re.fullmatch(r"[A-Za-z0-9%._~/:$&+,;=@'()*!-]*", uri), one.place


def test_sarif_has_what_the_schema_requires():
    """The required properties of sarif-schema-2.1.0.json, of every object that is written."""
    document = json.loads(as_sarif(EVERY))
    required = {
        "runs": {"tool"},
        "tool": {"driver"},
        "driver": {"name"},
        "rules": {"id"},
        "invocations": {"executionSuccessful"},
        "results": {"message"},
        "shortDescription": {"text"},
        "fullDescription": {"text"},
        "help": {"text"},
    }
    met = set()
    walked = [("", document)]
    for name, node in walked:
        for one in node if isinstance(node, list) else [node]:
            if isinstance(one, dict):
                assert required.get(name, set()) <= set(one), name
                met.add(name)
                walked += one.items()
                if name == "region":
                    assert all(type(number) is int and number >= 1 for number in one.values())
            if name == "level":
                assert one in ("none", "note", "warning", "error")
    assert {*required, "region"} <= met
    assert set(document) == {"$schema", "version", "runs"}
