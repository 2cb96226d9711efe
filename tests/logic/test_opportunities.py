"""What triggers a rule and where it is breached, by form and by meaning."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
)
from rulec.logic.opportunities import breach_of, trigger_of
from rulec.logic.printing import formula_text
from rulec.logic.semantics import holds, truth_values
from rulec.rulebook.loader import parse_rulebook
from support.generators.timed_formulas import letters_of, timed_formulas, timed_words

TRIGGERS = {
    # always
    "always (a implies b)": "a",
    "always (a implies (b implies c))": "a and b",
    "always (a implies eventually[<= 3 steps] b)": "a",
    "always (a or (b implies c))": "not a and b",
    "always ((a implies b) and (c implies d))": "a or c",
    "always not (a and b)": "a",
    # never
    "never (a and b)": "a",
    "never (a and b and c)": "a and b",
    "never (a then b then c)": "a",
    "never (a and b then c)": "a and b",
    "never (true then a then b)": "a",
    "never (c and (a then b))": "c and a",
    "never ((a then b) or (c and d))": "a or c",
    "not eventually (a and b)": "a",
    "G !(a & X(a U b))": "a",
    # several, and parts
    "always (a implies b) and never (c and d)": "a or c",
    "always[<= 2 steps] (a implies b)": "a and once[<= 2 steps] weak previously false",
    "a implies always (b implies c)": "once (a and weak previously false) and b",
    # what names nothing
    "always a": None,
    "never a": None,
    "always (a or b)": None,
    "always a and never (b and c)": None,
    "a": None,
    "eventually a": None,
    "always eventually a": None,
}


def rule_of(text):
    source = f"rulebook r\nsignal a, b, c, d\nhard rule r {{ {text} }}"
    return parse_rulebook(source).rules[0]


@pytest.mark.parametrize("formula", TRIGGERS)
def test_the_form_names_the_trigger(formula):
    found = trigger_of(rule_of(f"require {formula}").formula)
    assert (found and formula_text(found)) == TRIGGERS[formula]


formulas = timed_formulas | st.builds(
    Unary, st.sampled_from([UnaryOperator.ALWAYS, UnaryOperator.NEVER]), timed_formulas
)


@given(formulas, timed_words, st.sampled_from(["stutter", "finite"]))
def test_a_word_violates_a_formula_exactly_where_it_is_breached(formula, word, semantics):
    somewhere = Unary(UnaryOperator.EVENTUALLY, breach_of(formula))
    word = letters_of(Binary(BinaryOperator.AND, formula, formula), word)
    assert holds(formula, word, semantics) is not holds(somewhere, word, semantics)


@st.composite
def forms(draw) -> Formula:
    """Formulas of those forms that name triggers, with anything in them."""
    guard = draw(st.sampled_from([UnaryOperator.ALWAYS, UnaryOperator.NEVER]))
    operator = draw(
        st.sampled_from(
            [BinaryOperator.IMPLIES, BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.THEN]
        )
    )
    left = draw(timed_formulas | st.just(Constant(True)))
    inner = draw(st.sampled_from([BinaryOperator.THEN, BinaryOperator.IMPLIES, None]))
    right = draw(timed_formulas)
    if inner is not None:
        right = Binary(inner, right, draw(timed_formulas))
    bound = draw(st.none() | st.just(Bound(1, 2, "steps")))
    guarded = Unary(guard, Binary(operator, left, right), bound)
    if draw(st.booleans()):
        joined = draw(
            st.sampled_from([BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES])
        )
        return Binary(joined, draw(timed_formulas), guarded)
    return guarded


@given(forms(), timed_words, st.sampled_from(["stutter", "finite"]))
def test_a_breach_lies_in_an_opportunity(formula, word, semantics):
    trigger = trigger_of(formula)
    if trigger is None:
        return
    breach = breach_of(formula)
    word = letters_of(formula, word)
    both = zip(
        truth_values(breach, word, semantics), truth_values(trigger, word, semantics), strict=True
    )
    assert all(is_met for is_breached, is_met in both if is_breached)


def test_what_applies_only_at_first_is_breached_there():
    assert breach_of(Atom("a")) == Binary(
        BinaryOperator.AND,
        Unary(UnaryOperator.NOT, Atom("a")),
        Unary(UnaryOperator.WEAK_PREVIOUSLY, Constant(False)),
    )
