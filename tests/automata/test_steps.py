"""Rules with bounds in seconds: a machine for each step, about the states that there are."""

from dataclasses import replace
from fractions import Fraction
from math import nextafter

import pytest

from rulec import compile_rulebook, explain, find_maneuvers, verify_many
from rulec.api.rulebook_compilation import machines
from rulec.automata import compiler, step_compilation
from rulec.automata.compiler_jobs import Failed
from rulec.automata.step_compilation import StepCompiler
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.formula import Bound, Unary, UnaryOperator
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.planning.product.possible_instances import instances
from rulec.resource_limits import COMPILING, in_force
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace, TraceGraph
from rulec.vocabulary import Signal, Vocabulary
from support.builders.rulebooks import P, Q, always, book, both, eventually, implies, rule
from support.remembered_machines import ASKED

HALF, ONE = Fraction(1, 2), Fraction(1)


def within(seconds, formula):
    return Unary(UnaryOperator.EVENTUALLY, formula, Bound(Fraction(0), Fraction(seconds), "s"))


ANSWERED = rule("answered", always(implies(P, within(1, Q))))
PLAIN = rule("plain", always(implies(P, Q)), strength="soft")
BOOK = book(ANSWERED, PLAIN)


def trace(text, step_s):
    """``"p.q"``: in each state `p`, `q` or neither."""
    states = tuple({"p": letter == "p", "q": letter == "q"} for letter in text)
    return Trace("t", step_s, {}, states, place=SourceLocation("t.jsonl", 3))


def violated(verdict):
    return [one.rule for one in verdict.violations]


@pytest.mark.parametrize(
    ("step_s", "text", "kept"),
    [
        (1.0, "pq", True),
        (1.0, "p.q", False),
        (0.5, "p.q", True),
        (0.5, "p..q", False),
        (0.25, "p...q", True),
        (0.1, "p" + 9 * "." + "q", True),
        (0.1, "p" + 10 * "." + "q", False),
    ],
)
def test_seconds_are_seconds_whatever_the_step(step_s, text, kept):
    every = machines(BOOK)
    assert ("answered" in violated(verify(trace(text, step_s), every))) is not kept
    # As for a rulebook that was compiled for this step from the start.
    rules = compile_rulebook(BOOK, step_s=step_s)
    assert verify(trace(text, step_s), rules) == verify(trace(text, step_s), every)


def test_the_machine_of_another_step_does_not_judge():
    rules = compile_rulebook(BOOK, step_s=1)
    with pytest.raises(RulecError) as caught:
        verify(trace("pq", 0.5), rules)
    (problem,) = caught.value.diagnostics
    assert problem.code == "R0507"
    assert problem.message == (
        "rule `answered` was compiled for steps of 1 s; the trace has steps of 0.5 s"
    )
    assert problem.help == "compile its source with `step_s=0.5`"
    assert problem.place == SourceLocation("t.jsonl", 3)


def test_without_bounds_in_seconds_one_machine_judges_all():
    rules = compile_rulebook(book(PLAIN), step_s=1)
    assert rules.rules[0].step_s is None
    assert violated(verify(trace("pq", 0.5), rules)) == ["plain"]
    assert machines(book(PLAIN)).rules == rules.rules


def test_a_step_is_the_decimal_that_is_written():
    """0.1 s is a tenth: ten steps are a second, though the float is a little more than a tenth."""
    rules = compile_rulebook(BOOK, step_s=0.1)
    assert rules.rules[0].step_s == Fraction(1, 10)
    assert isinstance(verify(trace("p", 0.1), rules), Verdict)


@pytest.mark.parametrize("base", [0.5, 0.1, 0.04])
def test_a_step_that_is_nearly_another_is_not_that_one(base):
    """However near it is: the decimal that a float stands for is taken, not one around it."""
    nearly = [base * (1 + share) for share in (1e-12, 1e-9, 1e-6, 1e-5, 2e-5, 5e-5, 1e-4)]
    for step_s in (*nearly, nextafter(base, 0), nextafter(base, 9), 2 * base - nearly[1]):
        assert exact_step(step_s) == Fraction(repr(step_s)) != Fraction(repr(base))
    assert exact_step(base) == Fraction(repr(base))


@pytest.mark.parametrize("rate", [3, 7, 24, 30, 60, 120, 999])
def test_the_float_nearest_to_a_frame_rates_step_is_that_step(rate):
    """As recordings and their traces have it; but not what is written with fewer digits."""
    assert exact_step(1 / rate) == Fraction(1, rate)
    assert exact_step(1001 / (1000 * rate)) == Fraction(1001, 1000 * rate)
    assert exact_step(round(1 / rate, 9)) == Fraction(f"{1 / rate:.9f}")


@pytest.mark.parametrize(
    ("text", "lost"),
    [
        ("p..q", []),  # after 0.9 s
        ("p...q", ["answered"]),  # not after 0.9 s, but after 1.2 s
        ("p....q", ["answered"]),
    ],
)
def test_where_a_bound_is_no_multiple_of_the_step_the_states_that_there_are_decide(text, lost):
    for rules in (machines(BOOK), machines(book(ANSWERED))):
        for verdict in (
            verify(trace(text, 0.3), rules),
            *verify_many([trace(text, 0.3)] * 9, rules),
        ):
            assert [one for one in violated(verdict) if one != "plain"] == lost
            assert verdict.open == ()


def test_nothing_is_exactly_as_far_away_as_no_state_is():
    next_one = Unary(UnaryOperator.NEXT, Q, Bound(ONE, ONE, "s"))
    rules = machines(book(rule("exact", always(implies(P, next_one)))))
    for text, step_s, lost in (
        ("p.q", 0.5, []),
        ("p..qq", 0.3, ["exact"]),
        ("pqqqqq", 2.0, ["exact"]),
    ):
        assert violated(verify(trace(text, step_s), rules)) == lost


def test_duties_at_least_a_time_away_begin_at_the_first_state_that_far():
    later = Unary(UnaryOperator.EVENTUALLY, Q, Bound(ONE, None, "s"))
    rules = machines(book(rule("later", always(implies(P, later)))))
    assert violated(verify(trace("p..q.", 0.3), rules)) == ["later"]  # 0.9 s
    assert violated(verify(trace("p...q.", 0.3), rules)) == []


def test_rules_that_were_left_out_stay_out_where_a_step_does_not_fit():
    both = machines(BOOK)
    answered = replace(both, rules=tuple([own for own in both.rules if own.name == "answered"]))
    assert [own.name for own in answered.judgeable_at(0.3).rules] == ["answered"]
    assert violated(verify(trace("pq", 0.3), answered)) == []
    assert both.fitted_to(0.3) is both.fitted_to(0.3)


LARGE = """rulebook large
signal p, q
hard rule large { require always (p implies eventually[<= 100 s] q) }
soft rule plain { require always (p implies q) }
"""
MILLISECOND = Fraction(1, 1000)


@pytest.mark.parametrize("step_s", [MILLISECOND, Fraction(3, 10_000)])
def test_of_recordings_other_rules_are_judged_where_one_is_too_large(step_s, tmp_path):
    """100 s are 100,000 steps, or 333,333; 10,000 states are allowed."""
    (tmp_path / "large.rules").write_text(LARGE)
    every = compile_rulebook(tmp_path / "large.rules")
    with pytest.raises(RulecError) as caught:
        every.at_step(step_s)
    assert {problem.code for problem in caught.value.diagnostics} == {"R0401"}
    judgeable = every.judgeable_at(step_s)
    assert [one.name for one in judgeable.rules] == ["plain"]
    assert [own[:2] for own in judgeable.too_large] == [("large", "hard")]
    cut = replace(trace("p.", float(step_s)), ends="cut")
    verdict = verify(cut, judgeable)
    assert violated(verdict) == ["plain"]
    (left_out,) = verdict.not_judged
    assert left_out.rule == "large"
    assert "too large for steps of 0.00" in left_out.why
    assert every.judgeable_at(ONE).too_large == ()
    assert every.judgeable_at(step_s) is judgeable
    plain = replace(every, rules=every.rules[1:]).judgeable_at(step_s)
    assert [one.name for one in plain.rules] == ["plain"]
    assert plain.too_large == ()


def test_what_is_wrong_otherwise_is_refused_of_recordings_too(monkeypatch):
    monkeypatch.setattr(
        compiler, "answers_to", lambda jobs, **_: ([Failed("check")] * len(jobs), "")
    )
    with pytest.raises(RulecError) as caught:
        StepCompiler(BOOK).judgeable_at(ONE)
    assert {problem.code for problem in caught.value.diagnostics} == {"R0402"}


def test_a_violation_is_explained_where_a_step_does_not_fit():
    rules, lost = machines(BOOK), trace("p....q", 0.3)
    (violation, _) = verify(lost, rules).violations
    assert explain(violation, lost, rules).violation == violation


def test_a_state_of_a_step_that_does_not_fit_has_its_place():
    answer = verify_or_reason(replace(trace("pq", 0.3), states=({"p": 1},)), machines(BOOK))
    assert isinstance(answer, NotJudged)
    assert answer.error.diagnostics[0].place == SourceLocation("t.jsonl", 3)


def test_a_trace_without_a_step_is_no_question_to_the_compiler():
    every = machines(BOOK)
    for step_s in (0.0, -1.0, float("nan"), float("inf")):
        assert verify_or_reason(trace("pq", step_s), every).error.diagnostics[0].code == "R0501"


@pytest.fixture
def compiled(monkeypatch):
    """What is compiled, as lists of names, call by call."""
    calls = []

    def recorded(rulebook, formulas, **more):
        calls.append(([one.rule.name for one in formulas.rules], formulas.step_s))
        return build_all(rulebook, formulas, **more)

    build_all = step_compilation.build_all
    monkeypatch.setattr(step_compilation, "build_all", recorded)
    return calls


SOME_TIME = rule("some_time", eventually(both(P, within(1, Q))))
"""Clocks do not tell it: what it asks for may begin at any instant."""


def test_only_what_clocks_do_not_tell_is_compiled_for_another_step(compiled):
    every = StepCompiler(book(ANSWERED, rule("plain", always(Q)), SOME_TIME))
    for step in (HALF, ONE, HALF, ONE):
        rules = every(step).rules
        assert [one.name for one in rules] == ["answered", "plain", "some_time"]
        assert [one.step_s for one in rules] == [step, None, step]
    assert compiled == [(["answered", "plain", "some_time"], HALF), (["some_time"], ONE)]


def test_each_rule_at_the_step_of_its_own_examples(compiled):
    every = StepCompiler(book(replace(ANSWERED, step_s=HALF), ANSWERED_TOO))
    assert [one.step_s for one in every.at_own_steps().rules] == [HALF, ONE]
    assert [one.step_s for one in every(HALF).rules] == [HALF, HALF]
    assert [names for names, _ in compiled] == [["answered", "too"]]


ANSWERED_TOO = rule("too", always(implies(P, within(2, Q))))


def test_a_rule_without_examples_fits_any_step_that_its_bounds_fit():
    """Its bound of half a second is no multiple of the 1 s that examples would have."""
    quick = book(rule("quick", always(implies(P, within(Fraction(1, 2), Q)))))
    every = compile_rulebook(quick)
    assert [own.step_s for own in every.rules] == [HALF]
    assert violated(verify(trace("p..q", 0.25), every)) == ["quick"]
    assert violated(verify(trace("p.q", 0.25), every)) == []


def test_a_rulebook_compiled_for_no_step_fits_itself_to_that_of_each_trace():
    rules = compile_rulebook(BOOK)
    assert violated(verify(trace("p.q", 0.5), rules)) == ["plain"]
    assert violated(verify(trace("p.q", 1), rules)) == ["answered", "plain"]
    assert rules.at_step(0.5) is rules.at_step(HALF)
    assert rules.at_step(1) is rules
    assert rules.source is BOOK


def test_some_of_the_rules_stay_some_at_another_step():
    rules = compile_rulebook(BOOK)
    some = replace(rules, rules=rules.rules[:1])
    assert [one.name for one in some.at_step(HALF).rules] == ["answered"]


def test_an_empty_rulebook():
    assert StepCompiler(book())(ONE).rules == ()
    assert machines(book()).rules == ()


def test_a_graph_is_judged_by_machines_for_its_step():
    """p all along, q never: whatever the step, no maneuver answers in a second."""
    state = {"p": True, "q": False}
    graph = TraceGraph(
        0.5, {}, {}, ((state,),), (), (), (), cost_unit=Fraction(1), start=0, goals=(0,)
    )
    assert len(instances(graph, compile_rulebook(BOOK, step_s=0.5))) == 1
    with pytest.raises(RulecError, match=r"compiled for steps of 1 s; the graph has steps of 0.5"):
        instances(graph, compile_rulebook(BOOK, step_s=1))


@pytest.mark.parametrize("step_s", [None, 0.5])
def test_maneuvers_are_judged_by_machines_for_the_graphs_step(step_s):
    only_p = replace(ANSWERED, formula=always(implies(P, within(1, P))))
    words = Vocabulary("words", {}, {"p": Signal("p", (), False)})
    found = find_maneuvers("s1", Rulebook("test", words, (only_p,)), step_s=step_s)
    assert [one.step_s for one in found.rules.rules] == [Fraction(step_s or 1)]
    assert found.satisfying == found.traces > 0


def test_maneuvers_of_another_step_than_the_compiled_rulebooks():
    with pytest.raises(RulecError) as caught:
        find_maneuvers("s1", compile_rulebook(BOOK, step_s=0.5))
    (problem,) = caught.value.diagnostics
    assert (problem.code, problem.place) == ("R0507", SourceLocation("s1"))


def test_there_is_a_limit_on_the_time_that_all_rules_take(monkeypatch, tmp_path):
    asked, ask = [], compiler._ask

    def slowly(process, job, most_s):
        asked.append(job.name)
        return ask(process, job, most_s)[0], 0.6 * COMPILING.usual

    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(compiler, "answers_to", ASKED)
    monkeypatch.setattr(compiler, "_ask", slowly)
    every = StepCompiler(book(SOME_TIME))
    every(ONE)
    every(HALF)
    with pytest.raises(RulecError, match=r"120 seconds.*R0718"):
        every(Fraction(1, 4))
    assert len(asked) == 2


def test_steps_that_hardly_differ_are_compiled_together(compiled):
    every = StepCompiler(book(ANSWERED))
    for number in range(1, 40):
        step = Fraction(3, 10) + Fraction(1, 10**5 * number)
        assert [own.step_s for own in every(step).rules] == [step]
    assert len(compiled) == 1


def test_there_is_a_limit_on_the_steps_that_are_compiled_for(compiled):
    every = StepCompiler(book(SOME_TIME))
    with in_force(["steps=2"]):
        for number in (1, 2, 4):
            every(Fraction(1, number))
        with pytest.raises(RulecError, match="R0718") as refused:
            every(Fraction(1, 5))
    (said,) = refused.value.diagnostics
    assert "--limit steps=NUMBER" in said.help
    assert len(compiled) == 3


def test_a_step_that_is_met_again_does_not_count_again(compiled, monkeypatch):
    """Also if others, of which many may be refused, have come in between."""
    monkeypatch.setattr(step_compilation, "MOST_STEPS", 2)
    every = StepCompiler(book(SOME_TIME))
    with in_force(["steps=2"]):
        for number in (1, 2, 4, 1, 2, 4):
            every(Fraction(1, number))
        for number in (5, 8, 10):
            with pytest.raises(RulecError, match="R0718"):
                every(Fraction(1, number))
        every(Fraction(1, 2))
    assert len(compiled) == 3


def test_one_process_builds_the_machines_of_many_steps(compiled_anew, monkeypatch):
    # One may wait since an earlier test
    compiler._end_waiting()
    started, start = [], compiler._started

    def starting(choice):
        started.append(start(choice))
        return started[-1]

    monkeypatch.setattr(compiler, "_started", starting)
    every = StepCompiler(book(SOME_TIME))
    for number in range(1, 6):
        every(Fraction(1, number))
    assert len(started) == 2, "the first, and one that waits for more"
    (waiting,) = compiler._waiting.values()
    waiting[0].kill()
    waiting[0].wait()
    assert every(Fraction(1, 8)).rules
    assert len(started) == 3
    compiler._end_waiting()
    assert all(process.poll() is not None for process, _ in started)


def test_a_bound_of_too_many_steps_is_refused_without_trying():
    with pytest.raises(RulecError, match="one of its bounds has more than 10,000 steps"):
        StepCompiler(book(ANSWERED))(Fraction(1, 10**5))
