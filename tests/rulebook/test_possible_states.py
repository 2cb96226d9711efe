"""Whether a state can be, by a search, is what going through all states says."""

from fractions import Fraction
from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from rulec.logic import formula as ltl
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rules.axiom_contradictions import contradictions, may_hold
from rulec.vocabulary import Enumeration, Quantity, Signal, Vocabulary

WORDS = Vocabulary(
    "words",
    declarations={
        "p": Signal("p", (), default=True),
        "q": Signal("q"),
        "light": Enumeration("light", (), ("red", "green", "amber"), "green"),
        "pace": Quantity("pace", (), "km/h", 0.0),
    },
)
PACE = ((Fraction(1), ltl.QuantityTerm("pace")),)
CARS = ((Fraction(1), ltl.Count("c", "car", ltl.Constant(True))),)
LIMITS = [Fraction(number) for number in (0, 30, 50)]

ATOMS = st.one_of(
    st.sampled_from([ltl.Atom("p"), ltl.Atom("q"), ltl.Constant(True)]),
    st.sampled_from([ltl.Atom("light", (), value) for value in ("red", "green", "amber")]),
    st.builds(
        ltl.Comparison,
        st.just(PACE),
        st.sampled_from(["<", "<=", "=", "!=", ">=", ">"]),
        st.sampled_from(LIMITS),
    ),
)
OPERATORS = [ltl.BinaryOperator(word) for word in ("and", "or", "implies", "iff", "xor")]
FORMULAS = st.recursive(
    ATOMS,
    lambda parts: st.one_of(
        st.builds(ltl.Unary, st.just(ltl.UnaryOperator.NOT), parts),
        st.builds(ltl.Binary, st.sampled_from(OPERATORS), parts, parts),
    ),
    max_leaves=6,
)


def value(formula, state):
    """What a formula is in a state, read from the definitions of the operators."""
    match formula:
        case ltl.Constant(truth):
            return truth
        case ltl.Atom(name, _, wanted):
            return state[name] == (wanted or True)
        case ltl.Comparison(_, relation, limit):
            sign = (state["pace"] > limit) - (state["pace"] < limit)
            return sign in {
                "<": (-1,), "<=": (-1, 0), "=": (0,), "!=": (-1, 1), ">=": (0, 1), ">": (1,),
            }[relation]  # fmt: skip
        case ltl.Unary(_, operand):
            return not value(operand, state)
        case ltl.Binary(operator, left, right):
            first, second = value(left, state), value(right, state)
            return {
                "and": first and second, "or": first or second, "xor": first != second,
                "implies": not first or second, "iff": first == second,
            }[operator.value]  # fmt: skip


STATES = [
    {"p": p, "q": q, "light": light, "pace": pace}
    for p, q, light, pace in product(
        (False, True), (False, True), ("red", "green", "amber"), (-1, 0, 10, 30, 40, 50, 60)
    )
]


@given(st.lists(FORMULAS, min_size=1, max_size=4))
def test_a_state_is_found_where_there_is_one(formulas):
    there_is = any(all(value(one, state) for one in formulas) for state in STATES)
    assert may_hold(formulas, WORDS) == there_is


def compared(terms, relation, limit):
    return ltl.Comparison(terms, relation, Fraction(limit))


def test_numbers_of_objects_are_whole():
    more, fewer = compared(CARS, ">", 1), compared(CARS, "<", 2)
    assert not may_hold([more, fewer], WORDS)
    assert may_hold([compared(CARS, ">", 1), compared(CARS, "<", 3)], WORDS)
    assert not may_hold([compared(CARS, "<", 0)], WORDS)
    assert may_hold([compared(PACE, ">", 1), compared(PACE, "<", 2)], WORDS)


def test_what_is_said_of_other_moments_may_be_anything_but_one_thing_only():
    later = ltl.Unary(ltl.UnaryOperator.EVENTUALLY, ltl.Constant(False))
    assert may_hold([later], WORDS)
    assert not may_hold([later, ltl.Unary(ltl.UnaryOperator.NOT, later)], WORDS)


def joined(word, names):
    """The first with the second, with the third, and so on."""
    operator = ltl.BinaryOperator(word)
    formula = ltl.Atom(names[0])
    for name in names[1:]:
        formula = ltl.Binary(operator, formula, ltl.Atom(name))
    return formula


def test_what_takes_too_long_is_left_open():
    """Whether their number is odd and even only all 2 to the 40 states show."""
    names = [f"p{number}" for number in range(40)]
    words = Vocabulary("words", declarations={name: Signal(name) for name in names})
    odd = joined("xor", names)
    assert may_hold([odd, ltl.Unary(ltl.UnaryOperator.NOT, odd)], words)
    few = joined("xor", names[:8])
    assert not may_hold([few, ltl.Unary(ltl.UnaryOperator.NOT, few)], words)


def test_so_is_what_is_too_long():
    names = [f"p{number}" for number in range(220)]
    words = Vocabulary("words", declarations={name: Signal(name) for name in names})
    for number in (100, 101, 220):
        assert may_hold([joined("or", names[:number])], words)


def test_a_long_condition_of_a_rule_is_no_trouble():
    names = [f"p{number}" for number in range(190)]
    text = f"rulebook a signal {', '.join(names)}, q default false\nfact not (p1 and q)\n"
    book = parse_rulebook(
        f"{text}hard rule r {{ require always ({' or '.join(names)} implies q) }}\n"
        f"hard rule s {{ require never ({' and '.join(names)}) }}"
    )
    assert len(book.rules) == 2


def test_facts_about_many_objects_are_left_to_the_compiler():
    """Of twelve cars five can be chosen in 95,040 ways."""
    names = "abcdefghijkl"
    cars = ", ".join(f"{name}: car" for name in names[:5])
    text = (
        f"rulebook a type car signal p(a: car), near({cars}) default false\n"
        "fact not (near(a, b, c, d, e) and near(b, a, c, d, e))\n"
        f"hard rule r ({', '.join(f'{name}: car' for name in names)}) "
        f"{{ require never ({' and '.join(f'p({name})' for name in names)}) }}"
    )
    book = parse_rulebook(text)
    assert [*contradictions(book.rules[0].variables, book.axioms, book.vocabulary)] == []
