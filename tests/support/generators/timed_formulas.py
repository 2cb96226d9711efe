"""Random formulas with bounds and numbers, random words for them, and two more readings of both.

A state here gives every atom and every term its value directly: what a count counts is the
runtime's matter.
"""

from dataclasses import replace
from fractions import Fraction

from hypothesis import strategies as st

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Bound,
    Comparison,
    Constant,
    Count,
    Formula,
    QuantityTerm,
    Unary,
    UnaryOperator,
    atoms_of,
    with_operands,
)
from rulec.vocabulary import Quantity as DeclaredQuantity
from rulec.vocabulary import Vocabulary
from support.generators.random_formulas import ATOMS, TYPES, VOCABULARY

TIMED_VOCABULARY = Vocabulary(
    "timed",
    TYPES,
    {
        **VOCABULARY.declarations,
        "speed": DeclaredQuantity("speed", (), "km/h"),
        "gap": DeclaredQuantity("gap", ("thing",), "m"),
    },
)

SPEED, GAP = QuantityTerm("speed"), QuantityTerm("gap", ("x",))
CARS = Count("y", "car", Atom("place", ("y",), "near"))
SUMS = {
    "speed": ((Fraction(1), SPEED),),
    "gap(x) - 2 * speed": ((Fraction(1), GAP), (Fraction(-2), SPEED)),
    "count y: car (near(y))": ((Fraction(1), CARS),),
}
RELATIONS = ("<", "<=", "=", "!=", ">=", ">")


def in_seconds(formula: Formula) -> Formula:
    """The formula whose steps are seconds."""
    if not isinstance(formula, Unary | Binary):
        return formula
    bound = formula.bound and replace(formula.bound, unit="s")
    return replace(with_operands(formula, in_seconds), bound=bound)


def comparison(of: str, relation: str, limit: Fraction | int) -> Comparison:
    return Comparison(SUMS[of], relation, Fraction(limit), f"{of} {relation} {limit}")


limits = st.sampled_from([Fraction(n, 2) for n in range(-1, 6)])
comparisons = st.builds(comparison, st.sampled_from(list(SUMS)), st.sampled_from(RELATIONS), limits)
propositions = st.sampled_from(ATOMS) | comparisons

DISTANCE = {"next", "weak next", "previously", "weak previously"}
BOOLEAN = {"not", "and", "or", "implies", "iff", "xor"}


@st.composite
def bounds(draw, operator, unit="steps", scale=Fraction(1)):
    if operator.value in BOOLEAN or draw(st.booleans()):
        return None
    low = draw(st.integers(0, 3))
    if operator.value in DISTANCE:
        return Bound(low * scale, low * scale, unit)
    high = draw(st.none() | st.integers(low, low + 3))
    return Bound(low * scale, None if high is None else high * scale, unit)


@st.composite
def operations(draw, inner, unit, scale):
    if draw(st.booleans()):
        operator = draw(st.sampled_from(UnaryOperator))
        return Unary(operator, draw(inner), draw(bounds(operator, unit, scale)))
    operator = draw(st.sampled_from(BinaryOperator))
    return Binary(operator, draw(inner), draw(inner), draw(bounds(operator, unit, scale)))


def formulas_in(unit="steps", scale=Fraction(1), max_leaves=5):
    leaves = propositions | st.builds(Constant, st.booleans())
    return st.recursive(leaves, lambda inner: operations(inner, unit, scale), max_leaves=max_leaves)


timed_formulas = formulas_in()

timed_states = st.fixed_dictionaries(
    {
        "place": st.sampled_from(["near", "far", "gone"]),
        "light": st.sampled_from(["red", "green"]),
        "p": st.booleans(),
        "q": st.booleans(),
        SPEED: st.sampled_from([Fraction(n, 4) for n in range(-1, 9)]),
        GAP: st.sampled_from([Fraction(n, 2) for n in range(-3, 9)]),
        CARS: st.integers(0, 3).map(Fraction),
    }
)

timed_words = st.lists(timed_states, min_size=1, max_size=8)


def number(terms, state):
    return sum(coefficient * state[term] for coefficient, term in terms)


def is_true(proposition, state):
    if isinstance(proposition, Atom):
        value = state[proposition.name]
        return value if proposition.value is None else value == proposition.value
    value, limit = number(proposition.terms, state), proposition.limit
    return {
        "<": value < limit,
        "<=": value <= limit,
        "=": value == limit,
        "!=": value != limit,
        ">=": value >= limit,
        ">": value > limit,
    }[proposition.relation]


def letters_of(formula, word):
    return [frozenset(one for one in atoms_of(formula) if is_true(one, state)) for state in word]


def letter_number(reads, state):
    """The number of the letter that a machine with these reads makes of a state."""
    found, stride = 0, 1
    for read in reads:
        digit = read.digit(
            number(read.terms, state) if hasattr(read, "terms") else state[read.name]
        )
        assert 0 <= digit < read.size
        found += digit * stride
        stride *= read.size
    return found


def without_bounds(formula):
    """The same formula by operators without bounds: bounded ones unrolled, step by step."""
    match formula:
        case Unary(operator, operand, bound):
            return _unary(operator, without_bounds(operand), bound)
        case Binary(operator, left, right, bound):
            return _binary(operator, without_bounds(left), without_bounds(right), bound)
    return formula


NOT, AND, OR = UnaryOperator.NOT, BinaryOperator.AND, BinaryOperator.OR
TRUE = Constant(True)


def _not(formula):
    return Unary(NOT, formula)


def _unary(operator, p, bound):
    if bound is None:
        return Unary(operator, p)
    match operator.value:
        case "next" | "weak next" | "previously" | "weak previously":
            for _ in range(int(bound.low)):
                p = Unary(operator, p)
            return p
        case "eventually":
            return _unrolled(TRUE, p, bound, BinaryOperator.UNTIL, UnaryOperator.NEXT)
        case "always":
            return _not(_unary(UnaryOperator.EVENTUALLY, _not(p), bound))
        case "never":
            return _not(_unary(UnaryOperator.EVENTUALLY, p, bound))
        case "once":
            return _unrolled(TRUE, p, bound, BinaryOperator.SINCE, UnaryOperator.PREVIOUSLY)
        case "historically":
            return _not(_unary(UnaryOperator.ONCE, _not(p), bound))
    raise AssertionError(operator)


def _binary(operator, p, q, bound):
    if bound is None:
        return Binary(operator, p, q)
    match operator.value:
        case "until":
            return _unrolled(p, q, bound, BinaryOperator.UNTIL, UnaryOperator.NEXT)
        case "then" if bound.high == 0:
            return Constant(False)
        case "then":
            bound = Bound(max(bound.low, Fraction(1)), bound.high, "steps")
            return _unrolled(p, q, bound, BinaryOperator.UNTIL, UnaryOperator.NEXT)
        case "release":
            return _not(_binary(BinaryOperator.UNTIL, _not(p), _not(q), bound))
        case "weak until":
            whole = Bound(Fraction(0), bound.high, "steps")
            until = _binary(BinaryOperator.UNTIL, p, q, bound)
            return Binary(OR, until, _unary(UnaryOperator.ALWAYS, p, whole))
        case "strong release":
            return _not(_binary(BinaryOperator.WEAK_UNTIL, _not(p), _not(q), bound))
        case "since":
            return _unrolled(p, q, bound, BinaryOperator.SINCE, UnaryOperator.PREVIOUSLY)
    raise AssertionError(operator)


def _unrolled(p, q, bound, unbounded, beside):
    low = int(bound.low)
    if bound.high is None:
        now = Binary(unbounded, p, q)
    else:
        now = q
        for _ in range(int(bound.high) - low):
            now = Binary(OR, q, Binary(AND, p, Unary(beside, now)))
    for _ in range(low):
        now = Binary(AND, p, Unary(beside, now))
    return now
