"""Points that stand for all numbers within intervals, which planes cut into cells."""

from fractions import Fraction
from math import comb

from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import QuantityTerm
from rulec.valuations.linear_arrangement import (
    LinearPlane,
    sample_points,
)

NUMBERS = [QuantityTerm("x", ()), QuantityTerm("y", ())]
small = st.integers(-4, 4).map(Fraction)
intervals = st.tuples(small, small).map(lambda ends: (min(ends), max(ends)))
boxes = st.tuples(intervals, intervals).map(lambda each: dict(zip(NUMBERS, each, strict=True)))
planes = st.builds(
    lambda x, y, limit: LinearPlane(dict(zip(NUMBERS, (x, y), strict=True)), limit),
    *[small] * 3,
)


def sides(planes, point):
    sums = (
        sum(factor * point[number] for number, factor in plane.coefficients.items()) - plane.limit
        for plane in planes
    )
    return tuple((value > 0) - (value < 0) for value in sums)


@given(boxes, st.lists(planes, max_size=3), st.fractions(0, 1), st.fractions(0, 1))
def test_every_point_has_one_that_stands_for_it(box, planes, x, y):
    shares = dict(zip(NUMBERS, (x, y), strict=True))
    point = {n: low + shares[n] * (high - low) for n, (low, high) in box.items()}
    found = sample_points(box, planes)
    assert sides(planes, point) in {sides(planes, one) for one in found}
    assert all(box[n][0] <= one[n] <= box[n][1] for one in found for n in NUMBERS)


@given(
    st.tuples(*[st.none() | intervals] * 2), st.lists(planes, max_size=7), st.tuples(small, small)
)
def test_lines_across_a_plane_leave_out_no_cell(ends, lines, anywhere):
    box = dict(zip(NUMBERS, ends, strict=True))
    point = {
        n: at if box[n] is None else min(max(at, box[n][0]), box[n][1])
        for n, at in zip(NUMBERS, anywhere, strict=True)
    }
    found = [sides(lines, one) for one in sample_points(box, lines)]
    assert sides(lines, point) in found
    assert len(found) == len(set(found))


FOUR = [*NUMBERS, QuantityTerm("z", ()), QuantityTerm("w", ())]
across_four = st.builds(
    lambda factors, limit: LinearPlane(dict(zip(FOUR, factors, strict=True)), limit),
    st.tuples(*[st.sampled_from([Fraction(0), Fraction(0), Fraction(1), Fraction(-2)])] * 4),
    small,
)


@given(
    st.tuples(*[st.none() | intervals] * 4),
    st.lists(across_four, max_size=4),
    st.tuples(*[small] * 4),
    st.tuples(*[st.fractions(0, 1)] * 4),
)
def test_planes_with_numbers_of_their_own_leave_out_no_cell(ends, planes, anywhere, shares):
    box = dict(zip(FOUR, ends, strict=True))
    point = {
        n: at if box[n] is None else box[n][0] + share * (box[n][1] - box[n][0])
        for n, at, share in zip(FOUR, anywhere, shares, strict=True)
    }
    found = sample_points(box, planes)
    assert sides(planes, point) in {sides(planes, one) for one in found}
    assert all(box[n] is None or box[n][0] <= one[n] <= box[n][1] for one in found for n in FOUR)


def test_seven_compared_with_one_are_on_three_sides_each():
    """Elimination had too many inequalities for five of them."""
    one, *others = [QuantityTerm(name, ()) for name in "abcdefgh"]
    planes = [LinearPlane({one: Fraction(1), x: Fraction(-1)}, Fraction(16)) for x in others]
    box = {one: (Fraction(0), Fraction(30)), **dict.fromkeys(others, (Fraction(-40), Fraction(10)))}
    found = [sides(planes, point) for point in sample_points(box, planes)]
    assert len(found) == len(set(found)) == 3**7


def test_many_lines_are_as_many_cells_as_counted_by_hand():
    """Lines of which no two are parallel and no three meet: n lines, n(n-1)/2 points where two
    cross, n * n pieces of lines, n(n+1)/2 + 1 areas (Steiner 1826)."""
    n = 30
    lines = [
        LinearPlane({NUMBERS[0]: Fraction(-2 * k), NUMBERS[1]: Fraction(1)}, Fraction(-(k**2)))
        for k in range(n)
    ]
    found = {sides(lines, one) for one in sample_points(dict.fromkeys(NUMBERS), lines)}
    assert len(found) == n * (n - 1) // 2 + n * n + n * (n + 1) // 2 + 1


def test_planes_in_space_are_as_many_cells_as_counted_by_hand():
    """Planes of which three meet in one point, and no four: as lines cut a plane, they cut space.

    There are the points where three meet, pieces of the lines where two do, of each plane, and of
    space. A polynomial of third degree has at most three roots, so no four of these planes meet.
    """
    n = 9
    powers = [[Fraction(k**power) for power in range(4)] for k in range(n)]
    planes = [LinearPlane(dict(zip(FOUR[:3], own, strict=False)), own[3]) for own in powers]
    found = [sides(planes, one) for one in sample_points(dict.fromkeys(FOUR[:3]), planes)]
    points, lines = comb(n, 3), comb(n, 2) * (n - 1)
    pieces = n * (1 + (n - 1) + comb(n - 1, 2))
    assert len(found) == len(set(found)) == points + lines + pieces + 1 + n + comb(n, 2) + points


def test_cells_of_too_many_numbers_are_not_looked_for():
    numbers = [QuantityTerm(name, ()) for name in "abcdef"]
    planes = [
        LinearPlane({x: Fraction((k + 1) ** n) for n, x in enumerate(numbers)}, Fraction(k))
        for k in range(12)
    ]
    assert sample_points(dict.fromkeys(numbers), planes) is None


@given(boxes, planes)
def test_one_plane_has_a_point_on_each_side_that_there_is(box, plane):
    found = [sides([plane], one) for one in sample_points(box, [plane])]
    assert len(found) == len(set(found)) <= 3
