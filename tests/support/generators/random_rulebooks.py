"""Random rulebooks over a vocabulary that has one of everything, by a source of chance."""

from dataclasses import replace
from fractions import Fraction
from functools import partial

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
    atoms_of,
)
from rulec.logic.free_names import variables_of
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook, Variable
from support.builders.full_vocabulary import WORLD
from support.generators.random_priorities import LEVELS, PAIRS, closed
from support.generators.timed_formulas import BOOLEAN, DISTANCE, RELATIONS
from support.oracles.past_in_spot import is_easy
from support.oracles.possible_letters import possible_letters

NO = UnaryOperator.NOT
JOINING = [one for one in BinaryOperator if one.value in BOOLEAN]
NEAR, FAR = "near", "far"


def at(place, variable):
    return Atom("place", (variable,), place)


def number(text, *terms):
    """A sum of pairs of a coefficient and a term; ``text`` is how a rulebook says it."""
    return text, tuple((Fraction(factor), term) for factor, term in terms)


def quantity(name, *variables):
    return QuantityTerm(name, variables)


NOT_X = Unary(NO, Same("o", "x"))
LITTLE = Comparison(((Fraction(1), quantity("gap", "o")),), "<", Fraction(1), "gap(o) < 1 m")
WORLD_ATOMS = [Atom("light", (), "red"), Atom("light", (), "green"), Atom("p"), Atom("q")]
X_ATOMS = [at(NEAR, "x"), at(FAR, "x"), at("gone", "x"), Atom("loud", ("x",))]
Y_ATOMS = [at(NEAR, "y"), Atom("follows", ("x", "y")), Atom("follows", ("y", "x"))]
ANOTHER_NEAR = Binary(BinaryOperator.AND, Unary(NO, Same("r", "o")), at(NEAR, "r"))
LONELY = Comparison(((Fraction(1), Count("r", "thing", ANOTHER_NEAR)),), "<", Fraction(1), "alone")
WORLD_SUMS = [
    number(
        "count o: car (count r: thing (r != o and near(r)) < 1)", (1, Count("o", "car", LONELY))
    ),
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
LOUD = number("count o: thing (loud(o))", (1, Count("o", "thing", Atom("loud", ("o",)))))
X, CAR_X = Variable("x", "thing"), Variable("x", "car")
Y, CAR_Y = Variable("y", "thing"), Variable("y", "car")
HEADS = [(), (X,), (CAR_X,), (CAR_X, Y), (X, CAR_Y)]


def leaf(chance, variables):
    """An atom or a comparison; mostly about all the variables, if there are any."""
    if chance.random() < 0.05:
        return Constant(chance.random() < 0.5)
    about = chance.choice([*range(len(variables) + 1), len(variables)])
    if chance.random() < 0.6:
        return chance.choice([WORLD_ATOMS, X_ATOMS, Y_ATOMS][about])
    return comparison(chance, chance.choice([WORLD_SUMS, X_SUMS, Y_SUMS][about]))


def comparison(chance, of):
    text, terms = of
    relation, limit = chance.choice(RELATIONS), chance.choice(LIMITS)
    return Comparison(terms, relation, limit, f"{text} {relation} {limit}")


def bound(chance, operator):
    if operator.value in BOOLEAN or chance.random() < 0.5:
        return None
    low = Fraction(chance.randint(0, 3))
    if operator.value in DISTANCE:
        return Bound(low, low, "steps")
    return Bound(low, chance.choice([None, low, low + 1, low + 3]), "steps")


def formula(chance, leaf, n_leaves, unary=tuple(UnaryOperator), binary=tuple(BinaryOperator)):
    """Any formula with so many leaves."""
    if n_leaves == 1:
        found = leaf(chance)
    else:
        left = chance.randint(1, n_leaves - 1)
        operator = chance.choice(binary)
        sides = [formula(chance, leaf, n, unary, binary) for n in (left, n_leaves - left)]
        found = Binary(operator, *sides, bound(chance, operator))
    while chance.random() < 0.4:
        operator = chance.choice(unary)
        found = Unary(operator, found, bound(chance, operator))
    return found


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


def always(formula):
    return Unary(UnaryOperator.ALWAYS, formula)


def never_both(one, other):
    return always(Unary(NO, Binary(BinaryOperator.AND, one, other)))


def eventually(formula):
    return Unary(UnaryOperator.EVENTUALLY, formula)


P, Q = Atom("p"), Atom("q")
SOON = Bound(Fraction(0), Fraction(1), "steps")
TELLING = [
    ((), Unary(UnaryOperator.NEXT, Q)),
    ((), Unary(UnaryOperator.EVENTUALLY, P, SOON)),
    ((X,), Unary(UnaryOperator.EVENTUALLY, at(FAR, "x"), SOON)),
    ((), always(Binary(BinaryOperator.IMPLIES, P, eventually(Q)))),
    ((), eventually(always(Q))),
    ((), always(Binary(BinaryOperator.IMPLIES, P, Unary(UnaryOperator.NEXT, P)))),
    ((), Binary(BinaryOperator.UNTIL, Unary(NO, P), Q)),
    ((), eventually(Binary(BinaryOperator.AND, P, Q))),
    ((X,), eventually(at(NEAR, "x"))),
    ((X,), eventually(always(at(FAR, "x")))),
    ((CAR_X,), never_both(at(NEAR, "x"), eventually(at(FAR, "x")))),
    ((CAR_X, Y), never_both(at(NEAR, "x"), at(NEAR, "y"))),
]
"""Rules that many traces keep and many violate; of random ones most come out one way."""


def rule(chance, name, step_s, telling):
    variables, meant = chance.choice(TELLING)
    if chance.random() > telling:
        variables, meant = chance.choice(HEADS), None
    while meant is None or not is_easy(meant):
        n_leaves = chance.randint(1, 4)
        meant = formula(chance, partial(leaf, variables=variables), n_leaves)
    return placed(
        chance, name, variables, in_seconds(meant, step_s) if chance.random() < 0.5 else meant
    )


def placed(chance, name, variables, meant):
    return Rule(
        name,
        chance.choice(["hard", "soft"]),
        variables,
        meant,
        level=chance.choice(["", *LEVELS]),
        weight=chance.choice([Fraction(1), Fraction(2), Fraction(1, 3)]),
    )


def fact(chance, rules):
    """A fact about the objects of a rule; mostly of what the rule reads, sometimes it counts.

    About every other one is about values that are all of the same objects.
    """
    if chance.random() < 0.15:
        return Axiom((), Binary(BinaryOperator.IMPLIES, *chance.sample([Atom("p"), Atom("q")], 2)))
    about = chance.choice(rules)
    variables = about.variables
    read = [
        one
        for one in atoms_of(about.formula)
        if isinstance(one, Atom) or isinstance(one.terms[0][1], QuantityTerm)
    ]
    leaves = [*read, *read, *WORLD_ATOMS[2:]]
    if chance.random() < 0.5:
        some = tuple(one for one in variables if chance.random() < 0.6)
        variables = chance.choice([some, some, (X,), (CAR_X,)])
        names = {one.name for one in variables}
        more = [*WORLD_ATOMS, *X_ATOMS, *Y_ATOMS]
        leaves = [one for one in (*read, *read, *more) if set(variables_of(one)) == names]
    elif chance.random() < 0.2:
        leaves = [comparison(chance, LOUD)]
    said = formula(
        chance, lambda chance: chance.choice(leaves), chance.randint(1, 3), (NO,), tuple(JOINING)
    )
    return Axiom(variables, said)


def rulebook(chance, step_s, for_graphs=False):
    """For traces of a step; facts do not contradict each other. For graphs there are none."""
    n_rules = chance.randint(1, 4 if for_graphs else 3)
    telling, n_facts = (0.7, 0) if for_graphs else (0.2, chance.choice([0, 1, 2]))
    rules = tuple(rule(chance, f"r{n}", step_s, telling) for n in range(n_rules))
    if for_graphs and chance.random() < 0.7:
        # What cannot both be kept: something has to give.
        ends = eventually(always(chance.choice([P, Q, Binary(BinaryOperator.OR, P, Q)])))
        rules += (
            placed(chance, "one", (), ends),
            placed(chance, "other", (), Unary(NO, ends)),
        )
    semantics, pairs = (
        chance.choice(["stutter", "finite"]),
        chance.sample(PAIRS, chance.choice([0, 0, 1, 2, 3])),
    )
    while True:
        known = tuple(fact(chance, rules) for _ in range(n_facts))
        book = Rulebook("random", WORLD, rules, semantics=semantics, axioms=known)
        if all(possible_letters(one.formula, one.variables, book) for one in rules):
            return replace(book, levels=LEVELS, priorities=closed(pairs))
