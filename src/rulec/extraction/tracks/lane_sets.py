"""Sets of lanes as whole numbers, and the sets that bodies reach into."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.tracks.road_extents import RoadExtents

LaneSets: TypeAlias = NDArray[Any]
"""Sets of lanes as whole numbers: bit ``k`` is set if lane ``k`` is in the set."""


def lane_sets(lanes: Flags) -> LaneSets:
    """A mask of lanes (last axis) as sets."""
    # With more than 64 lanes they are Python's integers
    kind = np.min_scalar_type((1 << lanes.shape[-1]) - 1)
    sets: LaneSets = np.zeros(lanes.shape[:-1], dtype=kind)
    for lane in range(lanes.shape[-1]):
        sets |= lanes[..., lane].astype(kind) << lane
    return sets


def edges(lanes: Flags) -> tuple[NDArray[intp], NDArray[intp]]:
    """The numbers of the first and the last bound of lanes (last axis) that exist."""
    return lanes.argmax(axis=-1), lanes.shape[-1] - lanes[..., ::-1].argmax(axis=-1)


def is_in(sets: LaneSets, lane: NDArray[intp] | int) -> Flags:
    """Mask of the sets that contain a lane."""
    # Cast to the sets' narrow type, so that the result keeps it
    only = np.left_shift(1, lane, dtype=sets.dtype, casting="unsafe")
    flags: Flags = (sets & only) != 0
    return flags


def lanes_touched(
    extents: RoadExtents, there: LaneSets, least_m: Sequence[float], across: Floats | None = None
) -> tuple[LaneSets, ...]:
    """The sets of lanes ``there`` that bodies reach into, one for each threshold in ``least_m``.

    Bodies have to reach in by more than the threshold (m). With ``across``, all bodies are moved
    this far (m) to the left, by column.
    """
    found = tuple(np.zeros(there.shape, dtype=there.dtype) for _ in least_m)
    ends = (extents.left_of_min, extents.left_of_max)
    # Lane by lane, so that the data stay in the processor's caches
    low, high = (_moved(own[..., 0], across) for own in ends)
    middle = (low + high) / 2
    for lane in range(extents.left_of_min.shape[-1] - 1):
        next_low, next_high = (_moved(own[..., lane + 1], across) for own in ends)
        next_middle = (next_low + next_high) / 2
        breadth = high - low
        inside = np.minimum(breadth, middle - next_middle)
        np.minimum(inside, np.minimum(high, -next_low), out=inside)
        breadth /= 2
        for sets, least in zip(found, least_m, strict=True):
            # A narrow body, such as a pedestrian's, is in a lane with most of its width
            touched = inside > np.minimum(least, breadth)
            sets |= touched.astype(sets.dtype) << lane
        low, high, middle = next_low, next_high, next_middle
    for sets in found:
        sets &= there
    return found


def _moved(values: Floats, across: Floats | None) -> Floats:
    return values if across is None else values + across
