"""Operators of the past as memories: what is remembered, and that it means the same."""

import pytest
from hypothesis import given
from words import formulas, letters, words

from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator, atoms_of
from rulec.logic.past import definition, remembered
from rulec.logic.printing import in_spot, in_words
from rulec.logic.semantics import holds, truth_values

P, Q = Atom("p"), Atom("q")
ONCE_P = Unary(UnaryOperator.ONCE, P)


def always(formula):
    return Unary(UnaryOperator.ALWAYS, formula)


PAST = {"once", "historically", "previously", "weak previously", "since"}


def operators(formula):
    match formula:
        case Unary(operator, operand):
            return {operator.value} | operators(operand)
        case Binary(operator, left, right):
            return {operator.value} | operators(left) | operators(right)
    return set()


def test_once_remembers_itself():
    present, (memory,) = remembered(always(ONCE_P))
    assert in_words(present) == "always (p or memory 0)"
    assert in_words(definition(memory)) == (
        "not memory 0 and always (next memory 0 iff p or memory 0)"
    )
    assert memory.settled


def test_historically_was_true_before_anything_was():
    _, (memory,) = remembered(always(Unary(UnaryOperator.HISTORICALLY, P)))
    assert in_words(definition(memory)).startswith("memory 0 and always")


def test_the_same_past_is_remembered_once():
    since = Binary(BinaryOperator.SINCE, ONCE_P, Q)
    twice = Binary(BinaryOperator.IFF, since, Binary(BinaryOperator.OR, P, since))
    assert len(remembered(always(twice))[1]) == 2


def test_nothing_was_before_the_first_instant():
    """What speaks of the first instant alone needs no memory."""
    previously = Unary(UnaryOperator.PREVIOUSLY, always(P))
    formula = Binary(BinaryOperator.XOR, previously, Unary(UnaryOperator.WEAK_PREVIOUSLY, Q))
    present, memories = remembered(Unary(UnaryOperator.NOT, formula))
    assert in_words(present) == "not (false xor true)"
    assert memories == ()
    # Here the first instant is not the only one.
    assert len(remembered(Unary(UnaryOperator.NEXT, formula))[1]) == 2


def test_no_past_is_no_memory():
    formula = Binary(BinaryOperator.THEN, P, Unary(UnaryOperator.NEVER, Q))
    assert remembered(formula) == (formula, ())


@pytest.mark.parametrize("inside", [UnaryOperator.NEXT, UnaryOperator.NEVER])
def test_what_the_future_has_a_say_in_is_not_settled(inside):
    later = Unary(UnaryOperator.PREVIOUSLY, Unary(inside, P))
    both = Binary(BinaryOperator.AND, later, ONCE_P)
    _, memories = remembered(always(Unary(UnaryOperator.ONCE, both)))
    assert [memory.settled for memory in memories] == [False, True, False]


@given(formulas, words)
def test_memories_as_they_are_defined_give_back_the_meaning(formula, word):
    """Fill in what each memory is, from its definition alone, and evaluate what is left."""
    present, memories = remembered(formula)
    assert operators(present).isdisjoint(PAST)
    filled = letters(word)
    filled += [filled[-1]] * (len(memories) + 1)  # until none of them changes any more
    for memory in memories:
        assert operators(memory.formula).isdisjoint(PAST)
        value = memory.at_first
        for instant in range(len(filled)):
            filled[instant] |= {memory.atom} if value else frozenset()
            value = truth_values(memory.formula, filled)[instant]
    defined = [truth_values(definition(memory), filled)[0] for memory in memories]
    assert all(defined)
    assert holds(present, filled) == holds(formula, letters(word))


@given(formulas)
def test_a_memory_is_no_atom_of_a_rulebook(formula):
    _, memories = remembered(formula)
    fresh = {str(memory.atom) for memory in memories}
    assert len(fresh) == len(memories)
    assert fresh.isdisjoint(str(atom) for atom in atoms_of(formula))
    assert all(" " in name and "(" not in name for name in fresh)


def test_spot_has_no_past():
    with pytest.raises(KeyError):
        in_spot(ONCE_P)
