"""The state in which what decides is found, whatever kind of value it is; parts of arrays."""

from dataclasses import replace

import pytest
from hypothesis import given

import rulec
from rulec.logic.formula import atoms_of
from rulec.logic.semantics import holds, truth_values
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.explain.observed_states import ObservedWord, bits_of
from rulec.trace import Trace
from rulec.trace.trace_arrays import stretches_of
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.array_traces import in_arrays
from support.generators.timed_formulas import letters_of, timed_formulas, timed_words

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
    (violation,) = [x for x in verify(trace, compiled).violations if x.rule == rule]
    found = explain(violation, trace, compiled, repaired=False)
    assert found.decisive == decisive


def test_a_constant_that_is_unknown_in_some_states_is_what_others_say():
    source = "rulebook c\nquantity limit in m/s\nquantity speed in m/s\nconstant limit\n"
    source += "hard rule r { require always (speed <= limit) }\n"
    compiled = rulec.compile(rulec.parse_rulebook(source))
    states = ({"limit": UNKNOWN, "speed": 3.0}, {"limit": 2.0, "speed": 3.0})
    trace = Trace("t", 1.0, {}, states, ends="cut")
    (violation,) = verify(trace, compiled).violations
    limits = {fact.text: fact.values for fact in explain(violation, trace, compiled).facts}
    assert limits["limit"] == (2.0, 2.0)


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
    some = [range(4), range(1, 3), range(3, 4)]
    whole, middle, last = stretches_of([arrays] * 3, some, {"speed", "far", "parked", "light"})
    assert whole.trace() == trace
    assert middle.trace() == replace(trace, states=states[1:3], present={"a": (0, 0)})
    assert last.trace() == replace(trace, objects={}, states=states[3:], present={})


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(formula=timed_formulas, word=timed_words)
def test_all_parts_have_the_values_of_their_definitions(semantics, formula, word):
    letters = letters_of(formula, word)
    truths = {atom: bits_of([atom in own for own in letters]) for atom in atoms_of(formula)}
    observed = ObservedWord(truths, len(letters), semantics)
    assert observed.holds(formula) == holds(formula, letters, semantics)
    for part, values in observed.parts(formula).items():
        assert values[: len(letters)] == truth_values(part, letters, semantics)
