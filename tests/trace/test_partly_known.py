"""What is partly known is what all that it may be has in common, and time ends where drives do."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.fold import fold
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Unary,
    UnaryOperator,
)
from rulec.logic.semantics import truth_values
from rulec.trace.partly_known.partly_known_values import EnumeratedChoice, Number, Truth
from rulec.trace.partly_known.row_stretches import RowStretches
from rulec.trace.partly_known.temporal_operators import BitInstants

P, Q = Atom("p"), Atom("q")
MOST_STATES = 4
BEYOND = 3
"""States beyond a cut end, as many as the bounds below reach."""

three_valued = st.lists(st.sampled_from("TF?"), min_size=1, max_size=MOST_STATES)
bounds = st.one_of(
    st.none(),
    st.tuples(st.integers(0, 2), st.one_of(st.none(), st.integers(0, 3))).map(
        lambda ends: Bound(
            Fraction(ends[0]), None if ends[1] is None else Fraction(ends[1]), "steps"
        )
    ),
)
UNARY = [operator for operator in UnaryOperator if operator is not UnaryOperator.NOT]
BINARY = [
    BinaryOperator.THEN,
    BinaryOperator.UNTIL,
    BinaryOperator.RELEASE,
    BinaryOperator.WEAK_UNTIL,
    BinaryOperator.STRONG_RELEASE,
    BinaryOperator.SINCE,
]
formulas = st.one_of(
    st.builds(Unary, st.sampled_from(UNARY), st.just(Q), bounds),
    st.builds(Binary, st.sampled_from(BINARY), st.just(P), st.just(Q), bounds),
)


@st.composite
def pairs(draw):
    left = draw(three_valued)
    return left, draw(st.lists(st.sampled_from("TF?"), min_size=len(left), max_size=len(left)))


def completions(values):
    return product(*[{"T": [True], "F": [False], "?": [False, True]}[value] for value in values])


def as_bits(values):
    """Known truth has one half, as its makers give it."""
    sure = sum(1 << place for place, value in enumerate(values) if value == "T")
    unknown = sum(1 << place for place, value in enumerate(values) if value == "?")
    return Truth(sure, sure | unknown) if unknown else Truth.known(sure)


def as_rows(values):
    sure = np.array([[value == "T" for value in values]])
    unknown = np.array([[value == "?" for value in values]])
    return Truth(sure, sure | unknown) if unknown.any() else Truth.known(sure)


def listed(truth, n_states):
    """The sure and the possible states."""
    if isinstance(truth.sure, int):
        return tuple(
            [bool(half >> place & 1) for place in range(n_states)]
            for half in (truth.sure, truth.possible)
        )
    return tuple(
        np.broadcast_to(half, (1, n_states))[0].tolist() for half in (truth.sure, truth.possible)
    )


def in_common(outcomes):
    """What holds in all of these, state by state, and what in some."""
    columns = list(zip(*outcomes, strict=True))
    return [all(column) for column in columns], [any(column) for column in columns]


@pytest.mark.parametrize("form", [as_bits, as_rows])
@given(pair=pairs())
def test_operators_are_exact_where_each_value_occurs_once(form, pair):
    left, right = pair
    p, q = form(left), form(right)
    found = {"and": p & q, "or": p | q, "not": ~p, "same": p.same_as(q)}
    both = list(product(completions(left), completions(right)))
    expected = {
        "and": [[a and b for a, b in zip(x, y, strict=True)] for x, y in both],
        "or": [[a or b for a, b in zip(x, y, strict=True)] for x, y in both],
        "not": [[not a for a in x] for x, _ in both],
        "same": [[a == b for a, b in zip(x, y, strict=True)] for x, y in both],
    }
    for name, truth in found.items():
        assert listed(truth, len(left)) == in_common(expected[name]), name
    assert listed(Truth.known(p.unknown), len(left))[0] == [value == "?" for value in left]


def evaluated(formula, instants, left, right):
    return fold(formula, instants.algebra({P: left, Q: right}.__getitem__))


def holds_in(formula, pair, ends):
    """The formula's values in all that the states may be, and what may lie beyond them."""
    letters = [frozenset(), frozenset({P}), frozenset({Q}), frozenset({P, Q})]
    beyond = [()]
    if ends == "cut":
        beyond = [own for n in range(BEYOND + 1) for own in product(letters, repeat=n)]
    looks_back = formula.operator in {
        UnaryOperator.ONCE,
        UnaryOperator.HISTORICALLY,
        UnaryOperator.PREVIOUSLY,
        UnaryOperator.WEAK_PREVIOUSLY,
        BinaryOperator.SINCE,
    }
    for left, right in product(completions(pair[0]), completions(pair[1])):
        word = [
            frozenset(atom for atom, value in ((P, p), (Q, q)) if value)
            for p, q in zip(left, right, strict=True)
        ]
        for others in beyond:
            whole = [*others, *word] if looks_back else [*word, *others]
            begin = len(others) if looks_back else 0
            values = truth_values(formula, whole, "stutter" if ends == "goes on" else "finite")
            yield values[begin : begin + len(word)]


@given(pairs(), formulas, st.sampled_from(["over", "goes on", "cut"]))
def test_operators_of_time_are_exact_and_alike_in_both_forms(pair, formula, ends):
    n_states = len(pair[0])
    bits = evaluated(formula, BitInstants(n_states, ends), *map(as_bits, pair))
    first, last = np.array([[0]]), np.array([[n_states - 1]])
    rows = evaluated(formula, RowStretches(first, last, n_states, ends), *map(as_rows, pair))
    assert listed(bits, n_states) == listed(rows, n_states)
    sure, possible = in_common(holds_in(formula, pair, ends))
    own_sure, own_possible = listed(bits, n_states)
    assert all(a <= b for a, b in zip(own_sure, sure, strict=True))
    assert all(a <= b for a, b in zip(possible, own_possible, strict=True))
    weak = BinaryOperator.WEAK_UNTIL, BinaryOperator.STRONG_RELEASE
    if formula.operator not in weak:  # their operands occur twice
        assert (own_sure, own_possible) == (sure, possible)


@given(
    st.lists(pairs(), min_size=1, max_size=3), formulas, st.sampled_from(["over", "goes on", "cut"])
)
def test_drives_laid_end_to_end_are_as_each_alone(drives, formula, ends):
    lengths = [len(left) for left, _ in drives]
    end = np.cumsum(lengths)
    last = (end - 1).repeat(lengths)
    first = (end - lengths).repeat(lengths)
    together = [[value for drive in drives for value in drive[n]] for n in (0, 1)]
    instants = RowStretches(first, last, sum(lengths), ends)
    found = evaluated(formula, instants, *map(as_rows, together))
    expected = [[], []]
    for pair, n_states in zip(drives, lengths, strict=True):
        alone = evaluated(formula, BitInstants(n_states, ends), *map(as_bits, pair))
        for half, own in zip(expected, listed(alone, n_states), strict=True):
            half += own
    assert listed(found, sum(lengths)) == tuple(expected)


def test_what_lies_beyond_a_cut_is_unknown():
    """Nobody knows whether what holds in the first state began there."""
    began = Unary(UnaryOperator.PREVIOUSLY, Q)
    instants = BitInstants(3, "cut")
    assert listed(evaluated(began, instants, None, as_bits("TFT")), 3) == (
        [False, True, False],
        [True, True, False],
    )
    over = evaluated(began, BitInstants(3, "over"), None, as_bits("TFT"))
    assert listed(over, 3)[1] == [False, True, False]


def test_a_number_known_as_one_stays_known():
    low, high = Number(2, 2) + Number(3, 3), Number(2, 4) + Number(3, 3)
    assert (low.low, low.high, high.low, high.high) == (5, 5, 5, 7)
    unbounded = Number(np.array([-np.inf, 1.0]), np.array([np.inf, 2.0]))
    assert unbounded.unknown.tolist() == [True, False]


@given(st.lists(st.sets(st.integers(0, 8), min_size=1), min_size=1), st.integers(0, 8))
def test_a_choice_equals_a_value_if_it_can_be_no_other(choices, place):
    bits = np.array([sum(1 << value for value in own) for own in choices], dtype=np.uint16)
    choice = EnumeratedChoice(bits)
    truth = choice.equals(place)
    assert truth.sure.tolist() == [own == {place} for own in choices]
    assert truth.possible.tolist() == [place in own for own in choices]
    assert choice.unknown.tolist() == [len(own) > 1 for own in choices]


@given(pair=pairs())
def test_a_mask_is_an_operand_that_is_known(pair):
    left, right = pair
    truth, mask = as_rows(left), np.array([value == "T" for value in right])[None]
    for found, expected in (
        (mask & truth, truth & Truth.known(mask)),
        (truth & mask, truth & Truth.known(mask)),
        (mask | truth, truth | Truth.known(mask)),
        (truth | mask, truth | Truth.known(mask)),
    ):
        assert listed(found, len(left)) == listed(expected, len(left))
    more = truth.or_possibly(mask)
    assert listed(more, len(left))[0] == listed(truth, len(left))[0]
    assert listed(more, len(left))[1] == listed(truth | Truth.known(mask), len(left))[1]


@given(st.integers(-9, 9), st.integers(0, 5), st.integers(-9, 9))
def test_a_number_is_compared_for_all_that_it_may_be(measured, error, limit):
    number = Number.within(np.array([measured]), error)
    numbers = [measured + more for more in range(-error, error + 1)]
    for truth, outcomes in (
        (number > limit, [value > limit for value in numbers]),
        (number < limit, [value < limit for value in numbers]),
    ):
        assert (truth.sure.item(), truth.possible.item()) == (all(outcomes), any(outcomes))
