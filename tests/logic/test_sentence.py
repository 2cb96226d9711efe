"""Formulas in English: what some say, and that no two say the same."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Constant,
    Count,
    QuantityTerm,
    Same,
    Unary,
    UnaryOperator,
)
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.french import FRENCH
from rulec.logic.sentences.german import GERMAN
from rulec.logic.sentences.sentence import phrase, sentence
from rulec.logic.sentences.sentence_layout import in_one_line, lines
from support.generators.random_formulas import ATOMS

NOT, ALWAYS, NEVER = UnaryOperator.NOT, UnaryOperator.ALWAYS, UnaryOperator.NEVER
EVENTUALLY, NEXT = UnaryOperator.EVENTUALLY, UnaryOperator.NEXT
AND, OR, IMPLIES = BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLIES
THEN, UNTIL = BinaryOperator.THEN, BinaryOperator.UNTIL

HORN, FOG = Atom("horn"), Atom("fog")
BEHIND = Atom("station", ("v",), "behind")
BESIDE = Atom("station", ("v",), "beside")
FRONT = Atom("station", ("v",), "in_front_of")

SPEED, GAP = QuantityTerm("speed"), QuantityTerm("lateral_gap", ("v",))
SLOW = Comparison(((Fraction(1), SPEED),), "<", Fraction(50), "speed < 50 km/h")
WIDE = Comparison(
    ((Fraction(1), GAP), (Fraction(-1, 2), SPEED)),
    ">=",
    Fraction(0),
    "lateral_gap(v) >= 2 s * speed",
)


def seconds(low, high):
    return Bound(Fraction(low), None if high is None else Fraction(high), "s")


def steps(low, high):
    return Bound(Fraction(low), None if high is None else Fraction(high), "steps")


def counting(relation, limit, body=BEHIND):
    renamed = Atom(body.name, ("x",), body.value)
    return Comparison(
        ((Fraction(1), Count("x", "bus", renamed)),), relation, Fraction(limit), "count …"
    )


@pytest.mark.parametrize(
    ("formula", "english"),
    [
        (HORN, "“horn” holds at the start."),
        (FRONT, "The station of v is “in front of” at the start."),
        (
            Unary(NOT, Unary(NOT, HORN)),
            "It is not the case that “horn” does not hold at the start.",
        ),
        (Atom("R_cw"), "“R_cw” holds at the start."),
        (Unary(ALWAYS, SLOW), "At all times the speed is less than 50 km/h."),
        (
            Unary(ALWAYS, Binary(IMPLIES, BESIDE, WIDE)),
            (
                "At all times, if the station of v is “beside”, then the lateral gap of v is at "
                "least 2 s times the speed."
            ),
        ),
        (
            Unary(ALWAYS, Binary(IMPLIES, HORN, Unary(EVENTUALLY, FOG, seconds(0, 3)))),
            "At all times, if “horn” holds, then at some time up to 3 s later “fog” holds.",
        ),
        (
            Unary(EVENTUALLY, FOG, steps(1, None)),
            "At some time 1 step or more after the start “fog” holds.",
        ),
        (Unary(NEXT, HORN, steps(2, 2)), "Exactly 2 steps after the start “horn” holds."),
        (
            Unary(ALWAYS, Unary(UnaryOperator.ONCE, HORN, seconds("0.5", 2))),
            "At all times, at some time from 0.5 s to 2 s earlier, “horn” holds.",
        ),
        (
            Unary(NEVER, Binary(THEN, BEHIND, Binary(THEN, BESIDE, FRONT), seconds(1, 4))),
            (
                "It never happens that without a break first for 1 s to 4 s the station of v is "
                "“behind”, then the station of v is “beside”, then the station of v is “in front "
                "of”."
            ),
        ),
        (
            Unary(ALWAYS, Unary(NOT, Binary(AND, HORN, FOG))),
            "At all times it is not the case that both “horn” holds and “fog” holds.",
        ),
        (
            Unary(ALWAYS, counting(">=", 8)),
            "At all times there are at least 8 buses x for which the station of x is “behind”.",
        ),
        (
            counting("=", 0),
            "At the start there is no bus x for which the station of x is “behind”.",
        ),
        (
            Binary(UNTIL, HORN, Binary(OR, FOG, BEHIND)),
            (
                "“horn” holds until, sooner or later, either “fog” holds or the station of v is "
                "“behind”."
            ),
        ),
        (
            Binary(AND, Unary(ALWAYS, HORN), Unary(NOT, FOG)),
            (
                "Both of these hold: (a) at all times “horn” holds; and (b) “fog” does not hold "
                "at the start."
            ),
        ),
        (
            Binary(IMPLIES, Unary(ALWAYS, Binary(OR, HORN, FOG)), HORN),
            "If at all times, “horn” holds or “fog” holds, then “horn” holds at the start.",
        ),
        (
            Binary(IMPLIES, Binary(OR, FOG, Unary(ALWAYS, HORN)), HORN),
            (
                "If (a), then “horn” holds at the start, where: (a) “fog” holds at the start, or "
                "at all times “horn” holds."
            ),
        ),
    ],
)
def test_what_is_said(formula, english):
    assert in_one_line(phrase(formula, inside=False)) == english


def test_every_choice_of_distinct_objects():
    tree = {"bus": {"bus", "vehicle"}, "vehicle": {"vehicle", "bus"}, "walker": {"walker"}}
    shown = sentence(
        Unary(ALWAYS, HORN),
        [("v", "vehicle"), ("p", "walker"), ("w", "bus")],
        lambda one, other: other in tree[one],
    )
    assert in_one_line(shown) == (
        "For every vehicle v, every walker p and every other bus w: at all times “horn” holds."
    )


def test_lists_within_lists_are_labelled_by_their_depth():
    both = Unary(ALWAYS, Binary(OR, Unary(ALWAYS, HORN), FOG))
    deep = both
    for _ in range(4):
        deep = Binary(AND, deep, Unary(EVENTUALLY, Binary(IMPLIES, FOG, HORN)))
        deep = Unary(NOT, deep)
    shown = lines(phrase(deep, inside=False))
    assert [one.label for one in shown if one.text.startswith("at some time")] == [
        "(1.2)",
        "(2)",
        "(ii)",
        "(b)",
    ]
    assert {one.label for one in shown if one.depth == 5} == {"(1.1.1)", "(1.1.2)"}


objects = st.sampled_from(["x", "y"])
amounts = st.sampled_from([Fraction(0), Fraction(1), Fraction(3, 2), Fraction(3)])
bounds = st.none() | st.builds(
    lambda low, more, unit: Bound(low, None if more is None else low + more, unit),
    amounts,
    st.none() | amounts,
    st.sampled_from(["s", "steps"]),
)
distances = st.none() | st.builds(
    lambda n, unit: Bound(n, n, unit), amounts, st.sampled_from(["s", "steps"])
)
relations = st.sampled_from(["<", "<=", "=", "!=", ">=", ">"])
numbers = st.sampled_from([Fraction(0), Fraction(1), Fraction(1, 3), Fraction(-5, 2), Fraction(8)])
quantities = st.sampled_from(
    [QuantityTerm("speed"), QuantityTerm("gap", ("x",)), QuantityTerm("gap", ("y",))]
)
sums = st.dictionaries(quantities, st.sampled_from([Fraction(2), Fraction(-1, 2)]), max_size=1)


def compared(first, others, relation, limit):
    terms = {first: Fraction(1)} | {one: c for one, c in others.items() if one != first}
    ordered = tuple((c, term) for term, c in terms.items())
    return Comparison(ordered, relation, limit)


comparisons = st.builds(compared, quantities, sums, relations, numbers)
bodies = st.recursive(
    st.sampled_from(ATOMS) | st.builds(Same, objects, objects),
    lambda inner: (
        st.builds(Unary, st.just(NOT), inner) | st.builds(Binary, st.just(AND), inner, inner)
    ),
    max_leaves=3,
)
counts = st.builds(
    lambda count, relation, limit: Comparison(((Fraction(1), count),), relation, limit),
    st.builds(Count, objects, st.sampled_from(["bus", "road_user"]), bodies),
    relations,
    numbers,
)
NEXTS = (
    UnaryOperator.NEXT,
    UnaryOperator.WEAK_NEXT,
    UnaryOperator.PREVIOUSLY,
    UnaryOperator.WEAK_PREVIOUSLY,
)
REACHING = [one for one in UnaryOperator if one not in (*NEXTS, NOT)]
BOOLEAN = [AND, OR, IMPLIES, BinaryOperator.IFF, BinaryOperator.XOR]
TEMPORAL = [one for one in BinaryOperator if one not in BOOLEAN]

formulas = st.recursive(
    st.sampled_from(ATOMS) | st.builds(Constant, st.booleans()) | comparisons | counts,
    lambda inner: (
        st.builds(Unary, st.just(NOT), inner)
        | st.builds(Unary, st.sampled_from(REACHING), inner, bounds)
        | st.builds(Unary, st.sampled_from(NEXTS), inner, distances)
        | st.builds(Binary, st.sampled_from(BOOLEAN), inner, inner)
        | st.builds(Binary, st.sampled_from(TEMPORAL), inner, inner, bounds)
    ),
    max_leaves=5,
)


LANGUAGES = (ENGLISH, GERMAN, FRENCH)


def said(formula, language=ENGLISH):
    return in_one_line(phrase(formula, language, inside=False), language)


@given(formulas, formulas, st.sampled_from(LANGUAGES))
def test_different_formulas_have_different_sentences(one, other, language):
    assert (said(one, language) == said(other, language)) == (one == other)


def smallest():
    """All formulas over two atoms with at most two operators, and some with three."""
    p, q = Atom("p"), Atom("q")
    leaves = [p, q]
    one = [Unary(operator, leaf) for operator in UnaryOperator for leaf in leaves]
    one += [Binary(operator, a, b) for operator in BinaryOperator for a in leaves for b in leaves]
    two = [Unary(operator, inner) for operator in UnaryOperator for inner in one]
    for operator in BinaryOperator:
        two += [Binary(operator, inner, leaf) for inner in one for leaf in leaves]
        two += [Binary(operator, leaf, inner) for inner in one for leaf in leaves]
    chains = [
        Binary(a, Binary(b, p, q), Binary(c, q, p))
        for a in BinaryOperator
        for b in BinaryOperator
        for c in BinaryOperator
    ]
    return [*leaves, *one, *two, *chains]


@pytest.mark.parametrize("language", LANGUAGES, ids=lambda language: language.code)
def test_all_small_formulas_have_different_sentences(language):
    every = smallest()
    assert len({said(one, language) for one in every}) == len(set(every)) > 4000


BOUNDS = [None, seconds(0, 3), steps(0, 3), seconds(1, 3), seconds(1, None), seconds(3, 3)]


def mutants(formula):
    """Formulas that differ from this one at one place."""
    match formula:
        case Unary(operator, operand, bound):
            yield operand
            for one in mutants(operand):
                yield Unary(operator, one, bound)
            if operator is not NOT:
                like = NEXTS if operator in NEXTS else REACHING
                yield from (Unary(one, operand, bound) for one in like)
                yield from (Unary(operator, operand, one) for one in BOUNDS)
        case Binary(operator, left, right, bound):
            yield Binary(operator, right, left, bound)
            for one in mutants(left):
                yield Binary(operator, one, right, bound)
            for one in mutants(right):
                yield Binary(operator, left, one, bound)
            like = BOOLEAN if operator in BOOLEAN else TEMPORAL
            yield from (Binary(one, left, right, bound) for one in like)
            if operator in TEMPORAL:
                yield from (Binary(operator, left, right, one) for one in BOUNDS)
            if isinstance(left, Binary):
                within = Binary(operator, left.right, right, bound)
                yield Binary(left.operator, left.left, within, left.bound)
        case _:
            yield Unary(NOT, formula)
            yield Unary(ALWAYS, formula)


@given(formulas, st.sampled_from(LANGUAGES))
def test_whatever_is_changed_in_a_formula_changes_its_sentence(formula, language):
    for one in mutants(formula):
        assert (said(one, language) == said(formula, language)) == (one == formula), one


def unrelated(*_):
    return False


@pytest.mark.parametrize(
    ("language", "weakly", "ever_since"),
    [
        (
            ENGLISH,
            (
                "“horn” does not hold, and this is so for ever, or only until, at some time, "
                "“fog” holds."
            ),
            "“horn” does not hold, and this has been so ever since “fog” holds.",
        ),
        (
            GERMAN,
            (
                "Es gilt: „horn“ gilt nicht, und zwar für immer oder nur, bis irgendwann gilt: "
                "„fog“ gilt."
            ),
            "Es gilt: „horn“ gilt nicht, und zwar seitdem galt: „fog“ gilt.",
        ),
        (
            FRENCH,
            (
                "Ceci : « horn » n'est pas vrai, et cela pour toujours, ou seulement jusqu'à ce "
                "que, à un moment, ceci : « fog » est vrai."
            ),
            "Ceci : « horn » n'est pas vrai, et cela depuis que ceci : « fog » est vrai.",
        ),
    ],
)
def test_what_does_not_hold_for_ever_never_holds(language, weakly, ever_since):
    """`does not hold for ever` would say that it ends some day."""
    silent = Unary(NOT, HORN)
    for operator, said in ((BinaryOperator.WEAK_UNTIL, weakly), (BinaryOperator.SINCE, ever_since)):
        assert in_one_line(sentence(Binary(operator, silent, FOG), (), unrelated, language)) == said


def test_two_counts_are_compared_in_words():
    buses = Count("x", "bus", Atom("near", ("x",)))
    slow = Comparison(
        ((Fraction(1), QuantityTerm("pace", ("y",))),), "<", Fraction(5), "pace(y) < 5"
    )
    cars = Count("y", "car", Binary(AND, Atom("near", ("y",)), slow))
    text = "count x: bus (near(x)) >= 2 * count y: car (near(y) and pace(y) < 5)"
    compared = Comparison(((Fraction(1), buses), (Fraction(-2), cars)), ">=", Fraction(0), text)
    english = (
        "At all times the number of buses x (for which “near” holds of x) is at least 2 times the "
        "number of cars y (for which “near” holds of y and the pace of y is less than 5)."
    )
    german = (
        "Immer gilt: die Zahl der Objekte der Art „bus“ x (für die gilt: „near“ gilt für x) "
        "beträgt mindestens 2 mal die Zahl der Objekte der Art „car“ y (für die gilt: „near“ gilt "
        "für y und „pace“ von y beträgt weniger als 5)."
    )
    for language, said in ((ENGLISH, english), (GERMAN, german)):
        assert in_one_line(sentence(Unary(ALWAYS, compared), (), unrelated, language)) == said


def test_a_count_of_what_takes_a_list_stays_a_formula():
    deep = Binary(OR, Binary(AND, HORN, FOG), Binary(AND, FOG, BESIDE))
    text = "count x: bus (…) >= count y: car (near(y))"
    terms = (
        (Fraction(1), Count("x", "bus", deep)),
        (Fraction(-1), Count("y", "car", Atom("near", ("y",)))),
    )
    said = in_one_line(sentence(Comparison(terms, ">=", Fraction(0), text), (), unrelated))
    assert said == f"“{text}” is true at the start."
