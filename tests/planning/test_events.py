"""The probability that no event comes about, against a look at every world."""

from fractions import Fraction
from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from rulec.planning.probability.violation_events import none_of

WEIGHTS = {
    "a": {0: Fraction(1, 2), 1: Fraction(1, 2)},
    "b": {0: Fraction(3, 5), 1: Fraction(3, 10), 2: Fraction(1, 10)},
    "c": {0: Fraction(2, 3), 2: Fraction(1, 3)},
    "d": {0: Fraction(9, 10), 1: Fraction(1, 10)},
}
literals = st.sampled_from([(who, what) for who, own in WEIGHTS.items() for what in own])
events = st.dictionaries(
    st.sampled_from(list(WEIGHTS)), st.integers(0, 9), min_size=0, max_size=3
).map(
    lambda chosen: frozenset(
        (who, list(WEIGHTS[who])[what % len(WEIGHTS[who])]) for who, what in chosen.items()
    )
)


@given(st.sets(events, max_size=6))
def test_it_is_the_sum_over_all_worlds_in_which_none_does(some):
    expected = Fraction(0)
    for numbers in product(*WEIGHTS.values()):
        world = set(zip(WEIGHTS, numbers, strict=True))
        if not any(event <= world for event in some):
            weight = Fraction(1)
            for who, what in world:
                weight *= WEIGHTS[who][what]
            expected += weight
    assert none_of(some, WEIGHTS) == expected


def test_no_world_is_looked_at_by_itself():
    """Two hundred obstacles, each of which may do something wrong, in pairs with the next one."""
    half = {0: Fraction(1, 2), 1: Fraction(1, 2)}
    names = [f"o{n:03}" for n in range(200)]
    alone = [frozenset({(name, 1)}) for name in names]
    assert none_of(alone, dict.fromkeys(names, half)) == Fraction(1, 2**200)
    pairs = [
        frozenset({(one, 1), (other, 1)})
        for one, other in zip(names[::2], names[1::2], strict=True)
    ]
    assert none_of(pairs, dict.fromkeys(names, half)) == Fraction(3, 4) ** 100
