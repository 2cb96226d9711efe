"""Objects for counts: as many are counted as the states need."""

from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import Atom, Binary, BinaryOperator, Comparison, Count, Same, Unary
from rulec.logic.formula import UnaryOperator as Operator
from rulec.rulebook.model import Variable
from rulec.vocabulary import Enumeration, ObjectType, Signal, Vocabulary
from rulec.witnesses.letter_witness import Witness
from rulec.witnesses.witness_objects import MOST_OBJECTS, staged

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


@given(bodies, st.sampled_from([(V,), (V, W), (S, V)]), st.lists(st.integers(0, 5), min_size=1))
def test_the_counts_come_out(body, variables, sizes):
    count = Count("x", "road_user", body)
    scene = staged([Witness({}, ((count, size),)) for size in sizes], variables, VOCABULARY)
    if scene is None:
        return
    everyone = [*variables, *scene.objects]
    assert len({one.name for one in everyone}) == len(everyone)
    for axioms, size in zip(scene.states, sizes, strict=True):
        counted = [
            one.name
            for one in everyone
            if one.type != "stone" and is_counted(body, one.name, axioms)
        ]
        assert len(counted) == size


@given(st.lists(st.integers(0, MOST_OBJECTS), min_size=1, max_size=4))
def test_simple_bodies_are_always_staged(sizes):
    body = Binary(
        BinaryOperator.AND, Atom("station", ("x",), "behind"), Unary(Operator.NOT, Same("x", "v"))
    )
    states = [Witness({}, ((Count("x", "bus", body), size),)) for size in sizes]
    scene = staged(states, (V,), VOCABULARY)
    assert len(scene.objects) == max(sizes)


def test_what_is_not_that_easy():
    count = Count("x", "road_user", Atom("station", ("x",), "behind"))
    other = Count("x", "bus", Atom("station", ("x",), "behind"))
    foggy = Count("x", "road_user", Atom("fog"))
    compared = Count("x", "road_user", Comparison((), "<", 0))
    behind = {("station", ("v",)): "behind"}
    for witness in (
        Witness({}, ((count, 1), (other, 1))),
        Witness({}, ((foggy, 1),)),
        Witness({}, ((compared, 1),)),
        Witness({}, ((count, MOST_OBJECTS + 2),)),
        Witness(behind, ((count, 0),)),
    ):
        assert staged([witness], (V,), VOCABULARY) is None


def test_nothing_is_counted():
    states = [Witness({("rain", ()): True})]
    assert staged(states, (V,), VOCABULARY).states == ({("rain", ()): True},)
