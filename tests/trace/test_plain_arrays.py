"""Arrays' different numbers and medians, as NumPy has them."""

import numpy as np
import pytest

from rulec.trace.plain_arrays import distinct, median


@pytest.mark.parametrize("numbers", [[], [3], [2, 1, 2], [[5, 1], [1, 5]], [0.5, -0.0, 0.0]])
def test_distinct_numbers_are_those_of_numpy(numbers):
    assert distinct(np.array(numbers)).tolist() == np.unique(np.array(numbers)).tolist()


@pytest.mark.parametrize("numbers", [[3], [2.5, 1], [4, 1, 3], [0.1, 0.3, 0.2, 0.7], [1, np.nan]])
def test_the_median_is_that_of_numpy(numbers):
    assert median(np.array(numbers)) == pytest.approx(np.median(numbers), abs=0.0, nan_ok=True)
