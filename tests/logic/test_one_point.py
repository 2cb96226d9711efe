"""Formulas in fewer words mean the same, of all objects in all states."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import Atom, Binary, BinaryOperator, Comparison, Count, Same, Unary
from rulec.logic.formula import UnaryOperator as Op
from rulec.logic.kleene import holds
from rulec.logic.one_point import plain, replaced
from rulec.logic.sentences.sentence import phrase
from rulec.logic.sentences.sentence_layout import in_one_line
from rulec.monitoring.state_view import StateView
from rulec.rulebook.loader import parse_rulebook

BOOK = parse_rulebook("""
rulebook zoo
type animal
type bird is animal
type owl is bird
signal eats, flies, big(a: animal), near(b: bird) default false
hard rule r { require never eats }
""")
VOCABULARY = BOOK.vocabulary
FITS = VOCABULARY.is_subtype
AND, OR, IMPLIES = BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES
KINDS = {"v": "animal", "w": "owl"}


def some(variable, of_type, body, relation=">=", limit=1):
    count = Count(variable, of_type, body)
    return Comparison(((Fraction(1), count),), relation, Fraction(limit))


def bodies(inner):
    """What is said of a counted object and of v and w; ``x`` and ``y`` are counted."""
    return st.builds(Unary, st.just(Op.NOT), inner) | st.builds(
        Binary, st.sampled_from([AND, OR, IMPLIES]), inner, inner
    )


def about(names):
    atoms = [Atom("eats"), Atom("flies"), *(Atom("big", (name,)) for name in names)]
    return st.sampled_from(atoms)


def counts(variable, names, deeper):
    same = st.sampled_from([Same(variable, name) for name in names] + [Same("v", variable)])
    inner = st.recursive(about([*names, variable]) | same | deeper, bodies, max_leaves=5)
    conjoined = st.builds(Binary, st.just(AND), inner, same) | st.builds(
        Binary, st.just(AND), same, inner
    )
    return st.builds(
        some,
        st.just(variable),
        st.sampled_from(["animal", "bird", "owl"]),
        conjoined | inner | same,
        st.sampled_from([">=", "<", "="]),
        st.sampled_from([0, 1, 2]),
    )


ONE = counts("x", ["v", "w"], st.nothing())
TWO = counts("y", ["v", "w"], counts("x", ["v", "w", "y"], st.nothing()))
FORMULAS = st.recursive(about(["v", "w"]) | ONE | TWO, bodies, max_leaves=4)
TYPES = st.sampled_from(["animal", "bird", "owl"])


@given(FORMULAS, TYPES, st.dictionaries(st.sampled_from("abc"), TYPES), st.data())
def test_the_same_is_said_of_every_state(formula, kind, more, data):
    objects = {"v": kind, "w": "owl", **more}
    state = {
        "eats": data.draw(st.booleans()),
        "flies": data.draw(st.booleans()),
        "big": {name: data.draw(st.booleans()) for name in objects},
    }
    view = StateView(state, objects, VOCABULARY)
    itself = {name: name for name in objects}
    shorter = plain(formula, KINDS, FITS)
    assert holds(shorter, itself, view) == holds(formula, itself, view)
    assert plain(shorter, KINDS, FITS) == shorter


def said(formula):
    return in_one_line(phrase(plain(formula, KINDS, FITS), inside=True))


X_IS_V = Same("x", "v")
BIG_X = Atom("big", ("x",))


@pytest.mark.parametrize(
    ("formula", "english"),
    [
        (some("x", "animal", Binary(AND, X_IS_V, BIG_X)), "“big” holds of v."),
        (
            Unary(Op.NOT, some("x", "animal", Binary(AND, BIG_X, X_IS_V))),
            "“big” does not hold of v.",
        ),
        (some("x", "animal", X_IS_V), "Anything may be the case."),
        (some("x", "bird", X_IS_V), "V is a bird."),
        (some("x", "bird", X_IS_V, "<"), "V is not a bird."),
        (
            some("x", "bird", Binary(AND, X_IS_V, BIG_X)),
            "V is a bird and “big” holds of v.",
        ),
        (
            Binary(OR, Atom("eats"), Binary(OR, Atom("flies"), BIG_X)),
            "“eats” holds, “flies” holds or “big” holds of x.",
        ),
        (
            Binary(AND, Atom("eats"), Binary(OR, Atom("flies"), BIG_X)),
            "“eats” holds, and either “flies” holds or “big” holds of x.",
        ),
    ],
)
def test_what_is_said(formula, english):
    assert said(formula) == english


def test_the_largest_part_with_a_name_is_replaced_also_where_it_is_counted():
    large = Binary(AND, Atom("eats"), BIG_X)
    names = {large: Atom("A"), BIG_X: Atom("B")}
    whole = Binary(OR, some("x", "bird", large), Unary(Op.ALWAYS, BIG_X))
    assert replaced(whole, names) == Binary(
        OR, some("x", "bird", Atom("A")), Unary(Op.ALWAYS, Atom("B"))
    )
