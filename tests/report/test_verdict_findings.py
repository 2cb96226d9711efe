"""Findings of verdicts in every format, also with names that mean to do harm."""

import csv
import io
import json
import re
from html import unescape
from xml.etree import ElementTree

import jsonschema
import pyarrow.parquet
import pytest
from mcap.reader import make_reader

import rulec
from rulec.cli.verdict_outputs import finding_writer
from rulec.diagnostics import RulecError
from rulec.monitoring.explain.margins import Margin
from rulec.report.findings.finding_formats import ENDINGS
from rulec.report.findings.verdict_finding import (
    COLUMNS,
    FindingContext,
    RecordingFindings,
    VerdictFinding,
    measured,
)

BOOK = """\
rulebook tiny
use road

hard rule slow {
  cite "Art. 1"
  says "Drive slowly."
  require always speed <= 45 km/h
}

soft rule distance (v: vehicle) {
  require always (behind(v) and same_lane(v) implies gap(v) >= 5 m)
}

hard rule quiet { require never wet }
"""

EVIL = '=HYPERLINK("http://x")<b>&\x1b[31m\x00\n|'


@pytest.fixture(scope="module")
def rules():
    return rulec.compile_rulebook(rulec.parse_rulebook(BOOK))


def of(rule, outcome="violated", **fields):
    own = {"file": "a b.xml", "recording": "A", "rulebook": "tiny", "strength": "hard"}
    return VerdictFinding(**{**own, "rule": rule, "outcome": outcome, **fields})


SLOW = of(
    "slow",
    provision="Art. 1",
    vehicle="4",
    from_s=0.5,
    to_s=2.5,
    at_s=0.75,
    by=5.4,
    unit="km/h",
    measure="speed 50.4 km/h > 45 km/h",
    x=2.0,
    y=-1.5,
    lanelet="7",
)
DISTANCE = of("distance", strength="soft", vehicle="4", other=("3",), from_s=1.0, to_s=1.0)
OPEN = of("distance", "open", strength="soft", vehicle="5", other=("3",), open_on=("gap",))
UNTOLD = of("quiet", "not_judged", open_on=("wet",))
FOUND = RecordingFindings("a b.xml", "A", ("4", "5", "6"), (SLOW, DISTANCE, OPEN, UNTOLD))
BROKEN = RecordingFindings(
    "b.xml", "", (), (VerdictFinding(file="b.xml", outcome="not_judged", because="it is empty"),)
)


def written(rules, form, *found):
    stream = io.BytesIO()
    writer = finding_writer(form, stream, FindingContext(rules, "9.9"), "f")
    for one in found:
        writer.add(one)
    writer.close()
    return stream.getvalue()


def test_json_lines_have_every_field(rules):
    lines = [json.loads(line) for line in written(rules, "jsonl", FOUND, BROKEN).splitlines()]
    assert [line["rule"] for line in lines] == ["slow", "distance", "distance", "quiet", ""]
    assert list(lines[0]) == ["version", *COLUMNS]
    assert lines[0]["by"] == 5.4
    assert lines[2]["open_on"] == ["gap"]
    assert lines[4]["because"] == "it is empty"


def test_csv_has_a_row_for_each_finding(rules):
    text = written(rules, "csv", FOUND, BROKEN).decode()
    head, *rows = csv.reader(io.StringIO(text, newline=""))
    assert head == list(COLUMNS)
    first = dict(zip(head, rows[0], strict=True))
    assert (first["rule"], first["from_s"], first["by"], first["unit"]) == (
        "slow",
        "0.5",
        "5.4",
        "km/h",
    )
    assert first["at_s"] == "0.75"
    # A number below 0 stays one.
    assert first["y"] == "-1.5"
    assert [row[head.index("outcome")] for row in rows] == [
        *("violated", "violated", "open", "not_judged", "not_judged"),
    ]


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "'=1", "\t=1", "\r=1"])
def test_no_cell_of_csv_is_a_formula(rules, text):
    found = RecordingFindings("f", "A", (text,), (of("slow", vehicle=text, other=(text, "x")),))
    head, row = csv.reader(io.StringIO(written(rules, "csv", found).decode(), newline=""))
    for cell in (row[head.index("vehicle")], row[head.index("other")]):
        assert cell[0] in "'\\"
        assert not re.match(r"[=+\-@\t\r]", cell)


def test_parquet_has_the_same_rows_with_types(rules):
    table = pyarrow.parquet.read_table(io.BytesIO(written(rules, "parquet", FOUND, BROKEN)))
    assert table.column_names == list(COLUMNS)
    rows = table.to_pylist()
    assert (rows[0]["by"], rows[0]["other"], rows[1]["other"]) == (5.4, [], ["3"])
    assert rows[3]["from_s"] is None


def test_junit_has_a_case_for_each_rule_and_drive(rules):
    root = ElementTree.fromstring(written(rules, "junit", FOUND, BROKEN))
    first, second = root.findall("testsuite")
    assert first.attrib == {
        "name": "a b.xml: A",
        "tests": "7",
        "failures": "1",
        "errors": "0",
        "skipped": "2",
    }
    cases = {(case.get("classname"), case.get("name")): case for case in first}
    assert list(cases) == [
        *(("tiny.slow", drive) for drive in "456"),
        *(("tiny.distance", drive) for drive in "456"),
        ("tiny", "quiet"),
    ]
    # A hard rule fails, a soft one is said, what is open or not judged is skipped
    assert cases["tiny.slow", "4"].find("failure").get("message") == SLOW.says
    assert (
        cases["tiny.distance", "4"].findtext("system-out") == "4 violates distance towards 3 at 1 s"
    )
    assert cases["tiny.distance", "4"].find("failure") is None
    assert cases["tiny.distance", "5"].find("skipped").get("message") == (
        "whether 5 violates distance towards 3 is open: depends on gap"
    )
    assert cases["tiny", "quiet"].find("skipped").get("message") == "not told: wet"
    kept = [key for key, case in cases.items() if not list(case)]
    assert kept == [("tiny.slow", "5"), ("tiny.slow", "6"), ("tiny.distance", "6")]
    assert second.find("testcase/error").get("message") == "it is empty"
    assert second.get("errors") == "1"


def test_sarif_has_results_for_what_is_violated_or_open(rules):
    document = json.loads(written(rules, "sarif", FOUND, BROKEN))
    (run,) = document["runs"]
    assert document["version"] == "2.1.0"
    assert [rule["id"] for rule in run["tool"]["driver"]["rules"]] == ["slow", "distance", "quiet"]
    assert [(one["ruleId"], one["kind"], one["level"]) for one in run["results"]] == [
        ("slow", "fail", "error"),
        ("distance", "fail", "warning"),
        ("distance", "open", "none"),
    ]
    for result in run["results"]:
        rule = run["tool"]["driver"]["rules"][result["ruleIndex"]]
        assert rule["id"] == result["ruleId"]
    (location,) = run["results"][0]["locations"]
    assert location["physicalLocation"]["artifactLocation"]["uri"] == "a%20b.xml"
    (invocation,) = run["invocations"]
    assert invocation["executionSuccessful"] is False
    notes = invocation["toolExecutionNotifications"]
    assert [note["level"] for note in notes] == ["note", "error"]
    properties = run["results"][0]["properties"]
    assert (properties["at_s"], properties["x"], properties["lanelet"]) == (0.75, 2.0, "7")
    assert location["properties"]["timeRegion"] == {"from_s": 0.5, "to_s": 2.5, "at_s": 0.75}
    assert "properties" not in run["results"][2]["locations"][0]
    assert "at 0.75 s (from 0.5 s to 2.5 s)" in run["results"][0]["message"]["text"]
    prints = [one["partialFingerprints"]["rulec/v1"] for one in run["results"]]
    assert len(set(prints)) == 3


def test_sarif_without_findings(rules):
    (run,) = json.loads(written(rules, "sarif"))["runs"]
    assert run["results"] == []
    assert run["invocations"][0]["executionSuccessful"] is True


def messages(content):
    reader = make_reader(io.BytesIO(content))
    found = {}
    for schema, channel, message in reader.iter_messages():
        assert channel.message_encoding == "json"
        assert json.loads(schema.data)["type"] == "object"
        found.setdefault(channel.topic, []).append((message.log_time, json.loads(message.data)))
    return found


def test_mcap_has_an_event_for_each_finding_with_a_time(rules):
    content = written(rules, "mcap", FOUND)
    found = messages(content)
    decided, one = 750_000_000, 1_000_000_000
    assert [(at, line["rule"]) for at, line in found["/rulec/findings"]] == [
        (decided, "slow"),
        (one, "distance"),
    ]
    assert [(at, line["level"]) for at, line in found["/rulec/log"]] == [(decided, 4), (one, 3)]
    assert found["/rulec/log"][0][1]["timestamp"] == {"sec": 0, "nsec": decided}
    # Of the other one nobody knows where it was.
    ((at, update),) = found["/rulec/scene"]
    (entity,) = update["entities"]
    assert (at, entity["frame_id"], entity["lifetime"]) == (
        decided,
        "global",
        {"sec": 1, "nsec": decided},
    )
    (label,) = entity["texts"]
    assert label["pose"]["position"] == {"x": 2.0, "y": -1.5, "z": 3.0}
    assert label["text"] == SLOW.says
    summary = make_reader(io.BytesIO(content)).get_summary()
    assert summary.statistics.message_count == 5
    assert {schema.name for schema in summary.schemas.values()} == {
        "rulec.Finding",
        "foxglove.Log",
        "foxglove.SceneUpdate",
    }
    (record,) = make_reader(io.BytesIO(content)).iter_metadata()
    assert record.metadata["not_judged"] == "quiet"


def test_messages_in_mcap_are_of_their_schemas(rules):
    reader = make_reader(io.BytesIO(written(rules, "mcap", FOUND)), validate_crcs=True)
    taken = set()
    for schema, channel, message in reader.iter_messages():
        jsonschema.validate(json.loads(message.data), json.loads(schema.data))
        taken.add(channel.topic)
    assert taken == {"/rulec/findings", "/rulec/log", "/rulec/scene"}


def test_mcap_without_events_is_a_whole_file(rules):
    assert messages(written(rules, "mcap", RecordingFindings("f", "A", ("4",), ()))) == {}
    assert messages(written(rules, "mcap")) == {}


def test_mcap_has_one_time_line(rules):
    with pytest.raises(RulecError, match="MCAP has one time line"):
        written(rules, "mcap", FOUND, FOUND)


@pytest.mark.parametrize("at_s", [2e10, 1e300])
def test_mcap_counts_no_centuries(rules, at_s):
    late = RecordingFindings("f", "A", ("4",), (of("slow", from_s=at_s, to_s=at_s),))
    with pytest.raises(RulecError, match="MCAP counts time in ns up to 584 years"):
        written(rules, "mcap", late)


def test_messages_in_mcap_are_found_by_their_time(rules):
    given = [of(name, from_s=at, to_s=9.0) for name, at in (("c", 3.0), ("a", 1.0), ("b", 2.0))]
    content = written(rules, "mcap", RecordingFindings("f", "A", ("4",), tuple(given)))
    reader = make_reader(io.BytesIO(content), validate_crcs=True)

    def told(**limits):
        found = reader.iter_messages(topics=["/rulec/findings"], log_time_order=False, **limits)
        return [json.loads(message.data)["rule"] for _, _, message in found]

    assert told() == ["a", "b", "c"]
    assert told(starting_at=1_500_000_000, ending_before=3_000_000_000) == ["b"]


@pytest.mark.parametrize("form", ENDINGS)
def test_hostile_names_do_no_harm(rules, form):
    evil = of("slow", vehicle=EVIL, other=(EVIL, "\ud800"), from_s=1.0, to_s=1.0, x=1.0, y=1.0)
    content = written(rules, form, RecordingFindings(EVIL, EVIL, (EVIL,), (evil,)))
    if form in ("parquet", "mcap"):
        assert content
        return
    text = content.decode("utf-8")
    # No control character, and nothing that is taken for an element of XML.
    assert not re.search("[\x00-\x08\x0b\x0c\x0e-\x1f]", text)
    if form == "junit":
        tags = {one.tag for one in ElementTree.fromstring(text).iter()}
        assert "b" not in tags
    if form == "csv":
        assert len(list(csv.reader(io.StringIO(text, newline="")))) == 2
    if form == "jsonl":
        assert json.loads(text)["vehicle"] == EVIL
    if form == "sarif":
        assert json.loads(text)["runs"][0]["results"][0]["properties"]["vehicle"] == EVIL


def read_back(form, content):
    """The fields of each violation that a reader of the format gets."""
    if form == "jsonl":
        return [json.loads(line) for line in content.splitlines()]
    if form == "csv":
        return list(csv.DictReader(io.StringIO(content.decode(), newline="")))
    if form == "parquet":
        return pyarrow.parquet.read_table(io.BytesIO(content)).to_pylist()
    if form == "sarif":
        (run,) = json.loads(content)["runs"]
        return [{"rule": one["ruleId"], **one["properties"]} for one in run["results"]]
    if form == "mcap":
        return [line for _, line in messages(content)["/rulec/findings"]]
    cases = ElementTree.fromstring(content).iter("testcase")
    failed = [case for case in cases if case.find("failure") is not None]
    return [
        {"rule": case.get("classname").partition(".")[2], "vehicle": case.get("name")}
        for case in failed
    ]


@pytest.mark.parametrize("form", ENDINGS)
def test_a_finding_is_read_back(rules, form):
    """One type stands behind all formats; JUnit has its rule, drive and sentence."""
    found = RecordingFindings("a b.xml", "A", ("4",), (SLOW,))
    content = written(rules, form, found)
    (read,) = read_back(form, content)
    named = {name: value for name, value in read.items() if name in COLUMNS}
    assert {"rule", "vehicle"} <= set(named)
    for name, value in named.items():
        own = getattr(SLOW, name)
        expected = {None: None, (): []}.get(own, own)
        if form == "csv":
            expected = {None: "", (): ""}.get(own, str(own))
        assert value == expected, name
    if form in ("jsonl", "csv", "parquet"):
        assert list(named) == list(COLUMNS)
    if form in ("sarif", "junit"):
        assert SLOW.says in unescape(content.decode())


def test_comparisons_of_several_units_are_compared_by_their_shares():
    slow = Margin("speed_difference(v)", 4.9, "<", 10.0, "km/h")
    near = Margin("lateral_gap(v)", 1.4, "<", 3.5, "m")
    # 2.1 m is the smaller number, but three fifths of 3.5 m; 5.1 km/h is half of 10 km/h.
    assert measured([near, slow])["unit"] == "km/h"


def test_comparisons_of_one_unit_are_compared_as_they_are():
    slow, fast = Margin("speed", 4.0, ">", 2.0, "km/h"), Margin("speed", 90.0, ">", 85.0, "km/h")
    # 5 km/h are a smaller share than 2 km/h here, but it is the 2 km/h that a driver has to lose.
    assert measured([fast, slow])["by"] == 2.0


def test_a_limit_of_nothing_is_a_limit():
    still, near = Margin("speed", 3.0, ">", 0.0, "km/h"), Margin("gap(v)", 2.0, "<", 8.0, "m")
    assert measured([near, still])["unit"] == "m"
    assert measured([still])["by"] == 3.0
