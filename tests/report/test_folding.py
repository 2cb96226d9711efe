"""What is shown of a large explanation: what decides, and the states that there is room for."""

from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator
from rulec.monitoring.explain.explained_parts import Part
from rulec.report.verdicts.violation_table import fitting, folded, head, width
from support.builders.rulebooks import always, both, implies, no

A, B, C = (Atom(f"a_signal_with_a_long_name_{name}") for name in "abc")


def either(left, right):
    return Binary(BinaryOperator.OR, left, right)


def parts_of(formula, without=(), depth=0):
    """The parts of a formula; all decide but those in ``without``."""
    found = [Part(formula, depth, (True,), False, formula not in without, 0)]
    match formula:
        case Unary(_, operand):
            found += parts_of(operand, without, depth + 1)
        case Binary(_, left, right):
            found += parts_of(left, without, depth + 1) + parts_of(right, without, depth + 1)
    return found


def shown(formula, without=(), widest=48):
    return [title for title, _ in folded(parts_of(formula, without), widest)]


def later(operand):
    return Unary(UnaryOperator.NEXT, operand)


def test_links_of_a_chain_have_no_rows_of_their_own():
    assert shown(always(both(both(A, no(B)), later(C)))) == [
        "always (a_signal_with_a_long_name_a and not a_s…",
        "  a_signal_with_a_long_name_a and not a_signal_…",
        "    a_signal_with_a_long_name_a",
        "    not a_signal_with_a_long_name_b",
        "    next a_signal_with_a_long_name_c",
        "      a_signal_with_a_long_name_c",
    ]


def test_what_does_not_decide_is_left_out_with_all_its_parts():
    assert shown(either(both(A, B), later(C)), without=[both(A, B)]) == [
        "a_signal_with_a_long_name_a and a_signal_with_a…",
        "  next a_signal_with_a_long_name_c",
        "    a_signal_with_a_long_name_c",
    ]


def test_below_a_negation_stand_the_operands_of_what_is_negated():
    assert shown(no(either(A, later(B)))) == [
        "not (a_signal_with_a_long_name_a or next a_sign…",
        "  a_signal_with_a_long_name_a",
        "  next a_signal_with_a_long_name_b",
        "    a_signal_with_a_long_name_b",
    ]


def test_a_part_is_taken_apart_only_where_it_speaks_of_several_states():
    now = implies(Atom("p"), no(Atom("q")))
    assert shown(always(now)) == ["always (p implies not q)", "  p implies not q"]
    long = both(both(A, B), C)
    assert shown(always(long)) == [
        "always (a_signal_with_a_long_name_a and a_signa…",
        "  a_signal_with_a_long_name_a and a_signal_with…",
    ]
    assert shown(implies(Atom("p"), later(Atom("q")))) == [
        "p implies next q",
        "  p",
        "  next q",
        "    q",
    ]


def test_of_a_deep_part_there_is_something_to_read():
    """Each level is 2 characters further in, so that none would be left at level 24."""
    deep = reduce(lambda inner, _: Unary(UnaryOperator.NEXT, inner), range(30), A)
    assert shown(deep)[-1] == "  " * 30 + "a_signal_with_a_long_na…"


@pytest.mark.parametrize(
    ("columns", "decisive", "room", "expected"),
    [
        # All fit: two characters before each.
        (["T", "T", "F", "T"], 2, 12, ["0", "1", "2", "3"]),
        # Neighbours that are alike become one, the decisive one never.
        (["T", "T", "F", "F"], 2, 11, ["0-1", "2", "3"]),
        (["T", "T", "T", "T"], 2, 11, ["0-1", "2", "3"]),
        # Then those go that are the farthest from the decisive one, but for the first.
        (["A", "B", "C", "D", "E", "F"], 4, 15, ["0", "2", "3", "4", "5"]),
        (["A", "B", "C", "D", "E", "F"], 4, 9, ["0", "3", "4"]),
        # The decisive one stays, come what may, then the one before it is the last to go.
        (["A", "B", "C", "D", "E", "F"], 4, 6, ["3", "4"]),
        (["A", "B", "C", "D", "E", "F"], 4, 0, ["4"]),
        (["A", "B"], 0, 0, ["0"]),
    ],
)
def test_the_columns_that_fit(columns, decisive, room, expected):
    states = range(len(columns))
    found = fitting([[one] for one in columns], states, decisive, room)
    assert [head(states, places) for places in found] == expected


def test_states_that_do_not_follow_each_other_are_not_merged():
    found = fitting([["T"]] * 4, [0, 7, 8, 9], 3, 11)
    assert [head([0, 7, 8, 9], places) for places in found] == ["0", "7-8", "9"]


@given(
    cells=st.lists(st.sampled_from(["T", "F", "behind", "in_front_of"]), min_size=1, max_size=10),
    room=st.integers(0, 60),
    data=st.data(),
)
def test_columns_fit_or_the_decisive_one_stands_alone(cells, room, data):
    decisive = data.draw(st.integers(0, len(cells) - 1))
    columns, states = [[one] for one in cells], range(len(cells))
    found = fitting(columns, states, decisive, room)
    assert any(list(places) == [decisive] for places in found)
    assert [places.start for places in found] == sorted({places.start for places in found})
    assert all(len({cells[n] for n in places}) == 1 for places in found)
    assert len(found) == 1 or sum(width(columns, states, one) for one in found) <= room
