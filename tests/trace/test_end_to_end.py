"""Drives laid end to end: what looks back or ahead says of each what it says of it by itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.trace.end_to_end import EndToEnd, UnlikeDrivesError

flags = st.lists(st.booleans(), min_size=1, max_size=7)
steps = st.integers(0, 4)


def laid(several):
    """Where drives are, and their flags in one row."""
    bounds = (0, *np.cumsum([len(own) for own in several]).tolist())
    return EndToEnd(bounds), np.concatenate([np.array(own, dtype=bool) for own in several])


def each(several, found_of):
    """What is found of each drive by itself, one after the other."""
    ones = [(EndToEnd.of_one(len(own)), np.array(own, dtype=bool)) for own in several]
    return [value for spans, own in ones for value in found_of(spans, own).tolist()]


@given(st.lists(flags, min_size=1, max_size=4), steps)
def test_flags_are_those_of_each_drive(several, n):
    spans, row = laid(several)
    for found_of in (
        lambda spans, own: spans.within(own, n),
        lambda spans, own: spans.within(own, n, around=True),
        lambda spans, own: spans.within_last(own, n),
        lambda spans, own: spans.before(own),
        lambda spans, own: spans.after(own),
        lambda spans, own: spans.enters(own),
        lambda spans, own: spans.changes(own),
        lambda spans, own: spans.any(own),
        lambda spans, own: spans.all(own),
        lambda spans, own: spans.count_of_last(own, n + 1),
    ):
        expected = each(several, found_of)
        assert found_of(spans, row).tolist() == expected
        assert found_of(spans, np.stack((row, row))).tolist() == [expected, expected]


@given(st.lists(flags, min_size=1, max_size=4), steps)
def test_states_are_those_of_each_drive(several, n):
    spans, row = laid(several)
    latest, following = (
        each(several, lambda spans, own: spans.latest(own)),
        each(several, lambda spans, own: spans.next_state(own, n)),
    )
    assert (spans.latest(row) - spans.first).tolist() == latest
    assert (spans.next_state(row, n) - spans.first).tolist() == following
    rows = np.stack((row, ~row))
    for found_of in (spans.latest, spans.next_state):
        assert found_of(rows).tolist() == [found_of(own).tolist() for own in rows]


def test_by_hand():
    spans, row = laid([[False, True], [False, False, True], [False]])
    assert spans.latest(row).tolist() == [-1, 1, 1, 1, 4, 4]
    assert spans.next_state(row).tolist() == [1, 1, 4, 4, 4, 6]
    assert spans.next_state(row, 9).tolist() == [1, 1, 4, 4, 4, 15]
    assert spans.enters(row).tolist() == [False, True, False, False, True, False]
    assert spans.any(row).tolist() == [True, True, True, True, True, False]
    assert spans.spread([7, 8, 9]).tolist() == [7, 7, 8, 8, 8, 9]
    assert list(spans.those(spans.any(row))) == [(0, slice(0, 2)), (1, slice(2, 5))]


@given(st.lists(st.lists(st.integers(-5, 5), min_size=1, max_size=7), min_size=1), steps)
def test_the_most_of_the_last_ones_is_that_of_each_drive(several, n):
    spans, _ = laid(several)
    row = np.concatenate(several)
    expected = [max(own[max(k - n, 0) : k + 1]) for own in several for k in range(len(own))]
    assert spans.most_of_last(row, n).tolist() == expected


def test_drives_agree_or_are_unlike():
    spans, _ = laid([[True], [True]])
    assert spans.agreed([1, True])
    assert not spans.agreed([0, []])
    with pytest.raises(UnlikeDrivesError):
        spans.agreed([True, False])


def test_nothing_is_within_less_than_no_steps():
    """As where the time to look back is shorter than half a step, less the state itself."""
    spans, flags = EndToEnd((0, 2, 5)), np.array([True, False, True, True, False])
    assert not spans.within(flags, -1).any()
    assert not spans.within_last(flags, -1).any()
    assert spans.within(flags, 0).tolist() == flags.tolist()
