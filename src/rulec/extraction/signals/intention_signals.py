"""Signals of what others show and do next: turning off, leaving a stop, being on call.

What somebody was about to do is known from what it did. Whether it has signalled is known where the
recording has its lamps; elsewhere who does what it should have signalled first is unknown.
"""

from __future__ import annotations

import numpy as np

from rulec.extraction.drive_context import KMH, DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.tracks import Flags
from rulec.recordings.recording import Lamp

_PUBLIC = ("bus", "rail_vehicle")
_FLASH_S = 1.0
"""Lights that flash are on if they are lit within so long."""


def intention_signals(context: DriveContext) -> SignalColumns:
    """The signals of others' lamps and doors, and of what they are about to do."""
    stands = context.tracks.speed * KMH < context.thresholds.standing_kmh
    public = np.any([context.tracks.of_type(kind) for kind in _PUBLIC], axis=0)[:, None]
    doors, doors_told = _lit(context, "doors")
    hazard, hazard_told = _lit(context, "hazard_lights")
    blue, blue_told = _lit(context, "blue_light")
    blue = _flashing(blue, context)
    called = context.tracks.of_type("emergency_vehicle")[:, None]
    kinds = np.array([body.type == "unknown" for body in context.tracks.participants], dtype=bool)
    not_told = (called & ~blue_told & ~blue) | kinds[:, None]
    near, needs_way = context.relevant & _comes_near(context), _drives(context, stands)
    comes: Flags = np.any(near & called & blue & needs_way, axis=0)
    perhaps = np.any(near & (not_told | (called & blue & ~needs_way)), axis=0)
    signals = SignalColumns(
        {"emergency_vehicle_near": comes},
        {
            "boarding": public & stands & doors,
            "on_call": called & blue,
            "leaving_stop": np.zeros_like(stands),
        },
        {
            "boarding": public & stands & ~doors_told,
            "on_call": not_told,
            "emergency_vehicle_near": perhaps & ~comes,
        },
    )
    if any("hazard_lights" in body.shows for body in context.recording.participants):
        warns = hazard | blue
        signals |= SignalColumns(
            about={"warning_lights": warns}, unknown={"warning_lights": ~hazard_told & ~warns}
        )
    signals |= _turning(context) | _leaving(context, stands)
    return signals | _overtaking_soon(context) | _came_up(context)


def _lit(context: DriveContext, lamp: Lamp) -> tuple[Flags, Flags]:
    """Flags of participants whose lamp is lit, and of those of which the recording tells."""
    begins, states = context.first_step, context.states
    lit, told = np.zeros((2, len(context.tracks.participants), states), dtype=bool)
    for row, body in enumerate(context.tracks.participants):
        if lamp in body.shows:
            for step, lamps in body.lamps.items():
                if begins <= step < begins + states:
                    told[row, step - begins], lit[row, step - begins] = True, lamp in lamps
    return lit, told


def _flashing(lit: Flags, context: DriveContext) -> Flags:
    return _within(lit, round(_FLASH_S / context.recording.step_s), around=True)


def _within(flags: Flags, steps: int, *, around: bool = False) -> Flags:
    """Flags that hold at a state or at most ``steps`` states later, or also earlier."""
    count = flags.shape[-1]
    sums = np.concatenate(
        (np.zeros((*flags.shape[:-1], 1), dtype=int), np.cumsum(flags, axis=-1)), axis=-1
    )
    states = np.arange(count)
    after = np.minimum(states + steps + 1, count)
    before = np.maximum(states - steps, 0) if around else states
    within: Flags = sums[..., after] > sums[..., before]
    return within


def _comes_near(context: DriveContext) -> Flags:
    """Flags of those who are behind or beside ego, or come towards it on its carriageway.

    One that has come towards ego and is past it drives away.
    """
    station = relations.station(context)
    against = context.extents.along * KMH < -context.thresholds.standing_kmh
    pieces, lanes = context.road.piece(context.ego_extents.s[0]).tolist(), context.ego_lane.tolist()
    own = [context.road.lanelet(*pair) for pair in zip(pieces, lanes, strict=True)]
    divided = [context.surroundings.directions(lanelet)[1] is True for lanelet in own]
    towards = against & (station != relations.IN_FRONT_OF) & ~np.array(divided)
    comes: Flags = towards | (~against & (station != relations.BEHIND))
    return comes


def _drives(context: DriveContext, stands: Flags) -> Flags:
    """Flags of those who drive now, or have or will within ``preparing_s``: no more than held up.

    One that stands for longer, lights on, may be where it was called to.
    """
    moves = ~stands & ~np.isnan(context.tracks.speed)
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    return _within(moves, steps, around=True)


def _far_indicator(context: DriveContext) -> tuple[Flags, Flags]:
    return _lit(context, "left_indicator" if context.side == "right" else "right_indicator")


def _turning(context: DriveContext) -> SignalColumns:
    """The signal of those who have signalled to turn to the far side, and do."""
    passages = context.surroundings.passages
    shift = context.first_step - passages.tracks.first
    ahead = round(context.thresholds.preparing_s / context.recording.step_s)
    towards = 1 if context.side == "right" else -1
    least = np.radians(context.thresholds.turned_deg)
    shape = len(context.tracks.participants), context.states
    turns, open_end = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    rows = {body.id: row for row, body in enumerate(passages.tracks.participants)}
    for row, body in enumerate(context.tracks.participants):
        for passage in passages.of_row.get(rows[body.id], ()):
            first, last = passage.first - shift - ahead, passage.last - shift
            span = slice(max(first, 0), max(last + 1, 0))
            angle = passages.way(passage).turned * towards
            if not passage.sure:
                open_end[row, span] = True
            elif least < angle < np.pi - least:
                turns[row, span] = True
        if passages.junctions and not body.standing:
            end = int(np.flatnonzero(passages.tracks.present[rows[body.id]])[-1]) - shift
            open_end[row, max(end - ahead, 0) :] |= _may_turn(context, rows[body.id])
    lit, told = _far_indicator(context)
    turns &= context.tracks.of_type("vehicle")[:, None]
    if "arrivals" not in context.recording.complete:
        # Who signals and leaves the map may turn beyond it
        open_end |= lit & _ends_within(context, ahead)
    return SignalColumns(
        about={"turning_far": turns & lit},
        unknown={"turning_far": np.where(told, lit & open_end & ~turns, turns | open_end)},
    )


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


def _leaving(context: DriveContext, stands: Flags) -> SignalColumns:
    """The signal of buses that stand at a stop, signal to leave it, and do so soon."""
    buses = context.tracks.of_type("bus")[:, None]
    steps = round(context.thresholds.preparing_s / context.recording.step_s)
    leaves = buses & stands & _within(~stands & ~np.isnan(context.tracks.speed), steps)
    lit, told = _far_indicator(context)
    doors, doors_told = _lit(context, "doors")
    at_stop = _within(doors[:, ::-1], steps)[:, ::-1]
    known = told & doors_told
    # What it does after it is lost from sight nobody knows
    lost = buses & stands & lit & at_stop & _ends_within(context, steps)
    return SignalColumns(
        about={"leaving_stop": leaves & lit & at_stop},
        unknown={"leaving_stop": (leaves & ~known) | (lost & ~leaves)},
    )


def _ends_within(context: DriveContext, steps: int) -> Flags:
    """Flags of states in which a participant's track goes on for fewer states than so many."""
    states = np.arange(context.states)
    present = ~np.isnan(context.tracks.speed)
    last = np.where(present, states, -1).max(axis=1, initial=-1)
    ends: Flags = states + steps > last[:, None]
    return ends


def _overtaking_soon(context: DriveContext) -> SignalColumns:
    """The signal of those who have signalled to pull out to the far side, and do so soon."""
    far = 1 if context.side == "right" else -1
    lane = context.extents.lane
    steps = round(context.thresholds.signalling_s / context.recording.step_s)
    inside = context.touched.any(axis=-1)
    pulls_out = np.diff(lane, axis=1, append=lane[:, -1:]) * far > 0
    pulls_out &= inside & np.roll(inside, -1, axis=1)
    soon = context.going_along & _within(pulls_out, steps)
    lit, told = _far_indicator(context)
    ends = _ends_within(context, steps)
    return SignalColumns(
        about={"about_to_overtake": soon & lit},
        unknown={"about_to_overtake": np.where(told, lit & ends & ~soon, soon)},
    )


def _came_up(context: DriveContext) -> SignalColumns:
    """The signal of riders who came up beside ego while it waited at a junction.

    Of one that is beside it there when it is first seen nobody knows how it got there.
    """
    riders = context.tracks.of_type("light_rider")
    station = relations.station(context)
    waits = context.ego.speed[0] * KMH < context.thresholds.standing_kmh
    at_junction = np.zeros(context.states, dtype=bool)
    front = context.ego_extents.s_max[0]
    for start, end in context.road.junctions:
        at_junction |= (front >= start - context.thresholds.approach_m) & (front < end)
    came, unsure = np.zeros((2, *station.shape), dtype=bool)
    there = ~np.isnan(context.extents.s_min)
    for row in np.flatnonzero(riders).tolist():
        for state in range(context.states):
            if not there[row, state] or station[row, state] != relations.BESIDE:
                continue
            seen = state > 0 and there[row, state - 1]
            before = seen and station[row, state - 1] == relations.IN_FRONT_OF
            arrives = before and waits[state] and at_junction[state]
            came[row, state] = arrives or (seen and came[row, state - 1])
            appears = not seen and at_junction[state]
            unsure[row, state] = appears or (seen and unsure[row, state - 1])
    return SignalColumns(
        about={"came_up_beside": came},
        unknown={"came_up_beside": unsure},
        only={"came_up_beside": riders},
    )
