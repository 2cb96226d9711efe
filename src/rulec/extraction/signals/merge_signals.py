"""Signals of narrowings, where two lanes become one.

Two lanes beside each other become one where both lead to the same lanelet, or one of them ends.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.scenario.recorded.recording import Lanelet


def merge_signals(context: DriveContext) -> SignalColumns:
    """The signals of ego's place at narrowings, and of who is beside it there."""
    reach = context.thresholds.approach_m
    front, lane = context.ego_extents.s_max[0], context.ego_lane
    narrowing, merged = np.zeros((2, context.states), dtype=bool)
    abreast = np.zeros(context.relevant.shape, dtype=bool)
    level = relations.station(context) == relations.BESIDE
    for place, right in _merges(context):
        on_one = (lane == right) | (lane == right + 1)
        before = on_one & (front > place - reach) & (front <= place)
        narrowing |= before
        merged |= (front > place) & (front <= place + reach) & _was(before)
        other = np.where(lane == right, right + 1, right)
        there = np.take_along_axis(context.touched, other[None, :, None], axis=2)[..., 0]
        abreast |= before & level & there & context.going_along
    return SignalColumns(
        {"narrowing": narrowing, "merged": merged}, {"abreast_at_narrowing": abreast}
    )


def _was(flags: relations.Codes) -> relations.Codes:
    return np.maximum.accumulate(flags)


def _merges(context: DriveContext) -> Iterator[tuple[float, int]]:
    """Places along the road at which a lane and the next one to the left become one."""
    rows, borders = context.road.rows, context.road.borders
    for piece, (row, after) in enumerate(pairwise(rows)):
        for right, (one, other) in enumerate(pairwise(row)):
            if one is not None and other is not None:
                joins = set(one.successors) & set(other.successors)
                ends = [x for x in (one, other) if not _goes_on(x)]
                left_out = after[right] is None or after[right + 1] is None
                if joins or (left_out and len(ends) == 1):
                    yield float(borders[piece + 1]), right


def _goes_on(lanelet: Lanelet) -> bool:
    return bool(lanelet.successors)
