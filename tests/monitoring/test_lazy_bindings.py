"""Bindings made only where a rule may not be kept: the same verdicts, far fewer choices."""

import json
from dataclasses import replace
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec.api.named_monitor import Monitor
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.batch_verify import verify_chunk
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.online.monitor_sources import replay_trace
from rulec.planning.product.graph_product import explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import instances, violations
from rulec.resource_limits import in_force
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.rulebooks import compile_here
from support.generators.random_graphs import layered
from support.generators.seeds import seeds

BOOK = """
rulebook crowd
type car
type bus is car
signal beside(a: car), stopped(a: car), wet default false
signal behind(a: car, b: car) default false
quantity gap(a: car) in m default 9
hard rule ahead (a: car, b: car, c: car) {
  require always not (beside(a) and stopped(b) and behind(b, c))
}
hard rule soon (a: car, b: bus, c: car) {
  require always (beside(a) and gap(b) < 5 m implies next stopped(c) or wet)
}
hard rule later (a: car, b: car, c: bus) {
  require beside(a) and beside(b) implies eventually stopped(c)
}
"""
NAMES = "pqrs"


@pytest.fixture(scope="module")
def book():
    return compile_here(parse_rulebook(BOOK))


def per_object(values):
    return st.dictionaries(st.sampled_from(NAMES), values, max_size=4)


STATES = st.fixed_dictionaries(
    {},
    optional={
        "beside": per_object(st.booleans()),
        "stopped": per_object(st.booleans()),
        "wet": st.booleans(),
        "behind": per_object(per_object(st.booleans())),
        "gap": per_object(st.sampled_from([3, 5, 7])),
    },
)
SPANS = st.tuples(st.integers(0, 2), st.integers(0, 2)).map(sorted).map(tuple)


def crowd(n_cars, besides, **more):
    objects = {f"o{number}": "car" for number in range(n_cars)}
    return Trace("t", 1, objects, [{"beside": dict.fromkeys(besides, True), **more}] * 3)


SIX = """
rulebook six
type car
signal beside(a: car), stopped(a: car) default false
hard rule r (a: car, b: car, c: car, d: car, e: car, f: car) {
  require always not (beside(a) and beside(b) and beside(c)
                      and stopped(d) and stopped(e) and stopped(f))
}
"""


@pytest.fixture(scope="module")
def six():
    return compile_here(parse_rulebook(SIX))


def test_of_427_million_choices_none_is_made_that_cannot_violate_the_rule(six):
    assert verify(crowd(30, ["o1", "o2", "o3"]), six).violations == ()


def test_violations_of_many_choices_are_found(six):
    trace = crowd(30, ["o1", "o2", "o3"], stopped={"o4": True, "o5": True, "o6": True})
    (answer,) = verify_chunk([trace], six)
    assert len(answer.violations) == 6 * 6


def test_a_monitor_makes_few_of_many_choices_and_keeps_them_when_it_is_saved(six):
    still = crowd(30, ["o1", "o2", "o3"])
    moving = crowd(30, ["o1", "o2", "o3"], stopped={"o4": True, "o5": True, "o6": True})
    monitor = replay_trace(still, six)
    assert monitor.so_far.verdict == "holds so far"
    so_far = monitor.step(moving.states[0], moving.objects)
    assert (so_far.verdict, len(so_far.changes)) == ("violated", 6 * 6)
    again = Monitor.restore(six, json.loads(json.dumps(monitor.snapshot())))
    assert again.step(moving.states[0], moving.objects).changes == ()
    assert again.violations == monitor.violations


def test_choices_that_matter_and_are_too_many_are_refused(six):
    trace = crowd(30, [f"o{number}" for number in range(30)], stopped={"o1": True, "o2": True})
    with in_force(["choices=1000"]), pytest.raises(RulecError, match="R0718") as refused:
        verify(trace, six)
    (said,) = refused.value.diagnostics
    assert "rule `r`" in said.message
    assert "--limit choices=NUMBER" in said.help


def test_a_missing_value_is_missed_however_the_bindings_are_made(monkeypatch):
    book = compile_here(parse_rulebook(SIX.replace(" default false", "")))
    trace = crowd(6, [f"o{number}" for number in range(6)])
    monkeypatch.setattr("rulec.monitoring.bindings.MANY", 0)
    with pytest.raises(RulecError, match="R0504"):
        verify(trace, book)


def eagerly(call):
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("rulec.monitoring.bindings.MANY", 10**9)
        return call()


def lazily(call):
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("rulec.monitoring.bindings.MANY", 0)
        return call()


UNKNOWN_TOO = st.fixed_dictionaries(
    {},
    optional={
        "beside": per_object(st.sampled_from([True, False, UNKNOWN])),
        "stopped": per_object(st.sampled_from([True, False, UNKNOWN])),
        "wet": st.sampled_from([True, False, UNKNOWN]),
        "gap": per_object(st.sampled_from([3, 7, Interval(4, 6), UNKNOWN])),
    },
)
TOLD = st.sampled_from([None, ("beside", "stopped"), ("beside", "stopped", "behind", "wet", "gap")])


@given(
    st.lists(STATES, min_size=3, max_size=3) | st.lists(UNKNOWN_TOO, min_size=3, max_size=3),
    st.lists(st.sampled_from(["car", "bus"]), min_size=4, max_size=4),
    st.dictionaries(st.sampled_from(NAMES), SPANS, max_size=2),
    TOLD,
    st.booleans(),
)
def test_verdicts_are_those_of_all_bindings(book, states, kinds, present, told, cut):
    objects, ends = dict(zip(NAMES, kinds, strict=True)), "cut" if cut else "complete"
    trace = Trace("t", 1, objects, states, present, ends=ends, told=told)
    assert lazily(lambda: verify(trace, book)) == eagerly(lambda: verify(trace, book))


COMING_AND_GOING = st.lists(
    st.tuples(
        STATES | UNKNOWN_TOO,
        st.dictionaries(st.sampled_from(NAMES), st.sampled_from(["car", "bus"]), min_size=3),
    ),
    min_size=1,
    max_size=4,
)


def steps_of(book, layers, told, cut, again_at):
    """What a monitor says, saved and restored on the way; and what the past would be."""
    monitor, said = Monitor(book, told=told, cut=cut), []
    for number, (state, objects) in enumerate(layers):
        there = {
            name: {item: x for item, x in value.items() if item in objects}
            for name, value in state.items()
            if isinstance(value, dict) and name != "behind"
        }
        if number == again_at:
            monitor = Monitor.restore(book, json.loads(json.dumps(monitor.snapshot())))
        so_far = monitor.step({**there, "wet": state.get("wet", False)}, objects)
        said.append((so_far.verdict, dict(so_far.rules), so_far.changes))
    past = None if cut else {about: n for about, n in monitor.past(objects).states.items() if n}
    return said, monitor.violations, past


@given(COMING_AND_GOING, TOLD, st.booleans(), st.integers(1, 4))
def test_a_running_monitor_says_what_one_of_all_bindings_says(book, layers, told, cut, again_at):
    def run():
        return steps_of(book, layers, told, cut, again_at)

    assert lazily(run) == eagerly(run)


def paths_of(book, graph, before):
    """How many paths keep the rules, for sure and perhaps, and what each violates for sure."""
    monitor = Monitor(book, told=graph.told)
    for state in before:
        monitor.step(state, graph.objects)
    bound = instances(graph, book, past=monitor.past(graph.objects))
    accepted = [
        explore(node_transformers(graph, bound, perhaps=perhaps)).accepted
        for perhaps in (False, True)
    ]
    known = [own for own in bound if own.readings is None]
    paths = product(*[range(len(layer)) for layer in graph.states])
    return accepted, [violations(known, path) for path in paths]


@settings(max_examples=settings().max_examples // 2)
@given(
    seeds,
    st.lists(STATES | UNKNOWN_TOO, min_size=2, max_size=4),
    st.lists(STATES, max_size=2),
    TOLD,
)
def test_paths_are_counted_as_by_all_bindings(book, chance, pool, before, told):
    objects = dict(zip(NAMES, ("car", "car", "bus", "bus"), strict=True))
    graph = layered(chance, objects, lambda: chance.choice(pool), 3)
    graph = replace(graph, told=told)

    def found():
        return paths_of(book, graph, before)

    assert lazily(found) == eagerly(found)
