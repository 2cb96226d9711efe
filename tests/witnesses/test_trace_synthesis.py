"""Traces through synthesised states: names, types and values of all objects."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.diagnostics import Diagnostic, RulecError
from rulec.logic.formula import Atom, Binary, BinaryOperator, Count, Same
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.vocabulary import ObjectType, Signal, Vocabulary
from rulec.witnesses.counted_objects import (
    MOST_COUNTED_OBJECTS,
    CountedObjectKinds,
    counted_objects_of_types,
    fewest_counted_objects,
)
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.state_synthesis import JointState
from rulec.witnesses.trace_synthesis import (
    place_objects,
    synthesize_trace,
)
from rulec.witnesses.undecided import UndecidedError

VOCABULARY = Vocabulary(
    "counted",
    {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
    {
        "loud": Signal("loud", ("thing",), False),
        "parked": Signal("parked", ("car",)),
        "fog": Signal("fog", (), False),
        "rain": Signal("rain", ()),
    },
)
UNIVERSE = ObjectUniverse({"x": "thing"}, VOCABULARY)
KINDS = CountedObjectKinds(UNIVERSE)
LOUD = Count("o", "thing", Atom("loud", ("o",)))
PARKED = Count("o", "car", Atom("parked", ("o",)))
BOTH = Count("o", "car", Binary(BinaryOperator.AND, LOUD.body, PARKED.body))


def state(*wanted, values=None, counted=0):
    """A state in which each count comes to exactly a number of objects."""
    digits = tuple(
        (
            NumberRead(
                ((Fraction(1), count),),
                (Threshold(Fraction(n), inclusive=True), Threshold(Fraction(n), inclusive=False)),
            ),
            1,
        )
        for count, n in wanted
    )
    counts = tuple((count, counted) for count, _ in wanted)
    return JointState(values or {}, digits, counts)


numbers = st.integers(0, 4)


@given(numbers, numbers, numbers)
def test_as_few_objects_as_can_be(n_loud, n_parked, n_both):
    found = fewest_counted_objects(state((LOUD, n_loud), (PARKED, n_parked), (BOTH, n_both)), KINDS)
    if n_both > min(n_loud, n_parked):
        assert found is None
    else:
        # Who is both counts three times.
        assert len(found) == n_loud + n_parked - n_both
        assert [sum(one.adds[place] for one in found) for place in range(3)] == [
            n_loud,
            n_parked,
            n_both,
        ]
        types = sorted(one.type for one in found)
        again = counted_objects_of_types(
            state((LOUD, n_loud), (PARKED, n_parked), (BOTH, n_both)), KINDS, types
        )
        assert [one.type for one in again] == types


def test_own_objects_count_already():
    assert fewest_counted_objects(state((LOUD, 2), counted=2), KINDS) == ()
    assert len(fewest_counted_objects(state((LOUD, 3), counted=2), KINDS)) == 1
    assert fewest_counted_objects(state((LOUD, 1), counted=2), KINDS) is None


def test_too_many_objects_are_left_undecided():
    with pytest.raises(UndecidedError, match="more than 40 objects"):
        fewest_counted_objects(state((LOUD, MOST_COUNTED_OBJECTS + 1)), KINDS)
    many = fewest_counted_objects(state((LOUD, MOST_COUNTED_OBJECTS)), KINDS)
    assert len(many) == MOST_COUNTED_OBJECTS


def test_kinds_are_told_apart_by_what_they_add():
    kinds = {(one.type, one.adds) for one in KINDS.of(state((LOUD, 1), (PARKED, 1)))}
    assert kinds == {
        *(("thing", (loud, 0)) for loud in (0, 1)),
        *(("car", (loud, parked)) for loud in (0, 1) for parked in (0, 1)),
    }


def test_axioms_hold_for_further_objects():
    axiom = Axiom((Variable("c", "thing"),), Atom("loud", ("c",)))
    universe = ObjectUniverse({}, VOCABULARY, (axiom,))
    assert {one.adds for one in CountedObjectKinds(universe).of(state((LOUD, 1)))} == {(1,)}


def test_objects_are_the_same_in_all_states():
    states = [state((LOUD, 2)), state((LOUD, 0)), state((LOUD, 1))]
    objects, values = place_objects(states, UNIVERSE)
    # The rule's own object has that name already.
    assert objects == {"thing1": "thing", "thing2": "thing"}
    loud = [[one["loud", (name,)] for name in objects].count(True) for one in values]
    assert loud == [2, 0, 1]


def test_objects_of_one_state_may_be_in_the_way_in_another():
    every = Count("o", "thing", Binary(BinaryOperator.OR, LOUD.body, Same("o", "o")))
    with pytest.raises(UndecidedError, match="contradict another state"):
        place_objects([state((every, 2)), state((every, 0))], UNIVERSE)


def test_states_say_what_has_another_value_than_its_default():
    values = {("loud", ("x",)): True, ("fog", ()): False}
    trace = synthesize_trace([state(values=values)], UNIVERSE, Fraction(1, 2), lambda _: True)
    # What has no default is said, though nobody asks about it.
    assert trace.states == ({"loud": {"x": True}, "rain": False},)
    assert (trace.step_s, trace.objects) == (0.5, {"x": "thing"})
    unsaid = ObjectUniverse({}, VOCABULARY, (), frozenset({"rain"}))
    assert synthesize_trace([state()], unsaid, Fraction(1), lambda _: True).states == ({},)


def test_a_trace_shows_what_it_is_to_show():
    trace = synthesize_trace([state((PARKED, 1))], UNIVERSE, Fraction(1), lambda _: True)
    assert trace.objects == {"x": "thing", "car1": "car"}
    assert trace.states[0]["parked"] == {"car1": True}
    with pytest.raises(UndecidedError, match="are subject to the rule, too"):
        synthesize_trace([state((PARKED, 1))], UNIVERSE, Fraction(1), lambda _: False)
    with pytest.raises(AssertionError, match="does not do what it is to show"):
        synthesize_trace([state()], UNIVERSE, Fraction(1), lambda _: False)


def test_what_further_objects_make_impossible_is_no_mistake():
    def refuses(_):
        raise RulecError(Diagnostic("R0508", "no such state"))

    with pytest.raises(UndecidedError):
        synthesize_trace([state((PARKED, 1))], UNIVERSE, Fraction(1), refuses)
    with pytest.raises(RulecError):
        synthesize_trace([state()], UNIVERSE, Fraction(1), refuses)


HEAVY = Vocabulary(
    "heavy",
    {},
    {"heavy": Signal("heavy", (), False, constant=True), "fog": Signal("fog", (), False)},
)


def test_what_cannot_change_has_one_value_in_all_states():
    """The states say it of the first one alone; what is to be shown needs it to be false."""
    alone = ObjectUniverse({}, HEAVY)
    states = [JointState({("heavy", ()): True}), JointState({("fog", ()): True})]
    trace = synthesize_trace(
        states, alone, Fraction(1), lambda one: not any("heavy" in said for said in one.states)
    )
    assert trace.states == ({}, {"fog": True})


def test_what_cannot_change_is_said_in_all_states_if_it_is_no_default():
    """What one state says holds in all: tables that show states must not show a default there."""
    alone = ObjectUniverse({}, HEAVY)
    states = [JointState({("fog", ()): True}), JointState({("heavy", ()): True})]
    trace = synthesize_trace(
        states, alone, Fraction(1), lambda one: any("heavy" in said for said in one.states)
    )
    assert trace.states == ({"fog": True, "heavy": True}, {"heavy": True})


def test_a_trace_that_needs_what_cannot_change_to_change_is_left_open():
    states = [JointState({("heavy", ()): True}), JointState({("heavy", ()): False})]
    with pytest.raises(UndecidedError, match="`heavy`, which cannot change, would have to"):
        synthesize_trace(states, ObjectUniverse({}, HEAVY), Fraction(1), lambda _: False)
