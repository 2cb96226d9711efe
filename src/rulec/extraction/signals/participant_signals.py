"""Signals of other participants: relations, gaps, speeds, oncoming and standing ones."""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.measured_numbers import (
    LONGEST_S,
    bounds_to_others,
    moves,
    own_speed,
    safe_distance,
    safe_distance_error,
)
from rulec.extraction.signals.signal_columns import SignalColumns, latest, named_values, rounded
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.partition.cells.regions import LATERALS, STATIONS

_TWO_WHEELED = ("motorcycle", "bicycle")


def participant_signals(context: DriveContext) -> SignalColumns:
    """The signals of objects."""
    station, lateral = relations.station(context), relations.lateral(context)
    others, gap = relations.possible_laterals(context), relations.gap(context)
    bodies = context.tracks.participants
    speeds = context.zero_if_standing(context.extents.along * KMH)
    follows, _, may_follow = relations.ahead_in_lane(context)
    oncoming = is_oncoming(context) | _waits_oncoming(context)
    short = safe_distance(context) - gap
    wrong = np.hypot(safe_distance_error(context), context.tolerances.place_m)
    stands = context.tracks.speed * KMH < context.thresholds.standing_kmh
    # One that stands, and that ego drives by, does not drive ahead
    room = np.where(stands, relations.way_across(context) - context.thresholds.touching_m, -np.inf)
    may_pass_by = may_follow & (np.abs(room) < context.tolerances.place_m)
    may_follow &= room <= 0
    return SignalColumns(
        about={
            "position": relations.position(context),
            "station": named_values(station, STATIONS),
            "lateral": named_values(lateral, LATERALS),
            "gap": rounded(gap),
            "time_headway": rounded(_headway(context, gap)),
            "lateral_gap": rounded(relations.lateral_gap(context)),
            "speed_difference": rounded(context.ego_extents.along * KMH - speeds),
            "safe_gap": ~may_follow | (short <= 0),
            "precedes": _precedes(context, follows & ~oncoming, gap),
            "oncoming": oncoming,
            "goes_across": _goes_across(context),
            "stopped": stands,
            "parked": _constant(context, [body.standing for body in bodies]),
            "two_wheeled": _constant(context, [body.type in _TWO_WHEELED for body in bodies]),
            "in_the_road": context.tracks.on_lane,
        },
        only={"in_the_road": context.tracks.of_type("vulnerable_user")},
        unknown={
            "lateral": np.any([lateral != codes for codes in others], axis=0),
            "safe_gap": may_follow & (np.abs(short) < wrong)
            | (may_pass_by | may_follow & _parts_soon(context)) & (short > -wrong),
        },
        bounds=bounds_to_others(context),
    )


def _parts_soon(context: DriveContext) -> Flags:
    """Flags of those whose lane is not ego's at some state within ``parting_s``."""
    horizon = round(context.thresholds.parting_s / context.recording.step_s)
    states = np.arange(context.states)
    apart = (context.extents.lane != context.ego_extents.lane) & context.relevant
    when = np.where(apart, states, context.states + horizon)[:, ::-1]
    parts: Flags = np.minimum.accumulate(when, axis=1)[:, ::-1] <= states + horizon
    return parts


def gap_beside_safe_distance(context: DriveContext) -> tuple[Floats, Floats]:
    """The two distances (m) that ``safe_gap`` compares; NaN where ego does not follow."""
    _, _, follows = relations.ahead_in_lane(context)
    return np.where(follows, relations.gap(context), np.nan), safe_distance(context)


def _headway(context: DriveContext, gap: Floats) -> Floats:
    # The speed that the word `speed` says
    (speed, _), drives = own_speed(context), moves(context)
    seconds = gap / np.where(drives, speed, 1.0)
    return np.where(drives, np.minimum(seconds, LONGEST_S), LONGEST_S)


def is_oncoming(context: DriveContext) -> Flags:
    """Flags of participants that move against ego's direction."""
    moves = np.abs(context.extents.along) * KMH >= context.thresholds.standing_kmh
    against: Flags = moves & (context.extents.along < 0)
    return against & _faces_ego(context)


def _goes_across(context: DriveContext) -> Flags:
    """Flags of participants that move across the road, more than along it.

    Who walks or rides across goes on doing so, though it stops or somebody runs into it, until it
    leaves the road or moves along it.
    """
    least, step_s = context.thresholds.standing_kmh / KMH, context.recording.step_s
    along, across = np.abs(context.extents.along), np.abs(context.extents.across)
    moves: Flags = (across >= least) & (across > along)
    # Step by step: in means over a second a blow that moves a body at once lasts as long
    s = np.abs(np.diff(context.extents.s, axis=1, prepend=np.nan))
    d = np.abs(np.diff(context.extents.d_min + context.extents.d_max, axis=1, prepend=np.nan)) / 2
    turns = (s >= least * step_s) & (s > d)
    steps = max(round(context.thresholds.smoothing_s / step_s), 1)
    sums = np.pad(np.cumsum(turns, axis=1), ((0, 0), (steps, 0)))
    mostly = 2 * (sums[:, steps:] - sums[:, :-steps]) > steps
    vulnerable = np.array(context.tracks.of_type("vulnerable_user"), dtype=bool)[:, None]
    goes_on = latest(moves) > latest(mostly | ~context.tracks.on_lane)
    goes: Flags = moves | (goes_on & vulnerable)
    return goes


def _waits_oncoming(context: DriveContext) -> Flags:
    """Flags of vehicles that stand on lanes against ego's way, in a queue for example.

    Ego does not overtake them, no more than ones that move, nor follow one that waits in a junction
    for its turn. What only stands there, the wrong way round, is an obstacle in ego's lanes.
    """
    stands = np.abs(context.extents.along) * KMH < context.thresholds.standing_kmh
    vehicles = np.array(context.tracks.of_type("vehicle"), dtype=bool)[:, None]
    moves_elsewhere = context.elsewhere & ~stands.all(axis=1, keepdims=True)
    waits: Flags = stands & vehicles & (moves_elsewhere | ~context.touched.any(axis=-1))
    return waits & _faces_ego(context)


def _faces_ego(context: DriveContext) -> Flags:
    return np.cos(context.extents.turned) < -0.5


def _precedes(context: DriveContext, follows: Flags, gap: Floats) -> Flags:
    """Flags of participants that are next ahead of ego in its lane."""
    ahead = np.where(follows & context.relevant, gap, np.inf)
    nearest = ahead.min(axis=0, initial=np.inf)
    precedes: Flags = (ahead == nearest) & np.isfinite(ahead)
    return precedes


def _constant(context: DriveContext, flags: list[bool]) -> Flags:
    return np.repeat(np.array(flags, dtype=bool)[:, None], context.states, axis=1)
