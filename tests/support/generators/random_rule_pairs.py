"""Random rules to compare, and their verdicts straight from the definitions."""

from dataclasses import replace
from fractions import Fraction
from itertools import permutations, product

from hypothesis import strategies as st

from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Count,
    QuantityTerm,
    Unary,
    UnaryOperator,
)
from rulec.logic.semantics import holds
from rulec.rulebook.rulebook_model import Rule, Rulebook, Variable
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity
from support.builders.rulebooks import compile_here
from support.oracles.state_oracle import Reading

VOCABULARY = Vocabulary(
    "pairs",
    {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
    {
        "place": Enumeration("place", ("thing",), ("near", "far", "gone")),
        "p": Signal("p", (), False),
        "follows": Signal("follows", ("thing", "thing"), False),
        "speed": DeclaredQuantity("speed", (), "m/s", 0.0),
        "gap": DeclaredQuantity("gap", ("thing",), "m"),
    },
)

ONE = Fraction(1)


def compared(coefficients, relation, limit):
    terms = tuple((Fraction(factor), QuantityTerm(*term)) for factor, term in coefficients)
    return Comparison(terms, relation, Fraction(limit), f"{coefficients} {relation} {limit}")


def how_many(kind, value):
    return Count("o", kind, Atom("place", ("o",), value))


GAP, SPEED = ("gap", ("x",)), ("speed", ())

ALONE = [
    Atom("p"),
    Atom("place", ("x",), "near"),
    Atom("place", ("x",), "far"),
    compared([(1, SPEED)], ">=", 1),
    compared([(1, SPEED)], "<", 2),
    compared([(1, GAP)], "<", 2),
    compared([(1, GAP), (-1, SPEED)], ">", 0),
]

PAIRED = [
    Atom("p"),
    Atom("follows", ("x", "y")),
    Atom("follows", ("y", "x")),
    Atom("place", ("x",), "near"),
]

COUNTED = [
    Atom("p"),
    Comparison(((ONE, how_many("thing", "near")),), ">=", Fraction(1), "a"),
    Comparison(((ONE, how_many("thing", "near")),), ">=", Fraction(2), "b"),
    Comparison(((ONE, how_many("thing", "far")),), "<", Fraction(1), "c"),
    Comparison(((ONE, how_many("car", "near")),), ">=", Fraction(1), "d"),
]

TEMPORAL = [one for one in UnaryOperator if one is not UnaryOperator.NOT]
BOUNDED = [UnaryOperator.EVENTUALLY, UnaryOperator.ALWAYS, UnaryOperator.ONCE]
SHORT = Bound(Fraction(0), Fraction(1), "steps")


def formulas(atoms):
    return st.recursive(
        st.sampled_from(atoms),
        lambda inner: (
            st.builds(Unary, st.sampled_from(UnaryOperator), inner)
            | st.builds(Unary, st.sampled_from(BOUNDED), inner, st.just(SHORT))
            | st.builds(Binary, st.sampled_from(BinaryOperator), inner, inner)
        ),
        max_leaves=4,
    )


def sides(
    formulas,
    variables=(),
    semantics=("stutter", "stutter"),
    axioms=(),
    vocabulary=VOCABULARY,
):
    """Both rules compiled, each in a rulebook of its own."""
    found = []
    for number, (formula, how) in enumerate(zip(formulas, semantics, strict=True)):
        rule = Rule("r", "hard", tuple(variables), formula)
        book = Rulebook(f"book{number}", vocabulary, (rule,), semantics=how, axioms=axioms)
        compiled = compile_here(book)
        header = replace(compiled, rules=())
        found.append(AnalyzedRule(header, axioms, compiled.rules[0], number))
    return found


def allows(side, trace):
    """Is the rule kept for all ways to bind its variables to distinct objects?"""
    formula, reading = side.rule.formula, Reading(side.rulebook, trace)
    return all(
        holds(
            formula,
            [reading.letter(formula, objects, n) for n in range(first, last + 1)],
            side.rulebook.semantics,
        )
        for objects, first, last in reading.choices(side.rule)
    )


def states(objects, names):
    """All states of these objects, numbers being those around the thresholds."""
    values = {
        "place": ["near", "far", "gone"],
        "p": [False, True],
        "follows": [False, True],
        "speed": [0.5, 1.0, 1.5, 2.0, 2.5],
        "gap": [0.5, 1.75, 2.25],
    }
    keys = []
    for name in names:
        about = VOCABULARY.declarations[name].parameters
        keys += [(name, chosen) for chosen in permutations(objects, len(about))]
    for chosen in product(*(values[name] for name, _ in keys)):
        state = {}
        for (name, items), value in zip(keys, chosen, strict=True):
            *outer, last = (name, *items)
            inside = state
            for key in outer:
                inside = inside.setdefault(key, {})
            inside[last] = value
        yield state


X = Variable("x", "thing")
Y = Variable("y", "thing")
