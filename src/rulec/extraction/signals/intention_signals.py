"""Signals of what others show and do next: turning off, leaving a stop, being on call.

What somebody was about to do is known from what it did. Whether it has signalled is known where the
recording has its lamps; elsewhere who does what it should have signalled first is unknown.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import KMH, DriveContext, once
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.lamp_signals import FLASH_S
from rulec.extraction.signals.ego_lanelets import own_lanelets
from rulec.extraction.signals.signal_columns import SignalColumns, SignalNames
from rulec.extraction.signals.signal_passes import (
    Passes,
    once_a_recording,
    signals_by,
)
from rulec.extraction.tracks.tracks import Flags
from rulec.recordings.recording import JOINING, Lamp

_PUBLIC = ("bus", "rail_vehicle")

_FACES = -0.5
"""The cosine between the directions of ego's road and of one who has come the other way on it."""


def intention_signals(context: DriveContext, names: SignalNames = None) -> SignalColumns:
    """The signals of others' lamps and doors, and of what they are about to do."""
    return signals_by(_PASSES, context, names)


def _emergency_vehicle_near(context: DriveContext) -> SignalColumns:
    """Whether one on call is near; unknown of one that stands, or does not sound a told horn."""
    on_call, not_told = _on_call(context)
    rows = np.flatnonzero((on_call | not_told).any(axis=1))
    comes, perhaps = np.zeros((2, context.states), dtype=bool)
    if len(rows):
        near = context.relevant[rows] & _comes_near(context)[rows]
        needs_way = _drives(context, rows) & ~_is_silent(context, rows)
        comes = np.any(near & on_call[rows] & needs_way, axis=0)
        perhaps = np.any(near & (not_told[rows] | (on_call[rows] & ~needs_way)), axis=0)
    return SignalColumns(
        {"emergency_vehicle_near": comes}, unknown={"emergency_vehicle_near": perhaps & ~comes}
    )


def _called(context: DriveContext) -> SignalColumns:
    on_call, not_told = _on_call(context)
    return SignalColumns(about={"on_call": on_call}, unknown={"on_call": not_told})


@once
def _on_call(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of emergency vehicles with their blue lights on, and of those that perhaps are that."""
    called = context.tracks.of_type("emergency_vehicle")[:, None]
    kinds = np.array([body.type == "unknown" for body in context.tracks.participants], dtype=bool)
    blue, told = _lit(context, "blue_light")
    blue = _flashing(blue, context)
    return called & blue, (called & ~told & ~blue) | kinds[:, None]


def _boarding(context: DriveContext) -> SignalColumns:
    public = np.any([context.tracks.of_type(kind) for kind in _PUBLIC], axis=0)[:, None]
    stops = public & _stands(context)
    doors, told = _lit(context, "doors")
    return SignalColumns(about={"boarding": stops & doors}, unknown={"boarding": stops & ~told})


def _warning_lights(context: DriveContext) -> SignalColumns:
    if "hazard_lights" not in context.surroundings.whole.shows:
        return SignalColumns()
    hazard, told = _lit(context, "hazard_lights")
    blue, _ = _lit(context, "blue_light")
    warns = hazard | _flashing(blue, context)
    return SignalColumns(
        about={"warning_lights": warns}, unknown={"warning_lights": ~told & ~warns}
    )


def may_have_broken_down(context: DriveContext) -> Flags:
    """Flags of those who stand with the indicators of both sides lit, or with hazard lights.

    Nobody knows whether they do not stand for the traffic, or warn of the end of a jam.
    """
    left, right, hazard = (
        _lit(context, lamp)[0] for lamp in ("left_indicator", "right_indicator", "hazard_lights")
    )
    both = _flashing(left, context) & _flashing(right, context)
    warns: Flags = _stands(context) & (both | _flashing(hazard, context))
    return warns


def _hazard_lights(context: DriveContext) -> SignalColumns:
    if "hazard_lights" not in context.surroundings.whole.shows:
        return SignalColumns()
    hazard, told = _lit(context, "hazard_lights")
    return SignalColumns(
        about={"hazard_lights": hazard}, unknown={"hazard_lights": ~told & ~hazard}
    )


def _stands(context: DriveContext) -> Flags:
    stands: Flags = context.tracks.speed * KMH < context.thresholds.standing_kmh
    return stands


@once_a_recording
def _lamps(context: DriveContext) -> Mapping[Lamp, tuple[Flags, Flags]]:
    """Flags of participants of the whole recording whose lamp is lit, and of which it tells."""
    tracks = context.surroundings.tracks
    flags: dict[Lamp, tuple[Flags, Flags]] = {}
    for row, body in enumerate(tracks.participants):
        steps = np.fromiter(body.lamps, dtype=int, count=len(body.lamps)) - tracks.first
        inside = (steps >= 0) & (steps < tracks.present.shape[1])
        for lamp in body.shows if inside.any() else ():
            if lamp not in flags:
                flags[lamp] = np.zeros_like(tracks.present), np.zeros_like(tracks.present)
            lit, told = flags[lamp]
            told[row, steps[inside]] = True
            shown = np.array([lamp in lamps for lamps in body.lamps.values()], dtype=bool)
            lit[row, steps[inside]] = shown[inside]
    return flags


def _own_part(context: DriveContext, flags: Flags) -> Flags:
    """The drive's rows and columns of flags of the whole recording."""
    return flags.take(context.tracks.rows, axis=0).take(context.columns, axis=1)


def _lit(context: DriveContext, lamp: Lamp) -> tuple[Flags, Flags]:
    """Flags of participants whose lamp is lit, and of those of which the recording tells."""
    if lamp not in _lamps(context):
        return np.zeros_like(context.relevant), np.zeros_like(context.relevant)
    lit, told = _lamps(context)[lamp]
    return _own_part(context, lit), _own_part(context, told)


def _flashing(lit: Flags, context: DriveContext) -> Flags:
    return context.spans.within(lit, round(FLASH_S / context.recording.step_s), around=True)


def _comes_near(context: DriveContext) -> Flags:
    """Flags of those who are behind or beside ego, or come towards it on its carriageway.

    One that has come towards ego and is past it drives away, also while it waits at lights there.
    """
    station = relations.station(context)
    along, faces = context.extents.along, np.cos(context.extents.turned) < _FACES
    against = np.where(_stands(context), faces, along * KMH < -context.thresholds.standing_kmh)
    directions = context.surroundings.directions
    divided = own_lanelets(context).flags(lambda lanelet: directions(lanelet)[1] is True)
    towards = against & (station != relations.IN_FRONT_OF) & ~divided
    comes: Flags = towards | (~against & (station != relations.BEHIND))
    return comes


def _drives(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Flags of those who drive now, or have or will within ``preparing_s``: no more than held up.

    Of these rows. One that stands for longer, lights on, may be where it was called to.
    """
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    return context.spans.within(_moves(context)[rows], steps, around=True)


def _is_silent(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Flags of those of these rows whose horn the recording tells, and which do not sound it."""
    horn, told = (flags[rows] for flags in _lit(context, "horn"))
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    silent: Flags = told & ~context.spans.within(horn, steps, around=True)
    return silent


def _moves(context: DriveContext) -> Flags:
    moves: Flags = context.tracks.speed * KMH >= context.thresholds.standing_kmh
    return moves


def _far_indicator(context: DriveContext) -> tuple[Flags, Flags]:
    return _lit(context, "left_indicator" if context.side == "right" else "right_indicator")


def _turning_far(context: DriveContext) -> SignalColumns:
    """The signal of those who have signalled to turn to the far side, and do."""
    turns, open_end = (_own_part(context, flags) for flags in _turns(context))
    lit, told = _far_indicator(context)
    if "arrivals" not in context.recording.complete:
        # Who signals and leaves the map may turn beyond it
        ahead = round(context.thresholds.preparing_s / context.recording.step_s)
        open_end |= lit & _ends_within(context, ahead)
    return SignalColumns(
        about={"turning_far": turns & lit},
        unknown={"turning_far": np.where(told, lit & open_end & ~turns, turns | open_end)},
    )


@once_a_recording
def _turns(context: DriveContext) -> tuple[Flags, Flags]:
    """Flags of vehicles that turn to the far side soon, and of participants that perhaps do.

    Of all participants of the recording, in all its steps.
    """
    passages = context.surroundings.passages
    ahead = round(context.thresholds.preparing_s / context.recording.step_s)
    towards = 1 if context.side == "right" else -1
    least = np.radians(context.thresholds.turned_deg)
    turns, open_end = np.zeros((2, *passages.tracks.present.shape), dtype=bool)
    for row, own in passages.of_row.items():
        for passage in own:
            span = slice(max(passage.first - ahead, 0), passage.last + 1)
            angle = passages.way(passage).turned * towards
            if not passage.sure:
                open_end[row, span] = True
            elif least < angle < np.pi - least:
                turns[row, span] = True
    for row, body in enumerate(passages.tracks.participants):
        if passages.junctions and not body.standing:
            end = int(np.flatnonzero(passages.tracks.present[row])[-1])
            open_end[row, max(end - ahead, 0) :] |= _may_turn(context, row)
    return turns & passages.tracks.of_type("vehicle")[:, None], open_end


def _may_turn(context: DriveContext, row: int) -> bool:
    """True if a participant's track ends near a junction that it has not come to."""
    passages = context.surroundings.passages
    end = int(np.flatnonzero(passages.tracks.present[row])[-1])
    x, y, heading = (
        float(values[row, end])
        for values in (passages.tracks.x, passages.tracks.y, passages.tracks.heading)
    )
    reach = context.thresholds.approach_m
    ahead = x + reach * np.cos(heading), y + reach * np.sin(heading)
    inside = any(passage.last >= end for passage in passages.of_row.get(row, ()))
    return not inside and passages.crosses_junction((x, y), ahead)


def _leaving_stop(context: DriveContext) -> SignalColumns:
    """The signal of buses that stand at a stop, signal to leave it, and do so soon."""
    leaves, unknown = np.zeros((2, *context.relevant.shape), dtype=bool)
    buses = np.flatnonzero(context.tracks.of_type("bus"))
    if len(buses):
        leaves[buses], unknown[buses] = _buses_leave(context, buses)
    return SignalColumns(about={"leaving_stop": leaves}, unknown={"leaving_stop": unknown})


def _buses_leave(context: DriveContext, buses: NDArray[intp]) -> tuple[Flags, Flags]:
    """Flags of buses, a row each, that leave a stop, and of those of which nobody knows it."""
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    stands = _stands(context)[buses]
    leaves = stands & context.spans.within(_moves(context)[buses], steps)
    lit, told = (flags[buses] for flags in _far_indicator(context))
    doors, doors_told = (flags[buses] for flags in _lit(context, "doors"))
    at_stop = context.spans.within_last(doors, steps)
    known = told & doors_told
    # What it does after it is lost from sight nobody knows
    lost = stands & lit & at_stop & _ends_within(context, steps)[buses]
    return leaves & lit & at_stop, (leaves & ~known) | (lost & ~leaves)


def _ends_within(context: DriveContext, steps: int) -> Flags:
    """Flags of states in which a participant's track goes on for fewer states than so many."""
    ends: Flags = context.spans.columns + steps > context.spans.spread(_last_seen(context))
    return ends


@once
def _last_seen(context: DriveContext) -> NDArray[intp]:
    """The last state of each participant's track in each drive; the one before it for none."""
    spans = context.spans
    present = ~np.isnan(context.tracks.speed)
    seen = np.where(present, spans.columns, spans.first - 1)
    last: NDArray[intp] = np.maximum.reduceat(seen, spans.begins, axis=-1)
    return last


def _about_to_overtake(context: DriveContext) -> SignalColumns:
    """The signal of those who have signalled to pull out to the far side, and do so soon.

    Who is on a lane that joins others has to leave it, and overtakes nobody by that. Unknown of one
    that ego does not catch up with: they change lanes one after the other, and do not overtake.
    """
    far, lane = (1 if context.side == "right" else -1), context.extents.lane
    steps = round(context.thresholds.signalling_s / context.recording.step_s)
    onward = context.extents.lane_steps
    pulls_out = onward > 0 if far > 0 else onward < 0
    pulls_out[:, context.spans.end[context.spans.begins] - 1] = False
    rows = np.flatnonzero(pulls_out.any(axis=1))
    inside = context.on_lanes[rows]
    pulls_out[rows] &= inside & context.spans.after(inside)
    soon = np.zeros_like(pulls_out)
    soon[rows] = context.going_along[rows] & context.spans.within(pulls_out[rows], steps)
    joining = np.array(
        [[x is not None and JOINING in x.types for x in row] for row in context.road.rows]
    )
    joins: Flags | np.bool_ = np.False_
    if joining.any():
        joins = joining[context.road.piece(np.nan_to_num(context.extents.s)), lane]
        soon &= ~joins
    lit, told = _far_indicator(context)
    ends = _ends_within(context, steps)
    not_caught_up = soon & ~_caught_up(context)
    return SignalColumns(
        about={"about_to_overtake": soon & lit},
        unknown={
            "about_to_overtake": np.where(told, lit & ends & ~soon & ~joins, soon) | not_caught_up
        },
    )


def _caught_up(context: DriveContext) -> Flags:
    """Flags of those whom ego would be beside within ``catching_up_s``, at the speeds of both."""
    faster_mps = context.ego_extents.along - context.extents.along
    caught_up: Flags = relations.gap(context) <= faster_mps * context.thresholds.catching_up_s
    return caught_up


def _came_up(context: DriveContext) -> SignalColumns:
    """The signal of riders who came up beside ego while it waited at a junction.

    Of one that is beside it there when it is first seen nobody knows how it got there.
    """
    riders = context.tracks.of_type("light_rider")
    came, unsure = np.zeros((2, *context.relevant.shape), dtype=bool)
    if riders.any():
        came[riders], unsure[riders] = _came_beside(context, np.flatnonzero(riders))
    return SignalColumns(
        about={"came_up_beside": came},
        unknown={"came_up_beside": unsure},
        only={"came_up_beside": riders},
    )


def _came_beside(context: DriveContext, rows: NDArray[intp]) -> tuple[Flags, Flags]:
    """Flags of participants beside ego, of these rows, who came up there, or perhaps did."""
    waits = context.ego.speed[0] * KMH < context.thresholds.standing_kmh
    at_junction = np.zeros(context.states, dtype=bool)
    front = context.ego_extents.s_max[0]
    for start, end in context.road.junctions:
        at_junction |= (front >= start - context.thresholds.approach_m) & (front < end)
    station, there = relations.station(context)[rows], ~np.isnan(context.extents.s_min[rows])
    beside = there & (station == relations.BESIDE)
    behind_ego = there & (station == relations.IN_FRONT_OF)
    spans = context.spans
    # In a drive's first state who is beside ego is not behind it
    arrives = beside & spans.before(behind_ego) & (waits & at_junction)
    appears = beside & (spans.begins_here | ~spans.before(there)) & at_junction
    left = spans.latest(~beside)
    return spans.latest(arrives) > left, spans.latest(appears) > left


_PASSES: Passes = {
    ("emergency_vehicle_near",): _emergency_vehicle_near,
    ("boarding",): _boarding,
    ("on_call",): _called,
    ("leaving_stop",): _leaving_stop,
    ("warning_lights",): _warning_lights,
    ("hazard_lights",): _hazard_lights,
    ("turning_far",): _turning_far,
    ("about_to_overtake",): _about_to_overtake,
    ("came_up_beside",): _came_up,
}
