"""Formulas on bits: along one trace and across many, they say what direct evaluation says."""

from itertools import product

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Same,
    Unary,
    UnaryOperator,
)
from rulec.logic.semantics import holds
from rulec.trace.trace_columns import layout_of
from support.generators.random_formulas import formulas, letters, words
from support.generators.timed_formulas import (
    CARS,
    GAP,
    SPEED,
    is_true,
    letters_of,
    timed_formulas,
    timed_states,
    timed_words,
)
from support.oracles.bits import across, along
from support.oracles.bits.plane_program import program_of

both_semantics = st.sampled_from(["stutter", "finite"])
P, Q = Atom("p"), Atom("q")
NOT_P = Unary(UnaryOperator.NOT, P)
STATE = {"place": "near", "light": "red", "p": True, "q": False, SPEED: 1, GAP: 0, CARS: 2}
WITHOUT_P = {**STATE, "p": False}


def columns_of(word, true_in):
    return lambda one: np.array([true_in(one, state) for state in word], dtype=bool)


@given(timed_formulas, timed_words, both_semantics)
def test_along_a_trace(formula, word, semantics):
    expected = holds(formula, letters_of(formula, word), semantics)
    assert along(formula, len(word), columns_of(word, is_true), semantics) == expected


def is_in(one, letter):
    return one in letter


@given(formulas, words, both_semantics)
def test_along_a_trace_without_bounds(formula, word, semantics):
    column = columns_of(letters(word), is_in)
    expected = holds(formula, letters(word), semantics)
    assert along(formula, len(word), column, semantics) == expected


def by_step(found):
    """The layout of words, and their states in its order."""
    ordered = sorted(found, key=len, reverse=True)
    states = [word[t] for t in range(len(ordered[0])) for word in ordered if t < len(word)]
    return ordered, layout_of([len(word) for word in ordered]), states


@st.composite
def many_words(draw):
    """Some dozens of words over a few states: more chances than words drawn one by one."""
    pool = draw(st.lists(timed_states, min_size=1, max_size=6))
    chance = draw(st.randoms(use_true_random=False))
    return [chance.choices(pool, k=chance.randint(1, 8)) for _ in range(40)]


@given(timed_formulas, many_words(), both_semantics)
@example(Unary(UnaryOperator.ALWAYS, P), [[STATE, STATE], [STATE]], "finite")
@example(Unary(UnaryOperator.EVENTUALLY, NOT_P), [[STATE, STATE], [STATE]], "finite")
@example(Unary(UnaryOperator.WEAK_NEXT, P), [[STATE, WITHOUT_P], [STATE]], "finite")
def test_across_traces_of_any_lengths(formula, found, semantics):
    ordered, layout, states = by_step(found)
    verdicts = across(formula, layout, columns_of(states, is_true), semantics)
    assert verdicts.tolist() == [
        holds(formula, letters_of(formula, word), semantics) for word in ordered
    ]


SPANS = [None, (0, 0), (0, 1), (1, 2), (2, None), (4, 5)]
"""The last is longer than any of the short words."""
BOOLEAN = {"not", "and", "or", "implies", "iff", "xor"}
DISTANCE = {"next", "weak next", "previously", "weak previously"}


def bounds_of(operator):
    if operator.value in BOOLEAN:
        return [None]
    spans = [None, (0, 0), (2, 2), (4, 4)] if operator.value in DISTANCE else SPANS
    return [None if one is None else Bound(*one, "steps") for one in spans]


OPERATIONS = [
    *(Unary(operator, P, bound) for operator in UnaryOperator for bound in bounds_of(operator)),
    *(
        Binary(operator, P, Q, bound)
        for operator in BinaryOperator
        for bound in bounds_of(operator)
    ),
]
CASES = [
    *OPERATIONS,
    *(Unary(UnaryOperator.NEXT, one) for one in OPERATIONS),
    *(Unary(UnaryOperator.EVENTUALLY, one) for one in OPERATIONS),
]
LETTERS = [frozenset(), frozenset({P}), frozenset({Q}), frozenset({P, Q})]
SHORT = [list(word) for n in (3, 2, 1) for word in product(LETTERS, repeat=n)]


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
def test_every_operator_on_all_short_words(semantics):
    """Together, whatever their length, and with those of the same; and one by one."""
    groups = [SHORT, *([one for one in SHORT if len(one) == n] for n in (1, 2))]
    wrong = []
    for formula in CASES:
        expected = {id(word): holds(formula, word, semantics) for word in SHORT}
        for group in groups:
            ordered, layout, states = by_step(group)
            column = columns_of(states, is_in)
            found = across(formula, layout, column, semantics).tolist()
            if found != [expected[id(word)] for word in ordered]:
                wrong.append((str(formula), len(ordered)))
        for word in SHORT:
            column = columns_of(word, is_in)
            if along(formula, len(word), column, semantics) != expected[id(word)]:
                wrong.append((str(formula), word))
    assert wrong == []


LONG_AGO = Unary(UnaryOperator.EVENTUALLY, Unary(UnaryOperator.PREVIOUSLY, P, Bound(9, 9, "steps")))


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(bits=st.lists(st.tuples(st.booleans(), st.booleans()), min_size=60, max_size=140))
@example(bits=[(True, False)] * 64 + [(True, True)])
@example(bits=[(True, False)] * 128 + [(False, True)])
@example(bits=[(True, True)] * 65)
def test_longer_than_a_word_of_the_machine(semantics, bits):
    """Carries pass the borders of words; so do traces, which are as many here as instants there."""
    p, q = (np.array(column) for column in zip(*bits, strict=True))
    columns = {P: p, Q: q}
    word = [{one for one in (P, Q) if columns[one][t]} for t in range(len(bits))]
    for formula in (
        Binary(BinaryOperator.UNTIL, P, Q),
        Binary(BinaryOperator.UNTIL, P, Q, Bound(3, 100, "steps")),
        Unary(
            UnaryOperator.EVENTUALLY, Binary(BinaryOperator.SINCE, P, Unary(UnaryOperator.NOT, Q))
        ),
        LONG_AGO,
    ):
        assert along(formula, len(bits), columns.__getitem__, semantics) == holds(
            formula, word, semantics
        )
    layout = layout_of([2] * len(bits))
    twice = {P: np.concatenate([p, q]), Q: np.concatenate([q, p])}
    # p where the trace has p first and q then.
    formula = Binary(BinaryOperator.THEN, P, Q)
    assert across(formula, layout, twice.__getitem__, semantics).tolist() == p.tolist()


@given(formulas)
def test_a_program_does_nothing_twice_and_nothing_in_vain(formula):
    operations = program_of(formula).operations
    assert len(set(operations)) == len(operations)
    taken = {place for operation in operations for place in operation.takes} - {0}
    assert taken == set(range(1, len(operations)))


def test_a_program_keeps_no_longer_than_needed():
    formula = Binary(BinaryOperator.AND, P, Unary(UnaryOperator.EVENTUALLY, Q))
    program = program_of(Unary(UnaryOperator.ALWAYS, formula))
    names = [(one.name, over) for one, over in zip(program.operations, program.over, strict=True)]
    assert names == [
        ("given", ()),
        ("given", ()),
        ("until", (2,)),
        ("both", (1, 3)),
        ("no", (4,)),
        ("ever", (5,)),
        ("opposite", (6,)),
    ]


def test_one_object_or_another_is_no_question_to_a_word():
    with pytest.raises(ValueError, match="counted objects"):
        along(Same("v", "w"), 1, lambda _: np.array([True]))


@pytest.mark.parametrize("lengths", [[1, 2], [2, 0], [[1]]])
def test_lengths_descend_and_are_above_0(lengths):
    with pytest.raises(ValueError, match="descend"):
        layout_of(lengths)


def test_a_layout_is_time_major_and_pads_nothing():
    layout = layout_of([3, 3, 1])
    assert layout.starts.tolist() == [0, 3, 5, 7]
    assert [layout.active(step) for step in range(4)] == [3, 2, 2, 0]
    assert (layout.n_traces, layout.n_steps, layout.n_states) == (3, 3, 7)
