"""Coverage of rules with numbers: examples that pass the wanted limits, and what cannot be."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.book_tests.example_coverage import coverage
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator
from rulec.report.tests.example_text import missing_example
from rulec.rulebook.rulebook_model import Example, Rulebook, Variable
from rulec.witnesses.coverage_witness import is_possible
from support.builders.measured_vocabulary import MEASURED, SPEED, closer, gap, number, others_near
from support.builders.rulebooks import (
    P,
    always,
    both,
    compile_here,
    eventually,
    implies,
    near,
    no,
    rule,
)


def covered(formula, *examples):
    one = replace(rule("A", formula, "v: car"), examples=examples)
    rulebook = Rulebook("test", MEASURED, (one,))
    run = run_rulebook_examples(rulebook, compile_here(rulebook))
    (found,) = coverage(run)
    return found, run


def proposed(formula, *examples):
    found, _ = covered(formula, *examples)
    return [missing_example(edge, MEASURED) for edge in found.missing_edges]


def said(*gaps):
    return tuple({("gap", ("v",)): one} for one in gaps)


def test_numbers_that_pass_the_limits():
    assert proposed(always(no(closer("v", "1.5")))) == [
        "reject { gap(v) = 1 m }",
        "accept { gap(v) = 2 m }",
    ]
    assert proposed(always(number("", "<=", 30, (1, SPEED)))) == [
        "accept { speed = 30 km/h }",
        "reject { speed = 31 km/h }",
    ]
    assert proposed(always(number("", "=", "1.25", (1, gap("v"))))) == [
        "reject { gap(v) = 1 m }",
        "accept { gap(v) = 1.25 m }",
    ]


def test_numbers_are_not_below_zero_where_others_do():
    assert proposed(always(number("", "=", 0, (1, gap("v"))))) == [
        "reject { gap(v) = 1 m }",
        "accept { gap(v) = 0 m }",
    ]
    # With a speed of 50 km/h, its default, the gap would be some -30 m.
    both_below, both_above = proposed(always(number("", "<", 20, (1, gap("v")), (1, SPEED))))
    assert "-" not in both_below + both_above
    assert proposed(always(number("", "<", 0, (1, gap("v"))))) == [
        "accept { gap(v) = -1 m }",
        "reject { gap(v) = 0 m }",
    ]


def test_between_two_limits_that_are_close():
    low = number("", ">", "0.71", (1, gap("v")))
    high = number("", "<", "0.72", (1, gap("v")))
    assert proposed(always(no(both(low, high)))) == [
        "accept { gap(v) = 0 m }",
        "reject { gap(v) = 0.711 m }",
    ]


def test_a_sum_is_made_up_of_what_is_free():
    braking = number("gap(v) < 2 s * speed", "<", 0, (1, gap("v")), ("-5/9", SPEED))
    assert proposed(always(no(braking))) == [
        "reject { gap(v) = 27 m and speed = 50 km/h }",
        "accept { gap(v) = 28 m and speed = 50 km/h }",
    ]
    # At 72 km/h 2 s are 40 m; the speed is chosen for its own limit first.
    fast = number("", ">=", 72, (1, SPEED))
    assert proposed(implies(fast, no(braking))) == [
        "accept { speed = 71 km/h and gap(v) = 39 m }",
        "reject { speed = 72 km/h and gap(v) = 39 m }",
    ]


def test_objects_are_added_where_they_count():
    crowd = number("count x: car (near(x)) >= 2", ">=", 2, (1, others_near("v")))
    assert proposed(always(implies(P, no(crowd)))) == [
        "accept { true }",
        "reject (car1: car, car2: car) { p and near(car1) and near(car2) }",
    ]


def test_a_sum_without_a_free_part_is_chosen_together_with_its_parts():
    slow = number("speed < 10 km/h", "<", 10, (1, SPEED))
    tight = number("gap(v) < 5 m", "<", 5, (1, gap("v")))
    mixed = number("gap(v) < speed", "<", 0, (1, gap("v")), (-1, SPEED))
    assert proposed(always(implies(both(slow, tight), mixed))) == [
        "accept { speed = 9 km/h and gap(v) = 4 m }",
        "reject { speed = 4 km/h and gap(v) = 4 m }",
    ]


def test_a_sum_that_cannot_be_together_with_its_parts_is_not_asked_for():
    slow = number("speed < 2 km/h", "<", 2, (1, SPEED))
    wide = number("gap(v) > 5 m", ">", 5, (1, gap("v")))
    mixed = number("gap(v) < speed", "<", 0, (1, gap("v")), (-1, SPEED))
    assert proposed(always(no(both(both(slow, wide), mixed)))) == [
        "accept { speed = 1 km/h and gap(v) = 0 m }"
    ]


def test_what_no_state_can_be_is_not_asked_for():
    many = others_near("v")
    found, _ = covered(always(number("", ">=", 0, (1, many))))
    assert (found.n_edges, found.n_values) == (0, 1)
    # There are never two and a half objects, nor a number in a trace that is a third.
    for limit, term, edges in ((Fraction(5, 2), many, 0), (Fraction(1, 3), SPEED, 1)):
        found, _ = covered(eventually(number("", "=", limit, (1, term))))
        assert (found.n_edges, found.n_values) == (edges, 1)
        assert [value for _, value in found.missing_values] == [False]


def test_more_of_a_sum_than_of_its_parts_may_be_possible():
    third = number("", "=", Fraction(1, 3), (1, gap("v")), (Fraction(1, 3), SPEED))
    found, _ = covered(eventually(third))
    assert (found.n_edges, found.n_values) == (2, 2)


@pytest.mark.parametrize(
    ("limits", "possible"),
    [
        ([("0.1", True), ("0.1", False)], [True, True, True]),
        ([("1/3", True), ("1/3", False)], [True, False, True]),
        ([("1e400", True)], [True, False]),
        ([("-1e400", True)], [False, True]),
    ],
)
def test_what_a_number_in_a_trace_can_be(limits, possible):
    thresholds = tuple(Threshold(Fraction(limit), inclusive) for limit, inclusive in limits)
    read = NumberRead(((Fraction(1), SPEED),), thresholds)
    assert [is_possible(read, digit) for digit in range(read.size)] == possible


def test_values_of_comparisons_are_seen():
    formula = always(no(closer("v", "1.5")))
    found, _ = covered(formula, Example(True, said(1.5, 1.6)))
    assert [value for _, value in found.missing_values] == [True]
    found, _ = covered(formula, Example(True, said(1.5)), Example(False, said(1.4)))
    assert (found.missing_values, found.missing_edges) == ((), ())


def test_objects_of_an_example_count():
    crowd = number("", ">=", 2, (1, others_near("v")))
    others = (Variable("a", "car"), Variable("b", "car"), Variable("t", "thing"))
    places = {("place", (name,)): "near" for name in "vabt"}
    example = Example(False, (places,), objects=others)
    found, run = covered(always(no(crowd)), example)
    assert run.outcomes[0].passed
    assert [value for _, value in found.missing_values] == [False]
    alone = Example(True, ({("place", ("v",)): "near"},))
    whole = number("", "=", 2, (1, others_near("v")))
    found, _ = covered(always(no(whole)), example, alone)
    assert found.missing_values == ()
    found, run = covered(always(no(crowd)), example, alone)
    assert run.outcomes[1].passed
    assert found.missing_values == ()


gaps = st.sampled_from(["-2", "0", "0.3", "1.5", "7/2", "100"])
relations = st.sampled_from(["<", "<=", "=", "!=", ">=", ">"])
sums = st.sampled_from([((1, gap("v")), (2, SPEED)), ((1, gap("v")), ("-5/18", SPEED))])
propositions = (
    st.builds(lambda relation, limit: number("", relation, limit, (1, gap("v"))), relations, gaps)
    | st.builds(
        lambda relation, limit, terms: number("", relation, limit, *terms), relations, gaps, sums
    )
    | st.sampled_from([near("v"), P])
)
unary = [UnaryOperator.ALWAYS, UnaryOperator.EVENTUALLY, UnaryOperator.NEXT, UnaryOperator.NOT]
binary = [BinaryOperator.UNTIL, BinaryOperator.OR]
formulas = st.recursive(
    propositions,
    lambda inner: (
        st.builds(Unary, st.sampled_from(unary), inner)
        | st.builds(Binary, st.sampled_from(binary), inner, inner)
    ),
    max_leaves=4,
)


@given(formulas)
def test_proposed_numbers_take_their_edges(formula):
    found, _ = covered(formula)
    assert len(found.missing_edges) == found.n_edges
    whole = [
        edge for edge in found.missing_edges if not any(state.besides for state in edge.states)
    ]
    examples = [Example(edge.accepted, tuple(s.says for s in edge.states)) for edge in whole]
    after, run = covered(formula, *examples)
    assert all(one.passed for one in run.outcomes)
    # Only what could not be written as facts may be left.
    assert all(any(state.besides for state in edge.states) for edge in after.missing_edges)


def test_an_atom_beside_numbers():
    assert proposed(always(implies(closer("v", "1"), Atom("q")))) == [
        "reject { not q and gap(v) = 0 m }",
        "accept { not q and gap(v) = 1 m }",
    ]
