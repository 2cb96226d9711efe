"""Truth at every state: that of the definitions where all is known, and within it elsewhere."""

from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import atoms_of
from rulec.logic.kleene import holds
from rulec.logic.semantics import truth_values
from rulec.monitoring.moments import trace_truth
from rulec.monitoring.moments.name_tables import tables_of
from rulec.monitoring.moments.trace_truth import ReadyFormula, TraceTruth
from rulec.monitoring.state_view import StateView
from rulec.rulebook.rulebook_model import Variable
from rulec.trace import Trace
from rulec.trace.trace_model import present_in
from rulec.vocabulary.partial_values import UNKNOWN
from support.generators.timed_formulas import TIMED_VOCABULARY, timed_formulas

CARS = ("a", "b", "c")
X = (Variable("x", "thing"),)
PLACES = ["near", "far", "gone"]

states = st.fixed_dictionaries(
    {
        "place": st.fixed_dictionaries({car: st.sampled_from(PLACES) for car in CARS}),
        "light": st.sampled_from(["red", "green"]),
        "p": st.booleans(),
        "q": st.booleans(),
        "speed": st.sampled_from([0.0, 0.25, 1.0]),
        "gap": st.fixed_dictionaries({car: st.sampled_from([0.5, 1.0, 2.5]) for car in CARS}),
    }
)


@st.composite
def traces(draw, most_states=6):
    word = draw(st.lists(states, min_size=1, max_size=most_states))
    present = {}
    for car in CARS[1:]:
        first = draw(st.integers(0, len(word) - 1))
        present[car] = (first, draw(st.integers(first, len(word) - 1)))
    return Trace("t", 1.0, dict.fromkeys(CARS, "car"), tuple(word), present)


def word_of(formula, trace, car, first, last):
    """What is true of a car in each state that it is there, proposition by proposition."""
    return [
        frozenset(
            atom
            for atom in atoms_of(formula)
            if holds(
                atom,
                {"x": car},
                StateView(
                    trace.states[state],
                    present_in(state, trace.objects, trace.present),
                    TIMED_VOCABULARY,
                ),
            )
            is True
        )
        for state in range(first, last + 1)
    ]


def rows_of(formula, trace, semantics):
    tables = tables_of(trace, TIMED_VOCABULARY)
    truth = TraceTruth(tables, semantics, trace.ends)
    return {
        tables.objects[item]: (
            *(int(ends[row]) for ends in truth.stretch_of(part.choices)),
            part.truth.sure[row],
            part.truth.possible[row],
        )
        for part in truth.of(ReadyFormula(formula), truth.choices_of(X))
        for row, (item,) in enumerate(part.choices.items.tolist())
    }


@given(timed_formulas, traces(), st.sampled_from(["stutter", "finite"]))
def test_what_is_known_is_as_defined(formula, trace, semantics):
    found = rows_of(formula, trace, semantics)
    for car in CARS:
        first, last = trace.present.get(car, (0, len(trace.states) - 1))
        expected = truth_values(formula, word_of(formula, trace, car, first, last), semantics)
        if car not in found:
            assert not any(expected)
            continue
        own_first, own_last, sure, possible = found[car]
        assert (own_first, own_last) == (first, last)
        assert sure[first : last + 1].tolist() == expected
        assert (sure == possible).all()
        assert not sure[:first].any()


@given(timed_formulas, traces(4), st.data())
def test_what_is_unknown_is_bounded_by_its_completions(formula, trace, data):
    """A few Booleans are unknown; what is sure holds whatever they are."""
    places = list(product(range(len(trace.states)), "pq"))
    dark = data.draw(st.lists(st.sampled_from(places), unique=True, max_size=3))

    def completed(values):
        new = [dict(state) for state in trace.states]
        for (state, name), value in zip(dark, values, strict=True):
            new[state][name] = value
        return Trace("t", 1.0, trace.objects, tuple(new), trace.present)

    found = rows_of(formula, completed([UNKNOWN] * len(dark)), "finite")
    for values in product([False, True], repeat=len(dark)):
        own = rows_of(formula, completed(values), "finite")
        for car in CARS:
            if car not in found:
                assert car not in own or not own[car][2].any()
                continue
            _, _, sure, possible = found[car]
            actual = own[car][2] if car in own else np.zeros_like(sure)
            assert not (sure & ~actual).any()
            assert not (actual & ~possible).any()


@given(timed_formulas, traces(4), traces(3), traces(3), st.sampled_from(["stutter", "finite"]))
def test_what_is_cut_is_bounded_by_what_it_may_be_cut_from(formula, trace, before, behind, reading):
    cut = Trace("t", 1.0, trace.objects, trace.states, trace.present, ends="cut")
    found = rows_of(formula, cut, reading)
    for car in CARS:
        first, last = trace.present.get(car, (0, len(trace.states) - 1))
        alone = Trace("t", 1.0, {car: "car"}, trace.states[first : last + 1])
        own = rows_of(formula, Trace("t", 1.0, {car: "car"}, alone.states, ends="cut"), reading)
        assert counts_alone(formula) or car not in found or same(own.get(car), found[car])
        whole = (*before.states, *alone.states, *behind.states)
        actual = rows_of(formula, Trace("t", 1.0, {car: "car"}, whole), reading)
        n_before, n_states = len(before.states), len(alone.states)
        if car not in actual:
            assert car not in own or not own[car][2].any()
            continue
        values = actual[car][2][n_before : n_before + n_states]
        if car not in own:
            assert not values.any()
            continue
        assert not (own[car][2] & ~values).any()
        assert not (values & ~own[car][3]).any()


def counts_alone(formula):
    """Whether a formula counts objects, which other objects change."""
    return "count" in str([str(atom) for atom in atoms_of(formula)])


def same(alone, among):
    first, last, sure, possible = among
    if alone is None:
        return not possible.any()
    inside = slice(first, last + 1)
    return (alone[2] == sure[inside]).all() and (alone[3] == possible[inside]).all()


@given(timed_formulas, traces(), st.sampled_from(["stutter", "finite"]))
def test_many_rows_are_evaluated_in_parts(formula, trace, semantics):
    together = rows_of(formula, trace, semantics)
    most, trace_truth.MOST_ENTRIES = trace_truth.MOST_ENTRIES, 1
    try:
        apart = rows_of(formula, trace, semantics)
    finally:
        trace_truth.MOST_ENTRIES = most
    assert together.keys() == apart.keys()
    assert all((together[car][2] == apart[car][2]).all() for car in together)
