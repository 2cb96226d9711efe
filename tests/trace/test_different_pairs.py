"""Pairs of numbers that are told apart by a sum, also where two sums are the same by chance."""

from __future__ import annotations

import numpy as np
import pytest

from rulec.trace.plain_arrays import ODD, different_pairs

_SAME_SUM = [(0, int(ODD)), (1, 0), (0, 5), (1, 0)]


@pytest.mark.parametrize("pairs", [[(3, 1), (1, 3), (3, 1), (2, 2), (1, 3)], _SAME_SUM, [(4, 4)]])
def test_each_pair_is_like_its_example(pairs: list[tuple[int, int]]) -> None:
    one, other = np.array(pairs, dtype=np.uint64).T
    examples, which = different_pairs(one, other)
    assert [pairs[place] for place in examples[which].tolist()] == pairs


def test_few_examples_stand_for_many_pairs() -> None:
    one, other = np.array([(k % 3, k % 2) for k in range(600)], dtype=np.uint64).T
    examples, _ = different_pairs(one, other)
    assert len(examples) == 6
