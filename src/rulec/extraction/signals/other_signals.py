"""What is measured of others, and what they do: relations, gaps, speeds, who stands, who comes."""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns, named_values, rounded
from rulec.extraction.tracks.tracks import Flags, Floats
from rulec.partition.cells.regions import LATERALS, STATIONS

LONGEST_S = 1000.0
"""No headway is longer."""

_TWO_WHEELED = ("motorcycle", "bicycle")


def other_signals(view: DriveContext) -> SignalColumns:
    """Words about objects."""
    own, others, limits = view.own, view.others, view.thresholds
    station = relations.station(own, others)
    lateral = relations.lateral(own, others, view.touched, view.road)
    gap = relations.gap(own, others)
    walking = view.people.of_kind("pedestrian")
    follows = (station == relations.BEHIND) & (lateral == relations.SAME_LANE)
    return SignalColumns(
        about={
            "position": relations.position(own, others, view.touched, walking, view.road),
            "station": named_values(station, STATIONS),
            "lateral": named_values(lateral, LATERALS),
            "gap": rounded(gap),
            "time_headway": rounded(_headway(view, gap)),
            "lateral_gap": rounded(relations.lateral_gap(own, others)),
            "speed_difference": rounded(own.along * KMH - view.speeds()),
            "safe_gap": np.logical_or(~follows, gap >= safe_distance(view)),
            "precedes": _precedes(view, follows, gap),
            "oncoming": is_oncoming(view) | _waits_to_come(view),
            "stopped": view.people.speed * KMH < limits.standing_kmh,
            "parked": _for_good(view, [one.standing for one in view.people.participants]),
            "two_wheeled": _for_good(
                view, [one.type in _TWO_WHEELED for one in view.people.participants]
            ),
            "in_the_road": view.in_the_road,
        },
        only={"in_the_road": view.people.of_kind("vulnerable_user")},
    )


def _headway(view: DriveContext, gap: Floats) -> Floats:
    """How long ego takes for the gap at its speed (s); as good as for ever if it stands."""
    moves = view.own.along * KMH >= view.thresholds.standing_kmh
    seconds = gap / np.where(moves, view.own.along, 1.0)
    return np.where(moves, np.minimum(seconds, LONGEST_S), LONGEST_S)


def safe_distance(view: DriveContext) -> Floats:
    """How far behind somebody ego has to be not to run into it if it brakes as hard as it can.

    Ego brakes as hard after its reaction time. Who comes towards ego counts as standing.
    """
    limits = view.thresholds
    own = np.maximum(view.own.along, 0.0)
    other = np.maximum(view.others.along, 0.0)
    distance: Floats = limits.reaction_s * own + (own**2 - other**2) / (2 * limits.braking_mps2)
    return distance


def is_oncoming(view: DriveContext) -> Flags:
    """Who moves against ego's direction?"""
    moves = np.abs(view.others.along) * KMH >= view.thresholds.standing_kmh
    against: Flags = moves & (view.others.along < 0)
    return against & _faces_ego(view)


def _waits_to_come(view: DriveContext) -> Flags:
    """Which vehicles stand on lanes that lead against ego's way, as in a queue there?

    Ego does not overtake them, no more than those that move. Who stands in ego's own lanes the
    wrong way round is an obstacle there.
    """
    stands = np.abs(view.others.along) * KMH < view.thresholds.standing_kmh
    vehicles = np.array(view.people.of_kind("vehicle"), dtype=bool)[:, None]
    waits: Flags = stands & vehicles & ~view.touched.any(axis=-1)
    return waits & _faces_ego(view)


def _faces_ego(view: DriveContext) -> Flags:
    faces: Flags = np.cos(view.others.turned) < -0.5
    return faces


def _precedes(view: DriveContext, follows: Flags, gap: Floats) -> Flags:
    """Who is the next one ahead of ego in its lane?"""
    ahead = np.where(follows & view.near & ~is_oncoming(view), gap, np.inf)
    nearest = ahead.min(axis=0, initial=np.inf)
    next_one: Flags = (ahead == nearest) & np.isfinite(ahead)
    return next_one


def _for_good(view: DriveContext, flags: list[bool]) -> Flags:
    """The same in every state."""
    return np.repeat(np.array(flags, dtype=bool)[:, None], view.states, axis=1)
