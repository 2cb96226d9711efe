"""Axioms, counts and monitors as functions of letters, against all states; universes."""

from dataclasses import replace
from fractions import Fraction
from itertools import permutations, product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read, Threshold
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    Count,
    Same,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.vocabulary import ObjectType
from rulec.witnesses.letter_functions import (
    axiom_function,
    body_of,
    can_be_true,
    count_function,
    counts_read,
    monitor_function,
    plain_body_of,
    speaks_of_extra,
    truths_of,
)
from rulec.witnesses.object_universe import (
    EXTRA,
    Itself,
    ObjectUniverse,
    applied_to,
    canonical_term,
    counts_in,
)
from rulec.witnesses.undecided import UndecidedError
from support.generators.random_reads import PLAIN_STATES, VOCABULARY, value
from support.oracles.state_oracle import joined

atoms = st.sampled_from(
    [Atom("p"), Atom("q", ("x",)), Atom("place", ("x",), "near"), Constant(True)]
)
operators = [
    BinaryOperator.AND,
    BinaryOperator.OR,
    BinaryOperator.IMPLIES,
    BinaryOperator.IFF,
    BinaryOperator.XOR,
]


def bodies(leaves):
    return st.recursive(
        leaves,
        lambda inner: (
            st.builds(Unary, st.just(UnaryOperator.NOT), inner)
            | st.builds(Binary, st.sampled_from(operators), inner, inner)
        ),
        max_leaves=5,
    )


def truth(formula, values, names):
    match formula:
        case Constant(said):
            return said
        case Same(left, right):
            return names.get(left, left) == names.get(right, right)
        case Atom(name, arguments, wanted):
            said = values[name, tuple(names.get(one, one) for one in arguments)]
            return said == (True if wanted is None else wanted)
        case Unary(_, operand):
            return not truth(operand, values, names)
        case Binary(operator, left, right):
            return joined(operator.value, truth(left, values, names), truth(right, values, names))


@given(bodies(atoms))
def test_axioms_hold_in_the_letters_of_class_one(formula):
    function = axiom_function(formula, VOCABULARY)
    for values in PLAIN_STATES:
        assert value(function, values) == truth(formula, values, {})


@given(st.lists(bodies(atoms), min_size=1, max_size=3))
def test_sets_of_letters_in_which_formulas_hold(formulas):
    reads, sets = truths_of(formulas, VOCABULARY)
    for values in PLAIN_STATES:
        letter, stride = 0, 1
        for read in reads:
            letter += stride * read.digit(values[read.name, read.variables])
            stride *= read.size
        assert [bool(one >> letter & 1) for one in sets] == [
            truth(formula, values, {}) for formula in formulas
        ]


TWO = {"x": "thing", "y": "thing"}
about_counted = st.sampled_from(
    [Atom("p"), Atom("q", ("o",)), Atom("place", ("o",), "near"), Same("o", "x")]
)


@given(bodies(about_counted))
def test_counts_of_own_objects(body):
    count = Count("o", "thing", body)
    function = count_function(count, ObjectUniverse(TWO, VOCABULARY))
    for p, *rest in product([False, True], *[[False, True], ["near", "far"]] * 2):
        values = {("p", ()): p}
        for number, name in enumerate(TWO):
            values["q", (name,)] = rest[2 * number]
            values["place", (name,)] = rest[2 * number + 1]
        expected = sum(truth(body, values, {"o": name}) for name in TWO)
        assert function.counted[value(function.function, values)] == expected
        own = [read.digit(values[read.name, read.variables]) for read in function.function.reads]
        assert function.counted[function.function.value(own)] == expected


def test_a_count_inside_another_one_is_left_undecided():
    inner = Count("i", "thing", Atom("q", ("i",)))
    outer = Count("o", "thing", Comparison(((Fraction(1), inner),), ">=", Fraction(1)))
    with pytest.raises(UndecidedError, match="a count contains another one"):
        count_function(outer, ObjectUniverse(TWO, VOCABULARY))


def test_a_count_of_the_object_itself_is_decided_by_its_type():
    of_type = Count("i", "thing", Same("i", "o"))
    no_thing = Comparison(((Fraction(1), of_type),), "<", Fraction(1))
    outer = Count("o", "thing", Binary(BinaryOperator.OR, no_thing, Atom("q", ("o",))))
    types = {**VOCABULARY.types, "other": ObjectType("other")}
    known = Itself(replace(VOCABULARY, types=types))
    for kind, expected in (("thing", False), ("other", True)):
        body = body_of(outer, ("x", kind), known)
        assert body == Binary(BinaryOperator.OR, Constant(expected), Atom("q", ("x",)))
    function = count_function(outer, ObjectUniverse(TWO, VOCABULARY))
    assert sorted(function.counted) == [0, 1, 2]


def test_too_many_letters_are_left_undecided():
    whole = Constant(True)
    for number in range(15):
        whole = Binary(BinaryOperator.AND, whole, Atom("q", (f"x{number}",)))
    most = axiom_function(whole, VOCABULARY)
    assert (len(most.letters), sum(most.letters)) == (1 << 15, 1)
    with pytest.raises(UndecidedError, match="reads too much at once"):
        axiom_function(Binary(BinaryOperator.AND, whole, Atom("q", ("one_more",))), VOCABULARY)


def test_what_decides_nothing_is_left_out_of_a_body_where_all_has_defaults():
    near = Atom("place", ("o",), "near")
    count = Count("o", "thing", Binary(BinaryOperator.AND, Same("o", "x"), near))
    known, extra = Itself(VOCABULARY), (EXTRA, "thing")
    assert plain_body_of(count, extra, known) == Constant(False)
    assert plain_body_of(count, ("x", "thing"), known) == replace(near, arguments=("x",))
    # Of what has no default a state has to say something for everybody
    declarations = VOCABULARY.declarations
    told = declarations | {"place": replace(declarations["place"], default=None)}
    untold = replace(VOCABULARY, declarations=told)
    body = plain_body_of(count, extra, Itself(untold))
    assert not can_be_true(body)
    assert [*atoms_of(body)] == [replace(near, arguments=(EXTRA,))]


def test_bodies_speak_of_the_object_that_is_counted():
    count = Count("o", "thing", Binary(BinaryOperator.OR, Same("o", "x"), Atom("q", ("o",))))
    known = Itself(VOCABULARY)
    own, extra = (body_of(count, (name, "thing"), known) for name in ("x", EXTRA))
    assert own == Binary(BinaryOperator.OR, Constant(True), Atom("q", ("x",)))
    assert extra == Binary(BinaryOperator.OR, Constant(False), Atom("q", (EXTRA,)))
    assert speaks_of_extra(Read("q", (EXTRA,)))
    assert not speaks_of_extra(Read("q", ("x",)))


def test_a_monitor_reads_its_objects_in_the_place_of_its_variables():
    named = Count("z", "thing", Atom("q", ("z",)))
    number = NumberRead(((Fraction(1), named),), (Threshold(Fraction(1), inclusive=True),))
    monitor = MealyMonitor(
        (Read("q", ("v",)), number), (0, 1, 1, 0), ((0, 0),), ((True, True),), None, 0
    )
    function = monitor_function(monitor, {"v": "y"})
    assert function.reads[0] == Read("q", ("y",))
    # Counts that differ in their variable only are the same.
    other = Count("w", "thing", Atom("q", ("w",)))
    assert counts_read(function.reads) == [canonical_term(other)]
    assert function.letters == monitor.letters


@given(st.dictionaries(st.sampled_from("abc"), st.just("thing"), min_size=1), st.integers(0, 3))
def test_bindings_are_all_choices_of_distinct_objects(objects, n_variables):
    universe = ObjectUniverse(objects, VOCABULARY)
    variables = [Variable(f"v{number}", "thing") for number in range(n_variables)]
    bound = {tuple(binding.values()) for binding in universe.bindings(variables)}
    assert bound == set(permutations(objects, n_variables))


def test_axioms_are_said_of_all_objects():
    axiom = Axiom((Variable("o", "thing"),), Atom("q", ("o",)))
    universe = ObjectUniverse(TWO, VOCABULARY, (axiom,))
    said = [applied_to(one, names) for one, names in universe.axiom_bindings()]
    assert said == [Atom("q", ("x",)), Atom("q", ("y",))]


def test_counts_in_a_formula_are_those_outside_of_others():
    inner = Count("i", "thing", Atom("q", ("i",)))
    outer = Count("o", "thing", Comparison(((Fraction(1), inner),), ">=", Fraction(1)))
    formula = Comparison(((Fraction(1), outer),), ">=", Fraction(1))
    assert list(counts_in(formula)) == [outer]
    renamed = canonical_term(outer)
    (own,) = counts_in(renamed.body)
    assert renamed.variable != own.variable
