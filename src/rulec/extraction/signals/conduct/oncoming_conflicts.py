"""The signal of oncoming vehicles that have to brake as ego is over the middle of the road.

What decides is the situation when ego begins to be there, or the other vehicle is first seen:
whether that vehicle, at its speed then, would meet ego in its way, and whether it could avoid that
without braking harder than ``disturbing_mps2`` after its reaction time. A vehicle that already
stands, or is so far away that gentle braking is enough, may let ego go first. One that gets slower
may do so for ego if it would have come less than ``yielding_s`` after ego was back, also if it had
gone on as fast as up to 2 s before; but not if somebody is ahead of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rulec.array_types import Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.conduct.manoeuvre_signals import (
    at_junctions,
    sides_beyond_far_edge,
    two_way,
)
from rulec.extraction.signals.ego_lanelets import own_lanelets
from rulec.extraction.signals.words import word_of_objects
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.partly_known.partly_known_values import Truth

_GOES_FIRST = "PRIORITY_OVER_ONCOMING"
"""The sign that gives ego priority where the road is narrow."""

_ALONG_RAD = np.pi / 4
"""A vehicle at a larger angle to the road does not drive along it."""

_BEFORE_S = 2.0
"""Who sees that ego is about to go over the middle may brake so long (s) before it does."""

_AHEAD_S, _AHEAD_M, _SAME_LANE_M = 2.0, 10.0, 1.5
"""Somebody this near ahead, by time at its speed and by place beside that, may make one brake."""

_SLOWED_MPS = 0.5
"""A vehicle that is slower by more afterwards may have had to brake."""


class _Stay(NamedTuple):
    """Ego's states over the middle, from ``first`` to before ``end``; the end of its drive."""

    first: int
    end: int
    drive_end: int
    sure: bool


@word_of_objects("holds_up_oncoming")
def _holds_up_oncoming(context: DriveContext) -> Truth:
    held, seems_so = np.zeros((2, *context.relevant.shape), dtype=bool)
    far = sides_beyond_far_edge(context, context.ego_extents)[1][0]
    stays = _stays_over_the_middle(context, far)
    moves = context.tracks.of_type("road_user") & ~context.tracks.of_type("pedestrian")
    near = sides_beyond_far_edge(context, context.extents)[0] if stays else far
    for stay in stays:
        there = context.relevant[:, stay.first : stay.end] & moves[:, None]
        for row in there.any(axis=1).nonzero()[0].tolist():
            seen = stay.first + int(there[row].argmax())
            if not _comes_on_its_half(context, row, seen, near):
                continue
            in_way = far[seen : stay.end] - near[row, seen]
            found = _has_to_brake(context, stay, (row, seen), in_way)
            if found is None and _may_brake_for_ego(context, stay, (row, seen), near):
                found = False
            if found is not None:
                sure = found and stay.sure and seen == stay.first
                (held if sure else seems_so)[row, stay.first : stay.end] = True
    return Truth(held, held | seems_so)


def _stays_over_the_middle(context: DriveContext, far: Floats) -> list[_Stay]:
    """Where ego, heading along a road with traffic both ways, reaches over its middle.

    Not for sure where the map does not say whether there is another direction, in junctions, where
    ways lead elsewhere, and where ego is there from the start. A sign may give it priority.
    """
    both_ways = two_way(context)
    over = (far > context.thresholds.touching_m) & both_ways.possible
    over &= np.abs(context.ego_extents.turned[0]) <= _ALONG_RAD
    if not over.any():
        return []
    signs = own_lanelets(context).flags(lambda lanelet: _GOES_FIRST in lanelet.signs)
    spans, unsure = context.spans, ~both_ways.sure | at_junctions(context)
    return [
        _Stay(first, end, int(spans.end[first]), sure)
        for first, end in spans.runs(over)
        if not signs[first:end].any()
        for sure in [not (spans.begins_here[first] or unsure[first:end].any())]
    ]


def _comes_on_its_half(context: DriveContext, row: int, seen: int, near: Floats) -> bool:
    """Whether a vehicle comes along the other half of the road ahead of ego, still moving."""
    others, limits = context.extents, context.thresholds
    return bool(
        others.along[row, seen] * KMH_PER_MPS < -limits.standing_kmh
        and np.cos(others.turned[row, seen]) < -np.cos(_ALONG_RAD)
        and others.s_min[row, seen] > context.ego_extents.s_max[0, seen]
        and near[row, seen] > -limits.touching_m
    )


def _has_to_brake(
    context: DriveContext, stay: _Stay, other: tuple[int, int], in_way: Floats
) -> bool | None:
    """Whether a vehicle has to brake hard for ego: True, False if only perhaps, None if not.

    ``other``: its row and the state from which it is considered. ``in_way``: how far (m) ego
    reaches into its way, by state from there on.
    """
    row, seen = other
    limits, others, own = context.thresholds, context.extents, context.ego_extents
    passed_s: Floats = np.arange(stay.end - seen, dtype=np.float64)
    passed_s *= context.recording.step_s
    speed = -float(others.along[row, seen])
    room = float(others.s_min[row, seen]) - own.s_max[0, seen : stay.end]
    meets = _meets(room, speed * passed_s, in_way)
    if meets is None:
        meets_soon = room[-1] - speed * passed_s[-1] < _closing(context, stay, speed)
        still_over = stay.end == stay.drive_end and in_way[-1] > 0
        return False if still_over and meets_soon else None
    braked_s = np.minimum(
        np.maximum(passed_s - limits.reaction_s, 0.0), speed / limits.disturbing_mps2
    )
    at_full = np.minimum(passed_s, limits.reaction_s) * speed
    way = at_full + speed * braked_s - limits.disturbing_mps2 * braked_s**2 / 2
    place = context.tolerances.place_m
    hard = _meets(room + place, way, in_way - place) is not None
    brakes, slower = _brakes(context, row, slice(seen, seen + meets + 1), speed)
    if hard and (brakes or _touch(context, row, slice(seen, stay.end))):
        return _is_passed(context, row, slice(seen, stay.drive_end))
    return False if hard or slower else None


def _may_brake_for_ego(
    context: DriveContext, stay: _Stay, other: tuple[int, int], near: Floats
) -> bool:
    """Whether one that need not brake does get slower, and nobody ahead of it may be why.

    ``near``: how far (m) each one's near side is beyond the middle, by state.
    """
    row, seen = other
    limits, others, step_s = context.thresholds, context.extents, context.recording.step_s
    begin = max(seen - round(_BEFORE_S / step_s), int(context.spans.first[seen]))
    there = context.relevant[row, begin : seen + 1]
    speeds = np.where(there, context.tracks.speed[row, begin : seen + 1], -np.inf)
    fastest = begin + int(speeds.argmax())
    speed, least = float(speeds.max()), _SLOWED_MPS + context.tolerances.speed_mps
    if float(np.fmin.reduce(context.tracks.speed[row, fastest : stay.end])) >= speed - least:
        return False
    passed_s = (np.arange(seen, stay.end) - fastest) * step_s + limits.yielding_s
    room = float(others.s_min[row, fastest]) - context.ego_extents.s_max[0, seen : stay.end]
    if not (speed * passed_s >= room).any():
        return False
    ahead = others.s_min[row, fastest] - others.s_max[:, fastest]
    close = (ahead > 0) & (ahead < speed * _AHEAD_S + _AHEAD_M)
    return not (close & (np.abs(near[:, fastest] - near[row, fastest]) < _SAME_LANE_M)).any()


def _closing(context: DriveContext, stay: _Stay, speed: float) -> float:
    """How much (m) ego and another vehicle approach within ``parting_s`` after ego's stay."""
    own = max(float(context.ego_extents.along[0, stay.end - 1]), 0.0)
    return (own + speed) * context.thresholds.parting_s


def _meets(room: Floats, way: Floats, in_way: Floats) -> int | None:
    """The state in which a vehicle that moved by ``way`` (m) meets ego in its way, or None."""
    there = way >= room
    first = int(there.argmax())
    return first if there[first] and in_way[first] > 0 else None


def _brakes(context: DriveContext, row: int, states: slice, speed: float) -> tuple[bool, bool]:
    """Whether a vehicle surely brakes harder than ``disturbing_mps2``, and if it gets slower."""
    tracks = context.tracks
    least = tracks.acceleration[row, states] + tracks.acceleration_error[row, states]
    brakes = bool(np.any(least < -context.thresholds.disturbing_mps2))
    slowest = float(np.fmin.reduce(tracks.speed[row, states]))
    return brakes, slowest < speed - _SLOWED_MPS - context.tolerances.speed_mps


def _touch(context: DriveContext, row: int, states: slice) -> bool:
    """Whether the fronts of ego and another vehicle meet, one in the other's way."""
    others, own = context.extents, context.ego_extents
    met = (others.s_min[row, states] <= own.s_max[0, states]).nonzero()[0]
    across = relations.way_across(context)[row, states]
    return bool(len(met)) and bool(across[met[0]] < -context.tolerances.place_m)


def _is_passed(context: DriveContext, row: int, states: slice) -> bool:
    """Whether a vehicle gets past ego in the end, so that it did not brake to turn off before."""
    others, own = context.extents, context.ego_extents
    return bool((others.s_min[row, states] < own.s_max[0, states]).any())
