"""Signals of road marks, where the map has marks."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_signals import steady_lane
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.scenario.recorded.recording import Lanelet


def lane_mark_signals(context: DriveContext) -> SignalColumns:
    """The signals of marks; none at all if the map has none."""
    known = context.recording.lanelets.values()
    if not any(lanelet.left_mark or lanelet.right_mark for lanelet in known):
        return SignalColumns()
    existing = context.road.lanes_at(context.ego_extents.s[0])
    pieces = context.road.piece(context.ego_extents.s[0]).tolist()
    lanes = steady_lane(context, existing).tolist()
    names = ("marked_lanes", "on_solid_line", "broken_on_own_side")
    columns = np.zeros((len(names), context.states), dtype=bool)
    unknown = np.zeros(context.states, dtype=bool)
    for state, (piece, lane) in enumerate(zip(pieces, lanes, strict=True)):
        lanelets = zip(context.road.rows[piece], existing[state], strict=True)
        row = [lanelet if exists else None for lanelet, exists in lanelets]
        between = [_between(*pair) for pair in pairwise(row) if all(pair)]
        unknown[state] = any(not any(marks) for marks in between)
        columns[0, state] = bool(between) and all(set(marks) != {"none"} for marks in between)
        over = [_own_first(marks, line, lane) for line, marks in _over(context, state, row)]
        columns[1, state] = any("solid" in marks for marks in over)
        columns[2, state] = any(marks == ("broken", "solid") for marks in over)
    return SignalColumns(dict(zip(names, columns, strict=True)), unknown={"marked_lanes": unknown})


def _between(right: Lanelet | None, left: Lanelet | None) -> tuple[str | None, str | None]:
    """The marks between two lanes, that of the right one first."""
    return right.left_mark if right else None, left.right_mark if left else None


def _over(
    context: DriveContext, state: int, row: list[Lanelet | None]
) -> list[tuple[int, tuple[str | None, str | None]]]:
    """The numbers and marks of the lines that ego's body lies across."""
    straight, own = context.road.lanes.straight, context.ego_extents
    low, high = (float(bound[0, state]) for bound in (own.w_min, own.w_max))
    reach = context.thresholds.touching_m
    padded = [None, *row, None]
    return [
        (line, _between(padded[line], padded[line + 1]))
        for line in range(len(straight))
        if min(straight[line] - low, high - straight[line]) > reach
    ]


def _own_first(
    marks: tuple[str | None, str | None], line: int, lane: int
) -> tuple[str | None, str | None]:
    """Put the mark at ego's side first.

    A line has the number of the lane to its left.
    """
    right, left = marks
    return (left, right) if lane >= line else (right, left)
