"""Linear systems: what is found fits, and what fits is found."""

from fractions import Fraction
from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import QuantityTerm
from rulec.valuations.fourier_motzkin import LinearBound, solve

X, Y, Z = (QuantityTerm(name) for name in "xyz")

bounded = st.builds(
    LinearBound,
    st.dictionaries(
        st.sampled_from([X, Y, Z]),
        st.sampled_from([Fraction(n) for n in (-2, -1, 1, 2)]),
        min_size=1,
    ),
    st.integers(-4, 4).map(Fraction),
    st.booleans(),
)


def fits(one, numbers):
    total = sum(factor * numbers[term] for term, factor in one.coefficients.items())
    return total < one.limit if one.strict else total <= one.limit


@given(st.lists(bounded, max_size=6))
def test_against_a_search(system):
    found = solve(system, [X, Y, Z], {})
    if found is not None:
        assert all(fits(one, found) for one in system)
    else:
        grid = [Fraction(n, 2) for n in range(-5, 6)]
        for point in product(grid, repeat=3):
            assert not all(fits(one, dict(zip((X, Y, Z), point, strict=True))) for one in system)


def test_what_speaks_of_no_unknown_holds_or_does_not():
    for limit, strict, holds in ((0, False, True), (0, True, False), (-1, False, False)):
        assert (solve([LinearBound({}, Fraction(limit), strict)], [X], {}) is not None) is holds


def test_what_is_preferred_is_taken_where_it_fits():
    below = LinearBound({X: Fraction(1)}, Fraction(50), strict=True)
    assert solve([below], [X], {X: Fraction(13)}) == {X: Fraction(13)}
    assert solve([below], [X], {X: Fraction(50)}) == {X: Fraction(0)}


def test_short_decimals():
    between = [
        LinearBound({X: Fraction(-1)}, Fraction(-12, 10), strict=True),
        LinearBound({X: Fraction(1)}, Fraction(13, 10), strict=True),
    ]
    assert solve(between, [X], {}) == {X: Fraction(121, 100)}


def test_no_whole_number_between():
    between = [
        LinearBound({X: Fraction(-2)}, Fraction(-1)),
        LinearBound({X: Fraction(4)}, Fraction(3)),
    ]
    assert solve(between, [X], {}) is not None
    assert solve(between, [X], {}, frozenset([X])) is None


def test_a_third_has_no_decimal():
    third = [
        LinearBound({X: Fraction(3)}, Fraction(1)),
        LinearBound({X: Fraction(-3)}, Fraction(-1)),
    ]
    assert solve(third, [X], {}) is None
