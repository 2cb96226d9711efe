"""What on the map may make ego brake, stand or be slow, and what surely does or does not.

A junction or a crossing ahead is a reason only if ego has to let others pass there, or may have to.
It is none if ego goes straight on at a green light or on the road with priority, or has stood there
alone for long. Only nets show that, as they have all lights, signs and traffic.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.conduct.braking_causes.others_around import (
    CROSSES_M,
    others_in,
    without_followers,
)
from rulec.extraction.signals.map.level_crossing_signals import level_crossings
from rulec.extraction.signals.map.line_signals import light_shown, lights_of
from rulec.extraction.signals.map.map_signals import next_crossing
from rulec.extraction.signals.map.stop_lines import has_stop_sign, own_lines
from rulec.extraction.signals.map.zone_signals import crossings_lit
from rulec.extraction.signals.measured_numbers import own_front
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import GIVE_WAY_SIGNS
from rulec.scenario.recorded.reference_line import turn
from rulec.trace.plain_arrays import zero_if_nan

_BEND_RAD, _EVERY_M = np.radians(20.0), 10.0
_SLOWER_KMH = 1.0

MOVES_OFF_S = 5.0
"""A vehicle that has waited gets going within this time (s)."""

LOOKS_S = 3.0
"""A vehicle that has stood this long (s) has checked whether anybody comes."""

_TURNS_MPS = 4.0
"""No vehicle has to be slower than this to turn."""

_SEES_GREEN_S = 1.0
"""A vehicle may still brake for a light this long (s) after it has turned green."""

_GO, _STOP, _UNTOLD = 1, 2, 3
_TELLS = {"green_light": _GO, "red_light": _STOP, "amber_light": _STOP, "no_light": 0}

_HAIR_M = 0.01


@dataclass(frozen=True, eq=False, slots=True)
class MapReasons:
    """Masks of states: the map ``may`` give a reason, and surely ``does``.

    ``freely``: there is a junction or a crossing, and only others could make ego wait there.
    """

    may: Flags
    does: Flags
    freely: Flags


def map_reasons(context: DriveContext, asked: Flags, reach: Floats) -> MapReasons:
    """The map's reasons as far ahead as ego looks; certain only in states ``asked`` for."""
    road, front, rear = context.road, context.ego_extents.s_max[0], context.ego_extents.s_min[0]
    speed, drives = context.ego.speed[0], context.ego_moves
    shown = _lights_ahead(context, asked, reach)
    does = (shown == _STOP) | (asked & _at_stop_sign(context, reach))
    goes_on = asked & (shown <= _GO) & _all_are_recorded(context)
    changed = context.spans.within_last(shown > _GO, context.steps_in(_SEES_GREEN_S))
    may, freely, at_junction = np.zeros((3, context.states), dtype=bool)
    for start, end in road.junctions:
        here = (front >= start - reach) & (rear <= end)
        turned = abs(road.turned(start, end, aside_m=1.0))
        first, lit = _goes_first(context, start)
        lets_go = (shown == _GO) | first | ((front > start) & lit)
        free = here & goes_on & lets_go & (turned <= _BEND_RAD)
        may |= here & ~free
        freely |= free
        at_junction |= here
        if turned > np.radians(context.thresholds.turned_deg):
            does |= here & (front < end) & (speed > _TURNS_MPS)
    alone = _stands_alone(context, at_junction & goes_on & ~drives)
    may &= ~alone
    freely |= alone
    crossing, _ = next_crossing(context)
    at_crossing = crossing - front <= reach
    if at_crossing.any():
        lights = crossings_lit(context)
        untold = np.array([lights.get(start, (True, True))[1] for start in crossing.tolist()])
        free = at_crossing & goes_on & ~untold
        may |= at_crossing & ~free
        freely |= free
    may |= freely & changed
    for start, end in level_crossings(context):
        may |= (front >= start - reach) & (rear <= end)
    # Beyond its map the road is unknown
    may |= (front + reach > road.borders[-1]) | (rear < road.borders[0])
    may |= (
        speed * KMH_PER_MPS > context.limit_mps * KMH_PER_MPS + _SLOWER_KMH
    ) | context.limit_untold
    return MapReasons(may | does, does, freely & ~may)


def _all_are_recorded(context: DriveContext) -> bool:
    return {"arrivals", "light", "YIELD"} <= context.recording.complete


def _goes_first(context: DriveContext, start: float) -> tuple[bool, bool]:
    """Whether no traffic has priority over ego at a junction, and no sign makes it wait.

    And whether it has a light there.
    """
    road = context.road
    before, inside = road.piece(np.array([start - _HAIR_M, start + _HAIR_M])).tolist()
    entry, way = (road.lanelet(piece, road.own_lanes[piece]) for piece in (before, inside))
    first = way.first is not None and not way.first and not entry.signs & GIVE_WAY_SIGNS
    return first, bool(entry.lights)


def _lights_ahead(context: DriveContext, asked: Flags, reach: Floats) -> NDArray[intp]:
    """What the light ahead shows to ego in the states asked for, 0 without one."""
    road, front, recording = context.road, own_front(context), context.recording
    told = np.zeros(context.states, dtype=intp)
    for line in own_lines(context, lambda at: at.lights) if asked.any() else ():
        if lights_of(recording, road, line.piece, line.lane):
            ahead = asked & line.on_lane & (front <= line.last) & (front > line.first - reach)
            shown = light_shown(context, line.piece, line.lane)[ahead]
            told[ahead] = np.select(
                [shown == colour for colour in _TELLS], [*_TELLS.values()], _UNTOLD
            )
    return told


def _at_stop_sign(context: DriveContext, reach: Floats) -> Flags:
    """Mask of states in which ego comes to a stop sign, or has not stood there for long."""
    front, there = own_front(context), np.zeros(context.states, dtype=bool)
    for line in own_lines(context, has_stop_sign):
        there |= line.on_lane & (front <= line.last) & (front > line.first - reach)
    return there & context.spans.within_last(context.ego_moves, context.steps_in(LOOKS_S))


def _stands_alone(context: DriveContext, where: Flags) -> Flags:
    """Mask of states in which ego has stood somewhere for ``MOVES_OFF_S`` and been alone there.

    Nobody was within ``CROSSES_M``, except vehicles that have come up behind ego and wait for it.
    """
    spans, alone = context.spans, np.zeros(context.states, dtype=bool)
    states = np.flatnonzero(where)
    if not len(states):
        return alone
    others = without_followers(context, others_in(context, states))
    about = np.hypot(others.ahead, others.left) <= CROSSES_M
    alone[states] = ~about.any(axis=0)
    steps = context.steps_in(MOVES_OFF_S)
    found: Flags = ~spans.within_last(~alone, steps) & (spans.columns - spans.first >= steps)
    return found


def road_reasons(
    context: DriveContext, states: NDArray[intp], reach: Floats
) -> tuple[Flags, Flags]:
    """Mask of these states with a bend, a lower limit or an end of the lane ahead.

    And of those in which ego is faster than such a limit.
    """
    road, width, reach = context.road, context.existing_lanes.shape[1], reach[states]
    front, speed = context.ego_extents.s_max[0, states], context.ego.speed[0, states]
    lanes, turned = context.ego_lane[states], np.radians(context.thresholds.turned_deg)
    before = road.line.headings_at(zero_if_nan(context.ego_extents.s[0, states]))
    # Rows of places ahead, a column for each state
    ahead = np.arange(0.0, float(np.nanmax(reach, initial=0.0)) + _EVERY_M, _EVERY_M)[:, None]
    place = zero_if_nan(front + ahead)
    # No vehicle stands because of a bend
    bends = np.abs(turn(before, road.line.headings_at(place))) > _BEND_RAD
    bends &= context.ego_moves[states]
    there = road.lanes.existing_at(place)[:, np.arange(len(states)), lanes]
    codes = road.piece(place) * width + lanes
    different = np.unique(codes)
    told = [road.limit_mps(code // width, code % width, turned) for code in different.tolist()]
    known = np.array([np.inf if limit is None else limit for limit in told])
    untold = np.array(
        [road.limit_is_untold(*divmod(code, width)) for code in different.tolist()], dtype=bool
    )
    number = different.searchsorted(codes)
    limits, seen = known[number], ahead <= reach
    lower = (limits < speed) | (limits < context.limit_mps[states]) | untold[number]
    too_fast = (
        seen
        & (limits * KMH_PER_MPS + _SLOWER_KMH < speed * KMH_PER_MPS)
        & (limits < context.limit_mps[states])
    )
    return (seen & (bends | ~there | lower)).any(axis=0), too_fast.any(axis=0)
