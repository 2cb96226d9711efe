"""What ego does to the marks of its road, where the map has marks."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_signals import steady_lane
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.scenario.recorded.recording import Lanelet


def lane_mark_signals(view: DriveContext) -> SignalColumns:
    """Words about marks; none at all if the map has none."""
    if not any(x.left_mark or x.right_mark for x in view.recording.lanelets.values()):
        return SignalColumns()
    there = view.road.lanes_at(view.own.s[0])
    pieces = view.road.piece(view.own.s[0]).tolist()
    lanes = steady_lane(view, there).tolist()
    names = ("marked_lanes", "on_solid_line", "broken_on_own_side")
    columns = np.zeros((len(names), view.states), dtype=bool)
    unknown = np.zeros(view.states, dtype=bool)
    for state, (piece, lane) in enumerate(zip(pieces, lanes, strict=True)):
        row = [x if on else None for x, on in zip(view.road.rows[piece], there[state], strict=True)]
        between = [_between(*pair) for pair in pairwise(row) if all(pair)]
        unknown[state] = any(not any(marks) for marks in between)
        columns[0, state] = bool(between) and all(set(marks) != {"none"} for marks in between)
        over = [_own_first(marks, line, lane) for line, marks in _over(view, state, row)]
        columns[1, state] = any("solid" in marks for marks in over)
        columns[2, state] = any(marks == ("broken", "solid") for marks in over)
    return SignalColumns(dict(zip(names, columns, strict=True)), unknown={"marked_lanes": unknown})


def _between(right: Lanelet | None, left: Lanelet | None) -> tuple[str | None, str | None]:
    """The marks between two lanes, that of the right one first."""
    return right.left_mark if right else None, left.right_mark if left else None


def _over(
    view: DriveContext, state: int, row: list[Lanelet | None]
) -> list[tuple[int, tuple[str | None, str | None]]]:
    """The lines that ego has a part of itself on either side of: their numbers and marks."""
    straight = view.road.lanes.straight
    low, high = float(view.own.w_min[0, state]), float(view.own.w_max[0, state])
    reach = view.thresholds.touching_m
    padded = [None, *row, None]
    return [
        (line, _between(padded[line], padded[line + 1]))
        for line in range(len(straight))
        if min(straight[line] - low, high - straight[line]) > reach
    ]


def _own_first(
    marks: tuple[str | None, str | None], line: int, lane: int
) -> tuple[str | None, str | None]:
    """The mark at ego's side of a line first; a line has the number of the lane to its left."""
    right, left = marks
    return (left, right) if lane >= line else (right, left)
