"""Signals of emergency vehicles on call: which are, whether one is near, whether ego makes way.

Laws differ in what it means to be near and in the way. Only a vehicle that draws near behind ego,
is beside it or comes towards it is surely near; only one in its lane is surely in its way.
"""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.lamp_signals import ego_on_call
from rulec.extraction.signals.conduct.others_lamps import (
    flashing,
    lamps_of_all,
    lit_lamps,
)
from rulec.extraction.signals.ego_lanelets import own_lanelets, room_beside
from rulec.extraction.signals.signal_columns import Caused, ids_by_state
from rulec.extraction.signals.words import word, word_of_objects
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.partly_known.partly_known_values import Truth

_FACES = -0.5
"""Cosine between the directions of ego's road and of a vehicle that comes the other way on it."""


@word("emergency_vehicle_near")
def _emergency_vehicle_near(context: DriveContext) -> Caused:
    """Whether an emergency vehicle on call is near.

    Unknown for one that stands, does not sound a horn that the recording contains, is not beside
    ego soon, or comes on a crossing road, or braked there; and where ego itself is on call.
    """
    on_call, near = _on_call(context).possible, _surely_near(context)
    comes: Flags = np.logical_or.reduce(near)
    possible = comes | _crosses_near(context)
    rows = on_call.any(axis=1).nonzero()[0]
    if len(rows):
        others = context.relevant[rows] & _comes_near(context)[rows]
        possible |= np.logical_or.reduce(others & on_call[rows])
    if comes.any():
        comes &= ~ego_on_call(context).possible
    return Caused(Truth(comes, possible), ids_by_state(near & comes, context.ids))


@once
def _surely_near(context: DriveContext) -> Flags:
    """Mask of vehicles on call that drive and surely come near."""
    found: Flags = np.zeros(context.relevant.shape, dtype=bool)
    on_call = _on_call(context).sure
    rows = on_call.any(axis=1).nonzero()[0]
    if len(rows):
        needs_way = _drives(context, rows) & ~_is_silent(context, rows)
        near = context.relevant[rows] & on_call[rows] & needs_way
        found[rows] = near & _comes_near(context)[rows] & ~_is_far(context)[rows]
    return found


@word("way_cleared")
def _way_cleared(context: DriveContext) -> Flags | Truth:
    """Whether ego stands, or is at an edge of its lane.

    Unknown where the vehicles that are near have another lane or are clear of ego sideways: they
    get past, and laws may still want ego at the edge.
    """
    still = ~context.ego_moves
    cleared = still | _at_edge(context)
    near = _surely_near(context)
    if not near.any():
        return cleared
    clear = relations.way_across(context)
    in_way = near & context.in_ego_lane & (clear < context.thresholds.touching_m)
    in_way |= near & (clear < 0)
    return Truth(cleared, cleared | near.any(axis=0) & ~in_way.any(axis=0))


def _at_edge(context: DriveContext) -> Flags:
    (right, left), edge = room_beside(context), context.thresholds.at_edge_m
    return (np.minimum(right, left) < edge) & (np.abs(right - left) > edge)


@word_of_objects("on_call")
@once
def _on_call(context: DriveContext) -> Truth:
    """Which are emergency vehicles with their blue lights on; unknown of unknown vehicles."""
    called = context.tracks.of_type("emergency_vehicle")[:, None]
    kinds = np.array([body.type == "unknown" for body in context.tracks.participants], dtype=bool)
    if not called.any():
        nobody = np.zeros(context.relevant.shape, dtype=bool)
        return Truth(nobody, nobody | kinds[:, None])
    blue, told = lit_lamps(context, "blue_light")
    blue = flashing(blue, context)
    return (called & Truth(blue, blue | ~told)).unknown_at(kinds[:, None])


def _comes_near(context: DriveContext) -> Flags:
    """Mask of vehicles behind or beside ego, or coming towards it on its carriageway.

    An oncoming vehicle that is past ego drives away, even while it waits at lights there.
    """
    station, against = relations.station(context), _against(context)
    directions = context.surroundings.directions
    divided = own_lanelets(context).flags(lambda lanelet: directions(lanelet.id)[1] is True)
    towards = against & (station != relations.IN_FRONT_OF) & ~divided
    comes: Flags = towards | (~against & (station != relations.BEHIND))
    return comes


def _against(context: DriveContext) -> Flags:
    along, faces = context.extents.along, np.cos(context.extents.turned) < _FACES
    against: Flags = np.where(
        context.standing, faces, along * KMH_PER_MPS < -context.thresholds.standing_kmh
    )
    return against


def _is_far(context: DriveContext) -> Flags:
    """Mask of vehicles behind or coming towards ego that do not need its way at once.

    They are farther than at ``queue_headway_s``, as if held up, and would not be beside ego within
    ``parting_s``, before a change of lanes is over; those that come towards ego, and may wait at
    lights, are also farther than ``approach_m``.
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
    """Mask of states in which an emergency vehicle draws near on a crossing road, or braked there.

    Whether it then needs ego's way is unknown: its road may be a crossing's, or a bridge's. If it
    brakes hard as it draws near, or just after that, it may have been held up by ego, which need
    not be near any more when it waits.
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
    near = called & across_way & (np.hypot(*aside) < limits.approach_m)
    shortly, long = (context.steps_in(seconds) for seconds in (limits.passed_s, limits.preparing_s))
    brakes = tracks.acceleration[places] < -limits.disturbing_mps2
    held_up = near & brakes & context.spans.within_last(near & closer, shortly)
    found: Flags = np.logical_or.reduce(near & closer)
    found |= context.spans.within_last(np.logical_or.reduce(held_up), long)
    return found


def _drives(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask, for ``rows``, of vehicles that move within ``preparing_s``: at most held up.

    Before or after. One that stands for longer with its lights on may be where it was called to.
    """
    steps = context.steps_in(context.thresholds.preparing_s)
    return context.spans.within(context.moving[rows], steps, around=True)


def _is_silent(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask, for ``rows``, of vehicles that do not sound their horn, where it is recorded."""
    horn, told = (flags[rows] for flags in lit_lamps(context, "horn"))
    steps = context.steps_in(context.thresholds.preparing_s)
    silent: Flags = told & ~context.spans.within(horn, steps, around=True)
    return silent
