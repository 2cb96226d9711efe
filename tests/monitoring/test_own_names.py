"""Traces whose objects have names of their own: judged together, told apart in the verdicts."""

from functools import cache
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.monitoring.batch import batch_verify
from rulec.monitoring.batch.batch_verify import verify_chunk
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.verdict import NotJudged
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from support.builders.rulebooks import compile_here
from support.generators.random_records import chunks, rulebooks, told


def with_names(trace, names):
    """The trace with its objects renamed, in every place that speaks of them."""

    def inner(value):
        if not isinstance(value, dict):
            return value
        return {names.get(name, name): inner(one) for name, one in value.items()}

    states = tuple({name: inner(value) for name, value in state.items()} for state in trace.states)
    return Trace(trace.id, trace.step_s, inner(trace.objects), states, inner(trace.present))


@given(rulebooks(), chunks(), st.data())
def test_answers_are_those_of_the_traces_alone(rulebook, traces, data):
    """Names are swapped, too, and `nobody`, whom odd states speak of, is an object's name here."""
    compiled = compile_here(rulebook)
    orders = st.permutations(["a", "b", "c", "nobody", "e"])
    traces = [
        with_names(trace, dict(zip("abc", data.draw(orders)[:3], strict=True))) for trace in traces
    ]
    alone = [told(verify_or_reason(trace, compiled)) for trace in traces]
    assert [told(one) for one in verify_chunk(traces, compiled)] == alone


PAIRS = """rulebook pairs
type car
type bus is car
signal yields_to(v: car, w: car) default false
signal slow(v: car) default false
signal rain default false
hard rule mutual (v: car, w: bus) { require always (yields_to(v, w) implies next slow(w)) }
soft rule calm (v: car) { require never (slow(v) and rain) }
"""


@cache
def pairs():
    return compile_here(parse_rulebook(PAIRS, "pairs.rules"))


def drive(chance, number, n_states=3):
    """A trace of two cars and a bus, which is there from its second state on."""
    one, bus, other = names = [f"{number}.{n}" for n in range(3)]

    def state():
        return {
            "yields_to": {v: {w: chance.random() < 0.5 for w in names if w != v} for v in names},
            "slow": {name: chance.random() < 0.5 for name in names},
            "rain": chance.random() < 0.5,
        }

    objects = {one: "car", bus: "bus", other: "car"}
    states = tuple(state() for _ in range(n_states))
    return Trace(str(number), 0.5, objects, states, {bus: (1, n_states - 1)})


def test_they_are_judged_together(monkeypatch):
    chance = Random(7)
    traces = [drive(chance, number) for number in range(100)]
    alone = [verify_or_reason(trace, pairs()) for trace in traces]
    bound = {item for one in alone for each in one.violations for item in each.binding.values()}
    assert len(bound) > 100
    monkeypatch.setattr(
        batch_verify, "verify_or_reason", lambda *_: pytest.fail("a trace was judged alone")
    )
    assert verify_chunk(traces, pairs()) == alone


def test_a_trace_that_speaks_of_another_ones_objects_is_refused():
    chance = Random(7)
    traces = [drive(chance, number) for number in range(8)]
    traces[5] = with_names(traces[5], {})
    traces[5].states[1]["slow"]["3.0"] = True
    answers = verify_chunk(traces, pairs())
    assert [told(one) for one in answers] == [
        told(verify_or_reason(one, pairs())) for one in traces
    ]
    assert [isinstance(one, NotJudged) for one in answers] == [n == 5 for n in range(8)]
