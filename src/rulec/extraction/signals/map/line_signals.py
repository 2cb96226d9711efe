"""Signals of the way to what ego comes to: a line at which it may have to stop, a junction."""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import DriveContext, once
from rulec.extraction.signals.ego_lanelets import map_contents, own_lanelets
from rulec.extraction.signals.map.stop_lines import stop_line
from rulec.extraction.signals.measured_numbers import LONGEST_S, moves, own_front, own_speed
from rulec.extraction.signals.signal_columns import (
    SignalColumns,
    rounded,
    rounded_outward,
)
from rulec.extraction.signals.signal_passes import SignalPasses
from rulec.extraction.tracks.tracks import Floats
from rulec.recordings.recording import STOP_SIGNS, Lanelet
from rulec.trace.plain_arrays import distinct

_NO_JUNCTION_M = 1000.0


def _to_line(context: DriveContext) -> SignalColumns:
    """The way to the line, and how long ego takes to it."""
    if not _tells_lines(context):
        return SignalColumns()
    way, (near, far) = _way_to_line(context)
    (speed, error), drives = own_speed(context), moves(context)
    ahead = far > 0

    def seconds(distance: Floats, at_mps: Floats) -> Floats:
        may_drive = drives & (at_mps > 0)
        taken = np.minimum(distance / np.where(may_drive, at_mps, 1.0), LONGEST_S)
        return np.where(ahead, np.where(may_drive, taken, LONGEST_S), 0.0)

    times = seconds(near, speed + error), seconds(far, speed - error)
    return SignalColumns(
        {"distance_to_stop_line": rounded(way), "time_to_stop_line": rounded(seconds(way, speed))},
        bounds={
            "distance_to_stop_line": rounded_outward(near, far),
            "time_to_stop_line": rounded_outward(*times),
        },
    )


def _tells_lines(context: DriveContext) -> bool:
    known = map_contents(context)
    complete = {"light", "STOP"} <= context.recording.complete
    return complete or known.lights or bool(STOP_SIGNS & known.signs)


@once
def _way_to_line(context: DriveContext) -> tuple[Floats, tuple[Floats, Floats]]:
    """The way (m) to the next line of ego's lane, 0 without one, and its bounds.

    Where the map has no line it is at the nearest of the places where it may be.
    """
    front, place = own_front(context), context.tolerances.place_m
    touching = context.thresholds.touching_m
    way, near, far = np.zeros((3, context.states))
    for piece in range(len(context.road.rows) - 1, -1, -1):
        if not any(row is not None and _has_line(row) for row in context.road.rows[piece]):
            continue
        for lane in distinct(context.ego_lane).tolist():
            if not _has_line(context.road.lanelet(piece, lane)):
                continue
            first, last = stop_line(context, piece, lane)
            ahead = (front <= last) & (context.ego_lane == lane)
            ahead &= front > first - context.thresholds.near_m
            way[ahead] = np.maximum(first - front, 0.0)[ahead]
            near[ahead] = np.maximum(first - front - place, 0.0)[ahead]
            far[ahead] = np.maximum(last - touching - front + place, 0.0)[ahead]
    if STOP_SIGNS & map_contents(context).untold_signs:
        own = own_lanelets(context)
        may = own.flags(lambda lanelet: bool(STOP_SIGNS & lanelet.untold_signs))
        near[may] = 0.0
        far[may] = np.maximum(far, context.road.borders[-1] - front)[may]
    return way, (near, far)


def _has_line(lanelet: Lanelet) -> bool:
    return bool(lanelet.lights or lanelet.lights_to or STOP_SIGNS & lanelet.signs)


def _to_junction(context: DriveContext) -> SignalColumns:
    front, rear = context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    begin = np.full(context.states, np.inf)
    for low, high in sorted(context.road.junctions, reverse=True):
        begin = np.where(rear < high, low, begin)
    way, place = begin - front, context.tolerances.place_m
    to, *bounds = (np.clip(way + more, 0.0, _NO_JUNCTION_M) for more in (0.0, -place, place))
    return SignalColumns(
        {"distance_to_junction": rounded(to)},
        bounds={"distance_to_junction": rounded_outward(bounds[0], bounds[1])},
    )


line_signals = SignalPasses(
    {
        ("distance_to_stop_line", "time_to_stop_line"): _to_line,
        ("distance_to_junction",): _to_junction,
    }
)
"""The signals of the way to lines and junctions."""
