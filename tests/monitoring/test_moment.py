"""One state read: who is there, counts within counts, and what is not known."""

from fractions import Fraction

import pytest

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    Count,
    QuantityTerm,
    Same,
)
from rulec.logic.kleene import Unknown, holds, number_of, objects_counted, weighted_sum
from rulec.monitoring.state_view import StateView
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as QuantityItem
from support.builders.rulebooks import P, Q, always, both, far, near, no

VOCABULARY = Vocabulary(
    "numbers",
    {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
    {
        "place": Enumeration("place", ("thing",), ("near", "far", "gone")),
        "gap": QuantityItem("gap", ("thing", "thing"), "m"),
        "speed": QuantityItem("speed", (), "km/h", 50.0),
        "p": Signal("p", (), False),
        "q": Signal("q", ()),
    },
)
OBJECTS = {"car1": "car", "car2": "car", "tree": "thing"}
STATE = {
    "place": {"car1": "near", "car2": "near", "tree": "far"},
    "gap": {"car1": {"car2": 0.1, "tree": 7.5}, "car2": {"car1": 0.1}},
}
HERE = StateView(STATE, OBJECTS, VOCABULARY)


def times(factor, term):
    return Fraction(factor), term


def less(limit, *terms):
    return Comparison(terms, "<", Fraction(limit))


def close(one, other):
    return less(5, times(1, QuantityTerm("gap", (one, other))))


def test_objects_of_a_type_count_and_those_of_its_subtypes():
    assert objects_counted(Count("x", "thing", Constant(True)), {}, HERE) == (
        "car1",
        "car2",
        "tree",
    )
    assert objects_counted(Count("x", "car", Constant(True)), {}, HERE) == ("car1", "car2")
    assert objects_counted(Count("x", "thing", far("x")), {}, HERE) == ("tree",)


def test_objects_that_are_not_there_do_not_count_and_need_no_values():
    here = StateView({"place": {"car1": "near"}}, {"car1": "car"}, VOCABULARY)
    assert objects_counted(Count("x", "thing", near("x")), {}, here) == ("car1",)


def test_an_object_that_a_variable_names_counts_too():
    others = both(near("x"), no(Same("x", "v")))
    assert objects_counted(Count("x", "car", near("x")), {"v": "car1"}, HERE) == ("car1", "car2")
    assert objects_counted(Count("x", "car", others), {"v": "car1"}, HERE) == ("car2",)


@pytest.mark.parametrize("same", [Same("x", "v"), Same("v", "x")])
def test_only_the_one_that_a_variable_names(same):
    for body in (both(near("x"), same), both(both(same, near("x")), near("x"))):
        assert objects_counted(Count("x", "car", body), {"v": "car2"}, HERE) == ("car2",)
        assert objects_counted(Count("x", "car", body), {"v": "tree"}, HERE) == ()
        assert objects_counted(Count("x", "thing", body), {"v": "tree"}, HERE) == ()
    unknown = objects_counted(Count("x", "car", both(same, close("v", "x"))), {"v": "car1"}, HERE)
    assert unknown == Unknown("gap", ("car1", "car1"))
    away = StateView({"place": {"car1": "near"}}, {"car1": "car"}, VOCABULARY)
    assert objects_counted(Count("x", "car", same), {"v": "car2"}, away) == ()


def test_a_count_within_a_count():
    has_company = less(0, times(-1, Count("y", "car", both(near("y"), no(Same("x", "y"))))))
    assert objects_counted(Count("x", "thing", has_company), {}, HERE) == ("car1", "car2", "tree")
    alone = StateView(
        {"place": {"car1": "near", "tree": "far"}}, {"car1": "car", "tree": "thing"}, VOCABULARY
    )
    assert objects_counted(Count("x", "thing", has_company), {}, alone) == ("tree",)


def test_the_inner_variable_hides_the_outer_one():
    assert objects_counted(Count("v", "thing", far("v")), {"v": "car1"}, HERE) == ("tree",)


def test_sums_are_exact():
    gap, speed = QuantityTerm("gap", ("v", "w")), QuantityTerm("speed")
    bound = {"v": "car1", "w": "car2"}
    # Three tenths are three tenths; floats would say 0.30000000000000004.
    assert weighted_sum([times(3, gap)], bound, HERE) == Fraction(3, 10)
    assert weighted_sum([times(1, gap), times(Fraction(-5, 18), speed)], bound, HERE) == (
        Fraction(1, 10) - Fraction(250, 18)
    )
    assert number_of(speed, {}, HERE) == 50


@pytest.mark.parametrize(
    ("relation", "truth"),
    [("<", False), ("<=", True), ("=", True), ("!=", False), (">=", True), (">", False)],
)
def test_relations_at_the_limit(relation, truth):
    one = Comparison((times(1, QuantityTerm("gap", ("v", "w"))),), relation, Fraction(1, 10))
    assert holds(one, {"v": "car1", "w": "car2"}, HERE) is truth


UNKNOWN = Unknown("q", ())


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        (Q, UNKNOWN),
        (no(Q), UNKNOWN),
        (P, False),
        (both(Q, P), False),
        (both(P, Q), False),
        (both(no(P), Q), UNKNOWN),
        (both(Q, no(P)), UNKNOWN),
        (Binary(BinaryOperator.OR, Q, no(P)), True),
        (Binary(BinaryOperator.OR, Q, P), UNKNOWN),
        (Binary(BinaryOperator.OR, P, no(P)), True),
        (Binary(BinaryOperator.IMPLIES, P, Q), True),
        (Binary(BinaryOperator.IMPLIES, Q, no(P)), True),
        (Binary(BinaryOperator.IMPLIES, Q, P), UNKNOWN),
        (Binary(BinaryOperator.IMPLIES, no(P), P), False),
        (Binary(BinaryOperator.IFF, P, Q), UNKNOWN),
        (Binary(BinaryOperator.IFF, P, P), True),
        (Binary(BinaryOperator.XOR, Q, P), UNKNOWN),
        (Binary(BinaryOperator.XOR, P, no(P)), True),
    ],
)
def test_what_can_be_told_without_an_unknown_value_is_told(formula, expected):
    assert holds(formula, {}, HERE) == expected


def test_nobody_needs_to_know_the_gap_to_itself():
    """Whichever way round it is written."""
    not_me = no(Same("x", "v"))
    for body in (both(not_me, close("v", "x")), both(close("v", "x"), not_me)):
        assert objects_counted(Count("x", "car", body), {"v": "car1"}, HERE) == ("car2",)
    lonely = objects_counted(Count("x", "thing", close("v", "x")), {"v": "car1"}, HERE)
    assert lonely == Unknown("gap", ("car1", "car1"))


def test_what_decides_is_named_not_what_could_be_done_without():
    body = both(no(Same("x", "v")), close("v", "x"))
    missing = objects_counted(Count("x", "thing", body), {"v": "car2"}, HERE)
    assert missing == Unknown("gap", ("car2", "tree"))


def test_a_signal_and_a_value():
    here = StateView({"p": True, "q": False}, {}, VOCABULARY)
    assert holds(P, {}, here) is True
    assert holds(Q, {}, here) is False
    assert holds(Atom("place", ("v",), "near"), {"v": "tree"}, HERE) is False


def test_time_has_no_place_in_one_state():
    with pytest.raises(TypeError, match="one state alone"):
        holds(always(P), {}, HERE)
