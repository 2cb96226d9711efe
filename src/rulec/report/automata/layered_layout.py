"""Layered layout of boxes with few crossing links.

The layered drawing of Sugiyama, Tagawa, Toda, "Methods for visual understanding of hierarchical
system structures" (1981): orders by barycentres, then places by least squares.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

SWEEPS = 24


@dataclass(frozen=True, slots=True)
class LayoutBox:
    """Extent of a box left and right of its links' arrival point."""

    left: float
    right: float


def arrange(
    layers: Sequence[Sequence[int]],
    boxes: Mapping[int, LayoutBox],
    links: Sequence[tuple[int, int]],
) -> dict[int, float]:
    """The place of every box across its layer.

    Args:
        layers: the boxes of each layer, by their numbers.
        boxes: their sizes, margins included.
        links: pairs of boxes of neighbouring layers, the one of the earlier layer first.

    Returns:
        For each box where its links arrive, from 0.
    """
    above: dict[int, list[int]] = {box: [] for box in boxes}
    below: dict[int, list[int]] = {box: [] for box in boxes}
    for first, second in links:
        below[first].append(second)
        above[second].append(first)
    order = _ordered([list(layer) for layer in layers], above, below)
    return _placed(order, boxes, above, below)


def _ordered(
    layers: list[list[int]], above: Mapping[int, list[int]], below: Mapping[int, list[int]]
) -> list[list[int]]:
    best, fewest = layers, _crossings(layers, below)
    current = [list(layer) for layer in layers]
    for sweep in range(SWEEPS):
        downward = sweep % 2 == 0
        neighbours = above if downward else below
        numbers = range(1, len(current)) if downward else range(len(current) - 2, -1, -1)
        for number in numbers:
            fixed = current[number - 1 if downward else number + 1]
            place = {box: index for index, box in enumerate(fixed)}
            own = {box: index for index, box in enumerate(current[number])}
            current[number].sort(key=lambda box: _mean(neighbours[box], place, own[box]))
        crossings = _crossings(current, below)
        if crossings < fewest:
            best, fewest = [list(layer) for layer in current], crossings
    return best


def _mean(boxes: Sequence[int], place: Mapping[int, float], otherwise: float) -> float:
    return sum(place[box] for box in boxes) / len(boxes) if boxes else otherwise


def _crossings(layers: Sequence[Sequence[int]], below: Mapping[int, list[int]]) -> int:
    total = 0
    for upper, lower in pairwise(layers):
        place = {box: index for index, box in enumerate(lower)}
        ends = [sorted(place[box] for box in below[first]) for first in upper]
        for number, mine in enumerate(ends):
            total += sum(
                one > other for later in ends[number + 1 :] for one in mine for other in later
            )
    return total


def _placed(
    layers: Sequence[Sequence[int]],
    boxes: Mapping[int, LayoutBox],
    above: Mapping[int, list[int]],
    below: Mapping[int, list[int]],
) -> dict[int, float]:
    x: dict[int, float] = {}
    for layer in layers:
        x.update(_apart(layer, boxes, dict.fromkeys(layer, 0.0)))
    for sweep in range(SWEEPS):
        downward = sweep % 2 == 0
        for layer in layers if downward else reversed(layers):
            wanted = {}
            for box in layer:
                first, second = (above, below) if downward else (below, above)
                wanted[box] = _mean(first[box] or second[box], x, x[box])
            x.update(_apart(layer, boxes, wanted))
    left = min(x[box] - boxes[box].left for box in x)
    return {box: value - left for box, value in x.items()}


def _apart(
    layer: Sequence[int], boxes: Mapping[int, LayoutBox], wanted: Mapping[int, float]
) -> dict[int, float]:
    """Places nearest to those wanted, in order and without overlaps.

    Least squares under an order: pool adjacent violators.
    """
    offsets, reach = [], 0.0
    for number, box in enumerate(layer):
        reach += boxes[layer[number - 1]].right + boxes[box].left if number else 0.0
        offsets.append(reach)
    pools: list[tuple[float, int]] = []
    for box, offset in zip(layer, offsets, strict=True):
        total, count = wanted[box] - offset, 1
        while pools and pools[-1][0] / pools[-1][1] > total / count:
            before, size = pools.pop()
            total, count = total + before, count + size
        pools.append((total, count))
    shifts = [total / count for total, count in pools for _ in range(count)]
    return {box: shift + offset for box, shift, offset in zip(layer, shifts, offsets, strict=True)}
