"""Two rules side by side, against direct evaluation on short words and on the witnesses."""

from dataclasses import replace
from itertools import product

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rulec.analysis.diff.rule_comparison import compare, non_default_names
from rulec.analysis.shared_compilation import compile_shared
from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.trace import Trace
from rulec.vocabulary import Enumeration, Quantity, Signal
from support.generators.random_rule_pairs import (
    ALONE,
    COUNTED,
    PAIRED,
    VOCABULARY,
    X,
    Y,
    allows,
    compared,
    formulas,
    sides,
    states,
)

SEMANTICS = st.tuples(*[st.sampled_from(["stutter", "finite"])] * 2)


def farthest(trace, name):
    """How far a quantity of a trace is from its default, in any state and for any object."""
    declaration = VOCABULARY.declarations[name]
    if not isinstance(declaration, Quantity):
        return 0
    values = [state.get(name, declaration.default) for state in trace.states]
    each = [x for value in values for x in (value.values() if isinstance(value, dict) else [value])]
    return max(abs(value - declaration.default) for value in each)


def check(one, other, traces):
    """The witnesses are real and shortest, and where there is none no short trace tells."""
    found = compare(one, other, most=3)
    assert not found.undecided
    witnesses = {True: found.first_forbids, False: found.second_forbids}
    for traces_of_one, forbids, permits in (
        (found.first_forbids, one, other),
        (found.second_forbids, other, one),
    ):
        for witness in traces_of_one:
            assert not allows(forbids, witness)
            assert allows(permits, witness)
        needs = [non_default_names(witness, one.rulebook.vocabulary) for witness in traces_of_one]
        for number, later in enumerate(needs):
            assert not any(earlier == later for earlier in needs[:number])
            # What needs more keeps a number of the first witness nearer to its default
            first, own = traces_of_one[0], traces_of_one[number]
            assert not any(earlier < later for earlier in needs[:number]) or any(
                farthest(own, name) < farthest(first, name) for name in needs[0]
            )
    expected = {
        (True, True): "equal",
        (False, True): "stricter",
        (True, False): "laxer",
        (False, False): "incomparable",
    }
    assert found.relation == expected[not found.first_forbids, not found.second_forbids]
    for trace in traces:
        verdicts = allows(one, trace), allows(other, trace)
        if verdicts[0] != verdicts[1]:
            assert witnesses[verdicts[1]], trace
            witness = witnesses[verdicts[1]][0]
            assert len(witness.states) <= len(trace.states)


def words(objects, names, longest):
    every = list(states(objects, names))
    for length in range(1, longest + 1):
        for word in product(every, repeat=length):
            yield Trace("t", 1.0, objects, word)


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas(ALONE)] * 2), SEMANTICS)
def test_rules_about_one_object(pair, semantics):
    one, other = sides(pair, [X], semantics)
    check(one, other, words({"x": "thing"}, ["p", "place", "speed", "gap"], 1))


SMALL = list(words({"x": "thing"}, ["p", "place"], 3))


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas(ALONE[:3])] * 2), SEMANTICS)
def test_rules_about_one_object_on_longer_words(pair, semantics):
    check(*sides(pair, [X], semantics), SMALL)


PAIRS = [
    Trace("t", 1.0, {"x": "thing", "y": "thing"}, word)
    for length in (1, 2)
    for word in product(states({"x": "thing", "y": "thing"}, ["p", "follows"]), repeat=length)
]


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas(PAIRED[:3])] * 2), SEMANTICS)
def test_rules_about_two_objects(pair, semantics):
    check(*sides(pair, [X, Y], semantics), PAIRS)


GROUPS = [
    trace
    for objects in ({}, {"a": "thing"}, {"a": "thing", "b": "car"}, {"a": "car", "b": "car"})
    for trace in words(objects, ["p", "place"], 1 if len(objects) == 2 else 2)
]


TWO_THINGS = COUNTED[2]
A_CAR = next(one for one in COUNTED if "type='car'" in repr(one))


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas(COUNTED)] * 2), SEMANTICS)
@example(
    # Who has to be there in the first state is asked about by nobody in the second one.
    (
        Unary(UnaryOperator.ALWAYS, COUNTED[0]),
        Binary(BinaryOperator.AND, A_CAR, Binary(BinaryOperator.AND, COUNTED[0], TWO_THINGS)),
    ),
    ("stutter", "stutter"),
)
def test_rules_that_count(pair, semantics):
    check(*sides(pair, [], semantics), GROUPS)


FACT = Binary(
    BinaryOperator.OR,
    Unary(UnaryOperator.NOT, Atom("place", ("x",), "near")),
    Binary(BinaryOperator.AND, Atom("p"), compared([(1, ("gap", ("x",)))], "<", 2)),
)


def is_possible(trace):
    return all(
        state["place"]["x"] != "near" or (state["p"] and state["gap"]["x"] < 2)
        for state in trace.states
    )


POSSIBLE = [
    trace for trace in words({"x": "thing"}, ["p", "place", "gap"], 2) if is_possible(trace)
]


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas([*ALONE[:3], ALONE[5]])] * 2), SEMANTICS)
def test_facts_rule_out_states(pair, semantics):
    one, other = sides(pair, [X], semantics, (Axiom((X,), FACT),))
    check(one, other, POSSIBLE)
    found = compare(one, other)
    for trace in (*found.first_forbids, *found.second_forbids):
        states = tuple({"p": False, **state} for state in trace.states)
        assert is_possible(replace(trace, states=states))


ROAD = Enumeration("road", (), ("lane", "track", "way"), "way", constant=True)
WITH_CONSTANTS = replace(
    VOCABULARY,
    declarations=VOCABULARY.declarations
    | {"road": ROAD, "tows": Signal("tows", (), False, constant=True)},
)
CONSTANTS = [Atom("road", (), "lane"), Atom("road", (), "track"), Atom("tows")]
SETTLED = [
    Trace("t", 1.0, {}, [{"p": p, "road": road, "tows": tows} for p in word])
    for length in (1, 2, 3)
    for word in product([False, True], repeat=length)
    for road in ROAD.values
    for tows in (False, True)
]


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas([Atom("p"), *CONSTANTS])] * 2), SEMANTICS)
def test_what_cannot_change_is_the_same_in_all_states(pair, semantics):
    """Rules that differ only where it changes are equal."""
    check(*sides(pair, (), semantics, vocabulary=WITH_CONSTANTS), SETTLED)


def test_who_starts_as_one_thing_ends_as_it():
    lane, track, p = *CONSTANTS[:2], Atom("p")
    changes = Binary(BinaryOperator.AND, lane, Unary(UnaryOperator.EVENTUALLY, track))
    long = Binary(BinaryOperator.AND, lane, Unary(UnaryOperator.EVENTUALLY, p))
    never = [Unary(UnaryOperator.NOT, one) for one in (changes, long)]
    one, other = sides(never, vocabulary=WITH_CONSTANTS)
    found = compare(one, other)
    assert (found.relation, found.first_forbids) == ("laxer", ())
    (witness, *_) = found.second_forbids
    assert {state["road"] for state in witness.states} == {"lane"}


CARS = [trace for kind in ("thing", "car") for trace in words({"x": kind}, ["p", "place"], 2)]


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas(ALONE[:3])] * 2), SEMANTICS)
def test_one_rule_speaks_of_more_objects(pair, semantics):
    one, _ = sides(pair, [X], semantics)
    _, other = sides(pair, [Variable("x", "car")], semantics)
    check(one, other, CARS)
    found = compare(one, other)
    assert found.common == ("car",)
    narrow, _ = sides(pair, [Variable("x", "car")], semantics)
    assert found.on_common == compare(narrow, other).relation


@pytest.mark.parametrize("swapped", [False, True])
def test_variables_in_another_order_make_no_difference(swapped):
    follows, back = PAIRED[1], PAIRED[2]
    one, other = sides([follows, back if swapped else follows], [X, Y])
    assert compare(one, other).relation == "equal"


def test_a_limit_does_not_hide_a_lower_one():
    lower = "(night implies speed <= 50 km/h) and (built_up implies speed <= 40 km/h)"
    texts = ("speed <= 100 km/h", f"speed <= 90 km/h and {lower}")
    books = [
        parse_rulebook(f"rulebook b{n} use road hard rule r {{ require always ({text}) }}")
        for n, text in enumerate(texts)
    ]
    one, other = (
        each["r"] for each in compile_shared(books, [{"r": book.rules[0]} for book in books])
    )
    found = compare(other, one, most=9)
    assert found.relation == "stricter"
    vocabulary = other.rulebook.vocabulary
    reasons = {
        (trace.states[0]["speed"], *sorted(non_default_names(trace, vocabulary) - {"speed"}))
        for trace in found.first_forbids
    }
    assert reasons == {(91,), (51, "night"), (41, "built_up")}
    assert len(compare(other, one, most=2).first_forbids) == 2
