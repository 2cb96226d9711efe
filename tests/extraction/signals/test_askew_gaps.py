"""Gaps beside bodies that are askew, against polygons."""

from types import SimpleNamespace

import numpy as np
import shapely
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec.extraction.signals.lateral_gaps import _beside_askew, _by_turning
from rulec.trace.cells import Cells

ONE = Cells.at(np.array([[True]]))


def corners(x, y, turned, length, width):
    own = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)]) * (length / 2, width / 2)
    cos, sin = np.cos(turned), np.sin(turned)
    return own @ np.array([(cos, sin), (-sin, cos)]) + (x, y)


def extents(body, turned):
    (s_min, d_min), (s_max, d_max) = body.min(axis=0), body.max(axis=0)
    values = {"s_min": s_min, "s_max": s_max, "d_min": d_min, "d_max": d_max, "turned": turned}
    return SimpleNamespace(**{name: np.array([[value]]) for name, value in values.items()})


def gap_between(first, second, low, high):
    """The least distance across the road between polygons, over the stretch where both are."""
    least = np.inf
    for s in np.linspace(low + 1e-6, high - 1e-6, 200):
        line = shapely.LineString([(s, -99), (s, 99)])
        (_, a0, _, a1), (_, b0, _, b1) = (
            shapely.intersection(shapely.Polygon(body), line).bounds for body in (first, second)
        )
        least = min(least, max(b0 - a1, a0 - b1))
    return least


@given(
    st.floats(-0.55, 0.55),
    st.sampled_from([0.0, 0.0, np.pi, 0.3, -0.2]),
    st.tuples(st.floats(3, 12), st.floats(1.5, 2.6)),
    st.tuples(st.floats(0.5, 5), st.floats(0.4, 2)),
    st.tuples(st.floats(-6, 6), st.floats(-5, 5)),
)
def test_a_gap_is_never_too_large_and_right_if_one_is_askew(turned, other_turned, size, other, at):
    first, second = corners(0, 0, turned, *size), corners(*at, other_turned, *other)
    own, their = extents(first, turned), extents(second, other_turned)
    low, high = (
        max(first[:, 0].min(), second[:, 0].min()),
        min(first[:, 0].max(), second[:, 0].max()),
    )
    box = max((their.d_min - own.d_max).item(), (own.d_min - their.d_max).item())
    assume(high - low > 0.05 and box >= 0)
    left = np.array([at[1] > 0])
    found = box + (_beside_askew(ONE, own, their, left) + _beside_askew(ONE, their, own, ~left))[0]
    true = gap_between(first, second, low, high)
    assert box - 1e-9 <= found <= true + 0.02
    if other_turned in (0.0, np.pi):
        assert abs(found - true) < 0.05


@given(
    st.floats(-0.3, 0.3),
    st.floats(0.0, 0.25),
    st.floats(-1, 1),
    st.tuples(st.floats(3, 12), st.floats(1.5, 2.6)),
    st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
)
def test_bounds_cover_the_gap_at_every_heading_within_its_error(turned, error, part, size, at):
    measured, second = corners(0, 0, turned, *size), corners(*at, 0.0, 2.0, 0.6)
    own, their, left = extents(measured, turned), extents(second, 0.0), np.array([at[1] > 0])
    first = corners(0, 0, turned + part * error, *size)
    (low, high), (least, most) = (
        (max(body[:, 0].min(), second[:, 0].min()), min(body[:, 0].max(), second[:, 0].max()))
        for body in (measured, first)
    )
    box, true_box = (
        max((their.d_min - body[:, 1].max()).item(), (body[:, 1].min() - their.d_max).item())
        for body in (measured, first)
    )
    assume(high - low > 0.05 and most - least > 0.05 and box >= 0 and true_box >= 0)
    gap = box + _beside_askew(ONE, own, their, left).item()
    wrong, yes = np.array([error]), np.array([True])
    nearer, farther = _by_turning(ONE, own, their, left, error=wrong, beside=yes)
    assert box - nearer.item() <= true_box + 1e-9
    assert gap_between(first, second, least, most) <= gap + farther.item() + 0.02


def test_a_heading_known_exactly_changes_no_gap():
    body, second = corners(0, 0, 0.1, 12.0, 2.5), corners(1.0, 3.0, 0.0, 2.0, 0.6)
    own, their, left = extents(body, 0.1), extents(second, 0.0), np.array([True])
    found = _by_turning(ONE, own, their, left, error=np.zeros(1), beside=np.array([True]))
    np.testing.assert_allclose(found, 0.0, atol=1e-12)
