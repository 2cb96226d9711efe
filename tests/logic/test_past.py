"""Operators of the past as registers and memories, which mean the same."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.bounds import PAST, Range, operations_of
from rulec.logic.formula import Atom, Binary, BinaryOperator, Bound, Unary, UnaryOperator, atoms_of
from rulec.logic.past_registers import Register, definition, eliminate_past
from rulec.logic.printing import formula_text
from rulec.logic.semantics import holds, truth_values
from support.generators.timed_formulas import formulas_in, letters_of, timed_words

P, Q = Atom("p"), Atom("q")
ONCE_P = Unary(UnaryOperator.ONCE, P)


def always(formula):
    return Unary(UnaryOperator.ALWAYS, formula)


def steps(low, high):
    return Bound(Fraction(low), None if high is None else Fraction(high), "steps")


def has_past(formula):
    return any(one.operator in PAST for one in operations_of(formula))


def test_once_is_a_register():
    past = eliminate_past(always(ONCE_P))
    assert formula_text(past.present) == "always register 0"
    (register,) = past.registers
    assert (formula_text(register.left), formula_text(register.right)) == ("true", "p")
    assert register.span == Range(0, None)
    assert past.memories == ()


def test_historically_is_that_never_was_it_otherwise():
    past = eliminate_past(always(Unary(UnaryOperator.HISTORICALLY, P, steps(1, 4))))
    assert formula_text(past.present) == "always not register 0"
    (register,) = past.registers
    assert (formula_text(register.right), register.span) == ("not p", Range(1, 4))


def test_the_same_past_is_remembered_once():
    since = Binary(BinaryOperator.SINCE, ONCE_P, Q)
    twice = Binary(BinaryOperator.IFF, since, Binary(BinaryOperator.OR, P, since))
    assert len(eliminate_past(always(twice)).registers) == 2


def test_another_range_is_remembered_apart():
    def both(inside):
        within = [Unary(UnaryOperator.ONCE, inside, steps(0, high)) for high in (1, 3)]
        return eliminate_past(always(Binary(BinaryOperator.AND, *within)))

    assert [one.span for one in both(P).registers] == [Range(0, 1), Range(0, 3)]
    # One, two, three instants ago; the shorter range needs the first of them.
    assert len(both(Unary(UnaryOperator.NEXT, P)).memories) == 3


def test_no_past_is_no_memory():
    formula = Binary(BinaryOperator.THEN, P, Unary(UnaryOperator.NEVER, Q, steps(0, 2)))
    past = eliminate_past(formula)
    assert (past.present, past.registers, past.memories) == (formula, (), ())


@pytest.mark.parametrize("inside", [UnaryOperator.NEXT, UnaryOperator.NEVER])
def test_what_the_future_has_a_say_in_is_no_register(inside):
    later = Unary(UnaryOperator.PREVIOUSLY, Unary(inside, P))
    both = Binary(BinaryOperator.AND, later, ONCE_P)
    past = eliminate_past(always(Unary(UnaryOperator.ONCE, both)))
    assert len(past.registers) == 1
    assert len(past.memories) == 2
    assert all("memory" in formula_text(one.atom) for one in past.memories)


def test_a_memory_says_what_was_one_instant_ago():
    (memory,) = eliminate_past(
        always(Unary(UnaryOperator.PREVIOUSLY, Unary(UnaryOperator.NEXT, P)))
    ).memories
    assert formula_text(definition(memory)) == (
        "not memory 0 and always ((next p implies weak next memory 0) "
        "and (next p or weak next not memory 0))"
    )


def run(register, word):
    state, said = register.at_first, []
    for left, right in word:
        state = register.after(state, left, right)
        said.append(bool(state & 1))
    return said, state


spans = st.builds(
    lambda low, width: Range(low, None if width is None else low + width),
    st.integers(0, 4),
    st.none() | st.integers(0, 4),
)


@given(spans, st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=15))
def test_a_register_says_what_since_means(span, word):
    register = Register(Atom("r"), P, Q, span)
    letters = [{one for one, value in zip((P, Q), each, strict=True) if value} for each in word]
    since = Binary(BinaryOperator.SINCE, P, Q, steps(*span))
    assert run(register, word)[0] == truth_values(since, letters)


@given(spans, st.lists(st.tuples(st.booleans(), st.booleans()), max_size=15), st.data())
def test_registers_are_as_small_as_can_be(span, word, data):
    """Two states are told apart by what comes: if only `left` holds, and `right` no more."""
    register = Register(Atom("r"), P, Q, span)
    other = data.draw(st.lists(st.tuples(st.booleans(), st.booleans()), max_size=15))
    states = [run(register, one)[1] for one in (word, other)]
    quiet = [(True, False)] * 12  # longer than any of these spans
    futures = []
    for state in states:
        said = [bool(state & 1)]
        for left, right in quiet:
            state = register.after(state, left, right)
            said.append(bool(state & 1))
        futures.append(said)
    assert (states[0] == states[1]) == (futures[0] == futures[1])


def reachable(register):
    seen, waiting = {0}, [0]
    while waiting:
        state = waiting.pop()
        for left in (False, True):
            for right in (False, True):
                later = register.after(state, left, right)
                if later not in seen:
                    seen.add(later)
                    waiting.append(later)
    return len(seen)


@pytest.mark.parametrize(
    ("span", "n_states"),
    [
        (Range(0, None), 2),  # yes or no
        (Range(0, 100), 102),  # due for 0 to 100 steps more, or not at all
        (Range(3, None), 5),  # in 0 to 3 steps for good, or never
        (Range(5, 5), 2**6),  # each of the last five and this instant
    ],
)
def test_how_many_states_a_register_has(span, n_states):
    assert reachable(Register(Atom("r"), P, Q, span)) == n_states


@given(formulas_in(), timed_words, st.sampled_from(["stutter", "finite"]))
def test_what_is_left_gives_back_the_meaning(formula, word, semantics):
    """Fill in what registers say and what memories are, and evaluate what is left."""
    past = eliminate_past(formula)
    assert not has_past(past.present)
    filled = letters_of(formula, word)
    if semantics == "stutter":  # until none of them changes any more
        filled += [filled[-1]] * 40
    fresh = {one.atom: one for one in (*past.registers, *past.memories)}
    # In the order in which they were found, none speaks of a later one.
    for atom in sorted(fresh, key=lambda one: int(one.name.split()[1])):
        one = fresh[atom]
        if isinstance(one, Register):
            assert not has_past(one.left)
            pairs = zip(
                truth_values(one.left, filled), truth_values(one.right, filled), strict=True
            )
            filled = with_values(filled, atom, run(one, pairs)[0])
        else:
            assert not has_past(one.formula)
            value = False
            for instant in range(len(filled)):
                filled[instant] |= {atom} if value else frozenset()
                value = truth_values(one.formula, filled, semantics)[instant]
            assert holds(definition(one), filled, semantics)
    assert holds(past.present, filled, semantics) == holds(
        formula, letters_of(formula, word), semantics
    )


def with_values(word, atom, values):
    return [
        letter | {atom} if value else letter for letter, value in zip(word, values, strict=True)
    ]


@given(formulas_in())
def test_fresh_atoms_are_no_atoms_of_a_rulebook(formula):
    past = eliminate_past(formula)
    fresh = {str(one.atom) for one in (*past.registers, *past.memories)}
    assert len(fresh) == len(past.registers) + len(past.memories)
    assert fresh.isdisjoint(str(atom) for atom in atoms_of(formula))
    assert all(" " in name and "(" not in name for name in fresh)
