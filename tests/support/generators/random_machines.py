"""Random machines that read signals, enumerations and numbers, not minimal ones."""

from fractions import Fraction
from math import prod

from hypothesis import strategies as st

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read, Threshold
from rulec.logic.formula import QuantityTerm
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity

VOCABULARY = Vocabulary(
    "numbers",
    {"thing": ObjectType("thing")},
    {
        "p": Signal("p"),
        "q": Signal("q"),
        "place": Enumeration("place", ("thing",), ("near", "far", "gone", "lost")),
        "speed": DeclaredQuantity("speed", (), "km/h"),
    },
)

READS = (
    Read("p", ()),
    Read("place", ("x",), ("near", "far"), others=True),
    NumberRead(
        ((Fraction(1), QuantityTerm("speed")),),
        (
            Threshold(Fraction(3), inclusive=True),
            Threshold(Fraction(3), inclusive=False),
            Threshold(Fraction(5), inclusive=True),
        ),
    ),
    Read("q", ()),
)


@st.composite
def machines(draw):
    reads = draw(st.lists(st.sampled_from(READS), max_size=4, unique=True))
    total = prod(read.size for read in reads)
    n_classes = draw(st.integers(1, 4))
    n_states = draw(st.integers(1, 3))
    lowest = draw(st.sampled_from([0, 0, IMPOSSIBLE]))
    letters = draw(st.lists(st.integers(lowest, n_classes - 1), min_size=total, max_size=total))
    row = st.lists(st.integers(0, n_states - 1), min_size=n_classes, max_size=n_classes)
    verdicts = st.lists(st.booleans(), min_size=n_classes, max_size=n_classes)
    return MealyMonitor(
        tuple(reads),
        tuple(letters),
        tuple(tuple(draw(row)) for _ in range(n_states)),
        tuple(tuple(draw(verdicts)) for _ in range(n_states)),
        None,
        None,
    )
