"""Letters as states: they are read back, none is missed, and counts come out."""

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read, Threshold
from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Comparison,
    Constant,
    Count,
    QuantityTerm,
    Same,
    Unary,
)
from rulec.logic.formula import UnaryOperator as Operator
from rulec.rulebook.rulebook_model import Variable
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity
from rulec.witnesses.class_witness import ClassWitnesses
from rulec.witnesses.counted_objects import MOST_COUNTED_OBJECTS
from rulec.witnesses.undecided import UndecidedError

TYPES = {
    "road_user": ObjectType("road_user"),
    "bus": ObjectType("bus", "road_user"),
    "stone": ObjectType("stone"),
}
VOCABULARY = Vocabulary(
    "small",
    TYPES,
    {
        "station": Enumeration("station", ("road_user",), ("behind", "beside")),
        "horn": Signal("horn", ("road_user",), False),
        "near": Signal("near", ("road_user", "road_user")),
        "fog": Signal("fog"),
        "rain": Signal("rain", (), False),
        "speed": DeclaredQuantity("speed", (), "m/s", 2.0),
        "gap": DeclaredQuantity("gap", ("road_user",), "m"),
    },
)
V, W, S = Variable("v", "bus"), Variable("w", "road_user"), Variable("s", "stone")

bodies = st.recursive(
    st.sampled_from(
        [
            Atom("station", ("x",), "behind"),
            Atom("horn", ("x",)),
            Atom("near", ("x", "v")),
            Atom("rain"),
            Same("x", "v"),
        ]
    ),
    lambda inner: (
        st.builds(Unary, st.just(Operator.NOT), inner)
        | st.builds(
            Binary,
            st.sampled_from(
                [
                    BinaryOperator.AND,
                    BinaryOperator.OR,
                    BinaryOperator.IMPLIES,
                    BinaryOperator.IFF,
                    BinaryOperator.XOR,
                ]
            ),
            inner,
            inner,
        )
    ),
    max_leaves=3,
)


def is_counted(body, name, axioms):
    """Straight from the definitions, every value being given or having a default."""
    match body:
        case Same(_, other):
            return name == other
        case Atom(declaration, arguments, value):
            key = (declaration, tuple(name if one == "x" else one for one in arguments))
            default = VOCABULARY.declarations[declaration].default
            assert key in axioms or default is not None
            return axioms.get(key, default) == (True if value is None else value)
        case Unary(_, operand):
            return not is_counted(operand, name, axioms)
        case Binary(operator, left, right):
            a, b = is_counted(left, name, axioms), is_counted(right, name, axioms)
            return {
                BinaryOperator.AND: a and b,
                BinaryOperator.OR: a or b,
                BinaryOperator.IMPLIES: not a or b,
                BinaryOperator.IFF: a == b,
                BinaryOperator.XOR: a != b,
            }[operator]


def witnesses_of(reads, variables):
    """The witnesses of a rule with these reads, each letter being a class of its own."""
    n_letters = 1
    for read in reads:
        n_letters *= read.size
    monitor = MealyMonitor(
        tuple(reads), tuple(range(n_letters)), ((0,) * n_letters,), ((True,) * n_letters,), None, 0
    )
    rule = CompiledRule("r", "hard", tuple(variables), "", "", Constant(True), monitor, "")
    return ClassWitnesses(rule, VOCABULARY)


def at_least(*limits):
    return tuple(Threshold(Fraction(limit), inclusive=True) for limit in limits)


def how_many(*counts, limits=range(1, 7)):
    return [NumberRead(((Fraction(1), count),), at_least(*limits)) for count in counts]


def possible_sizes(body, variables, most):
    """How many objects can count, by trying all that can be said of the rule's own and of one more.

    Of further objects there are as many as one likes.
    """
    own = [variable.name for variable in variables if variable.type != "stone"]
    subjects = [
        *(("station", (name,)) for name in [*own, "+"]),
        *(("horn", (name,)) for name in [*own, "+"]),
        *(("near", (name, "v")) for name in [*own, "+"]),
        ("rain", ()),
    ]
    values = [["behind", "beside"] if name == "station" else [False, True] for name, _ in subjects]
    sizes = set()
    for chosen in product(*values):
        facts = dict(zip(subjects, chosen, strict=True))
        counted = sum(is_counted(body, name, facts) for name in own)
        sizes |= {counted}
        if is_counted(body, "+", facts):
            sizes |= set(range(counted, most + 1))
    return sizes


@given(bodies, st.sampled_from([(V,), (S, V)]), st.lists(st.integers(0, 5), min_size=1, max_size=3))
def test_the_counts_come_out(body, variables, sizes):
    witnesses = witnesses_of(how_many(Count("x", "road_user", body)), variables)
    possible = possible_sizes(body, variables, 5)
    for size in sizes:
        assert witnesses.is_read(size) is (size in possible)
    try:
        objects, states = witnesses.example([size for size in sizes if size in possible])
    except UndecidedError:
        return
    everyone = [*variables, *objects]
    assert len({one.name for one in everyone}) == len(everyone)
    for facts, size in zip(states, [size for size in sizes if size in possible], strict=True):
        # What is not said is arbitrary.
        said = {("station", (one.name,)): "beside" for one in everyone}
        said |= {("near", (one.name, "v")): False for one in everyone} | facts
        counted = [
            one.name for one in everyone if one.type != "stone" and is_counted(body, one.name, said)
        ]
        assert len(counted) == size


@given(st.lists(st.integers(0, MOST_COUNTED_OBJECTS), min_size=1, max_size=4))
def test_objects_are_as_few_as_can_be(sizes):
    body = Binary(
        BinaryOperator.AND, Atom("station", ("x",), "behind"), Unary(Operator.NOT, Same("x", "v"))
    )
    reads = how_many(Count("x", "bus", body), limits=range(1, MOST_COUNTED_OBJECTS + 2))
    objects, _ = witnesses_of(reads, [V]).example(sizes)
    assert [one.name for one in objects] == [f"bus{n + 1}" for n in range(max(sizes))]
    assert {one.type for one in objects} <= {"bus"}


def test_several_counts_come_out_together():
    behind = Count("x", "road_user", Atom("station", ("x",), "behind"))
    loud = Count("y", "bus", Atom("horn", ("y",)))
    witnesses = witnesses_of(how_many(behind, loud, limits=(1, 2)), [])
    for n_behind, n_loud in product(range(3), repeat=2):
        objects, (facts,) = witnesses.example([n_behind + 3 * n_loud])
        names = {one.name: one.type for one in objects}
        assert sum(facts["station", (name,)] == "behind" for name in names) == n_behind
        assert sum(facts.get(("horn", (name,))) is True for name in names) == n_loud
        assert all(names[name] == "bus" for name in names if facts.get(("horn", (name,))) is True)
        assert len(names) == max(n_behind, n_loud)


def test_what_counts_read_of_own_objects_is_said():
    only = Count("x", "bus", Binary(BinaryOperator.AND, Same("x", "v"), Atom("horn", ("x",))))
    witnesses = witnesses_of(how_many(only, limits=(1, 2)), [V])
    assert witnesses.example([0, 1]) == ((), ({("horn", ("v",)): False}, {("horn", ("v",)): True}))
    assert not witnesses.is_read(2)
    assert witnesses.example([0, 2]) is None


def test_numbers_of_counted_objects():
    near = Comparison(((Fraction(1), QuantityTerm("gap", ("x",))),), "<", Fraction(5))
    near_by = how_many(Count("x", "road_user", near), limits=(1,))
    (one,), (facts,) = witnesses_of(near_by, []).example([1])
    assert facts["gap", (one.name,)] < 5


def test_what_is_too_much_is_undecided():
    count = Count("x", "road_user", Atom("station", ("x",), "behind"))
    reads = how_many(count, limits=(MOST_COUNTED_OBJECTS + 2,))
    with pytest.raises(UndecidedError):
        witnesses_of(reads, [V]).example([1])


def test_nothing_is_counted():
    witnesses = witnesses_of([Read("rain", ())], [V])
    assert witnesses.example([1]) == ((), ({("rain", ()): True},))


SPEED, GAP = QuantityTerm("speed"), QuantityTerm("gap", ("v",))
numbers = st.lists(st.integers(-2, 4), min_size=1, max_size=2, unique=True).map(sorted)
sums = st.sampled_from(
    [((1, SPEED),), ((1, GAP),), ((1, GAP), (-1, SPEED)), ((1, GAP), (2, SPEED))]
)


@given(st.lists(st.tuples(sums, numbers), min_size=1, max_size=3, unique_by=lambda pair: pair[0]))
def test_letters_are_those_that_some_state_has(described):
    reads = [
        Read("station", ("v",), ("behind",), others=True),
        *(
            NumberRead(tuple((Fraction(factor), term) for factor, term in terms), at_least(*limits))
            for terms, limits in described
        ),
    ]
    witnesses = witnesses_of(reads, [V])
    grid = [Fraction(n, 2) for n in range(-12, 13)]
    met = {
        letter_of(
            reads, {("station", ("v",)): "behind", ("speed", ()): speed, ("gap", ("v",)): gap}
        )
        for speed, gap in product(grid, repeat=2)
    }
    n_letters = 2
    for read in reads[1:]:
        n_letters *= read.size
    for letter in range(n_letters):
        if not witnesses.is_read(letter):
            assert letter not in met
        else:
            _, (values,) = witnesses.example([letter])
            assert letter_of(reads, values) == letter


def letter_of(reads, values):
    letter, stride = 0, 1
    for read in reads:
        if isinstance(read, Read):
            digit = read.digit(values[read.name, read.variables])
        else:
            digit = read.digit(
                sum(
                    factor * Fraction(str(values[term.name, term.arguments]))
                    for factor, term in read.terms
                )
            )
        letter += stride * digit
        stride *= read.size
    return letter


def test_the_plainest_state_has_the_defaults():
    reads = [Read("rain", ()), Read("horn", ("v",)), Read("station", ("v",), ("behind",), True)]
    monitor = MealyMonitor(
        tuple(reads), (0, 0, 0, 1, 1, 1, 1, 1), ((0, 0),), ((True, True),), None, 0
    )
    rule = CompiledRule("r", "hard", (V,), "", "", Constant(True), monitor, "")
    _, states = ClassWitnesses(rule, VOCABULARY).example([0, 1])
    assert [letter_of(reads, with_defaults(reads, state)) for state in states] == [0, 4]
    # Of finer classes each has one.
    finer = ClassWitnesses(rule, VOCABULARY, (), range(8))
    _, states = finer.example([2, 7])
    assert [letter_of(reads, with_defaults(reads, state)) for state in states] == [2, 7]


def with_defaults(reads, state):
    return {
        (read.name, read.variables): VOCABULARY.declarations[read.name].default for read in reads
    } | state


def test_what_decides_nothing_has_its_default():
    horn = Atom("horn", ("x",))
    either = Binary(BinaryOperator.OR, horn, Unary(Operator.NOT, horn))
    count = Count("x", "bus", Binary(BinaryOperator.AND, Same("x", "v"), either))
    _, (state,) = witnesses_of(how_many(count, limits=(1,)), [V]).example([1])
    assert state.get(("horn", ("v",)), False) is False
