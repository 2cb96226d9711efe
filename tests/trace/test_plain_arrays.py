"""Ranges of numbers, and medians of groups."""

import statistics

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rulec.trace.plain_arrays import medians, medians_hold, ranges, zero_if_nan


@given(st.lists(st.floats(allow_infinity=False), max_size=9))
def test_nothing_but_nan_becomes_zero(numbers):
    found, wanted = zero_if_nan(np.array(numbers)), np.nan_to_num(np.array(numbers))
    assert found.tolist() == wanted.tolist()


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
