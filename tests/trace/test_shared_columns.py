"""Parts of columns that traces share are what each trace would have by itself."""

import pickle

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rulec.trace.shared_columns import SharedColumns

COLUMNS = {
    "speed": np.arange(10.0),
    "gap": np.arange(20.0),
    "near": (np.arange(20.0), np.arange(20.0) + 1),
}
ABOUT = frozenset({"gap", "near"})


def part(first, middle, last):
    """The parts of two traces with states from and up to these, and twice as many cells."""
    cut = [slice(first, middle), slice(middle, last)]
    twice = [slice(2 * own.start, 2 * own.stop) for own in cut]
    return [SharedColumns(COLUMNS, ABOUT, *own) for own in zip(cut, twice, strict=True)]


@given(st.lists(st.integers(0, 10), min_size=3, max_size=3).map(sorted))
def test_parts_are_cut_and_joined(bounds):
    first, middle, last = bounds
    one, other = part(first, middle, last)
    assert one["speed"].tolist() == list(range(first, middle))
    assert other["gap"].tolist() == list(range(2 * middle, 2 * last))
    assert other["near"][1].tolist() == [x + 1 for x in range(2 * middle, 2 * last)]
    assert one.is_before(other)
    assert one.up_to(other)["gap"].tolist() == [*one["gap"], *other["gap"]]
    assert other.is_before(one) == (first == last)


def test_others_are_not_joined():
    one, other = part(0, 3, 5)
    alike = SharedColumns(dict(COLUMNS), ABOUT, other.states, other.cells)
    assert not one.is_before(alike)
    assert not one.is_before(dict(other))


def test_elsewhere_a_part_is_by_itself():
    one, _ = part(0, 3, 10)
    again = pickle.loads(pickle.dumps(one))
    assert type(again) is dict
    assert set(again) == set(COLUMNS) == set(one)
    assert again["gap"].tolist() == [0, 1, 2, 3, 4, 5]
    assert len(pickle.dumps(one)) < 900
