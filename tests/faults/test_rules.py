"""Judging a rule raises: it costs that rule, on the traces on which it does."""

import json
from dataclasses import replace

import pytest

import rulec
from rulec.api.rulebook_compilation import machines
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.stacked import stacked_run
from rulec.monitoring.online import running_monitor
from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun

GERMAN = machines("de")
PAPER = machines("esterle2019")
RECORDING = rulec.read_recording("docs/samples/following.xml")
SAMPLE = "docs/samples/traces.jsonl"


def said(verdict, but=()):
    found = (*verdict.violations, *verdict.open, *verdict.not_judged)
    return [own for own in found if own.rule not in but]


@pytest.mark.parametrize("rule", ["following_distance", "speed_limit", "give_way_to_pedestrians"])
def test_on_arrays(monkeypatch, rule):
    before = list(rulec.verify_recording(RECORDING, GERMAN))
    outcomes = stacked_run.outcomes

    def broken(own, *others):
        if own.rule.name == rule:
            raise ValueError("planted")
        return outcomes(own, *others)

    monkeypatch.setattr(stacked_run, "outcomes", broken)
    for known, after in zip(before, rulec.verify_recording(RECORDING, GERMAN), strict=True):
        lost = [own.rule for own in after.answer.not_judged if own.by_fault]
        assert lost in ([], [rule])
        assert said(after.answer, lost) == said(known.answer, lost)
        assert bool(lost) == bool(after.answer.faults)


def planted_in_runs(monkeypatch, book, rule):
    """Every engine for traces raises for a rule."""
    monkeypatch.setattr(
        "rulec.monitoring.batch.batch_verify.verify_cells",
        lambda *_, **__: (_ for _ in ()).throw(RecursionError("planted")),
    )
    answer, outcomes = UncertainRun._answer, stacked_run.outcomes

    def broken_answer(self, own, *others):
        if own.name == rule:
            raise RecursionError("planted")
        return answer(self, own, *others)

    def broken_outcomes(own, *others):
        if own.rule.name == rule:
            raise RecursionError("planted")
        return outcomes(own, *others)

    monkeypatch.setattr(UncertainRun, "_answer", broken_answer)
    monkeypatch.setattr(stacked_run, "outcomes", broken_outcomes)


of_both_ends = pytest.mark.parametrize("ends", ["complete", "cut"])


@of_both_ends
@pytest.mark.parametrize("copies", [1, 4])
def test_on_traces(monkeypatch, ends, copies):
    traces = [replace(one, ends=ends) for one in rulec.read_traces(SAMPLE)] * copies
    before = list(rulec.verify_many(traces, PAPER))
    rule = PAPER.rules[0].name
    planted_in_runs(monkeypatch, PAPER, rule)
    for known, after in zip(before, rulec.verify_many(traces, PAPER), strict=True):
        assert {own.rule for own in after.not_judged if own.by_fault} == {rule}
        assert said(after, [rule]) == said(known, [rule])
    one = rulec.verify(traces[0], PAPER)
    assert [own.rule for own in one.not_judged] == [rule]
    assert one.satisfied in (None, False)


@of_both_ends
def test_the_command_names_it_and_ends_with_2(monkeypatch, capsys, ends):
    rule = PAPER.rules[0].name
    planted_in_runs(monkeypatch, PAPER, rule)
    monkeypatch.setattr("rulec.cli.commands.traffic.verify.read_machines", lambda *_: PAPER)
    assert main(["verify", SAMPLE, "-r", "esterle2019", "--json", "--end", ends]) == 2
    out, err = capsys.readouterr()
    for line in map(json.loads, out.splitlines()):
        assert [own["rule"] for own in line["not_judged"]] == [rule]
        assert line["faults"][0]["code"] == "R0790"
    assert f"`{rule}` in `t1`: a fault of rulec" in err
    assert "RecursionError planted" in err
    assert "Traceback" not in err


def test_the_traceback_is_there_on_request(monkeypatch, capsys):
    planted_in_runs(monkeypatch, PAPER, PAPER.rules[0].name)
    monkeypatch.setattr("rulec.cli.commands.traffic.verify.read_machines", lambda *_: PAPER)
    monkeypatch.setenv("RULEC_TRACEBACK", "1")
    assert main(["verify", SAMPLE, "-r", "esterle2019"]) == 2
    assert "Traceback" in capsys.readouterr().err


def test_a_monitor_refuses_the_state_and_stays_as_it_was(monkeypatch):
    monitor = rulec.Monitor(PAPER)
    trace = next(iter(rulec.read_traces(SAMPLE)))
    monitor.step(trace.states[0], trace.objects)
    before = monitor.snapshot()
    with monkeypatch.context() as patched:
        patched.setattr(running_monitor, "take_step", lambda *_: {}["planted"])
        with pytest.raises(RulecError) as caught:
            monitor.step(trace.states[1], trace.objects)
    assert caught.value.diagnostics[0].code == "R0790"
    assert monitor.snapshot() == before
    assert monitor.step(trace.states[1], trace.objects).state == 1


def test_what_is_no_fault_stays_what_it_is(monkeypatch):
    trace = replace(next(iter(rulec.read_traces(SAMPLE))), ends="complete")
    for problem in (KeyboardInterrupt(), BrokenPipeError()):

        def broken(*_, problem=problem):
            raise problem

        monkeypatch.setattr("rulec.monitoring.batch.verify.StackedRun", broken)
        with pytest.raises(type(problem)):
            rulec.verify(trace, PAPER)
