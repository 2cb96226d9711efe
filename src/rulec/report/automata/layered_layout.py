"""Layered layout of boxes with few crossing links.

The layered drawing of Sugiyama, Tagawa, Toda, "Methods for visual understanding of hierarchical
system structures" (1981): order by barycentres, then positions by least squares.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

SWEEPS = 24


@dataclass(frozen=True, slots=True)
class LayoutBox:
    """A box in a layer: its extent left and right of its links' end, and its height."""

    layer: int
    left: float
    right: float
    height: float


def arrange(boxes: Sequence[LayoutBox], links: Sequence[tuple[int, int]]) -> list[float]:
    """The position of every box within its layer, from 0: where its links end.

    ``links`` are pairs of box numbers in adjacent layers, the earlier layer first. Boxes include
    their margins.
    """
    above: list[list[int]] = [[] for _ in boxes]
    below: list[list[int]] = [[] for _ in boxes]
    for first, second in links:
        below[first].append(second)
        above[second].append(first)
    layers: list[list[int]] = [[] for _ in range(1 + max(box.layer for box in boxes))]
    for number, box in enumerate(boxes):
        layers[box.layer].append(number)
    return _placed(_ordered(layers, above, below), boxes, above, below)


def _ordered(
    layers: list[list[int]], above: Sequence[Sequence[int]], below: Sequence[Sequence[int]]
) -> list[list[int]]:
    best, fewest = layers, _crossings(layers, below)
    current = list(layers)
    for sweep in range(SWEEPS):
        step = 1 if sweep % 2 == 0 else -1
        neighbours = above if step > 0 else below
        for fixed, number in pairwise(range(len(current))[::step]):
            place = {box: index for index, box in enumerate(current[fixed])}
            own = {box: index for index, box in enumerate(current[number])}
            current[number] = sorted(own, key=lambda box: _mean(neighbours[box], place, own[box]))
        crossings = _crossings(current, below)
        if crossings < fewest:
            best, fewest = list(current), crossings
    return best


def _mean(boxes: Sequence[int], place: Mapping[int, float], otherwise: float) -> float:
    return sum(place[box] for box in boxes) / len(boxes) if boxes else otherwise


def _crossings(layers: Sequence[Sequence[int]], below: Sequence[Sequence[int]]) -> int:
    total = 0
    for upper, lower in pairwise(layers):
        place = {box: index for index, box in enumerate(lower)}
        ends = ([place[target] for target in below[box]] for box in upper)
        total += sum(a > b for left, right in combinations(ends, 2) for a in left for b in right)
    return total


def _placed(
    layers: Sequence[Sequence[int]],
    boxes: Sequence[LayoutBox],
    above: Sequence[Sequence[int]],
    below: Sequence[Sequence[int]],
) -> list[float]:
    x: dict[int, float] = {}
    for layer in layers:
        x.update(_apart(layer, boxes, dict.fromkeys(layer, 0.0)))
    for sweep in range(SWEEPS):
        first, second = (above, below) if sweep % 2 == 0 else (below, above)
        for layer in layers if sweep % 2 == 0 else reversed(layers):
            desired = {box: _mean(first[box] or second[box], x, x[box]) for box in layer}
            x.update(_apart(layer, boxes, desired))
    left = min(x[number] - box.left for number, box in enumerate(boxes))
    return [x[number] - left for number in range(len(boxes))]


def _apart(
    layer: Sequence[int], boxes: Sequence[LayoutBox], desired: Mapping[int, float]
) -> dict[int, float]:
    """The positions nearest to those desired, in order and without overlaps.

    Least squares under an order constraint: pool adjacent violators.
    """
    offsets, reach = [], 0.0
    for number, box in enumerate(layer):
        reach += boxes[layer[number - 1]].right + boxes[box].left if number else 0.0
        offsets.append(reach)
    pools: list[tuple[float, int]] = []
    for box, offset in zip(layer, offsets, strict=True):
        total, count = desired[box] - offset, 1
        while pools and pools[-1][0] / pools[-1][1] > total / count:
            before, size = pools.pop()
            total, count = total + before, count + size
        pools.append((total, count))
    shifts = [total / count for total, count in pools for _ in range(count)]
    return {box: shift + offset for box, shift, offset in zip(layer, shifts, offsets, strict=True)}
