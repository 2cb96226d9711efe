"""Traces in arrays are explained as their states are, of which few are made."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.logic.free_names import names_in
from rulec.monitoring.explain.explained_arrays import explain_arrays
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.verdict import Verdict
from rulec.monitoring.verify import verify, verify_or_reason
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.array_traces import CannotSayError, in_arrays
from support.builders.rulebooks import compile_here
from support.generators.blurred_traces import blurred
from support.generators.constant_values import steady, with_some_constant, with_unknown_constants
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds


@given(seeds)
@settings(phases=[Phase.generate], max_examples=settings().max_examples // 4)
def test_columns_explain_what_states_do(chance):
    book = with_some_constant(chance, rulebook(chance, Fraction(1)))
    compiled, vocabulary = compile_here(book, Fraction(1)), book.vocabulary
    single = {name for name, own in vocabulary.declarations.items() if len(own.parameters) < 2}
    names = {n for x in (*book.rules, *book.axioms) for n in names_in(x.formula)}
    for whole in traces(chance, Fraction(1))[:3]:
        states = [{x: own for x, own in state.items() if x in single} for state in whole.states]
        steadied = steady(replace(whole, states=tuple(states)), vocabulary.constants)
        dark = blurred(chance, steadied, (names & single) - {*vocabulary.constants}, most=12)
        dark = with_unknown_constants(chance, dark, vocabulary.constants)
        told = frozenset().union(*dark.states) if chance.random() < 0.5 else None
        try:
            arrays = in_arrays(replace(dark, ends="cut", told=told), vocabulary)
        except CannotSayError:
            continue
        trace = arrays.trace()
        verdict = verify_or_reason(trace, compiled)
        for violation in verdict.violations if isinstance(verdict, Verdict) else ():
            found = explain_arrays(violation, arrays, compiled, {})
            assert found in (None, explain(violation, trace, compiled, repaired=False))


BOOK = """\
rulebook shown
type car
light is one of red, green default green
quantity speed in m/s default 0
quantity limit in m/s default 10
quantity reach in m default 10
quantity far(c: car) in m default 0
signal parked(c: car) default false
signal ahead(c: car) default false
hard rule slow { require always (speed - limit < 0.3 m/s) }
hard rule near (v: car) { require always (far(v) <= 20 m) }
hard rule one_away { require always (count c: car (far(c) - reach > 5 m) <= 1) }
hard rule other_parked (v: car) { require always not some c: car (c = v and parked(c)) }
hard rule go { require never red }
hard rule past (v: car) { require never (ahead(v) then not ahead(v) and green) }
"""
"""What is read: a sum, one object, who counts among all, one other name for ego's, a text."""

CARS = {"a": "car", "b": "car"}


@pytest.mark.parametrize(
    ("state", "rule", "decisive"),
    [
        # As decimals the sum is the limit; as floats it is below
        ({"speed": 1.2, "limit": 0.9}, "slow", 2),
        ({"speed": Interval(10.3, 10.5), "limit": 10.0}, "slow", 2),
        ({"far": {"a": Interval(20.5, 21), "b": UNKNOWN}}, "near", 2),
        ({"far": {"a": 15.2, "b": Interval(16, 17)}, "reach": 10.1}, "one_away", 2),
        ({"parked": {"b": True}}, "other_parked", 2),
        ({"light": "red"}, "go", 2),
        ({"ahead": {"a": True, "b": False}}, "past", 3),
    ],
)
def test_one_state_of_two_cars(state, rule, decisive):
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    trace = Trace("t", 1.0, CARS, ({}, {}, state, {}), {"b": (1, 3)}, ends="cut")
    arrays = in_arrays(trace, compiled.vocabulary)
    (violation,) = [x for x in verify(trace, compiled).violations if x.rule == rule]
    found = explain_arrays(violation, arrays, compiled, {})
    assert found == explain(violation, trace, compiled, repaired=False)
    assert found.decisive == decisive


def test_a_constant_that_is_unknown_in_some_states_is_what_others_say():
    source = "rulebook c\nquantity limit in m/s\nquantity speed in m/s\nconstant limit\n"
    source += "hard rule r { require always (speed <= limit) }\n"
    compiled = rulec.compile(rulec.parse_rulebook(source))
    states = ({"limit": UNKNOWN, "speed": 3.0}, {"limit": 2.0, "speed": 3.0})
    trace = Trace("t", 1.0, {}, states, ends="cut")
    (violation,) = verify(trace, compiled).violations
    assert explain_arrays(violation, in_arrays(trace, compiled.vocabulary), compiled, {}) is None
    limits = {fact.text: fact.values for fact in explain(violation, trace, compiled).facts}
    assert limits["limit"] == (2.0, 2.0)


def test_what_follows_from_other_values_takes_all_states():
    source = "rulebook f\nsignal a\nsignal b default false\nfact a implies b\n"
    compiled = rulec.compile(rulec.parse_rulebook(source + "hard rule r { require never b }\n"))
    trace = Trace("t", 1.0, {}, ({"a": True, "b": True}, {"a": True}), ends="cut")
    (violation,) = verify(trace, compiled).violations
    assert explain_arrays(violation, in_arrays(trace, compiled.vocabulary), compiled, {}) is None


def test_some_states_of_a_trace():
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    states = (
        {"speed": 1.0, "far": {"a": 1.0}},
        {"speed": UNKNOWN, "far": {"a": 2.0, "b": 5.0}},
        {"far": {"b": Interval(6, 7)}, "parked": {"b": True}},
        {"speed": 4.0, "light": "red"},
    )
    trace = Trace("t", 1.0, {"a": "car", "b": "car"}, states, {"a": (0, 1), "b": (1, 2)})
    arrays = in_arrays(trace, compiled.vocabulary)
    assert arrays.at((0, 1, 2, 3)).trace() == trace
    assert arrays.at((0, 2)).trace() == replace(
        trace, states=states[::2], present={"a": (0, 0), "b": (1, 1)}
    )
    assert arrays.at((3,)).trace() == replace(trace, objects={}, states=states[3:], present={})
