"""Signals of what others show and do next: turning off, leaving a stop, overtaking.

What a participant was about to do is known from what it did. Whether it signalled is known if its
lamps are recorded; otherwise it is unknown for those that do what they should have signalled.
"""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.computed_once import once, once_a_recording
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.others_lamps import (
    flashing,
    lit_lamps,
    own_part,
)
from rulec.extraction.signals.ego_lanelets import those_on_lanes
from rulec.extraction.signals.signal_columns import OfObjects
from rulec.extraction.signals.words import word, word_of_objects
from rulec.extraction.tracks.driven_road import reach_into
from rulec.recordings.recording import JOINING
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth

_PUBLIC = ("bus", "rail_vehicle")


@word_of_objects("boarding")
def _boarding(context: DriveContext) -> Truth:
    public = np.any([context.tracks.of_type(kind) for kind in _PUBLIC], axis=0)[:, None]
    if not public.any():
        nobody = np.zeros(context.relevant.shape, dtype=bool)
        return Truth.known(nobody).unknown_at(nobody)
    stops = public & context.standing
    doors, told = _open_doors(context)
    doors &= ~_doors_away(context)
    return Truth.known(stops & doors).unknown_at(stops & ~told)


def _open_doors(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks of participants with doors open on any side, and of those of which that is recorded."""
    of_sides = [lit_lamps(context, lamp) for lamp in ("doors", "left_doors", "right_doors")]
    is_open, told = (np.any(flags, axis=0) for flags in zip(*of_sides, strict=True))
    return is_open, told


def _doors_away(context: DriveContext) -> Flags:
    """Mask of participants beside ego whose doors on its side are known to be shut."""
    beside = relations.station(context) == relations.BESIDE
    ego_at_right = relations.lateral(context) == relations.RIGHT_OF
    ego_at_left = relations.lateral(context) == relations.LEFT_OF
    (left, told), (right, _) = (lit_lamps(context, lamp) for lamp in ("left_doors", "right_doors"))
    # Who comes towards ego has it at its own other side
    against = np.abs(context.extents.turned) > np.pi / 2
    left, right = np.where(against, right, left), np.where(against, left, right)
    away: Flags = told & beside & ((ego_at_right & ~right) | (ego_at_left & ~left))
    return away


@word_of_objects("warning_lights")
def _warning_lights(context: DriveContext) -> Truth | None:
    if "hazard_lights" not in context.surroundings.whole.shows:
        return None
    hazard, told = lit_lamps(context, "hazard_lights")
    blue, _ = lit_lamps(context, "blue_light")
    warns = hazard | flashing(blue, context)
    return Truth(warns, warns | ~told)


def may_have_broken_down(context: DriveContext) -> Flags:
    """Mask of participants that stand with both indicators or the hazard lights flashing.

    They may as well stand because of traffic, or warn of the end of a jam.
    """
    still = context.standing
    if not still.any():
        return still
    left, right, hazard = (
        lit_lamps(context, lamp)[0]
        for lamp in ("left_indicator", "right_indicator", "hazard_lights")
    )
    both = flashing(left, context) & flashing(right, context)
    warns: Flags = still & (both | flashing(hazard, context))
    return warns


@word_of_objects("hazard_lights")
def _hazard_lights(context: DriveContext) -> Truth | None:
    if "hazard_lights" not in context.surroundings.whole.shows:
        return None
    hazard, told = lit_lamps(context, "hazard_lights")
    return Truth(hazard, hazard | ~told)


def _far_indicator(context: DriveContext) -> tuple[Flags, Flags]:
    return lit_lamps(context, "left_indicator" if context.side == "right" else "right_indicator")


@word_of_objects("turning_far")
def _turning_far(context: DriveContext) -> Truth:
    """The signal of vehicles that have signalled to turn to the far side, and do.

    However long they wait for it with the indicator on.
    """
    turns, open_end = (own_part(context, flags) for flags in _turns(context))
    lit, told = _far_indicator(context)
    if lit.any():
        turns |= _lit_until(context, turns & lit, lit)
        seen_last = _ends_within(context, 1)
        if "arrivals" not in context.recording.complete:
            # A vehicle that signals and leaves the map may turn beyond it
            ahead = context.steps_in(context.thresholds.preparing_s)
            open_end |= lit & _ends_within(context, ahead)
        else:
            seen_last &= context.spans.columns == context.spans.end - 1
        drives = context.tracks.of_type("vehicle")[:, None]
        open_end |= drives & _lit_until(context, seen_last, lit)
    return Truth.known(turns & lit).unknown_at(
        np.where(told, lit & open_end & ~turns, turns | open_end)
    )


def _lit_until(context: DriveContext, flags: Flags, lit: Flags) -> Flags:
    """Mask of states from which an indicator stays lit until a flagged state."""
    spans, rows = context.spans, lit.any(axis=1).nonzero()[0]
    lasts, lit = np.zeros_like(lit), lit[rows]
    until = spans.next_state(flags[rows] & lit)
    lasts[rows] = lit & (until < spans.next_state(~lit))
    return lasts


@once_a_recording
def _turns(context: DriveContext) -> tuple[Flags, Flags]:
    """Masks of vehicles that turn to the far side soon, and of participants that perhaps do.

    For all participants of the recording, in all its steps.
    """
    passages = context.surroundings.passages
    ahead = context.steps_in(context.thresholds.preparing_s)
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
            end = int(passages.tracks.present[row].nonzero()[0][-1])
            open_end[row, max(end - ahead, 0) :] |= _may_turn(context, row)
    return turns & passages.tracks.of_type("vehicle")[:, None], open_end


def _may_turn(context: DriveContext, row: int) -> bool:
    """Whether a participant's track ends near a junction before reaching it."""
    passages = context.surroundings.passages
    end = int(passages.tracks.present[row].nonzero()[0][-1])
    x, y, heading = (
        float(values[row, end])
        for values in (passages.tracks.x, passages.tracks.y, passages.tracks.heading)
    )
    reach = context.thresholds.approach_m
    ahead = x + reach * np.cos(heading), y + reach * np.sin(heading)
    inside = any(passage.last >= end for passage in passages.of_row.get(row, ()))
    return not inside and passages.crosses_junction((x, y), ahead)


@word_of_objects("leaving_stop")
def _leaving_stop(context: DriveContext) -> Truth:
    """The signal of buses that stand at a stop, signal to leave it, and do so soon."""
    leaves, doubtful = np.zeros((2, *context.relevant.shape), dtype=bool)
    buses = context.tracks.of_type("bus").nonzero()[0]
    if len(buses):
        leaves[buses], doubtful[buses] = _buses_leave(context, buses)
    return Truth.known(leaves).unknown_at(doubtful)


def _buses_leave(context: DriveContext, buses: NDArray[intp]) -> tuple[Flags, Flags]:
    """Masks, one row per bus, of those that leave a stop and of those for which it is unknown."""
    steps = context.steps_in(context.thresholds.preparing_s)
    still = context.standing[buses]
    leaves = still & context.spans.within(context.moving[buses], steps)
    lit, told = (flags[buses] for flags in _far_indicator(context))
    doors, doors_told = (flags[buses] for flags in _open_doors(context))
    at_stop = context.spans.within_last(doors, steps)
    known = told & doors_told
    # What a bus does after it is lost from sight is unknown
    lost = still & lit & at_stop & _ends_within(context, steps)[buses]
    known &= _could_wait(context, buses, still & lit & at_stop)
    return leaves & lit & at_stop, (leaves & ~known) | (lost & ~leaves)


def _could_wait(context: DriveContext, buses: NDArray[intp], signals: Flags) -> Flags:
    """Mask of buses that ego could still stop behind, in comfort, when they began to signal.

    Or when its drive began, if they signalled before. Whoever is nearer need not brake hard.
    """
    limits, speed, spans = context.thresholds, context.ego.speed[0], context.spans
    needed = limits.reaction_s * speed + speed**2 / (2 * limits.disturbing_mps2)
    begins = signals & (~spans.before(signals) | spans.begins_here)
    too_near = begins & (relations.gap(context)[buses] < needed)
    could: Flags = spans.latest(too_near) < spans.latest(begins)
    return could | ~signals


def _ends_within(context: DriveContext, steps: int) -> Flags:
    """Mask of states in which a participant's track ends fewer than ``steps`` states later."""
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


@word_of_objects("about_to_overtake")
def _about_to_overtake(context: DriveContext) -> Truth:
    """The signal of vehicles that have signalled to pull out to the far side, and do so soon.

    A vehicle on a lane that joins others has to leave it, and overtakes nobody by that. Unknown for
    vehicles that ego does not catch up with: they change lanes one after the other.
    """
    far = 1 if context.side == "right" else -1
    steps = context.steps_in(context.thresholds.signalling_s)
    onward = context.extents.lane_steps
    pulls_out = onward > 0 if far > 0 else onward < 0
    pulls_out[:, context.spans.end[context.spans.begins] - 1] = False
    rows = pulls_out.any(axis=1).nonzero()[0]
    lit, told = _far_indicator(context)
    if not len(rows) and not lit.any():
        return Truth.known(lit).unknown_at(lit)
    inside = context.on_lanes[rows]
    pulls_out[rows] &= inside & context.spans.after(inside)
    soon = np.zeros_like(pulls_out)
    soon[rows] = context.going_along[rows] & context.spans.within(pulls_out[rows], steps)
    soon &= ~those_on_lanes(context, JOINING, soon)
    doubtful, asked = soon.copy(), Cells.at(soon & told)
    np.put(doubtful, asked.places, ~_caught_up(context, asked))
    if lit.any():
        lost = told & lit & _ends_within(context, steps) & ~soon
        doubtful |= lost & ~those_on_lanes(context, JOINING, lost)
    return Truth.known(soon & lit).unknown_at(doubtful)


def _caught_up(context: DriveContext, cells: Cells) -> Flags:
    """Mask of cells of vehicles that ego reaches within ``catching_up_s`` at both speeds."""
    faster_mps = cells.of(context.ego_extents.along[0]) - cells.of(context.extents.along)
    caught_up: Flags = (
        cells.of(relations.gap(context)) <= faster_mps * context.thresholds.catching_up_s
    )
    return caught_up


@word("came_up_beside")
def _came_up(context: DriveContext) -> OfObjects:
    """The signal of riders that came up beside ego while it waited at a junction.

    For a rider that is already beside ego when first seen, it is unknown how it got there.
    """
    riders = context.tracks.of_type("light_rider")
    came, unsure = np.zeros((2, *context.relevant.shape), dtype=bool)
    if riders.any():
        came[riders], unsure[riders] = _came_beside(context, riders.nonzero()[0])
    return OfObjects(Truth.known(came).unknown_at(unsure), riders)


def _came_beside(context: DriveContext, rows: NDArray[intp]) -> tuple[Flags, Flags]:
    """Masks of participants in ``rows`` beside ego that came up there, or perhaps did."""
    waits = ~context.ego_moves
    front, approach_m = context.ego_extents.s_max[0], context.thresholds.approach_m
    at_junction = reach_into(context.road.junctions, front, front, approach_m)
    station, there = relations.station(context)[rows], ~np.isnan(context.extents.s_min[rows])
    beside = there & (station == relations.BESIDE)
    behind_ego = there & (station == relations.IN_FRONT_OF)
    spans = context.spans
    # In a drive's first state a participant beside ego is not behind it
    arrives = beside & spans.before(behind_ego) & (waits & at_junction)
    appears = beside & (spans.begins_here | ~spans.before(there)) & at_junction
    left = spans.latest(~beside)
    return spans.latest(arrives) > left, spans.latest(appears) > left
