"""Futures judged after a past, against judging past and future together, path by path."""

import json
from dataclasses import replace
from fractions import Fraction

import pytest
from books import P, Q, always, book, both, compile_here, eventually, far, implies, near, no, rule
from graphs import graphs
from hypothesis import assume, given
from hypothesis import strategies as st
from journeys import as_trace
from words import formulas

import rulec
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import Place, RulecError
from rulec.logic.formula import atoms_of
from rulec.runtime.before import only_trace, past_of
from rulec.runtime.effects import effects
from rulec.runtime.instances import instances, violations
from rulec.runtime.letters import present_in
from rulec.runtime.monitor import Monitor
from rulec.runtime.online.replay import said_of
from rulec.runtime.product import explore
from rulec.runtime.verify import verify
from rulec.trace import Trace
from rulec.trace.paths import paths

HALF = Fraction(1, 2)
CARS = ("car1", "car2")
RULES = compile_rulebook(
    book(
        rule("never_near_then_far", always(no(both(near("x"), eventually(far("x"))))), "x: car"),
        rule("comes_near", eventually(near("x")), "x: car"),
        rule("no_two_near", always(no(both(near("x"), near("y")))), "x: thing", "y: thing"),
        rule("p_is_answered", always(implies(P, eventually(Q)))),
        rule("ends_in_q", eventually(always(Q)), strength="soft"),
    )
)

places = st.sampled_from(["near", "far", "gone"])


@st.composite
def pasts(draw):
    """States, each with the cars that are there; these come, go and come back."""
    found = []
    for _ in range(draw(st.integers(1, 4))):
        there = draw(st.sets(st.sampled_from(CARS)))
        state = {"p": draw(st.booleans()), "q": draw(st.booleans())}
        state["place"] = {name: draw(places) for name in sorted(there)}
        found.append((state, dict.fromkeys(sorted(there), "car")))
    return found


def after(rules, past):
    judge = Monitor(rules)
    for state, objects in past:
        judge.step(state, objects)
    return judge


def along(graph, path):
    """The states of a path, each with the objects that are there."""
    for layer, node in enumerate(path):
        there = present_in(layer, graph.objects, graph.present)
        yield said_of(there, graph.states[layer][node]), there


def named(violations):
    """With the objects' names as they were before each stay got a name of its own."""
    return sorted(
        (one.rule, [name.split()[0] for name in one.binding.values()], str(one.step))
        for one in violations
    )


def judged_together(rules, past, graph, path):
    """What past and path violate: by the end of the past, and later."""
    trace = as_trace([*past, *along(graph, path)])
    before, later = [], []
    for one in verify(trace, rules).violations:
        if one.strength == "hard":
            ends = min((trace.present[name][1] for name in one.binding.values()), default=len(past))
            decided = ends if one.step is None else one.step
            (before if decided < len(past) else later).append(one)
    return before, later


def check(rules, past, graph):
    found = past_of(graph, after(rules, past), rules, HALF)
    bound = instances(graph, rules, past=found)
    satisfying = 0
    for path in paths(graph):
        before, later = judged_together(rules, past, graph, path)
        assert named(before) == named(found.violations)
        satisfying += not later
        shown = [
            replace(one, step=None if one.step is None else one.step + len(past))
            for one in violations(bound, path)
        ]
        assert named(shown) == named(later)
    assert explore(effects(graph, bound)).accepted == satisfying


@given(pasts(), graphs(objects=CARS))
def test_counts_are_those_of_judging_past_and_paths_together(past, graph):
    check(RULES, past, graph)


@given(formulas, st.sampled_from(["stutter", "finite"]), pasts(), graphs(objects=CARS))
def test_any_rule_goes_on_where_it_stood(formula, semantics, past, graph):
    x = ("x: thing",) if any(atom.arguments for atom in atoms_of(formula)) else ()
    check(compile_here(replace(book(rule("A", formula, *x)), semantics=semantics)), past, graph)


@given(pasts(), graphs(objects=CARS))
def test_a_trace_a_monitor_and_its_snapshot_are_the_same_past(past, graph):
    names = {name for _, there in past for name in there}
    stays = {name: [n for n, (_, there) in enumerate(past) if name in there] for name in names}
    assume(all(held == list(range(held[0], held[-1] + 1)) for held in stays.values()))
    trace = Trace(
        "past",
        0.5,
        dict.fromkeys(sorted(names), "car"),
        tuple(state for state, _ in past),
        {name: (held[0], held[-1]) for name, held in stays.items()},
    )
    hard = [one.name for one in RULES.rules if one.strength == "hard"]
    found = past_of(graph, trace, RULES, HALF)
    for other in (after(RULES, past), json.loads(json.dumps(after(RULES, past).snapshot()))):
        same = past_of(graph, other, RULES, HALF)
        assert same.violations == found.violations
        assert {key: s for key, s in same.states.items() if key[0] in hard} == found.states
        assert {key for key in same.settled if key[0] in hard} == found.settled


@given(graphs())
def test_without_a_past_all_begins_here(graph):
    begun = past_of(graph, Monitor(RULES), RULES, HALF)
    assert instances(graph, RULES, past=begun) == instances(graph, RULES)


def refused(past, scenario="s2"):
    with pytest.raises(RulecError) as error:
        rulec.find_maneuvers(scenario, "esterle2019", after=past)
    (diagnostic,) = error.value.diagnostics
    return diagnostic


BEHIND = {"position": {"o1": "b"}}


def test_a_past_that_leads_elsewhere_is_refused():
    place = Place("past.jsonl", 1)
    half = refused(Trace("t", 0.5, {"o1": "vehicle"}, (BEHIND,), place=place))
    assert (half.code, half.place) == ("R0511", place)
    assert "steps of 0.5 s" in half.message
    other = refused(Trace("t", 1.0, {"o1": "pedestrian"}, (BEHIND,)))
    assert (other.code, other.message) == (
        "R0511",
        "`o1` was a `pedestrian` and now is a `vehicle`",
    )


def test_a_past_judged_by_other_rules_is_refused():
    assert refused(Monitor(RULES)).code == "R0511"
    assert refused(Monitor(RULES).snapshot()).code == "R0510"


def test_what_is_no_trace_is_no_past():
    assert refused(Trace("t", 1.0, {}, ())).code == "R0506"
    assert refused(Trace("t", 1.0, {"o1": "vehicle"}, ({"position": {"o1": "x"}},))).code == "R0503"


def test_who_has_left_may_come_back_as_another():
    """Gone before the scenario begins, so it is somebody else."""
    before = Trace("t", 1.0, {"o1": "pedestrian"}, (BEHIND, {}), {"o1": (0, 0)})
    found = rulec.find_maneuvers("s2", "esterle2019", after=before)
    assert (found.satisfying, found.violated_before) == (83, ())


def test_there_is_one_past():
    trace = Trace("t", 1.0, {}, ({},))
    place = Place("past.jsonl")
    assert only_trace([trace], place) is trace
    with pytest.raises(RulecError, match="several traces"):
        only_trace([trace, trace], place)
    unreadable = RulecError(())
    with pytest.raises(RulecError) as error:
        only_trace([trace, unreadable], place)
    assert error.value is unreadable
