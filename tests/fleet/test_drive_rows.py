"""Rows of a fleet's table, counted by hand and held against what `verify` writes."""

import math
from dataclasses import replace

import pytest

import rulec
from rulec.extraction.traces.recorded_drive import Place
from rulec.fleet.drive_rows import DriveRows, driven_m, judged_by
from rulec.fleet.finding_columns import COLUMNS, arrow_schema, arrow_table
from rulec.monitoring.moments.drive_facts import facts_of
from rulec.monitoring.rulebook_edition import rulebook_hash
from support.builders.fleet_inputs import fleet_rules, lanes, tracks


@pytest.fixture(scope="module")
def judged(tmp_path_factory):
    """A recording in which two are too fast."""
    columns = tracks([0]) | {"recording": None}
    columns = {name: values for name, values in columns.items() if values}
    roads = lanes(tmp_path_factory.mktemp("roads"))
    recording = rulec.recording_from_columns(columns, roads, name="r000")
    rules = fleet_rules()
    return rulec.verify_recording(recording, rules), rules


@pytest.fixture(scope="module")
def rows(judged):
    verdicts, rules = judged
    by = judged_by(rules, verdicts.request)
    return list(DriveRows(rules, by).of_recording(verdicts, "r.parquet"))


def test_every_drive_has_its_row_and_one_for_each_rule(judged, rows):
    verdicts, rules = judged
    by_drive = verdicts.rows()
    drives = [row for row in rows if row["kind"] == "drive"]
    assert [row["ego"] for row in drives] == [row["ego"] for row in by_drive]
    assert len(drives) > 1
    for drive in drives:
        own = [x["rule"] for x in rows if x["kind"] == "rule" and x["vehicle"] == drive["vehicle"]]
        assert own == [rule.name for rule in rules.rules]


def test_a_row_of_a_rule_says_whether_it_is_violated(judged, rows):
    violated = {(x["trace"], rule) for x in judged[0].rows() for rule in x["violated"]}
    assert violated
    for kind in ("rule", "finding"):
        named = [x for x in rows if x["kind"] == kind and x["outcome"] == "violated"]
        assert {(x["vehicle"], x["rule"]) for x in named} == violated
        assert all(x["at_s"] is not None for x in named if kind == "finding")


def test_times_and_states_of_a_drive_fit_together(judged, rows):
    step_s = judged[0].recording.step_s
    for row in rows:
        if row["kind"] == "drive" and row["outcome"] != "not_judged":
            assert row["duration_s"] == pytest.approx(row["states"] * step_s)
            assert row["to_s"] - row["from_s"] == pytest.approx((row["states"] - 1) * step_s)
            # Nobody in it stands, and nobody drives faster than 50 m/s
            assert 0 < row["distance_m"] < 50 * row["duration_s"]


def drive_along(places, judged):
    drive = next(x.drive for x in judged[0].answers() if hasattr(x, "drive"))
    return replace(drive, places=tuple(Place(x, y, "") for x, y in places))


def test_distance_is_that_of_the_way_and_none_of_who_wavers(judged):
    quarter = [(10 * math.cos(k / 100), 10 * math.sin(k / 100)) for k in range(158)]
    assert driven_m(drive_along(quarter, judged)) == pytest.approx(15.7, rel=1e-3)
    standing = [(0.2 * (k % 2), 0.0) for k in range(100)]
    assert driven_m(drive_along(standing, judged)) <= 0.2
    assert driven_m(drive_along([], judged)) is None


def test_the_table_has_every_column_and_texts_that_utf8_has():
    table = arrow_table([{"kind": "drive", "vehicle": "half \ud800", "other": ("a",), "states": 3}])
    assert table.schema == arrow_schema()
    (row,) = table.to_pylist()
    assert list(row) == list(COLUMNS)
    assert row["vehicle"] == "half \\ud800"
    assert (row["rule"], row["by"], row["open_on"]) == ("", None, [])
    assert arrow_table([]).num_rows == 0


def test_a_hash_is_of_what_decides_verdicts(tmp_path, judged):
    rules = judged[1]
    path = rulec.write_compiled(rules, tmp_path)[-1]
    assert rulebook_hash(rulec.compile_rulebook(path)) == rulebook_hash(rules)
    reworded = replace(rules, rules=tuple(replace(x, says="in other words") for x in rules.rules))
    assert rulebook_hash(reworded) == rulebook_hash(rules)
    fewer = replace(rules, rules=rules.rules[1:])
    softer = replace(rules, rules=(replace(rules.rules[0], strength="soft"), *rules.rules[1:]))
    assert len({rulebook_hash(x) for x in (rules, fewer, softer)}) == 3


def test_choices_are_written_as_options_are(judged):
    wanted = rulec.RequestedDrives(
        thresholds=rulec.Thresholds(near_m=200.0, away_s=0.5),
        assumed={"built_up": True},
        defaults=True,
    )
    by = judged_by(judged[1], wanted)
    assert by.thresholds == "away_s=0.5; near_m=200"
    assert by.assumptions == "built_up=true; defaults"
    assert judged_by(judged[1], rulec.RequestedDrives()).columns() | {"rulebook_hash": ""} == {
        "rulebook": "fleet_rules",
        "rulebook_hash": "",
        "rulec": rulec.__version__,
        "thresholds": "",
        "assumptions": "",
    }


def test_rows_of_rules_have_opportunities_that_arrays_and_states_agree_on(judged, rows):
    """Two are too fast: each had one opportunity, its drive, and took it."""
    verdicts, _ = judged
    for answer in verdicts.answers():
        facts = facts_of(answer.drive.trace, verdicts.rules, answer.answer)
        assert facts == facts_of(answer.drive.arrays, verdicts.rules, answer.answer)
        own = facts.exposure
        for row in rows:
            if row["vehicle"] == answer.drive.trace.id and row.get("rule") in own:
                if row["kind"] != "rule":
                    continue
                assert row["opportunities"] == own[row["rule"]].opportunities
                assert (row["violated"] > 0) is (row["outcome"] == "violated")
    assert sum(row.get("violated", 0) for row in rows if row["kind"] == "rule") == 2
