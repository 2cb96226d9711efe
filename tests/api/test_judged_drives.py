"""One `verify` for traces, files of them and recordings, and results that can be asked."""

import csv
import io
import json
import re

import numpy as np
import pytest

import rulec
from rulec.cli.main import main
from rulec.report.findings.verdict_finding import COLUMNS

FOLLOWING, TRACES = "docs/samples/following.xml", "docs/samples/traces.jsonl"


@pytest.fixture(scope="module")
def found():
    return rulec.verify(FOLLOWING, "de")


@pytest.fixture(scope="module")
def traced():
    return rulec.verify(TRACES, "esterle2019")


def plain(verdict):
    return [(x.rule, x.binding, x.step) for x in verdict.violations]


def test_drives_have_the_verdicts_that_they_have_one_by_one(found):
    each = {one.drive.arrays.id: one.answer for one in rulec.verify_recording(FOLLOWING, "de")}
    assert list(found) == list(each)
    assert {name: plain(found[name]) for name in found} == {
        name: plain(verdict) for name, verdict in each.items()
    }
    assert len(found) == 6
    assert found.violated == tuple(name for name in each if each[name].satisfied is False)


def test_traces_have_the_verdicts_that_they_have_one_by_one(traced):
    traces = list(rulec.read_traces(TRACES))
    assert list(traced) == [trace.id for trace in traces]
    for trace in traces:
        assert traced[trace.id] == rulec.verify(trace, "esterle2019")
    assert traced.violated == ("t1",)


def test_a_recording_that_has_been_read_is_judged_like_its_file(found):
    read = rulec.verify(rulec.read_recording(FOLLOWING), "de")
    assert [one.says for one in read.findings] == [one.says for one in found.findings]


def test_findings_are_those_that_the_command_writes(found, capsys):
    assert main(["verify", FOLLOWING, "-r", "de", "--output-format", "csv"]) == 1
    written = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [row["rule"] for row in written] == [one.rule for one in found.findings]
    violated = [row for row in written if row["outcome"] == "violated"]
    for row, own in zip(violated, found.rows(), strict=True):
        assert list(own) == list(COLUMNS) == list(row)
        assert (row["vehicle"], row["measure"]) == (own["vehicle"], own["measure"])
        assert (row["rulebook_hash"], row["sentence"]) == (own["rulebook_hash"], own["sentence"])


def test_a_finding_says_what_it_is_about(found):
    first = found.violations()[0]
    assert first.law == "Straßenverkehrs-Ordnung (StVO)"
    assert first.sentence.startswith("Follow at a distance")
    # 1 is behind 2 by less than its own stopping distance exceeds that of 2
    assert (first.value < first.limit, first.unit) == (True, "m")
    assert first.by == pytest.approx(first.limit - first.value, abs=0.1)
    assert 0 < first.by_at_least < first.by
    shown = repr(first).removeprefix("VerdictFinding(").removesuffix("…)")
    assert first.says.startswith(shown)


def test_what_a_violation_rests_on(found):
    rests = {one.rule: one.rests_on for one in found.violations()}
    # Whether somebody waves ego on, no recording says
    assert rests == {"following_distance": "measured", "give_way_to_pedestrians": "default"}
    wanted = rulec.RequestedDrives(assumed={"told_to_go": False})
    assumed = rulec.verify(FOLLOWING, "de", wanted=wanted).violations()
    assert {one.rule: one.rests_on for one in assumed} == {
        "following_distance": "measured",
        "give_way_to_pedestrians": "assumed",
    }


def test_the_summary_is_what_the_command_prints(found, capsys):
    main(["verify", FOLLOWING, "-r", "de"])
    printed = capsys.readouterr().out.splitlines()
    # But for options of the command
    kept = [line for line in found.summary().splitlines() if "would let" not in line]
    assert [line for line in printed if line in kept] == kept
    assert max(map(len, found.summary(60).splitlines())) <= 60


def test_every_rule_of_the_book_is_named_once(found, capsys):
    """By Python, and by the command that is asked why."""
    outcomes = found.outcomes()
    assert {*outcomes} == {rule.name for rule in rulec.compile_rulebook("de").rules}
    broken = {one.rule for one in found.violations()}
    assert {rule for rule, outcome in outcomes.items() if outcome == "found"} == broken
    # Nobody in it is a tram, and six cars follow each other
    assert outcomes["following_distance_behind_rail_vehicles"] == "idle"
    assert outcomes["solid_line"] == "nothing found"
    main(["verify", FOLLOWING, "-r", "de", "--why"])
    words = re.findall(r"[a-z_]+", capsys.readouterr().out)
    # Some rules are called like the word that they lack
    declared = rulec.compile_rulebook("de").vocabulary.declarations
    for rule, outcome in outcomes.items():
        assert words.count(rule) == 1 or rule in declared, (rule, outcome)


def test_json_names_every_rule_of_each_drive(found, capsys):
    main(["verify", FOLLOWING, "-r", "de", "--why", "--json"])
    rules, in_every = {rule.name for rule in rulec.compile_rulebook("de").rules}, []
    for line in capsys.readouterr().out.splitlines():
        drive = json.loads(line)
        doubtful = {one["rule"] for name in ("open", "not_judged") for one in drive[name]}
        assert doubtful | {*drive["judged"]} == rules
        assert doubtful.isdisjoint(drive["judged"])
        assert {*drive["idle"]} <= {*drive["judged"]}
        assert not {one["rule"] for one in drive["violations"]} & {*drive["idle"]}
        in_every.append({*drive["idle"]})
    idle = {rule for rule, outcome in found.outcomes().items() if outcome == "idle"}
    assert idle <= set.union(*in_every)


def test_a_violation_is_explained_and_drawn(found, traced):
    for result in (found, traced):
        for finding in result.violations():
            explained = result.explain(finding)
            assert explained.rule.name == finding.rule
            assert [str(margin) for margin in explained.margins()][:1] in ([], [finding.measure])
        with pytest.raises(ValueError, match="no violation of these"):
            result.explain(rulec.VerdictFinding(file="", outcome="violated", rule="other"))
    assert found.draw(found.worst).startswith(b"<svg")
    assert found.draw("1") == rulec.draw_drive(FOLLOWING, "de", "1")
    assert found.draw() == rulec.draw_drive(FOLLOWING, "de")
    assert traced.draw("t1") == traced.draw(traced.worst)


def test_the_worst_is_hard_and_misses_its_limit_by_the_largest_share(found, traced):
    shares = {one.vehicle: one.by / one.limit for one in found.violations() if one.by is not None}
    assert found.worst.vehicle == max(shares, key=shares.get)
    assert traced.worst.rule == "R1"
    assert rulec.verify("docs/samples/passing.fcd.xml", "de").worst is None


def test_as_a_table(found):
    rows = found.rows()
    assert found.to_arrow().to_pylist() == rows
    # 1 follows 2, 6 follows 3; 7 walks
    assert [(row["vehicle"], row["other"]) for row in rows] == [
        ("1", "2"),
        ("1", "7"),
        ("2", "7"),
        ("6", "3"),
    ]
    assert len(found.findings.to_arrow()) == len(found.findings)


def test_results_say_in_a_line_what_was_found(found, traced):
    assert repr(found) == "JudgedDrives(de: 3 of 6 drives broke a hard rule)"
    assert repr(traced) == "JudgedTraces(esterle2019: 1 of 2 traces broke a hard rule)"
    assert repr(found.violations()) == "FindingRows(4 findings of 2 rules)"


def test_of_many_violations_of_one_drive_the_rest_is_counted():
    book = rulec.parse_rulebook(
        "rulebook alone\nuse road\nhard rule alone (v: vehicle) { require never gap(v) >= 0 m }\n"
    )
    result = rulec.verify(FOLLOWING, book, wanted=rulec.RequestedDrives(egos=("1",)))
    number = len(result.violations())
    assert number > 3
    lines = result.summary().splitlines()
    assert f"    and {number - 2} more of the same drives" in lines
    assert sum(line.startswith("    1  ") for line in lines) == 2


def test_what_is_open_is_no_violation_in_a_picture():
    """From 36 km/h by 8 m/s² ego comes to 266 km/h in the four seconds that are recorded."""
    t = 0.5 * np.arange(9)
    street = rulec.build_lanelet("street", [(0, 0), (400, 0)], types=["urban"])
    ego = rulec.build_participant("ego", "car", t, 20 + 10 * t + 4 * t**2, 0 * t, step_s=0.5)
    recording = rulec.build_recording([street], [ego], step_s=0.5, side="right")
    book = rulec.parse_rulebook(
        "rulebook hasty\nuse road\n"
        "hard rule quick { require eventually[<= 10 s] speed > 300 km/h }\n"
        "hard rule slow { require always speed <= 40 km/h }\n"
    )
    result = rulec.verify(recording, book)
    assert [one.rule for one in result["ego"].open] == ["quick"]
    (violation,) = result.violations()
    assert violation.rule == "slow"
    assert b"ego: 1 violation, 1 open by hasty" in result.draw("ego")
    assert result.draw("ego") == rulec.draw_drive(recording, book, "ego")


def test_traces_of_one_name_and_bad_ones(tmp_path):
    good = {"id": "t", "states": [{"position": {"v": "b"}}], "objects": {"v": "vehicle"}}
    steps = [{"position": {"v": one}} for one in "brrf"]
    lines = [good, {**good, "states": steps}, {**good, "id": "u", "states": 3}]
    file = tmp_path / "t.jsonl"
    file.write_text("".join(f"{json.dumps(line)}\n" for line in lines))
    result = rulec.verify(file, "esterle2019")
    assert list(result) == ["t", "t (2)", ""]
    assert result.violated == ("t (2)",)
    assert isinstance(result[""], rulec.NotJudged)
    (violation,) = result.violations()
    assert result.explain(violation).decisive == 3
    assert [one.outcome for one in result.findings] == ["violated", "not_judged"]
    assert result.summary().splitlines()[-1] == "3 traces: 1 satisfied, 1 violated, 1 not judged"


def test_arguments_of_the_other_kind_are_refused():
    with pytest.raises(ValueError, match="a recording takes `wanted`"):
        rulec.verify(FOLLOWING, "de", rulec.Assumptions(ends="cut"))
    with pytest.raises(ValueError, match="this is a file of traces"):
        rulec.verify(TRACES, "esterle2019", map_path=FOLLOWING)
    with pytest.raises(TypeError, match="not int"):
        rulec.verify(3, "de")


def test_a_monitor_takes_the_name_of_a_rulebook():
    by_name, compiled = rulec.Monitor("esterle2019"), rulec.compile_rulebook("esterle2019")
    same = rulec.Monitor(compiled)
    for monitor in (by_name, same):
        for one in "brrf":
            monitor.step({"position": {"v": one}}, {"v": "vehicle"})
    assert by_name.violations == same.violations
    assert by_name.snapshot() == same.snapshot()


def test_the_best_path_is_the_best_candidates():
    world = rulec.TrafficWorld(rulec.read_recording(FOLLOWING), "3", now_s=2.0)
    further = np.array([[[0, 0, 0, 0], [5, 0, 0, 0]], [[3, 0, 0, 0], [6, 0, 0, 0]]])
    paths = world.past[-1] + further
    scores = rulec.score(paths, world, "de", after=world.past)
    assert (scores.best_path == scores.paths[scores.best]).all()
