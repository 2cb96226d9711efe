"""Bounds of ego's place, speed and body in the cells of a layer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from rulec.array_types import Floats
from rulec.partition import NavigationGraph
from rulec.partition.cells.cell_model import Layer, Reach
from rulec.scenario import MotionBounds

Bounds: TypeAlias = tuple[Floats, Floats]
"""The least and the greatest values, a row for each cell."""

_FASTEST_MPS = 100.0
_WINDOW_S = 0.5
"""Extracted speeds are means from this long (s) before to this long after, or from the state before
to the one after if these are farther apart."""

_HAIR_S = 1e-6

_BEND_RAD = np.radians(6.0)
"""Upper bound on the angle between two lines along the same road where it bends."""


@dataclass(frozen=True, slots=True, eq=False)
class EgoBoxes:
    """Bounds for each cell when its layer begins.

    ``s`` and ``d`` (m) are those of ego's centre; ``mean_speed`` (m/s) is the speed that extraction
    measures, a mean, whatever its direction. Half the body's extents along and across the road (m)
    cover all headings that ego may have; ``sideways`` is its greatest speed across the road (m/s).
    ``front_before`` is a lower bound (m) on the place of ego's front ``came_s`` ago, in the layer
    before or, if that is earlier, in the state before.
    """

    s: Bounds
    d: Bounds
    mean_speed: Bounds
    half_length: Bounds
    half_width: Bounds
    sideways: Floats
    front_before: Floats
    came_s: float

    @property
    def came(self) -> Floats:
        """How far (m) ego has come since then at most, by cell, if it is as far back as it can."""
        return np.maximum(self.s[0] + self.half_length[0] - self.front_before, 0.0)


def column(values: Floats) -> Floats:
    """Numbers by cell as a column, to be compared with those of others in a row."""
    return values[:, None]


def ego_boxes(graph: NavigationGraph, state_s: float) -> Iterator[EgoBoxes]:
    """The bounds in each layer; a recording has a state every ``state_s`` (s)."""
    motion = graph.bounds
    size = body_size(graph)
    last = len(graph.layers) - 1
    came_s = max(graph.step_s, state_s)
    window_s = max(_WINDOW_S, state_s)
    fronts = None
    for number, layer in enumerate(graph.layers):
        reach = graph.reach[number] if graph.reach else (None,) * len(layer.cells)
        before = min(number * graph.step_s, window_s)
        after = min((last - number) * graph.step_s, window_s)
        margins = _mean_margins(motion, before, after)
        boxes = _boxes(layer, reach, size, margins, (came_s, motion))
        if fronts is not None and came_s <= graph.step_s + _HAIR_S:
            least = np.full(len(layer.cells), np.inf)
            for front, onward in zip(fronts, graph.successors[number - 1], strict=True):
                least[[*onward]] = np.minimum(least[[*onward]], front)
            least[np.isinf(least)] = -np.inf  # No way leads there
            boxes = replace(boxes, front_before=np.maximum(boxes.front_before, least))
        fronts = (boxes.s[0] + boxes.half_length[0]).tolist()
        yield boxes


def body_size(graph: NavigationGraph) -> tuple[float, float]:
    """Ego's length and width (m): as recorded, else from the bounds, else those of a car."""
    ego, bounds = graph.scenario.ego, graph.bounds or graph.scenario.ego.bounds or MotionBounds()
    return ego.length or bounds.length, ego.width or bounds.width


def _mean_margins(motion: MotionBounds | None, before: float, after: float) -> tuple[float, float]:
    """How far (m/s) a mean of speed may be below and above the speed."""
    if motion is None or not before + after:
        return _FASTEST_MPS, _FASTEST_MPS
    gains, loses, seconds = motion.acceleration, motion.braking, before + after
    below = (gains * before**2 + loses * after**2) / 2 / seconds
    above = (loses * before**2 + gains * after**2) / 2 / seconds
    return below, above


def _boxes(
    layer: Layer,
    reach: tuple[Reach | None, ...],
    size: tuple[float, float],
    margins: tuple[float, float],
    since: tuple[float, MotionBounds | None],
) -> EgoBoxes:
    rows = []
    for cell, own in zip(layer.cells, reach, strict=True):
        if own is None:
            box = cell.bounds
            rows.append((box.s_min, box.s_max, box.d_min, box.d_max, 0.0, _FASTEST_MPS, 0.0, 100.0))
        else:
            sideways = max(abs(own.lateral_speed[0]), abs(own.lateral_speed[1]))
            rows.append((*own.s, *own.d, *own.speed, 0.0, sideways))
    s0, s1, d0, d1, slow, fast, _, sideways = np.array(rows).reshape(-1, 8).T
    slow = np.maximum(slow, 0.0)
    # A heading differs from the road's by at most 45°, and by what speeds along and across it allow
    turned = np.minimum(np.arctan2(sideways, np.maximum(slow, 1e-9)), np.pi / 4) + _BEND_RAD
    half, side = size[0] / 2, size[1] / 2
    lengths = _extents(half, side, turned)
    widths = _extents(side, half, turned)
    most = np.hypot(fast, sideways)
    means = slow - margins[0], most + margins[1]
    came_s, motion = since
    braking = 0.0 if motion is None else motion.braking
    return EgoBoxes(
        s=(s0, s1),
        d=(d0, d1),
        mean_speed=means,
        half_length=lengths,
        half_width=widths,
        sideways=sideways,
        front_before=s0 + lengths[0] - fast * came_s - braking * came_s**2 / 2,
        came_s=came_s,
    )


def _extents(along: float, across: float, turned: Floats) -> Bounds:
    """The least and the greatest half extent of a rectangle turned by up to an angle (rad)."""
    at_most = along * np.cos(turned) + across * np.sin(turned)
    widest = np.minimum(turned, np.arctan2(across, along))
    return (
        np.minimum(along, at_most),
        along * np.cos(widest) + across * np.sin(widest),
    )
