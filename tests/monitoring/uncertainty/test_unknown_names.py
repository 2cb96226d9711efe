"""A name that is unknown itself is unknown of every object, whoever reads it."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings

from rulec import compile_rulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.assumptions import Assumptions
from rulec.monitoring.batch.batch_verify import verify_chunk
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.verdict import RuleNotJudged, Verdict
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.rulebooks import compile_here
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds

BOOK = parse_rulebook(
    """rulebook gaps
type car
quantity gap(v: car) in m
kind(v: car) is one of fast, slow
signal near(v: car, w: car) default false
signal rain default false
hard rule far (v: car) { require always (gap(v) > 5 m or slow(v)) }
hard rule apart (v: car, w: car) { require never near(v, w) }
hard rule dry { require always !rain }"""
)
DECLARATIONS = BOOK.vocabulary.declarations
KIND = replace(DECLARATIONS["kind"], constant=True)
WORDS = Vocabulary("gaps", BOOK.vocabulary.types, {**DECLARATIONS, "kind": KIND})
RULES = compile_here(replace(BOOK, vocabulary=WORDS))
OBJECTS = {"a": "car", "b": "car"}
KNOWN = {
    "gap": {"a": 9.0, "b": 9.0},
    "kind": {"a": "fast", "b": "fast"},
    "near": {"a": {"b": False}, "b": {"a": False}},
}
EACH = {
    "gap": {"a": UNKNOWN, "b": UNKNOWN},
    "kind": {"a": UNKNOWN, "b": UNKNOWN},
    "near": {"a": {"a": UNKNOWN, "b": UNKNOWN}, "b": {"a": UNKNOWN, "b": UNKNOWN}},
}


def trace(**changes):
    return Trace("t", 1.0, OBJECTS, ({**KNOWN, **changes}, KNOWN))


def doubts(verdict):
    return {(result.rule, tuple(result.binding.values())) for result in verdict.open}


@pytest.mark.parametrize(
    ("name", "opened"),
    [
        ("gap", {("far", ("a",)), ("far", ("b",))}),
        ("near", {("apart", ("a", "b")), ("apart", ("b", "a"))}),
    ],
)
def test_unknown_of_every_object(name, opened):
    verdict = verify(trace(**{name: UNKNOWN}), RULES)
    assert doubts(verdict) == opened
    assert verdict == verify(trace(**{name: EACH[name]}), RULES)


def test_unknown_of_every_second_object():
    verdict = verify(trace(near={"a": UNKNOWN, "b": {"a": False}}), RULES)
    assert doubts(verdict) == {("apart", ("a", "b"))}


def test_constants():
    near = {"gap": {"a": 1.0, "b": 1.0}}
    state = {**KNOWN, **near, "kind": UNKNOWN}
    whole = verify(Trace("t", 1.0, OBJECTS, (state, state)), RULES)
    assert whole.violations == ()
    assert doubts(whole) == {("far", ("a",)), ("far", ("b",))}
    each = {**state, "kind": EACH["kind"]}
    assert whole == verify(Trace("t", 1.0, OBJECTS, (each, each)), RULES)


def test_together_as_alone():
    traces = [trace(), trace(gap=UNKNOWN), trace(near=UNKNOWN), trace(kind=UNKNOWN)] * 20
    assert verify_chunk(traces, RULES) == [verify(one, RULES) for one in traces]


def test_an_explanation_shows_one_completion():
    lost = trace(gap=UNKNOWN, near=UNKNOWN, rain=True)
    (violation,) = verify(lost, RULES).violations
    assert explain(violation, lost, RULES).decisive == 0


def test_what_is_known_decides_in_an_explanation(tmp_path):
    """Lit or not, ego cut in. That it changed lanes before is no reason: it may have been lit."""
    book = tmp_path / "lanes.rules"
    book.write_text(
        "rulebook lanes\nuse road\n"
        "hard rule changing {\n"
        "  require never (lane_change and not lane_is_clear or lane_change and no_indicator)\n}\n"
    )
    rules = compile_rulebook(book)
    clear, cuts_in = ({"lane_change": True, "lane_is_clear": own} for own in (True, False))
    none = {"lane_change": False, "lane_is_clear": True}
    for indicator in ({}, {"indicator": UNKNOWN}):
        states = tuple(state | indicator for state in (none, clear, none, cuts_in, none))
        told = frozenset(states[0])
        lost = Trace("t", 1.0, {}, states, ends="cut", told=told)
        (violation,) = verify(lost, rules).violations
        found = explain(violation, lost, rules)
        assert found.decisive == 3
        decides = {fact.text for fact in found.facts if fact.decides}
        assert decides == {"lane_change", "lane_is_clear"}
        assert [change.place for change in found.repair] == [3]


@pytest.mark.parametrize(
    ("require", "interval", "shown"),
    [
        # What may have been kept was, so that the first state that surely breaks it decides
        ("always gap(v) >= 5 m", Interval(4.0, 7.0), True),
        ("always not gap(v) < 5 m", Interval(4.0, 7.0), True),
        ("always gap(v) <= 5 m", Interval(4.0, 7.0), True),
        ("never gap(v) > 5 m", Interval(3.0, 16.0), True),
        # Neither end suits both, and the middle does not
        ("always (gap(v) <= 5 m or gap(v) >= 8 m)", Interval(4.0, 9.0), False),
    ],
)
def test_of_bounds_the_end_counts_by_which_a_rule_is_rather_kept(
    tmp_path, require, interval, shown
):
    book = tmp_path / "gaps.rules"
    book.write_text(
        "rulebook gaps\ntype car\nquantity gap(v: car) in m\n"
        f"hard rule far (v: car) {{ require {require} }}\n"
    )
    rules = compile_rulebook(book)
    broken = 6.0 if "<= 5" in require or "> 5" in require else 3.0
    states = tuple({"gap": {"a": own}} for own in (interval, broken))
    lost = Trace("t", 1.0, {"a": "car"}, states, ends="cut")
    (violation,) = verify(lost, rules).violations
    assert violation.step == 1
    found = explain(violation, lost, rules)
    (always, inside, *_) = found.parts
    assert always.values == (False, False)
    kept = (
        inside.values if always.text.startswith("always") else tuple(not x for x in inside.values)
    )
    assert kept == (shown, False)


def test_a_rule_is_kept_where_what_is_not_told_could_change_nothing():
    """Nobody knows whether it rains; at most 10 m ahead of nobody, it does not matter."""
    text = (
        "rulebook wet signal rain default false quantity room in m default 9 "
        "hard rule slippery { require never (rain and room < 5 m) }"
    )
    rules = compile_rulebook(parse_rulebook(text))
    told = frozenset({"room"})
    far, near = (Trace("t", 1.0, {}, ({"room": 9.0}, {"room": x}), told=told) for x in (7.0, 3.0))
    assert verify(far, rules) == Verdict("t", (), kept_regardless=("slippery",))
    assert verify(far, rules).satisfied is True
    lacking = RuleNotJudged("slippery", "hard", ("rain",))
    assert verify(near, rules) == Verdict("t", (), not_judged=(lacking,))
    assert verify(near, rules).satisfied is None


@given(seeds)
@settings(phases=[Phase.generate])
def test_what_is_not_told_is_as_what_is_unknown_in_every_state(chance):
    """But for values of a word that a source tells by others alone: of these nothing is kept."""
    book = rulebook(chance, Fraction(1))
    compiled = compile_here(book, Fraction(1))
    declared = compiled.vocabulary.declarations
    for trace in traces(chance, Fraction(1))[:3]:
        told = frozenset(name for name in declared if chance.random() < 0.6)
        states = [{x: state[x] for x in state if x in told} for state in trace.states]
        untold = replace(trace, states=tuple(states), told=told)
        unknown = dict.fromkeys(declared.keys() - told, UNKNOWN)
        explicit = replace(untold, states=tuple([unknown | x for x in states]), told=None)
        try:
            found, other = verify(untold, compiled), verify(explicit, compiled)
        except RulecError:
            continue
        # What facts tell in spite of the source does not make it known to violate a rule
        lacking = {one.rule for one in found.not_judged}
        assert found.violations == tuple([x for x in other.violations if x.rule not in lacking])
        doubtful = {one.rule for one in (*other.open, *other.violations)}
        assert {x.rule for x in (*found.open, *found.violations)} | lacking == doubtful
        assert doubtful.isdisjoint(found.kept_regardless)


def test_assumptions_are_about_what_is_not_told():
    told = frozenset(KNOWN)
    open_ = Trace("t", 1.0, OBJECTS, ({**KNOWN, "rain": UNKNOWN}, KNOWN), ends="cut", told=told)
    assert [result.rule for result in verify(open_, RULES).not_judged] == ["dry"]
    raining = Assumptions(values={"rain": True}).applied(open_)
    assert [state["rain"] for state in raining.states] == [True, True]
    assert raining.ends == "cut"
    assert [violation.rule for violation in verify(raining, RULES).violations] == ["dry"]
    dry = Assumptions(values={"rain": True}).applied(trace(rain=False))
    assert [state.get("rain") for state in dry.states] == [False, None]
    usual = Assumptions(defaults=True).applied(open_)
    assert (usual.ends, usual.told) == ("complete", None)
    assert usual.states == (KNOWN, KNOWN)
    assert Assumptions("cut", defaults=True).applied(open_).ends == "cut"
