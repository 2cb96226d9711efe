"""Random functions of letters over a small vocabulary, and all states that tell letters apart."""

from fractions import Fraction
from itertools import product
from math import prod

from hypothesis import strategies as st

from rulec.automata.mealy_monitor import NumberRead, Read, Threshold
from rulec.logic.formula import QuantityTerm
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity
from rulec.witnesses.letter_functions import LetterFunction

VOCABULARY = Vocabulary(
    "reads",
    {"thing": ObjectType("thing")},
    {
        "p": Signal("p", (), True),
        "q": Signal("q", ("thing",)),
        "place": Enumeration("place", ("thing",), ("near", "far", "gone"), "far"),
        "speed": DeclaredQuantity("speed", (), "m/s", 1.0),
        "gap": DeclaredQuantity("gap", ("thing",), "m"),
    },
)
OBJECTS = {"x": "thing"}
SPEED, GAP = QuantityTerm("speed"), QuantityTerm("gap", ("x",))
P, Q, PLACE = ("p", ()), ("q", ("x",)), ("place", ("x",))

thresholds = st.lists(
    st.builds(Threshold, st.integers(-2, 3).map(Fraction), st.booleans()),
    min_size=1,
    max_size=2,
    unique=True,
).map(lambda limits: tuple(sorted(limits, key=lambda one: (one.limit, not one.inclusive))))
sums = st.sampled_from(
    [
        ((Fraction(1), SPEED),),
        ((Fraction(-2), SPEED),),
        ((Fraction(1), GAP),),
        ((Fraction(1), GAP), (Fraction(-1), SPEED)),
        ((Fraction(-1), SPEED), (Fraction(1), GAP)),
        ((Fraction(2), GAP), (Fraction(-2), SPEED)),
    ]
)
number_reads = st.builds(NumberRead, sums, thresholds)
plain_reads = st.sampled_from(
    [
        Read(*P),
        Read(*Q),
        Read(*PLACE, ("near",), others=True),
        Read(*PLACE, ("far", "gone"), others=True),
        Read(*PLACE, ("near", "far", "gone")),
    ]
)


def subject(read):
    return read.terms if isinstance(read, NumberRead) else read.name


@st.composite
def letter_functions(draw, reads=plain_reads | number_reads, n_classes=3, max_reads=3):
    own = draw(st.lists(reads, max_size=max_reads, unique_by=subject))
    total = prod(read.size for read in own)
    classes = st.integers(0, n_classes - 1)
    return LetterFunction(
        tuple(own), tuple(draw(st.lists(classes, min_size=total, max_size=total)))
    )


def digit(read, values):
    """The digit of a read in a state, straight from the definition."""
    if isinstance(read, Read):
        return read.digit(values[read.name, read.variables])
    total = sum(factor * values[term.name, term.arguments] for factor, term in read.terms)
    return sum(
        total >= one.limit if one.inclusive else total > one.limit for one in read.thresholds
    )


def value(function, values):
    """The class that a function has in a state."""
    letter, stride = 0, 1
    for read in function.reads:
        letter += stride * digit(read, values)
        stride *= read.size
    return function.letters[letter]


GRID = [Fraction(n, 2) for n in range(-10, 11)]
ALL_STATES = [
    {P: p, Q: q, PLACE: place, ("speed", ()): speed, ("gap", ("x",)): gap}
    for p, q, place in product([True, False], [False, True], ["near", "far", "gone"])
    for speed, gap in product(GRID, repeat=2)
]
PLAIN_STATES = ALL_STATES[:: len(GRID) ** 2]
NUMBERS = ALL_STATES[: len(GRID) ** 2]


def exact_values(state):
    """What a synthesised state says, numbers as they are written; all else has any value."""
    values = {**PLAIN_STATES[0], ("speed", ()): Fraction(0), ("gap", ("x",)): Fraction(0)}
    for key, said in state.values.items():
        values[key] = Fraction(str(said)) if type(said) is float else said
    return values
