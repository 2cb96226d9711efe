"""Arrays' different numbers and medians, as NumPy has them."""

import statistics

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.trace.plain_arrays import (
    begin_runs,
    distinct,
    median,
    medians,
    medians_hold,
    quantile,
    ranges,
    ranks,
    zero_if_nan,
)


@pytest.mark.parametrize("numbers", [[], [3], [2, 1, 2], [[5, 1], [1, 5]], [0.5, -0.0, 0.0]])
def test_distinct_numbers_are_those_of_numpy(numbers):
    assert distinct(np.array(numbers)).tolist() == np.unique(np.array(numbers)).tolist()


@pytest.mark.parametrize("numbers", [[3], [2.5, 1], [4, 1, 3], [0.1, 0.3, 0.2, 0.7], [1, np.nan]])
def test_the_median_is_that_of_numpy(numbers):
    assert median(np.array(numbers)) == pytest.approx(np.median(numbers), abs=0.0, nan_ok=True)


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=12), st.floats(0, 1))
def test_quantiles_are_those_of_numpy(numbers, share):
    wanted = np.quantile(numbers, share)
    assert quantile(np.array(numbers), share) == pytest.approx(wanted, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    ("numbers", "runs"), [([], ""), ([0], "T"), ([3, 4, 6, 7, 8, 20], "TFTFFT"), ([1, 3], "TT")]
)
def test_runs_begin_where_no_number_is_one_more_than_the_one_before(numbers, runs):
    found = begin_runs(np.array(numbers, dtype=np.intp))
    assert found.tolist() == [run == "T" for run in runs]


@given(st.lists(st.lists(st.integers(0, 5), max_size=7), min_size=1, max_size=9))
def test_ranks_are_places_in_the_sorted_column(columns):
    most = max(map(len, columns))
    padded = np.array([[*own, *[np.nan] * (most - len(own))] for own in columns], dtype=float)
    wanted = []
    for own in columns:
        in_order = sorted(range(len(own)), key=own.__getitem__)
        wanted.append([*map(in_order.index, range(len(own))), *range(len(own), most)])
    assert ranks(padded.T).T.tolist() == wanted


@given(st.lists(st.floats(allow_infinity=False), max_size=9))
def test_nothing_but_nan_becomes_zero(numbers):
    found, wanted = zero_if_nan(np.array(numbers)), np.nan_to_num(np.array(numbers))
    assert found.tolist() == wanted.tolist()


def test_what_is_no_number_has_no_quantile():
    assert np.isnan(quantile(np.array([1.0, np.nan]), 0.5))


@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(0, 5)), max_size=9))
def test_ranges_stand_one_after_the_other(wanted):
    begins, lengths = np.array(wanted, dtype=np.intp).reshape(-1, 2).T
    numbers, firsts = ranges(begins, lengths)
    assert numbers.tolist() == [n for begin, size in wanted for n in range(begin, begin + size)]
    assert firsts.tolist() == [sum(size for _, size in wanted[:k]) for k in range(len(wanted))]


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(-3, 3)), max_size=60), st.booleans())
def test_groups_are_halved(entries, lonely):
    # One group far larger than others has no rows of their own
    entries = entries + [(3, k % 5) for k in range(40)] * lonely
    groups = np.array([group for group, _ in entries], dtype=np.intp)
    values = np.array([value for _, value in entries], dtype=float)
    found, sizes = medians(groups, values, 10)
    for group in range(10):
        own = [value for number, value in entries if number == group]
        assert sizes[group] == len(own)
        assert found[group] == statistics.median(own) if own else np.isnan(found[group])


@given(st.lists(st.tuples(st.integers(0, 4), st.integers(-2, 2)), max_size=30), st.integers(-2, 2))
def test_what_holds_of_small_numbers_holds_of_medians_as_small(entries, limit):
    groups = np.array([group for group, _ in entries], dtype=np.intp)
    values = np.array([value for _, value in entries], dtype=float)
    found = medians_hold(groups, values, 5, lambda numbers: numbers < limit - 0.25)
    for group in range(5):
        own = [value for number, value in entries if number == group]
        assert found[group] == (bool(own) and statistics.median(own) < limit - 0.25)
