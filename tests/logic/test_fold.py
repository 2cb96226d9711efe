"""The fold over algebras says what the definitions say; an algebra without an operator refuses."""

import pytest
from hypothesis import given

from rulec.logic.bounds import BOOLEAN, operations_of
from rulec.logic.fold import Algebra, bit_sets, fold, temporal_operation
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Same,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.logic.semantics import truth_values
from support.generators.random_formulas import formulas, letters, words

P, Q = Atom("p"), Atom("q")


def booleans(letter, **more):
    return Algebra(
        proposition=letter.__contains__,
        constant=bool,
        negation=lambda operand: not operand,
        conjunction=lambda left, right: left and right,
        disjunction=lambda left, right: left or right,
        equivalence=lambda left, right: left is right,
        **more,
    )


def without_time(formula):
    return all(operation.operator in BOOLEAN for operation in operations_of(formula))


@given(formulas.filter(without_time), words)
def test_a_formula_of_one_state_has_its_value_at_every_letter(formula, word):
    word = letters(word)
    expected = truth_values(formula, word)
    assert [fold(formula, booleans(letter)) for letter in word] == expected
    sets = {
        atom: sum((atom in letter) << instant for instant, letter in enumerate(word))
        for atom in atoms_of(formula)
    }
    instants = fold(formula, bit_sets(sets, (1 << len(word)) - 1))
    assert instants == sum(value << instant for instant, value in enumerate(expected))


@pytest.mark.parametrize("operator", [op for op in BinaryOperator if op in BOOLEAN])
@pytest.mark.parametrize("letter", [set(), {P}, {Q}, {P, Q}])
def test_every_connective_says_what_the_definitions_say(operator, letter):
    formula = Binary(operator, P, Q)
    (expected,) = truth_values(formula, [letter])
    assert fold(formula, booleans(letter)) is expected
    everything = 0b11
    sets = {P: everything * (P in letter), Q: everything * (Q in letter)}
    assert fold(formula, bit_sets(sets, everything)) == everything * expected


def test_an_algebra_may_say_derived_operators_itself():
    algebra = booleans({P}, implication=lambda *_: "implied", difference=lambda *_: "differs")
    assert fold(Binary(BinaryOperator.IMPLIES, P, Q), algebra) == "implied"
    assert fold(Binary(BinaryOperator.XOR, P, Q), algebra) == "differs"


def test_each_part_is_worked_out_once_if_values_are_kept():
    asked = []

    def proposition(atom):
        asked.append(atom)
        return True

    formula = Binary(
        BinaryOperator.AND, Binary(BinaryOperator.OR, P, Q), Unary(UnaryOperator.NOT, P)
    )
    algebra = booleans(set())
    algebra = Algebra(
        **{name: getattr(algebra, name) for name in Algebra.__slots__}
        | {"proposition": proposition}
    )
    known = {}
    assert fold(formula, algebra, known) is False
    assert asked == [P, Q]
    assert set(known) == {formula, formula.left, formula.right, P, Q}


def test_an_algebra_without_time_or_objects_refuses():
    with pytest.raises(TypeError, match="one state alone"):
        fold(Unary(UnaryOperator.ALWAYS, P), booleans({P}))
    with pytest.raises(ValueError, match="counted objects"):
        fold(Same("v", "w"), booleans({P}))


def test_operators_of_the_future_are_said_by_four():
    def said(name):
        return lambda left, right, span: (name, left, right, tuple(span))

    operation = temporal_operation(
        lambda operand: ("not", operand),
        until=said("until"),
        release=said("release"),
        weak_until=said("weak until"),
        strong_release=said("strong release"),
    )
    algebra = booleans({P}, operation=operation)
    one, rest = (1, 1), (0, None)
    for operator, expected in {
        UnaryOperator.NEXT: ("until", None, True, one),
        UnaryOperator.WEAK_NEXT: ("release", None, True, one),
        UnaryOperator.EVENTUALLY: ("until", None, True, rest),
        UnaryOperator.ALWAYS: ("release", None, True, rest),
        UnaryOperator.NEVER: ("release", None, ("not", True), rest),
    }.items():
        assert fold(Unary(operator, P), algebra) == expected
    for operator, name in {
        BinaryOperator.UNTIL: "until",
        BinaryOperator.RELEASE: "release",
        BinaryOperator.WEAK_UNTIL: "weak until",
        BinaryOperator.STRONG_RELEASE: "strong release",
    }.items():
        assert fold(Binary(operator, P, Constant(False)), algebra) == (name, True, False, rest)
    then = fold(Binary(BinaryOperator.THEN, P, P), algebra)
    assert then == ("until", True, True, (1, None))
    with pytest.raises(ValueError, match="`since` is an operator of the past"):
        fold(Binary(BinaryOperator.SINCE, P, Q), algebra)
