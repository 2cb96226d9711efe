"""Points that stand for all numbers within intervals, which planes cut into cells."""

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from rulec.logic.formula import QuantityTerm
from rulec.monitoring.uncertainty.state_letters.linear_arrangement import LinearPlane, sample_points

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


@given(boxes, planes)
def test_one_plane_has_a_point_on_each_side_that_there_is(box, plane):
    found = [sides([plane], one) for one in sample_points(box, [plane])]
    assert len(found) == len(set(found)) <= 3
