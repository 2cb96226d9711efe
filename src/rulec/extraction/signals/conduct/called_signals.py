"""Signals of emergency vehicles on call: who is, does one come near, and is its way clear of ego.

What it means to be near, and in the way, differs by law. Only who draws near behind ego, is beside
it or comes towards it surely is near; only who takes up its lane surely is in its way.
"""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext, once
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.lamp_signals import lamp_signals
from rulec.extraction.signals.conduct.others_lamps import (
    flashing,
    lamps_of_all,
    lit_lamps,
    moves,
    stands,
)
from rulec.extraction.signals.ego_lanelets import own_lanelets, room_beside
from rulec.extraction.signals.signal_columns import SignalColumns, ids_by_state
from rulec.extraction.signals.signal_passes import SignalPasses
from rulec.extraction.tracks.tracks import Flags

_OWN = "ego_on_call"

_FACES = -0.5
"""The cosine between the directions of ego's road and of one who has come the other way on it."""


def _emergency_vehicle_near(context: DriveContext) -> SignalColumns:
    """Whether one on call is near.

    Unknown of one that stands, does not sound a told horn, is not beside ego soon, or comes on a
    road across; and where ego is on call itself.
    """
    on_call, not_told = _on_call(context)
    surely, perhaps = _surely_near(context), _crosses_near(context)
    rows = (on_call | not_told).any(axis=1).nonzero()[0]
    if len(rows):
        near = context.relevant[rows] & _comes_near(context)[rows]
        perhaps |= np.logical_or.reduce(near & (on_call | not_told)[rows])
    comes: Flags = np.logical_or.reduce(surely)
    if comes.any():
        comes &= ~_may_be_on_call(context)
    return SignalColumns(
        {"emergency_vehicle_near": comes},
        unknown={"emergency_vehicle_near": perhaps & ~comes},
        whom={"emergency_vehicle_near": ids_by_state(surely & comes, context.ids)},
    )


@once
def _surely_near(context: DriveContext) -> Flags:
    """Flags of those on call that drive and come near for sure."""
    found: Flags = np.zeros(context.relevant.shape, dtype=bool)
    on_call, _ = _on_call(context)
    rows = on_call.any(axis=1).nonzero()[0]
    if len(rows):
        needs_way = _drives(context, rows) & ~_is_silent(context, rows)
        near = context.relevant[rows] & on_call[rows] & needs_way
        found[rows] = near & _comes_near(context)[rows] & ~_is_far(context)[rows]
    return found


def _way_cleared(context: DriveContext) -> SignalColumns:
    """Whether ego stands, or is at an edge of its lane.

    Unknown where those that are near have another lane: whether they need ego's, or laws want it at
    the edge all the same, nobody knows.
    """
    still = context.ego.speed[0] * KMH < context.thresholds.standing_kmh
    cleared = still | _at_edge(context)
    near = _surely_near(context)
    if not near.any():
        return SignalColumns({"way_cleared": cleared})
    in_way = near & (context.in_ego_lane | (relations.way_across(context) < 0))
    return SignalColumns(
        {"way_cleared": cleared},
        unknown={"way_cleared": near.any(axis=0) & ~in_way.any(axis=0) & ~cleared},
    )


def _at_edge(context: DriveContext) -> Flags:
    (right, left), edge = room_beside(context), context.thresholds.at_edge_m
    return (np.minimum(right, left) < edge) & (np.abs(right - left) > edge)


def _called(context: DriveContext) -> SignalColumns:
    on_call, not_told = _on_call(context)
    return SignalColumns(about={"on_call": on_call}, unknown={"on_call": not_told})


@once
def _on_call(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of emergency vehicles with their blue lights on, and of those that perhaps are that."""
    called = context.tracks.of_type("emergency_vehicle")[:, None]
    kinds = np.array([body.type == "unknown" for body in context.tracks.participants], dtype=bool)
    if not called.any():
        nobody = np.zeros(context.relevant.shape, dtype=bool)
        return nobody, nobody | kinds[:, None]
    blue, told = lit_lamps(context, "blue_light")
    blue = flashing(blue, context)
    return called & blue, (called & ~told & ~blue) | kinds[:, None]


def _may_be_on_call(context: DriveContext) -> Flags:
    """Flags of states in which ego may be on call, too: which of two goes first nobody knows."""
    own = lamp_signals(context, frozenset({_OWN}))
    may_be: Flags = own.world[_OWN] | own.unknown.get(_OWN, np.False_)
    return may_be


def _comes_near(context: DriveContext) -> Flags:
    """Flags of those who are behind or beside ego, or come towards it on its carriageway.

    One that has come towards ego and is past it drives away, also while it waits at lights there.
    """
    station, against = relations.station(context), _against(context)
    directions = context.surroundings.directions
    divided = own_lanelets(context).flags(lambda lanelet: directions(lanelet)[1] is True)
    towards = against & (station != relations.IN_FRONT_OF) & ~divided
    comes: Flags = towards | (~against & (station != relations.BEHIND))
    return comes


def _against(context: DriveContext) -> Flags:
    along, faces = context.extents.along, np.cos(context.extents.turned) < _FACES
    against: Flags = np.where(
        stands(context), faces, along * KMH < -context.thresholds.standing_kmh
    )
    return against


def _is_far(context: DriveContext) -> Flags:
    """Flags of those behind ego or coming towards it who do not need its way at once.

    They are farther than at ``queue_headway_s``, as if held up, and would not be beside ego before
    a change of lanes is over, within ``parting_s``; who comes towards it, and may wait at lights,
    is farther than ``approach_m``, too.
    """
    limits, along, own = context.thresholds, context.extents.along, context.ego_extents.along
    theirs = np.maximum(along, 0.0)
    gains = np.maximum(theirs - own, 0.0)
    station, against = relations.station(context), _against(context)
    behind = ~against & (station == relations.IN_FRONT_OF)
    towards = against & (station == relations.BEHIND)
    gains = np.where(towards, np.maximum(own, 0.0) - along, gains)
    theirs = np.where(towards, -along, theirs)
    reach = np.maximum(gains * limits.parting_s, theirs * limits.queue_headway_s)
    reach = np.maximum(reach, np.where(towards, limits.approach_m, 0.0))
    far: Flags = (behind | towards) & (relations.gap(context) > reach)
    return far


def _crosses_near(context: DriveContext) -> Flags:
    """Flags of states in which an emergency vehicle draws near on a road across.

    Nobody knows whether it needs ego's way then: it may be a crossing's, or another one's above it.
    """
    tracks, limits = context.surroundings.tracks, context.thresholds
    rows = tracks.of_type("emergency_vehicle").nonzero()[0]
    if not len(rows):
        return np.zeros(context.states, dtype=bool)
    places = np.ix_(rows, context.columns)
    blue, told = lamps_of_all(context).get("blue_light", (np.zeros_like(tracks.present),) * 2)
    called = flashing(blue[places], context) | ~told[places]
    aside = tracks.x[places] - context.ego.x[0], tracks.y[places] - context.ego.y[0]
    drifts = tracks.vx[places] - context.ego.vx[0], tracks.vy[places] - context.ego.vy[0]
    closer = aside[0] * drifts[0] + aside[1] * drifts[1] < 0
    across = np.abs(np.cos(tracks.heading[places] - context.ego.heading[0]))
    across_way = across < np.cos(np.radians(limits.turned_deg))
    near = np.hypot(*aside) < limits.approach_m
    found: Flags = np.logical_or.reduce(called & closer & across_way & near)
    return found


def _drives(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Flags of those who drive now, or have or will within ``preparing_s``: no more than held up.

    Of these rows. One that stands for longer, lights on, may be where it was called to.
    """
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    return context.spans.within(moves(context)[rows], steps, around=True)


def _is_silent(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Flags of those of these rows whose horn the recording tells, and which do not sound it."""
    horn, told = (flags[rows] for flags in lit_lamps(context, "horn"))
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    silent: Flags = told & ~context.spans.within(horn, steps, around=True)
    return silent


called_signals = SignalPasses(
    {
        ("emergency_vehicle_near",): _emergency_vehicle_near,
        ("on_call",): _called,
        ("way_cleared",): _way_cleared,
    }
)
"""The signals of emergency vehicles on call."""
