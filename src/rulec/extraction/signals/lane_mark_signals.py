"""Signals of road marks, where the map has marks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once, once_a_map
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.ego_lanelets import SHOULDER, map_contents
from rulec.extraction.signals.measured_numbers import own_widths
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.signals.words import word
from rulec.recordings.polylines import places_in
from rulec.recordings.recording import Lanelet, LaneMark, is_lane
from rulec.scenario.recorded.route import lanelet_area
from rulec.trace.partly_known.partly_known_values import Truth

_SOLID = frozenset({"solid", "double_solid"})

_SINGLE = (
    ("solid", "solid"),
    ("solid", None),
    (None, "solid"),
    ("solid", "none"),
    ("none", "solid"),
)
"""Marks of a single line: it is the mark of both lanes, or of the one whose bound it is."""

_STEADY_MPS = 1.0
"""Below this speed the places of a vehicle do not show its direction."""

_EXACT_M = 0.1

_MOVED_OFF_M, _STOOD_S = 1.0, 1.0
"""The box of a parked vehicle drifts by less; a vehicle in place for this long stands."""

_Marks = tuple[LaneMark | None, LaneMark | None]


@dataclass(frozen=True, eq=False, slots=True)
class MarkedRows:
    """The rows of lanelets beside ego, None where no lane exists; ``number`` is a state's row."""

    rows: tuple[tuple[Lanelet | None, ...], ...]
    number: NDArray[intp]


@once
def _marked_rows(context: DriveContext) -> MarkedRows:
    there = context.existing_lanes
    pieces = context.road.piece(context.ego_extents.s[0])
    # A piece and its existing lanes, encoded as one number
    lanes = 1 << np.arange(there.shape[1])
    keys = pieces << len(lanes) | there @ lanes
    different = np.unique(keys)
    rows = tuple(
        tuple(
            lanelet if key & lane else None
            for lanelet, lane in zip(context.road.rows[key >> len(lanes)], lanes, strict=True)
        )
        for key in different.tolist()
    )
    return MarkedRows(rows, different.searchsorted(keys))


@word("marked_lanes")
def _marked_lanes(context: DriveContext) -> Truth | None:
    """Whether all lines between ego's lanes are marked."""
    if not map_contents(context).marks:
        return None
    marked = _marked_rows(context)
    between = [[_between(*pair) for pair in pairwise(row) if all(pair)] for row in marked.rows]
    told = np.array([all(any(marks) for marks in row) for row in between])
    all_marked = np.array(
        [bool(row) and all(set(marks) != {"none"} for marks in row) for row in between]
    )
    return Truth.known(all_marked[marked.number]).unknown_at(~told[marked.number])


@word("on_solid_line", "broken_on_own_side", "single_line")
def _lines_under_ego(context: DriveContext) -> SignalColumns:
    """Whether ego is on a solid line, one broken on the side that it comes from, and a single one.

    Unknown where tolerances or the map decide, where marks are unknown, and for the line at the
    road's edge: maps do not contain what is beyond it, and laws on it differ. So also for the line
    towards a hard shoulder: who may drive there, other rules say. A vehicle that stands
    all through its drive crosses no line: it is parked on the one at the edge. A vehicle that
    stands from the drive's start was not seen crossing the line under it, until it moves off; and
    for one first seen on a line, the side that it came from is unknown.
    """
    if not map_contents(context).marks:
        return _NONE
    names = ("on_solid_line", "broken_on_own_side", "single_line")
    stays = context.spans.all(~context.ego_moves)
    if stays.all():
        return SignalColumns(
            dict.fromkeys(names, Truth.known(np.zeros(context.states, dtype=bool)))
        )
    place, offsets = context.tolerances.place_m, context.map_offset_m
    unmoved, low, high = (
        np.zeros(context.states),
        context.ego_extents.left_of_min[0],
        context.ego_extents.left_of_max[0],
    )
    measured = _across(context, low, high, (0.0, unmoved))
    every = slice(None)
    outer = _outer_lines(context)
    outer &= ~_on_a_lane_beside(context, (measured & outer).any(axis=1).nonzero()[0])[:, None]
    outer |= _shoulder_lines(context)
    found = _under(context, measured & ~outer, every)
    # Beyond the road's edge there may be premises, a parking space or a lane missing on the map
    not_told = ~found[:, 0] & _under(context, measured, every)[:, [0, -1]].any(axis=1)
    near = _near_a_line(context, place + np.abs(offsets))
    shifts = [unmoved, offsets] if offsets.any() else [unmoved]
    others = list(product((place, -place), shifts))
    tried = [(near, _across(context, low, high, other)) for other in others]
    # A body lies across a line by its place, not only by the direction of its box
    middle, half = context.ego_extents.left_of[0], _half_across(context)[:, None]
    tried += [
        (near | found[:, 0], _across(context, middle - half, middle + half, other))
        for other in [(0.0, unmoved), *others]
    ]
    states = np.concatenate([where.nonzero()[0] for where, _ in tried])
    lines = np.concatenate([lines[where] for where, lines in tried])
    others_found = _under(context, lines & ~outer[states], states)
    differs = (others_found[:, :-1] != found[states, :-1]).any(axis=1)
    differs |= ~found[states, 0] & _under(context, lines, states)[:, 0]
    not_told[states[differs]] = True
    not_told &= ~_gets_over(context, found[:, 0], outer)
    not_told |= found[:, 0] & _not_moved_yet(context)
    found[stays], not_told[stays] = False, False
    told = {
        name: Truth.known(own).unknown_at(not_told)
        for name, own in zip(names, found.T, strict=False)
    }
    told["broken_on_own_side"] = told["broken_on_own_side"].unknown_at(found[:, 3])
    return SignalColumns(told)


def _gets_over(context: DriveContext, on_it: Flags, outer: Flags) -> Flags:
    """Mask of states in which ego passes from clear of a solid line to clear of it on the far side.

    Ego surely lies across it at some moment then, and only the moment is in doubt. Applies to at
    most one line, solid from both sides all the time and not an ``outer`` one.
    """
    if not on_it.any():
        return on_it
    own, spans, limits = context.ego_extents, context.spans, context.thresholds
    error = context.tolerances.place_m + np.abs(context.map_offset_m)
    side = np.where(error < own.left_of_min[0].T, 1, 0)
    side -= -error > own.left_of_max[0].T
    number, lines = _marked_rows(context).number, np.arange(len(side))[:, None]
    kinds = (_line_kinds(context).take(number, axis=1)[:, None] >> lines) & 1 > 0
    solid, broken_right, broken_left, _, untold = kinds
    doubtful = (side == 0) & (solid | untold)
    before, behind = spans.latest(side != 0), spans.next_state(side != 0)
    longest = 2 * limits.passed_s / context.recording.step_s
    over = (before >= spans.first) & (behind < spans.end) & (behind - before <= longest)
    ends = np.maximum(before, 0), np.minimum(behind, context.states - 1)
    first, last = (np.take_along_axis(side, at, axis=1) for at in ends)
    over &= (side == 0) & (first * last < 0)
    changes, lies = np.append(0, number[1:] != number[:-1]).cumsum(), on_it.cumsum()
    over &= (changes[ends[0]] == changes[ends[1]]) & (lies[ends[0]] < lies[ends[1]])
    over &= solid & ~broken_right & ~broken_left & ~untold & ~outer.T
    found: Flags = over.any(axis=0) & (doubtful.sum(axis=0) == 1)
    return found


@once
def _comes_from(context: DriveContext) -> tuple[NDArray[intp], NDArray[intp]]:
    """Bits of the lines that ego reaches from their left, by state, and of those with unknown side.

    The side is the one on which its body last was clear of the line; before that, the one of its
    middle in the drive's first state.
    """
    own, spans = context.ego_extents, context.spans
    left, right = (own.left_of_min[0] > 0.0).T, (own.left_of_max[0] < 0.0).T
    latest = spans.latest(left | right)
    seen = latest >= spans.first
    at_first = (own.left_of[0][spans.first] >= 0.0).T
    from_left = np.where(seen, np.take_along_axis(left, np.maximum(latest, 0), axis=1), at_first)
    bits = 1 << np.arange(len(left))
    return bits @ from_left, bits @ ~seen


def _not_moved_yet(context: DriveContext) -> Flags:
    """Mask of states in which ego stands where it was first seen, for ``_STOOD_S`` or more."""
    x, y, spans = context.ego.x[0], context.ego.y[0], context.spans
    way = np.hypot(x - x[spans.first], y - y[spans.first])
    away = way > _MOVED_OFF_M + 2 * context.tolerances.place_m
    stood: Flags = spans.latest(away) < spans.first
    counts = np.add.reduceat(stood.astype(intp), spans.begins)
    stood &= spans.spread((counts - 1) * context.recording.step_s >= _STOOD_S)
    return stood


def _outer_lines(context: DriveContext) -> Flags:
    """Mask of the lines (second axis) at the edges of ego's road, by state."""
    lanes = context.existing_lanes
    outer = np.empty((len(lanes), lanes.shape[1] + 1), dtype=bool)
    # Beyond the outermost lanes there are none
    outer[:, 0], outer[:, -1] = lanes[:, 0], lanes[:, -1]
    outer[:, 1:-1] = lanes[:, 1:] != lanes[:, :-1]
    return outer


def _shoulder_lines(context: DriveContext) -> Flags:
    """Mask of the lines (second axis) at the edges of hard shoulders, by state."""
    marked = _marked_rows(context)
    found = [
        [_is_shoulder(right) != _is_shoulder(left) for right, left in pairwise([None, *row, None])]
        for row in marked.rows
    ]
    flags: Flags = np.array(found)[marked.number]
    return flags


def _is_shoulder(lanelet: Lanelet | None) -> bool:
    return lanelet is not None and SHOULDER in lanelet.types


def _on_a_lane_beside(context: DriveContext, asked: NDArray[intp]) -> Flags:
    """Mask of the states in ``asked`` in which ego reaches onto a lane outside its road.

    This happens where a file does not say which lanes of the other direction lie beside ego's. A
    hard shoulder is beyond the edge of the carriageway, whether or not it is on the map.
    """
    found = np.zeros(context.states, dtype=bool)
    names, areas = _lane_areas(context) if asked.size else ((), ())
    if areas:
        own = {lanelet.id for row in context.road.rows for lanelet in row if lanelet is not None}
        is_outside = ~np.isin(names, [*own])
        half, heading = own_widths(context)[asked] / 2, context.ego.heading[0, asked]
        for side in (-half, half):
            x = context.ego.x[0, asked] - side * np.sin(heading)
            y = context.ego.y[0, asked] + side * np.cos(heading)
            states, lanes = places_in(areas, x, y)
            found[asked[states[is_outside[lanes]]]] = True
    return found


@once_a_map
def _lane_areas(context: DriveContext) -> tuple[Sequence[str], Sequence[shapely.Geometry]]:
    """The ids and the areas of the map's lanes without hard shoulders."""
    lanes = [x for x in context.recording.lanelets.values() if is_lane(x) and not _is_shoulder(x)]
    return [lane.id for lane in lanes], [lanelet_area(lane) for lane in lanes]


def _half_across(context: DriveContext) -> Floats:
    """How far (m) ego would reach to either side of its middle if it pointed where it moves.

    A slow ego points where its box does in sources as exact as ``_EXACT_M``, and along the lanes in
    others; also along the lanes where places are so inexact that a track points where it slips.
    """
    width, turned = own_widths(context), context.ego_extents.turned[0]
    place = context.tolerances.place_m
    if place >= context.thresholds.touching_m:
        return width / 2
    steps = max(context.steps_in(context.thresholds.smoothing_s / 2), 1)
    at, spans = context.spans.columns, context.spans
    before, after = np.maximum(at - steps, spans.first), np.minimum(at + steps, spans.end - 1)
    dx, dy = (places[0, after] - places[0, before] for places in (context.ego.x, context.ego.y))
    lasts = np.maximum(after - before, 1) * context.recording.step_s
    # Relative to the road's direction, which is the heading less the turned angle
    aside = np.arctan2(dy, dx) - context.ego.heading[0] + turned
    slow = turned if place < _EXACT_M else 0.0
    aside = np.where(np.hypot(dx, dy) >= _STEADY_MPS * lasts, aside, slow)
    along = context.ego_extents.s_max[0] - context.ego_extents.s_min[0]
    lengths = (along - width * np.abs(np.sin(turned))) / np.maximum(np.abs(np.cos(turned)), 0.5)
    reach: Floats = (width * np.abs(np.cos(aside)) + lengths * np.abs(np.sin(aside))) / 2
    return reach


def _across(context: DriveContext, low: Floats, high: Floats, other: tuple[float, Floats]) -> Flags:
    """Mask of the lines that a body lies across, by state; line ``k`` lies right of lane ``k``.

    ``low`` and ``high`` are how far (m) left of each line the body begins and ends. ``other`` is
    the extra distance (m) that it has to reach beyond a line, and by state its shift to the right.
    """
    more, right = other
    across = np.minimum(right[:, None] - low, high - right[:, None])
    crossed: Flags = across > context.thresholds.touching_m + more
    return crossed


def _under(context: DriveContext, crossed: Flags, states: NDArray[intp] | slice) -> Flags:
    """What the lines are that ego crosses in some states, as a row of flags per state.

    The flags: a line is solid; a solid one is broken on the side from which ego comes; it is a
    single one; a solid one is broken on one side and ego's side was not seen; marks are unknown.
    """
    bits = crossed @ (1 << np.arange(crossed.shape[1]))
    from_left, unseen = (own[states] for own in _comes_from(context))
    kinds = _line_kinds(context).take(_marked_rows(context).number[states], axis=1)
    solid, broken_right, broken_left, single, not_told = kinds & bits
    broken = solid & (broken_right & ~from_left | broken_left & from_left)
    return np.stack(
        [
            solid != 0,
            broken != 0,
            (solid & single != 0) & (solid & (solid - 1) == 0),
            solid & unseen & (broken_right | broken_left) != 0,
            not_told != 0,
        ],
        axis=1,
    )


@once
def _line_kinds(context: DriveContext) -> NDArray[intp]:
    """Bits of the lines of each kind, by row of lanelets (second axis): bit ``k`` is line k.

    The kinds: solid, broken on the right, broken on the left, single, and unknown.
    """

    def kinds(marks: _Marks) -> tuple[bool, ...]:
        right, left = marks
        is_solid = not _SOLID.isdisjoint(marks)
        return is_solid, right == "broken", left == "broken", marks in _SINGLE, not any(marks)

    found = [
        [kinds(_between(*pair)) for pair in pairwise([None, *row, None])]
        for row in _marked_rows(context).rows
    ]
    flags = np.array(found, dtype=bool)
    bits: NDArray[intp] = flags.transpose(2, 0, 1) @ (1 << np.arange(flags.shape[1]))
    return bits


def _between(right: Lanelet | None, left: Lanelet | None) -> _Marks:
    """The marks of the line between two lanes, given by the lane on its right and on its left."""
    return right.left_mark if right else None, left.right_mark if left else None


def _near_a_line(context: DriveContext, margin_m: Floats) -> Flags:
    """Mask of states in which a margin decides whether ego's body lies across a line."""
    own = context.ego_extents
    across = np.minimum(-own.left_of_min[0], own.left_of_max[0])
    near: Flags = (np.abs(across - context.thresholds.touching_m) <= margin_m[:, None]).any(axis=1)
    return near


_NONE = SignalColumns()
