"""Random formulas and random words over one small vocabulary."""

from hypothesis import strategies as st

from rulec.logic.formula import (
    Atom,
    Binary,
    BinaryOperator,
    Constant,
    Formula,
    Unary,
    UnaryOperator,
)
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary

TYPES = {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")}

VOCABULARY = Vocabulary(
    "small",
    TYPES,
    {
        "place": Enumeration("place", ("thing",), ("near", "far", "gone")),
        "light": Enumeration("light", (), ("red", "green"), "red"),
        "p": Signal("p", (), False),
        "q": Signal("q", (), None),
    },
)

ATOMS = [
    Atom("place", ("x",), "near"),
    Atom("place", ("x",), "far"),
    Atom("place", ("x",), "gone"),
    Atom("light", (), "red"),
    Atom("light", (), "green"),
    Atom("p"),
    Atom("q"),
]

formulas: st.SearchStrategy[Formula] = st.recursive(
    st.sampled_from(ATOMS) | st.builds(Constant, st.booleans()),
    lambda inner: (
        st.builds(Unary, st.sampled_from(UnaryOperator), inner)
        | st.builds(Binary, st.sampled_from(BinaryOperator), inner, inner)
    ),
    max_leaves=6,
)

states = st.fixed_dictionaries(
    {
        "place": st.fixed_dictionaries({"car1": st.sampled_from(["near", "far", "gone"])}),
        "light": st.sampled_from(["red", "green"]),
        "p": st.booleans(),
        "q": st.booleans(),
    }
)

words = st.lists(states, min_size=1, max_size=7)


def parts_of(formula):
    """The formula and all that it is made of."""
    yield formula
    match formula:
        case Unary(_, operand):
            yield from parts_of(operand)
        case Binary(_, left, right):
            yield from parts_of(left)
            yield from parts_of(right)


def letters(word: list[dict]) -> list[frozenset[Atom]]:
    """The atoms, with the rule's variable ``x``, that are true in each state."""
    return [
        frozenset(
            {Atom("place", ("x",), state["place"]["car1"]), Atom("light", (), state["light"])}
            | {Atom(name) for name in "pq" if state[name]}
        )
        for state in word
    ]
