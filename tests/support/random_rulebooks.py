"""Random rulebooks over a vocabulary that has one of everything."""

from fractions import Fraction

from hypothesis import assume
from hypothesis import strategies as st
from past_in_spot import is_easy
from possible import possible_letters
from random_priorities import LEVELS, PAIRS, closed
from timed import RELATIONS, operations

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Constant,
    Count,
    Quantity,
    Same,
    Unary,
    UnaryOperator,
    atoms_of,
)
from rulec.rulebook.model import Fact, Rule, Rulebook, Variable
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity

WORLD = Vocabulary(
    "world",
    {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
    {
        "place": Enumeration("place", ("thing",), ("near", "far", "gone")),
        "light": Enumeration("light", (), ("red", "green"), "red"),
        "p": Signal("p", (), False),
        "q": Signal("q", (), None),
        "loud": Signal("loud", ("thing",), False),
        "follows": Signal("follows", ("thing", "thing"), False),
        "speed": DeclaredQuantity("speed", (), "m/s"),
        "pace": DeclaredQuantity("pace", (), "m/s", 1.0),
        "gap": DeclaredQuantity("gap", ("thing",), "m"),
        "apart": DeclaredQuantity("apart", ("thing", "thing"), "m", 0.3),
    },
)

NO = UnaryOperator.NOT
BOOLEAN = [BinaryOperator(word) for word in ("and", "or", "implies", "iff", "xor")]
NEAR, FAR = "near", "far"


def at(place, variable):
    return Atom("place", (variable,), place)


def number(text, *terms):
    """A sum of pairs of a coefficient and a term; ``text`` is how a rulebook says it."""
    return text, tuple((Fraction(factor), term) for factor, term in terms)


def quantity(name, *variables):
    return Quantity(name, variables)


NOT_X = Unary(NO, Same("o", "x"))
LITTLE = Comparison(((Fraction(1), quantity("gap", "o")),), "<", Fraction(1), "gap(o) < 1 m")
WORLD_ATOMS = [Atom("light", (), "red"), Atom("light", (), "green"), Atom("p"), Atom("q")]
X_ATOMS = [at(NEAR, "x"), at(FAR, "x"), at("gone", "x"), Atom("loud", ("x",))]
Y_ATOMS = [at(NEAR, "y"), Atom("follows", ("x", "y")), Atom("follows", ("y", "x"))]
WORLD_SUMS = [
    number("speed", (1, quantity("speed"))),
    number("pace", (1, quantity("pace"))),
    number("count o: car (near(o))", (1, Count("o", "car", at(NEAR, "o")))),
    number(
        "count o: thing (loud(o) or gap(o) < 1 m)",
        (1, Count("o", "thing", Binary(BinaryOperator.OR, Atom("loud", ("o",)), LITTLE))),
    ),
]
X_SUMS = [
    number("gap(x)", (1, quantity("gap", "x"))),
    number("gap(x) - 2 * speed", (1, quantity("gap", "x")), (-2, quantity("speed"))),
    number(
        "count o: thing (o != x and follows(o, x))",
        (1, Count("o", "thing", Binary(BinaryOperator.AND, NOT_X, Atom("follows", ("o", "x"))))),
    ),
]
Y_SUMS = [
    number("apart(x, y)", (1, quantity("apart", "x", "y"))),
    number("gap(x) - gap(y)", (1, quantity("gap", "x")), (-1, quantity("gap", "y"))),
]
LIMITS = [Fraction(limit) for limit in ("0", "3/10", "1", "3/2", "2")]


def comparisons(sums):
    def compared(of, relation, limit):
        text, terms = of
        return Comparison(terms, relation, limit, f"{text} {relation} {limit}")

    return st.builds(compared, st.sampled_from(sums), st.sampled_from(RELATIONS), limits)


limits = st.sampled_from(LIMITS)
X, CAR_X = Variable("x", "thing"), Variable("x", "car")
Y, CAR_Y = Variable("y", "thing"), Variable("y", "car")
ALONE = st.sampled_from(WORLD_ATOMS) | comparisons(WORLD_SUMS)
WITH_X = ALONE | st.sampled_from(X_ATOMS) | comparisons(X_SUMS) | st.sampled_from(X_ATOMS)
WITH_Y = WITH_X | st.sampled_from(Y_ATOMS) | comparisons(Y_SUMS) | st.sampled_from(Y_ATOMS)
HEADS = [
    ((), ALONE),
    ((X,), WITH_X),
    ((CAR_X,), WITH_X),
    ((CAR_X, Y), WITH_Y),
    ((X, CAR_Y), WITH_Y),
]


def formulas(leaves):
    return st.recursive(
        leaves | st.builds(Constant, st.booleans()),
        lambda inner: operations(inner, "steps", Fraction(1)),
        max_leaves=4,
    ).filter(is_easy)


def in_seconds(formula, step_s):
    """The same formula for traces of this step, its bounds being in seconds."""
    match formula:
        case Unary(operator, operand, bound):
            return Unary(operator, in_seconds(operand, step_s), seconds_of(bound, step_s))
        case Binary(operator, left, right, bound):
            left, right = in_seconds(left, step_s), in_seconds(right, step_s)
            return Binary(operator, left, right, seconds_of(bound, step_s))
    return formula


def seconds_of(bound, step_s):
    if bound is None:
        return None
    high = None if bound.high is None else bound.high * step_s
    return Bound(bound.low * step_s, high, "s")


@st.composite
def rules(draw, name, step_s):
    variables, leaves = draw(st.sampled_from(HEADS))
    formula = draw(formulas(leaves))
    return Rule(
        name,
        draw(st.sampled_from(["hard", "soft"])),
        variables,
        in_seconds(formula, step_s) if draw(st.booleans()) else formula,
        level=draw(st.sampled_from(["", *LEVELS])),
        weight=draw(st.sampled_from([Fraction(1), Fraction(2), Fraction(1, 3)])),
    )


LOUD = comparisons(
    [number("count o: thing (loud(o))", (1, Count("o", "thing", Atom("loud", ("o",)))))]
)


@st.composite
def facts(draw, rule):
    """A fact about the objects of a rule; mostly of what the rule reads, sometimes it counts."""
    read = [
        one
        for one in dict.fromkeys(atoms_of(rule.formula))
        if isinstance(one, Atom) or isinstance(one.terms[0][1], Quantity)
    ]
    leaves = st.sampled_from([*read, *WORLD_ATOMS[2:]]) | st.sampled_from(WORLD_ATOMS)
    leaves = LOUD if draw(st.integers(0, 4)) == 0 else leaves
    formula = st.recursive(
        leaves,
        lambda inner: (
            st.builds(Unary, st.just(NO), inner)
            | st.builds(Binary, st.sampled_from(BOOLEAN), inner, inner)
        ),
        max_leaves=3,
    )
    return Fact(rule.variables, draw(formula))


@st.composite
def rulebooks(draw, step_s, with_facts=True):
    """Of up to three rules, for traces of a step; its facts do not contradict each other."""
    every = tuple(draw(rules(f"r{n}", step_s)) for n in range(draw(st.integers(1, 3))))
    known = ()
    if with_facts and draw(st.booleans()):
        known = tuple(draw(st.lists(st.sampled_from(every).flatmap(facts), max_size=2)))
    book = Rulebook(
        "random",
        WORLD,
        every,
        semantics=draw(st.sampled_from(["stutter", "finite"])),
        facts=known,
        levels=LEVELS,
        priorities=closed(draw(st.sets(st.sampled_from(PAIRS), max_size=3))),
    )
    assume(all(possible_letters(one.formula, one.variables, book) for one in book.rules))
    return book
