"""Random rules to compare, and their verdicts straight from the definitions."""

from dataclasses import replace
from fractions import Fraction
from itertools import permutations, product

from books import compile_here
from hypothesis import strategies as st

from rulec.analysis.distinct import Side
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Constant,
    Count,
    Quantity,
    Unary,
    UnaryOperator,
)
from rulec.logic.semantics import holds
from rulec.rulebook.model import Rule, Rulebook, Variable
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity

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
    terms = tuple((Fraction(factor), Quantity(*term)) for factor, term in coefficients)
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


def sides(formulas, variables=(), semantics=("stutter", "stutter"), facts=()):
    """Both rules compiled, each in a rulebook of its own."""
    found = []
    for number, (formula, how) in enumerate(zip(formulas, semantics, strict=True)):
        rule = Rule("r", "hard", tuple(variables), formula)
        book = Rulebook(f"book{number}", VOCABULARY, (rule,), semantics=how, facts=facts)
        compiled = compile_here(book)
        header = replace(compiled, rules=())
        found.append(Side(header, facts, compiled.rules[0], number))
    return found


def allows(side, trace):
    """Is the rule kept for all ways to bind its variables to distinct objects?"""
    variables = side.rule.variables
    for chosen in permutations(trace.objects, len(variables)):
        fits = all(
            side.rulebook.vocabulary.is_subtype(trace.objects[name], variable.type)
            for name, variable in zip(chosen, variables, strict=True)
        )
        names = {variable.name: name for name, variable in zip(chosen, variables, strict=True)}
        if fits and not _holds(side, trace, names):
            return False
    return True


def _holds(side, trace, names):
    atoms = set(_propositions(side.rule.formula))
    word = [
        frozenset(one for one in atoms if _true(one, state, trace.objects, names, side))
        for state in trace.states
    ]
    return holds(side.rule.formula, word, side.rulebook.semantics)


def _propositions(formula):
    match formula:
        case Unary(_, operand):
            return _propositions(operand)
        case Binary(_, left, right):
            return _propositions(left) + _propositions(right)
        case Constant():
            return []
    return [formula]


def _true(one, state, objects, names, side):
    if isinstance(one, Atom):
        return _value(one.name, [names[v] for v in one.arguments], state) == (one.value or True)
    total = Fraction(0)
    for factor, term in one.terms:
        if isinstance(term, Quantity):
            value = _value(term.name, [names[v] for v in term.arguments], state)
            total += factor * Fraction(str(value))
        else:
            total += factor * sum(
                _true(term.body, state, objects, {**names, term.variable: name}, side)
                for name, kind in objects.items()
                if side.rulebook.vocabulary.is_subtype(kind, term.type)
            )
    relations = {
        "<": total < one.limit,
        "<=": total <= one.limit,
        ">=": total >= one.limit,
        ">": total > one.limit,
    }
    return relations[one.relation]


def _value(name, objects, state):
    found = state.get(name)
    for item in objects:
        found = None if found is None else found.get(item)
    return VOCABULARY.declarations[name].default if found is None else found


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
