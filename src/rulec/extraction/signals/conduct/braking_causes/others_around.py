"""Where others are around ego, and how they move, relative to its heading, on any road."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.scenario.recorded.reference_line import turn

CROSSES_M, _ACROSS_RAD = 30.0, np.radians(30.0)
"""A participant this near to the side that drives across may come into ego's way."""


@dataclass(frozen=True, eq=False, slots=True)
class Others:
    """Where others are in some ``states``: ahead of ego and left of it (m), by its heading.

    One row per participant; ``rows`` are theirs in the whole recording; ``away`` is how far (m)
    they are from ego's line to either side.
    """

    states: NDArray[intp]
    rows: NDArray[intp]
    ahead: Floats
    left: Floats
    away: Floats

    def part(self, chosen: NDArray[intp]) -> Others:
        """The others in some of the states."""
        ahead, left, away = (own.take(chosen, axis=1) for own in (self.ahead, self.left, self.away))
        return Others(self.states.take(chosen), self.rows, ahead=ahead, left=left, away=away)


@dataclass(frozen=True, eq=False, slots=True)
class MotionAhead:
    """The motion of others: speeds ahead of ego and to its left (m/s), by its heading.

    ``turned`` is their heading relative to ego's (rad).
    """

    along: Floats
    sideways: Floats
    turned: Floats
    moves: Flags

    @property
    def goes_along(self) -> Flags:
        """Whether they head about where ego does."""
        flags: Flags = np.abs(self.turned) < _ACROSS_RAD
        return flags

    @property
    def goes_across(self) -> Flags:
        """Whether they head across ego's way."""
        angle = np.abs(self.turned)
        flags: Flags = (angle > _ACROSS_RAD) & (angle < np.pi - _ACROSS_RAD)
        return flags


def others_in(context: DriveContext, states: NDArray[intp]) -> Others:
    """All others of the recording in some states, including those not on ego's road."""
    tracks, own, spans = context.surroundings.tracks, context.ego, context.spans
    columns = context.columns[states]
    rows = tracks.present.take(columns, axis=1).any(axis=1).nonzero()[0]
    x, y = (values[rows].take(columns, axis=1) for values in (tracks.x, tracks.y))
    if context.own is context.surroundings:
        drives = spans.number[states]
        places = rows.searchsorted(own.rows)[drives]
        there = (places < len(rows)).nonzero()[0]
        there = there[rows[places[there]] == own.rows[drives[there]]]
        x[places[there], there] = np.nan
    heading = own.heading[0, states]
    cos, sin = np.cos(heading), np.sin(heading)
    x -= own.x[0, states]
    y -= own.y[0, states]
    left = y * cos - x * sin
    return Others(states, rows, ahead=x * cos + y * sin, left=left, away=np.abs(left))


def without_followers(context: DriveContext, others: Others) -> Others:
    """The others without those that go ego's way behind it, which wait for ego."""
    places = others.rows.searchsorted(context.tracks.rows)
    there = (others.rows.take(places, mode="clip") == context.tracks.rows).nonzero()[0]
    behind = (relations.station(context) == relations.IN_FRONT_OF) & context.going_along
    gone = np.zeros(others.ahead.shape, dtype=bool)
    gone[places[there]] = behind[there].take(others.states, axis=1)
    ahead, left, away = (
        np.where(gone, np.nan, own) for own in (others.ahead, others.left, others.away)
    )
    return Others(others.states, others.rows, ahead=ahead, left=left, away=away)


def motion_of(context: DriveContext, rows: NDArray[intp], states: NDArray[intp]) -> MotionAhead:
    """The motion of others, given by rows in the whole recording and as many states."""
    tracks = context.surroundings.tracks
    at, own = (rows, context.columns[states]), context.ego.heading[0]
    cos, sin, own = np.cos(own)[states], np.sin(own)[states], own[states]
    vx, vy = tracks.vx[at], tracks.vy[at]
    return MotionAhead(
        along=vx * cos + vy * sin,
        sideways=vy * cos - vx * sin,
        turned=turn(own, tracks.heading[at]),
        moves=np.hypot(vx, vy) * KMH_PER_MPS >= context.thresholds.standing_kmh,
    )
