"""Futures judged after a past, against judging past and future together, path by path."""

import json
from fractions import Fraction

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import rulec
from rulec.api.named_monitor import Monitor
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.formula import Unary, UnaryOperator
from rulec.planning.product.possible_instances import instances
from rulec.planning.trace_history import only_trace, past_of
from rulec.trace import Trace, TraceGraph
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.rulebooks import (
    P,
    Q,
    always,
    book,
    both,
    eventually,
    far,
    implies,
    near,
    no,
    rule,
)
from support.generators.random_graphs import graphs

HALF = Fraction(1, 2)
LONE = TraceGraph(
    step_s=0.5,
    objects={},
    present={},
    states=(({"p": True, "q": False, "place": {}},),),
    successors=(),
    weights=(),
    margins=(),
    cost_unit=Fraction(1),
    start=0,
    goals=(0,),
)
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
    place = SourceLocation("past.jsonl", 1)
    half = refused(Trace("t", 0.5, {"o1": "vehicle"}, (BEHIND,), place=place))
    assert (half.code, half.place) == ("R0511", place)
    assert "steps of 0.5 s" in half.message


def test_who_is_of_another_type_now_is_somebody_else():
    """Behind ego as `o1` is, only the one that goes on may not be passed on the right."""
    state = {**BEHIND, "CONGESTED": False}
    vehicle, pedestrian = (
        rulec.find_maneuvers("s3", "esterle2019", after=Trace("t", 1.0, {"o1": kind}, (state,)))
        for kind in ("vehicle", "pedestrian")
    )
    nobody = rulec.find_maneuvers("s3", "esterle2019", after=Trace("t", 1.0, {}, ({},)))
    assert vehicle.satisfying < pedestrian.satisfying == nobody.satisfying


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
    place = SourceLocation("past.jsonl")
    assert only_trace([trace], place) is trace
    with pytest.raises(RulecError, match="several traces"):
        only_trace([trace, trace], place)
    unreadable = RulecError(())
    with pytest.raises(RulecError) as error:
        only_trace([trace, unreadable], place)
    assert error.value is unreadable


def test_what_of_the_past_is_unknown_leaves_open_what_hangs_on_it():
    def counts(congested, **more):
        state = {**BEHIND, "CONGESTED": congested}
        past = Trace("t", 1.0, {"o1": "vehicle"}, (state,), **more)
        found = rulec.find_maneuvers("s3", "esterle2019", after=past)
        return found.satisfying, found.open, found.doubtful_past

    (yes, *_), (no_, *_) = counts(True), counts(False)
    assert yes > no_
    assert counts(UNKNOWN) == (no_, yes - no_, ("R1",))


def test_rules_that_look_back_are_open_behind_what_has_been_cut():
    """Whoever has been near may have been so before the past begins."""
    once = always(implies(P, Unary(UnaryOperator.ONCE, Q)))
    rules = compile_rulebook(
        book(rule("once", once), rule("later", always(implies(P, eventually(Q)))))
    )
    states = ({"p": True, "q": True},)
    for ends, doubtful in (("complete", set()), ("cut", {"once"})):
        past = Trace("past", 0.5, {}, states, ends=ends)
        found = past_of(LONE, past, rules, HALF)
        assert found.doubtful_rules == doubtful
        (bound, *_) = instances(LONE, rules, past=found)
        assert (bound.readings is not None) == bool(doubtful)


def test_a_monitor_that_began_in_the_middle_is_no_past():
    judge = Monitor(RULES, told=None, cut=True)
    judge.step({"p": True, "q": True, "place": {}})
    with pytest.raises(RulecError, match="before the first state of the past") as error:
        past_of(LONE, judge, RULES, HALF)
    assert [one.code for one in error.value.diagnostics] == ["R0511"]


CONSTANTS = """
rulebook constants
use paper
signal heavy default false
constant heavy
hard rule r (o: obstacle) { require never (heavy and f(o)) }
"""


@pytest.fixture(scope="module")
def with_constants(tmp_path_factory):
    file = tmp_path_factory.mktemp("rules") / "constants.rules"
    file.write_text(CONSTANTS)
    return rulec.compile_rulebook(file)


@pytest.mark.parametrize("heavy", [False, True])
def test_constants_of_the_past_hold_in_the_future(with_constants, heavy):
    """As in the traces that begin with the past, each judged as a whole."""
    traces = list(rulec.traces("s1", with_constants, step_s=0.5))
    objects = traces[0].objects
    state = {"position": dict.fromkeys(objects, "b"), "heavy": heavy}
    monitor = rulec.Monitor(with_constants, 0.5)
    monitor.step(state, objects)
    whole = [
        rulec.verify(Trace("t", 0.5, objects, (state, *own.states)), with_constants)
        for own in traces
    ]
    kept = sum(verdict.satisfied is True for verdict in whole)
    assert (0 < kept < len(whole)) if heavy else kept == len(whole)
    for past in (Trace("t", 0.5, objects, (state,)), monitor, monitor.snapshot()):
        found = rulec.find_maneuvers("s1", with_constants, after=past, step_s=0.5)
        assert (found.traces, found.satisfying) == (len(whole), kept)
        assert "heavy" not in found.by_default


def test_constants_that_contradict_the_past_are_refused(with_constants):
    state = {"surface": "R_cw", "CONGESTED": False, "heavy": True}
    assumed = rulec.Assumptions(values={"heavy": False})
    with pytest.raises(RulecError, match="the past says that `heavy` is true") as error:
        rulec.find_maneuvers(
            *("s1", with_constants),
            after=Trace("t", 0.5, {}, (state,)),
            step_s=0.5,
            assumptions=assumed,
        )
    assert [x.code for x in error.value.diagnostics] == ["R0511"]
