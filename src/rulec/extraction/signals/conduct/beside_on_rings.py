"""Who rides round a ring in ego's lane, farther out than ego, and goes on where ego leaves it.

Laws differ on whether leaving a ring is a turn, so it is open whether ego then turns in its way.
"""

from __future__ import annotations

import numpy as np
import shapely

from rulec.array_types import Flags
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.bodies import gap_s
from rulec.extraction.signals.map.right_of_way.conflicts import DRIVES_MPS, LONGEST_WAIT_S
from rulec.extraction.signals.map.roundabout_signals import roundabouts
from rulec.scenario.recorded.route import lanelet_area

BEHIND_M, ASIDE_M = 30.0, 8.0
"""A participant that goes on beside ego is at most this far behind it or aside when ego turns."""

LAPS_M = 0.25
"""One that laps ego's side by at most this much may ride beside it: roads bend."""

_OFF_M = 1.0
"""Whose middle is this far (m) off the ring has left it: drawn borders of lanes are not exact."""

_LEAVES_S = 2.0
"""It takes ego's body about as long (s) to get off the ring."""


@once
def cut_on_ring(context: DriveContext) -> Flags:
    """Mask of participants and the states in which ego, leaving a ring, may be in their way."""
    cut: Flags = np.zeros(context.relevant.shape, dtype=bool)
    if not context.surroundings.ring(context.side):
        return cut
    for _, end, _ in roundabouts(context):
        for number, columns in enumerate(context.spans.slices):
            front = context.ego_extents.s_max[0, columns]
            # Not who is beyond the ring from the start
            if (states := (front > end).nonzero()[0]).size and states[0]:
                first = columns.start + int(states[0])
                lasts = context.steps_in(_LEAVES_S)
                found = _cut(context.one(number), end, int(states[0]))
                cut[:, first : min(first + lasts, columns.stop)] |= found[:, None]
    return cut


def _cut(context: DriveContext, end: float, state: int) -> Flags:
    """Those in whose way ego may be as its front leaves a ring at a place, in a state."""
    onwards, out = _fork(context, end)
    passages, shift = context.surroundings.passages, context.first_column
    found: Flags = np.zeros(len(context.relevant), dtype=bool)
    if onwards.is_empty:
        return found
    tracks, own, column = passages.tracks, int(context.ego.rows[0]), shift + state
    for number, row in enumerate(context.tracks.rows.tolist()):
        rides = "pedestrian" not in tracks.participants[row].object_types
        if not rides or not tracks.present[row, column]:
            continue
        if not _is_farther_out(context, own, row, column):
            continue
        later = tracks.present[row, column:].nonzero()[0] + column
        places = shapely.points(tracks.x[row, later], tracks.y[row, later])
        if shapely.contains(out, places).any():
            continue
        there = shapely.contains(onwards, places)
        if not there.any():
            found[number] = later[-1] - column <= _LEAVES_S / context.recording.step_s
            continue
        first = int(there.argmax())
        past = first + int(np.append(~there[first:], True).argmax())
        found[number] = _comes(context, (own, row), column, int(later[past - 1]))
    return found


def _fork(context: DriveContext, end: float) -> tuple[shapely.Geometry, shapely.Geometry]:
    """Where the ring goes on from the place where ego's road leaves it, and that road off it."""
    ring, road = context.surroundings.ring(context.side), context.road
    lanelets, piece = context.recording.lanelets, int(np.searchsorted(road.borders, end)) - 1
    last = [x for x in road.rows[piece] if x is not None]
    out = [x for row in road.rows[piece + 1 :] for x in row if x is not None and x.id not in ring]
    after = {number for x in last for number in x.successors if number in ring}
    onwards, whole, away = (
        shapely.union_all([lanelet_area(x) for x in part])
        for part in ([lanelets[x] for x in after], [lanelets[x] for x in ring], out)
    )
    return onwards, shapely.buffer(shapely.difference(away, whole), -_OFF_M)


def _is_farther_out(context: DriveContext, own: int, row: int, column: int) -> bool:
    """Whether a body is beside the way that ego has come, or behind it, clear of it outwards."""
    passages = context.surroundings.passages
    tracks = passages.tracks
    came = tracks.present[own, : column + 1].nonzero()[0]
    x, y, heading = (part[own, came] for part in (tracks.x, tracks.y, tracks.heading))
    nearest = int(np.hypot(x - tracks.x[row, column], y - tracks.y[row, column]).argmin())
    forth = np.array([np.cos(heading[nearest]), np.sin(heading[nearest])])
    outwards = np.array([forth[1], -forth[0]]) * (1 if context.side == "right" else -1)
    ours, theirs = (tracks.outline(one, column) for one in (own, row))
    if ours is None or theirs is None:
        return False
    aside = np.array([-np.sin(heading[-1]), np.cos(heading[-1])])
    from_ego = theirs - (x[nearest], y[nearest])
    clear = float((from_ego @ outwards).min() - np.ptp(ours @ aside) / 2)
    travelled = passages.travelled[own, came]
    behind = float(travelled[-1] - travelled[nearest] - (from_ego @ forth).mean())
    least = -max(context.tolerances.place_m, LAPS_M)
    half = float(passages.lengths[own]) / 2
    return least <= clear <= ASIDE_M and -half <= behind <= BEHIND_M


def _comes(context: DriveContext, rows: tuple[int, int], column: int, goes_on: int) -> bool:
    """Whether another one comes where ego's body was so soon after it that ego may hold it up.

    Or would have come so soon, had it gone on as fast as it was when ego left.
    """
    passages, step_s = context.surroundings.passages, context.recording.step_s
    speed = float(passages.tracks.speed[rows[1], column])
    soon_s = gap_s(context, rows, (column, goes_on))
    if speed <= DRIVES_MPS or soon_s > LONGEST_WAIT_S:
        return soon_s < context.thresholds.yielding_s
    way = passages.travelled[rows[1]]
    late_s = (goes_on - column) * step_s - float(way[goes_on] - way[column]) / speed
    return soon_s - max(late_s, 0.0) < context.thresholds.yielding_s
