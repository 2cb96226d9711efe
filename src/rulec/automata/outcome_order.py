"""How states of an outcome machine compare in what they can still come to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def outcome_order(
    successors: Sequence[Sequence[int]], outputs: Sequence[Sequence[int]]
) -> tuple[int, ...]:
    """For each state those, as bits, from which no word comes to less."""
    size = len(successors)
    targets_of, outcomes = np.array(successors), np.array(outputs, dtype=np.int8)
    order = np.ones((size, size), dtype=bool)
    for column in {column.tobytes(): column for column in outcomes.T}.values():
        order &= column[:, None] <= column[None, :]
    targets = list({column.tobytes(): column for column in targets_of.T}.values())
    while True:
        before = order.sum()
        for target in targets:
            # Two takes are several times as fast as one index of two arrays.
            order &= order.take(target, axis=0).take(target, axis=1)
        if order.sum() == before:
            rows = np.packbits(order, axis=1, bitorder="little")
            return tuple([int.from_bytes(row.tobytes(), "little") for row in rows])
