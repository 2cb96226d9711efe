"""Every public value survives pickle, copies and processes, and shows itself briefly."""

import copy
import inspect
import json
import pickle
import re
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path
from tempfile import mkdtemp

import numpy as np
import pytest

import rulec
from rulec.logic.formula import Comparison
from rulec.resources import install_command

TRACES = "docs/samples/traces.jsonl"
RECORDING = Path("docs/samples/passing.fcd.xml")
NET = Path("docs/samples/passing.net.xml")


@cache
def values():
    """One value of every public type, by its name."""
    tmp = Path(mkdtemp())
    book = rulec.load_rulebook("esterle2019")
    rules = rulec.compile_rulebook("esterle2019")
    traces = list(rulec.read_traces(TRACES))
    verdict = next(one for one in rulec.verify_many(traces, rules) if one.violations)
    trace = next(one for one in traces if one.id == verdict.trace)
    graph = rulec.navigation_graph("s2", step_s=0.5)
    maneuvers = rulec.find_maneuvers("s2", rules, step_s=0.5)
    monitor = rulec.Monitor(rules)
    monitor.step({"position": {"v1": "b"}}, {"v1": "vehicle"})
    so_far = monitor.step({"position": {"v1": "f"}}, {"v1": "vehicle"})
    recording = rulec.read_recording(RECORDING, NET)
    judged = rulec.verify_recording(recording, "de")
    all_drives = rulec.verify(recording, "fr")
    drive = next(one for one in judged.answers() if isinstance(one, rulec.DriveVerdict))
    audit = rulec.audit("de")
    diff = rulec.diff("de", "gb", patterns=["crossing_overtaking*"])
    run = rulec.test("esterle2019")
    lineage = rulec.tree("de")
    behind = {"position": {"v1": "b"}}
    cells = rulec.TraceCells(rulec.layout_of([1]), np.array([0]), (behind,), {"v1": "vehicle"})
    position = np.array([0, 0, 3, 1], dtype=np.uint8)
    columns = rulec.TraceColumns(
        rulec.layout_of([2, 2]), {("position", ("v1",)): position}, {"v1": "vehicle"}
    )
    with pytest.raises(rulec.RulecError) as caught:
        rulec.load_rulebook("no_such_book")
    error = caught.value
    bad_text = "rulebook a signal p hard rule r { require p or q }"
    with pytest.raises(rulec.RulecError) as caught:
        rulec.parse_rulebook(bad_text)
    mistake = caught.value.diagnostics[0]
    page = Path("docs/ranking.md").read_text(encoding="utf-8")
    scenario = tmp / "kerb.toml"
    scenario.write_text(
        next(block for block in page.split("```") if "obstacle.prediction" in block).split("\n", 1)[
            1
        ]
    )
    alternatives = rulec.find_maneuvers(scenario, rules, horizon_s=2)
    probabilities = rulec.rule_probabilities(alternatives, alternatives.cheapest(1)[0])
    example = next(rule.examples[0] for rule in book.rules if rule.examples)
    (first,) = maneuvers.ranked(1)
    audited = rulec.audit_source("de", "sumo")
    ranged = rulec.VerdictRange("violated", "holds so far")
    undecided = rulec.OpenVerdict("r", "hard", {"v": "1"}, ("not told",), ("p",))
    found = tmp / "found.jsonl"
    drive_row = {"kind": "drive", "vehicle": "7", "outcome": "kept", "duration_s": 1800}
    rule_row = {"kind": "rule", "vehicle": "7", "rule": "r", "opportunities": 10, "violated": 1}
    found.write_text("".join(f"{json.dumps(row)}\n" for row in (drive_row, rule_row)))
    rates = rulec.rates_of_findings(found)
    moments = next(rulec.find("(v: vehicle) b(v)", traces, "esterle2019"))
    world = rulec.TrafficWorld(recording, judged.egos[0])
    scores = rulec.score(world.past[None, -2:] + (1.0, 0, 0, 0), world, "de", world.past)
    known = [
        *(rulec.Session(), mistake, mistake.place, error, rulec.explain("R0104")),
        *(rulec.Label(mistake.place, "here"), rulec.Fix(mistake.place, "p"), book.vocabulary),
        rulec.Offer("Write `p`", (rulec.Fix(mistake.place, "p"),)),
        *(example, book.rules[0], book),
        *(book.rules[0].variables[0], rulec.check("esterle2019"), rules.rules[0], rules),
        *(rules.rules[0].machine, trace, maneuvers.paths, cells, columns, verdict),
        *(
            verdict.violations[0],
            rulec.NotJudged("t", error),
            rulec.verify_columns(columns, rules)[0],
            rulec.verify_cells(cells, rules)[0],
        ),
        *(rulec.explain(verdict.violations[0], trace, rules), monitor, so_far, so_far.changes[0]),
        *(graph, graph.layers[0], graph.layers[0].cells[0], rulec.envelopes(maneuvers)[0][0]),
        *(maneuvers, maneuvers.prunings()[0], first, first.maneuver, maneuvers.classes()),
        *(maneuvers.variants(1)[0], rulec.load_scenario("s2"), rulec.Choice(), recording, judged),
        *(drive, drive.drive, rulec.NoDrive("1", "it stands"), rulec.RequestedDrives()),
        rulec.RecordingSource(Path(RECORDING)),
        *(rulec.RequestedDrives().thresholds, recording.participants[0], audit, audit.counts),
        *(
            audit.findings[0],
            audit.articles[0],
            audit.provisions[0],
            diff,
            diff.pairs[0],
            diff.pairs[0].comparison,
        ),
        *((*diff.only_first, *diff.only_second)[0], run, run.outcomes[0], lineage),
        *(lineage.rules[0], rulec.coverage(run)[0], rulec.list()[0], probabilities),
        *(probabilities.rules[0], rulec.alternative_counts(alternatives)[0]),
        next(iter(recording.lanelets.values())),
        next(iter(recording.participants[0].states.values())),
        rulec.PlanningProblem("1", 0, next(iter(recording.participants[0].states.values())), ()),
        rulec.PenaltyRank("soft", ("",)),
        rulec.verify_compiled(rulec.write_compiled(rules, tmp)[-1])[0],
        *(audited, audited.rules[0], rulec.Interval(1.0, 2.0), ranged),
        *(rulec.Assumptions("cut", {"p": True}), rulec.RuleNotJudged("r", "hard", ("p",))),
        *(rulec.ConditionalOutcome({"p": True}, "kept"), undecided),
        rulec.UncoveredEdge(0, 1, (), True),
        rulec.UntouchedLimit(
            Comparison((), ">", Fraction(5), "speed > 5 km/h"),
            True,
            rulec.UncoveredEdge(0, 1, (), True),
        ),
        *(rulec.formats()[0], rulec.Light(0, (("red", 3),)), rulec.ObservedLight({0: "red"})),
        *(rulec.Weather(wet=True), rulec.read_map(NET, recording.step_s)),
        rulec.SettingPair("option", "limit", "1", "2"),
        *(rates, rates.rules[0], rates.rules[0].per_hour, rates.judged_by[0]),
        *(moments, moments.moments[0]),
        *(world, scores, scores.candidates[0], scores.margins(0)[0]),
        *(all_drives, all_drives.findings, all_drives.findings[0], rulec.verify(TRACES, rules)),
    ]
    return {type(one).__name__: one for one in known}


PUBLIC_TYPES = [name for name in rulec.__all__ if inspect.isclass(getattr(rulec, name))]


def same(one, other):
    """Are two values of one type the same in what they show?"""
    if isinstance(one, Mapping):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if type(one) is not type(other):
        return False
    if isinstance(one, rulec.RulecError):
        return one.diagnostics == other.diagnostics
    if isinstance(one, rulec.Monitor):
        return one.snapshot() == other.snapshot() and one.so_far == other.so_far
    if isinstance(one, rulec.NotJudged):
        return one.trace == other.trace and same(one.error, other.error)
    if isinstance(one, rulec.Maneuvers):
        return one.rows() == other.rows() and one.classes() == other.classes()
    if isinstance(one, rulec.RecordingVerdicts):
        return list(one.answers()) == list(other.answers())
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if is_dataclass(one):
        return all(
            same(getattr(one, field.name), getattr(other, field.name))
            for field in fields(one)
            if field.compare
        )
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other or (type(one).__eq__ is object.__eq__ and repr(one) == repr(other))


@pytest.mark.parametrize("name", PUBLIC_TYPES)
def test_every_public_value_survives(name):
    value = values()[name]
    assert same(value, pickle.loads(pickle.dumps(value)))
    assert same(value, copy.deepcopy(value))
    assert same(value, copy.copy(value))


@pytest.mark.parametrize("name", PUBLIC_TYPES)
def test_every_public_value_is_shown_in_one_short_line(name):
    text = repr(values()[name])
    assert len(text) < 200
    assert "\n" not in text
    assert " at 0x" not in text


ROWS = [name for name in PUBLIC_TYPES if hasattr(getattr(rulec, name), "rows")]


@pytest.mark.parametrize("name", ROWS)
def test_rows_are_plain_and_become_arrow_and_html(name):
    value = values()[name]
    rows = value.rows()
    assert all(type(row) is dict and row.keys() == rows[0].keys() for row in rows)
    table = value.to_arrow()
    assert table.num_rows == len(rows)
    assert not rows or table.column_names == list(rows[0])
    assert value._repr_html_().count("<tr>") == (len(rows) + 1 if rows else 0)


def test_what_has_rows():
    assert {"Verdict", "Maneuvers", "RulebookDiff", "Audit", "Checked", "ExampleRun"} < set(ROWS)
    assert {"Rulebook", "CompiledRulebook", "RulecError", "RecordingVerdicts"} < set(ROWS)


def test_html_escapes():
    violation = rulec.Violation("<b>", "hard", {"v": "<script>"}, 0)
    text = rulec.Verdict("<i>", (violation,))._repr_html_()
    assert "<script>" not in text
    assert "<b>" not in text
    assert "&lt;script&gt;" in text


def test_without_pyarrow_the_way_out_is_said(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(ImportError, match=re.escape(install_command("parquet"))):
        values()["Verdict"].to_arrow()


def test_a_process_pool():
    """Spawned, so that all that goes there and back is pickled; an error does not break it."""
    rules, trace = values()["CompiledRulebook"], values()["Trace"]
    judge = partial(rulec.verify, rules=rules)
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        assert pool.submit(judge, trace).result() == rulec.verify(trace, rules)
        with pytest.raises(rulec.RulecError) as caught:
            pool.submit(judge, replace(trace, step_s=0.0)).result()
        assert caught.value.diagnostics[0].code == "R0501"
        maneuvers = pool.submit(rulec.find_maneuvers, "s1", rules).result()
        assert maneuvers.satisfying == rulec.find_maneuvers("s1", rules).satisfying


def test_verdicts_on_a_recording_and_its_drives_are_gone_through():
    judged = rulec.verify_recording(RECORDING, "esterle2019", map_path=NET)
    assert [one.drive.trace.id for one in judged] == [one.trace.id for one in judged.drives]
    assert [one.answer.trace for one in judged] == ["f.0", "g.0"]
    assert "_drives_of" not in repr(judged.drives)


def test_a_compiled_rulebook_fits_itself_to_a_step_after_it_was_pickled():
    rules = pickle.loads(pickle.dumps(rulec.compile_rulebook("de")))
    assert {rule.step_s for rule in rules.at_step(0.1).rules} >= {None}
    answers = rulec.verify_recording(RECORDING, rules, map_path=NET).answers()
    assert not any(
        isinstance(one, rulec.DriveVerdict) and isinstance(one.answer, rulec.NotJudged)
        for one in answers
    )
