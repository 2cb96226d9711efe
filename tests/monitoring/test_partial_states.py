"""A running monitor's best and worst verdicts are those over all completions."""

import json
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.api.named_monitor import Monitor
from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.online.four_valued import WORST_FIRST, best_of, worst_of
from rulec.monitoring.uncertainty import required_names, uncertain_machine
from rulec.monitoring.uncertainty.judged_rules import judged_rules
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.rulebooks import (
    P,
    Q,
    always,
    book,
    compile_here,
    eventually,
    far,
    implies,
    near,
    no,
    rule,
)
from support.generators.blurred_traces import blurred, telling_numbers
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds
from support.oracles.completion_oracle import completions, keeps_facts, n_completions
from support.oracles.presence import there

NUMBERS = telling_numbers()
ORDER = settings(phases=[Phase.generate])
KEPT = ("satisfied", "satisfied")
MOST = 150


def followed(monitor, trace, *, saved=lambda _: False):
    """The verdicts of each rule and binding after each state; those that parted stay."""
    known, every = {}, []
    for number, state in enumerate(trace.states):
        present = there(trace, number)
        monitor.step({name: within(present, value) for name, value in state.items()}, present)
        known.update(
            {
                (change.rule, tuple(change.binding.values())): pair(change.verdict)
                for change in monitor.so_far.changes
                if change.ended
            }
        )
        lost = {(x.rule, tuple(x.binding.values())) for x in monitor.violations}
        now = known | dict.fromkeys(lost, ("violated", "violated"))
        for about in monitor.snapshot()["rules"]:
            for one in about["bindings"]:
                now[about["rule"], tuple(one["objects"])] = pair(one["verdict"])
        every.append(now)
        if saved(number):
            snapshot = json.loads(json.dumps(monitor.snapshot()))
            monitor = Monitor.restore(monitor.rulebook, snapshot)
    return monitor, every


def within(objects, value):
    if not isinstance(value, dict):
        return value
    return {name: within(objects, inner) for name, inner in value.items() if name in objects}


def pair(verdict):
    return (verdict, verdict) if isinstance(verdict, str) else tuple(verdict)


def extent(verdicts):
    ranks = sorted(map(WORST_FIRST.index, verdicts))
    return WORST_FIRST[ranks[-1]], WORST_FIRST[ranks[0]]


def whole_runs(compiled, book_, trace):
    for _, whole in completions(trace, book_.vocabulary, NUMBERS):
        if keeps_facts(book_, whole):
            yield followed(Monitor(compiled, whole.step_s), whole)[1]


@given(seeds)
@ORDER
def test_after_every_state_they_are_the_best_and_the_worst_of_all_completions(chance):
    book_ = rulebook(chance, Fraction(1))
    compiled = compile_here(book_, Fraction(1))
    formulas = [x.formula for x in (*book_.rules, *book_.axioms)]
    names = {name for formula in formulas for name in names_in(formula)}
    for trace in traces(chance, Fraction(1))[:2]:
        partial = blurred(chance, trace, names, most=3)
        if n_completions(partial, book_.vocabulary, NUMBERS) > MOST:
            continue
        try:
            expected = list(whole_runs(compiled, book_, partial))
        except RulecError:
            # A value without default is missing.
            continue
        if not expected:
            continue
        monitor, found = followed(
            Monitor(compiled, partial.step_s), partial, saved=lambda _: chance.random() < 0.3
        )
        for number, verdicts in enumerate(found):
            for key in {*verdicts, *(key for one in expected for key in one[number])}:
                # What is no longer spoken of was kept.
                outcomes = [one[number].get(key, KEPT)[0] for one in expected]
                assert verdicts.get(key, KEPT) == extent(outcomes), (number, key, partial, book_)
        judged = verify(partial, compiled)
        said = {(x.rule, tuple(x.binding.values())) for x in judged.violations}
        doubted = {(x.rule, tuple(x.binding.values())) for x in judged.open}
        lost = {"pending", "violated"}
        last = found[-1].items()
        assert said == {key for key, (best, _) in last if best in lost}
        assert doubted == {key for key, (best, worst) in last if worst in lost and best not in lost}
        final = {(x.rule, tuple(x.binding.values()), x.step) for x in monitor.violations}
        settled = {
            (x.rule, tuple(x.binding.values()), x.step)
            for x in judged.violations
            if x.step is not None
        }
        assert {one for one in final if one[2] is not None} == settled


CAR = {"a": "car"}
NEVER_FAR = rule("never_far", always(no(far("x"))), "x: car")
COMES_NEAR = rule("comes_near", eventually(near("x")), "x: car")
ANSWERED = rule("answered", always(implies(P, eventually(Q))))


def monitor(*rules, **source):
    return Monitor(compile_here(book(*rules)), **source)


def test_what_is_unknown_leaves_a_verdict_between_two():
    judge = monitor(NEVER_FAR)
    found = judge.step({"place": {"a": UNKNOWN}}, CAR)
    assert (found.best, found.worst) == ("holds so far", "violated")
    assert found.rules["never_far"] == found.verdict
    assert judge.violations == ()
    assert judge.step({"place": {"a": "far"}}, CAR).verdict == "violated"
    assert [one.step for one in judge.violations] == [1]


def test_what_becomes_known_settles_what_was_open():
    judge = monitor(COMES_NEAR)
    assert judge.step({"place": {"a": UNKNOWN}}, CAR).best == "holds so far"
    assert judge.so_far.worst == "pending"
    assert judge.step({"place": {"a": "near"}}, CAR).verdict == "holds so far"


def test_who_leaves_while_it_is_open_leaves_the_rule_open():
    judge = monitor(COMES_NEAR)
    judge.step({"place": {"a": UNKNOWN}}, CAR)
    found = judge.step({}, {})
    (change,) = found.changes
    assert change.ended
    assert tuple(change.verdict) == ("satisfied", "violated")
    again = Monitor.restore(judge.rulebook, json.loads(json.dumps(judge.snapshot())))
    for one in (judge, again):
        later = one.step({"place": {"b": "near"}}, {"b": "car"})
        assert (later.best, later.worst) == ("holds so far", "violated")


def test_who_leaves_when_it_is_violated_or_pending_has_violated():
    judge = monitor(rule("starts", near("x"), "x: car"), COMES_NEAR)
    judge.step({"place": {"a": "far"}}, CAR)
    judge.step({"place": {"a": "gone"}}, CAR)
    assert judge.step({}, {}).rules["comes_near"] == "violated"


@pytest.mark.parametrize(
    ("told", "judged"),
    [
        (None, ["no_p", "answered"]),
        (["q"], []),
        (["p"], ["no_p"]),
        (["p", "q"], ["no_p", "answered"]),
    ],
)
def test_rules_that_a_source_says_too_little_for_are_not_judged(told, judged):
    judge = monitor(rule("no_p", always(no(P))), ANSWERED, told=told)
    judge.step({"p": False, "q": True})
    again = Monitor.restore(judge.rulebook, json.loads(json.dumps(judge.snapshot())))
    for one in (judge, again):
        assert list(one.so_far.rules) == judged
        assert {*judged, *one.not_judged} == {"no_p", "answered"}


LAMPS = """rulebook lamps signal moves default false
light is one of dark, green, red, cross default dark
hard rule closed { require never (cross and moves) }
hard rule stop { require never ((red or cross) and moves) }
hard rule go { require never (dark and moves) }
"""


@pytest.mark.parametrize(
    ("told", "judged"),
    [
        (["light", "moves"], ["closed", "stop", "go"]),
        (["light", "moves", "dark", "green", "red"], ["stop", "go"]),
        (["light", "moves", "cross"], ["closed", "stop"]),
        (["light", "moves", "green"], []),
        # Of a name that is not told no value is
        (["moves", "red"], []),
    ],
)
def test_no_rule_is_kept_because_of_a_value_that_a_source_never_says(told, judged):
    compiled = rulec.compile_rulebook(parse_rulebook(LAMPS))
    found = judged_rules(compiled, frozenset(told), cut=True)
    assert [rule.name for rule in found.rulebook.rules] == judged
    lacking = {one.rule: one.untold for one in found.unknowable}
    assert "stop" in judged or lacking["stop"] in {("red", "cross"), ("light",)}
    assert "closed" in judged or lacking["closed"] in {("cross",), ("light",)}
    said = {"light": "green", "moves": True}
    state = {name: value for name, value in said.items() if name in told}
    trace = Trace("t", 1.0, {}, (state, state), told=frozenset(told))
    verdict = verify(trace, compiled)
    assert {one.rule for one in verdict.not_judged} == {"closed", "stop", "go"} - {*judged}
    assert not verdict.violations


def test_what_is_told_is_a_name_or_a_value():
    compiled = rulec.compile_rulebook(parse_rulebook(LAMPS))
    with pytest.raises(RulecError) as problem:
        verify(Trace("t", 1.0, {}, ({},), told=frozenset({"light", "gren"})), compiled)
    (diagnostic,) = problem.value.diagnostics
    assert diagnostic.code == "R0502"
    assert diagnostic.help == "did you mean `green`?"


@pytest.mark.parametrize(
    ("strength", "best", "worst"),
    [("hard", "satisfied", "violated"), ("soft", "satisfied", "satisfied")],
)
def test_nobody_keeps_hard_rules_that_are_not_judged(strength, best, worst):
    judge = monitor(rule("no_p", always(no(P)), strength=strength), told=["q"])
    judge.step({"q": True})
    assert judge.not_judged == ("no_p",)
    again = Monitor.restore(judge.rulebook, json.loads(json.dumps(judge.snapshot())))
    for one in (judge, again):
        assert (one.so_far.best, one.so_far.worst) == (best, worst)
        assert (one.step({"q": False}).best, one.so_far.worst) == (best, worst)


def test_whether_a_source_says_too_little_is_not_looked_for_without_end(monkeypatch):
    """A rule of many states whose every letter leads elsewhere is taken to be one to judge."""
    monkeypatch.setattr(required_names, "MOST_LOOKED_AT", -1)
    judge = monitor(rule("no_p", always(no(P))), told=["q"])
    assert list(judge.so_far.rules) == ["no_p"]


def test_a_duty_of_many_steps_is_found_to_be_one_that_q_alone_violates(monkeypatch):
    text = "signal p, q default false hard rule d { require never historically[<= 2 s] (p or q) }"
    parsed = parse_rulebook(f"rulebook long {text}")
    compiled = rulec.compile_rulebook(parsed, step_s=Fraction(1, 100))
    steps = []

    def counted(self, about):
        steps.append(about)
        return step(self, about)

    step = required_names.RequiredNames._step
    monkeypatch.setattr(required_names.RequiredNames, "_step", counted)
    assert judged_rules(compiled, frozenset({"q"}), cut=True).unknowable == ()
    # As many as the duty has steps, once or twice.
    assert 200 <= len(steps) <= 1000


@pytest.mark.parametrize("whole", [0, 3, 1 << 16])
@given(chance=seeds)
@settings(max_examples=20)
def test_large_machines_are_asked_in_another_way_with_the_same_answer(whole, chance):
    """Their states are not compared unless too many sets are met; here all machines are large."""
    compiled = rulec.compile_rulebook(rulebook(chance, Fraction(1)))
    declared = sorted(compiled.vocabulary.declarations)
    told = frozenset(chance.sample(declared, len(declared) // 2))
    usual = judged_rules(replace(compiled), told, cut=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(required_names, "MOST_COMPARED", 0)
        patch.setattr(required_names, "MOST_LOOKED_AT_WHOLE", whole)
        patch.setattr(uncertain_machine, "_PREPARED", {})
        found = judged_rules(replace(compiled), told, cut=True)
    assert [rule.name for rule, _ in found.machines] == [rule.name for rule, _ in usual.machines]
    assert found.unknowable == usual.unknowable
    assert found.lacking == usual.lacking


def test_what_a_source_cannot_tell_is_unknown_though_it_has_a_default():
    text = "signal p signal q default false hard rule both { require always (p and not q) }"
    compiled = rulec.compile_rulebook(parse_rulebook(f"rulebook dark {text}"))
    assert Monitor(compiled).step({"p": True}).verdict == "holds so far"
    dark = Monitor(compiled, told=["p"])
    assert (dark.step({"p": True}).best, dark.so_far.worst) == ("holds so far", "violated")
    assert dark.step({"p": False}).verdict == "violated"


def test_what_was_before_a_cut_trace_is_unknown():
    text = "rulebook past signal p, q hard rule recalled { require always (p implies once q) }"
    recalled = rulec.compile_rulebook(parse_rulebook(text))
    state = {"p": True, "q": False}
    assert Monitor(recalled).step(state).verdict == "violated"
    judge = Monitor(recalled, cut=True)
    found = judge.step(state)
    assert (found.best, found.worst) == ("satisfied", "violated")
    again = Monitor.restore(judge.rulebook, json.loads(json.dumps(judge.snapshot())))
    assert again.so_far.rules == found.rules


LEAVING = """\
rulebook leaving
type car
signal s(v: car), t(v: car) default false
hard rule r (v: car) { require CONDITION }
"""


@pytest.mark.parametrize(
    ("condition", "kept", "violated"),
    [
        ("eventually s(v)", False, False),
        ("never s(v)", True, False),
        ("always s(v)", False, True),
        ("always (t(v) implies eventually s(v))", True, False),
        ("next s(v)", False, False),
    ],
)
def test_who_leaves_a_cut_trace_was_lost_from_view(condition, kept, violated):
    rules = rulec.compile_rulebook(parse_rulebook(LEAVING.replace("CONDITION", condition)))
    trace = Trace("t", 1, {"a": "car"}, ({}, {}), {"a": (0, 0)}, ends="cut")
    found = verify(trace, rules)
    assert (found.satisfied is True, bool(found.violations)) == (kept, violated)
    judge = Monitor(rules, cut=True)
    judge.step({}, {"a": "car"})
    on_rule = judge.step({}, {}).rules["r"]
    assert (worst_of(on_rule) != "violated", best_of(on_rule) == "violated") == (kept, violated)
    assert bool(judge.violations) is violated
    again = Monitor.restore(rules, json.loads(json.dumps(judge.snapshot())))
    assert again.so_far.rules == {"r": on_rule}


def test_a_monitor_that_knows_all_is_saved_as_ever():
    judge = monitor(NEVER_FAR)
    judge.step({"place": {"a": "near"}}, CAR)
    assert judge.snapshot()["version"] == 1
    judge.step({"place": {"a": UNKNOWN}}, CAR)
    assert judge.snapshot()["version"] == 2
    assert worst_of(judge.so_far.verdict) == "violated"
    assert best_of(judge.so_far.verdict) == "holds so far"


def test_an_interval_is_no_truth_and_no_value_of_an_enumeration():
    judge = monitor(NEVER_FAR)
    with pytest.raises(RulecError) as refused:
        judge.step({"place": {"a": Interval(1, 2)}}, CAR)
    assert [one.code for one in refused.value.diagnostics] == ["R0503"]


KINDS = """\
rulebook kinds
kind is one of a_car, a_truck default a_car
quantity limit in m/s default 10
quantity speed in m/s default 0
signal fast default false
constant kind
hard rule truck { require always (a_truck implies not fast) }
hard rule slow { require always (speed <= limit or speed <= 5 m/s) }
"""


def test_a_verdict_on_an_unknown_constant_is_not_exact_as_long_as_it_is_open():
    judge = Monitor(rulec.compile_rulebook(parse_rulebook(KINDS)))
    assert judge.step({"kind": UNKNOWN, "speed": Interval(4, 11)}).exact
    assert not judge.step({"kind": UNKNOWN, "fast": True}).exact
    again = Monitor.restore(judge.rulebook, json.loads(json.dumps(judge.snapshot())))
    for one in (judge, again):
        assert not one.so_far.exact
        found = one.step({"kind": "a_truck", "fast": True})
        assert (found.rules["truck"], found.exact) == ("violated", True)


def test_values_that_several_sums_read_are_completed_together():
    judge = Monitor(rulec.compile_rulebook(parse_rulebook(KINDS)))
    assert judge.step({"speed": Interval(4, 8)}).rules["slow"] == "holds so far"
    assert judge.step({"speed": Interval(3, 5), "limit": UNKNOWN}).rules["slow"] == "holds so far"
    found = judge.step({"speed": UNKNOWN, "limit": Interval(1, 2)})
    assert (found.best, found.worst, found.exact) == ("holds so far", "violated", True)


SLIPPERY = """rulebook slippery
type car
signal horn, icy, wet, loud(v: car) default false
fact icy implies wet
hard rule calm { require always (horn and wet implies some c: car (loud(c))) }
"""


def test_a_fact_tells_what_is_unknown_to_a_rule_that_asks_of_everybody():
    judge = Monitor(rulec.compile_rulebook(parse_rulebook(SLIPPERY)))
    slides = {"horn": True, "wet": UNKNOWN, "loud": {"a": False}}
    assert pair(judge.step(slides, CAR).rules["calm"]) == ("holds so far", "violated")
    assert judge.step({**slides, "icy": True}, CAR).rules["calm"] == "violated"
