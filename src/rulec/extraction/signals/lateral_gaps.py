"""Gaps across the road between bodies beside each other, and their bounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.presences import presence_cells
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import Bounds, rounded_outward
from rulec.extraction.tracks.road_extents import RoadExtents
from rulec.trace.cells import Cells

_NEXT_TO_M = 5.0
"""So near (m) across the road bodies are measured by more than rectangles along it."""

_MOST_ASKEW_RAD = 0.6
"""Up to this angle a body's width is computed from its rectangle along the road."""

_SOON_BESIDE_M = 2.0
"""What wrong headings change is bounded roughly for bodies farther apart (m) along the road."""

_KNOWN_RAD = 1e-3
"""Headings that are less wrong move the corners of the longest bodies by less than a centimetre."""

_HAIR = 1e-6


def lateral_gaps(context: DriveContext) -> tuple[Floats, Bounds]:
    """The gaps (m) across the road between bodies, 0 where they overlap, and their bounds.

    A body that is askew begins farther off beside another one than the rectangle along the road
    that contains it. How far is as well known as its heading, so the lower bound is to the
    rectangle. Of two that are askew the gap is too small, never too large. What the errors of
    headings change adds to the errors of places.
    """
    cells, place = presence_cells(context), context.tolerances.place_m
    across = cells.of(relations.way_across(context))
    own, others = context.ego_extents, context.extents
    gap, nearer, farther = across.copy(), *np.full((2, len(across)), place)
    close = (np.abs(across) < _NEXT_TO_M).nonzero()[0]
    if not len(close):
        return np.maximum(gap, 0.0), _rounded(across, gap, (nearer, farther))
    few, joint = cells.part(close), context.tolerances.joint
    errors = (
        _noticeable(few.of(own_heading_errors(context))),
        _noticeable(_heading_errors_of_others(context, few)),
    )
    are_known = not any(error.any() for error in errors)
    if not are_known:
        for turns, error in zip((own, others), errors, strict=True):
            rough = joint(nearer[close], _at_most_by_turning(few, turns, error))
            nearer[close] = farther[close] = rough
    along = few.of(relations.way_along(context))
    # With known headings, bodies that are not beside each other need no better bounds
    soon = (along < (0.0 if are_known else _SOON_BESIDE_M)).nonzero()[0]
    if len(soon):
        chosen, few, beside = close[soon], few.part(soon), along[soon] < 0
        left = (few.of(others.d_min) + few.of(others.d_max)) > (
            few.of(own.d_min) + few.of(own.d_max)
        )
        if not are_known:
            nearer[chosen] = farther[chosen] = place
        for askew, other, is_left, error in (
            (own, others, left, errors[0][soon]),
            (others, own, ~left, errors[1][soon]),
        ):
            by_askew = _beside_askew(few, askew, other, is_left)
            gap[chosen] += np.where(beside, by_askew, 0.0)
            if not are_known:
                less, more = _by_turning(few, askew, other, is_left, error, beside=beside)
                nearer[chosen] = joint(nearer[chosen], less)
                farther[chosen] = joint(farther[chosen], more)
    return np.maximum(gap, 0.0), _rounded(across, gap, (nearer, farther))


def _rounded(across: Floats, gap: Floats, errors: tuple[Floats, Floats]) -> Bounds:
    """The bounds of gaps: ``errors`` nearer than rectangles are, and farther than bodies."""
    nearer, farther = errors
    low, high = np.maximum(across - nearer, 0.0), np.maximum(gap + farther, 0.0)
    return rounded_outward(low, high)


def _beside_askew(cells: Cells, askew: RoadExtents, other: RoadExtents, is_left: Flags) -> Floats:
    """How much farther (m) a body's side is from another body than its rectangle along the road.

    By cell; ``is_left``: the other one is at its left. The corner that reaches farthest there is
    one in front if it is turned to that side, else one of the rear. From there its side leads away
    from the other one, and so does its front or rear.
    """
    turned = cells.of(askew.turned)
    angle = _from_axis(turned)
    low, high = cells.of(askew.s_min), cells.of(askew.s_max)
    wide, sin = cells.of(askew.d_max) - cells.of(askew.d_min), np.sin(angle)
    # The width of a body with these sides along and across the road; of others, 0 is too little
    width = (wide * np.cos(angle) - (high - low) * sin) / np.cos(2 * angle)
    corner = np.where(angle < _MOST_ASKEW_RAD, np.clip(width, 0.0, wide), 0.0) * sin
    others = cells.of(other.s_min), cells.of(other.s_max)
    return _side_of_askew(turned, (low, high), corner, wide, others, is_left=is_left)


def _side_of_askew(
    turned: Floats,
    ends: tuple[Floats, Floats],
    corner: Floats,
    wide: Floats,
    others: tuple[Floats, Floats],
    *,
    is_left: Flags,
) -> Floats:
    """How much farther (m) than its rectangle a body's side begins beside ``others``.

    ``ends`` are from where to where along the road the bodies are, ``corner`` is how far the
    farthest corner is from them, ``wide`` how far they extend across it.
    """
    (low, high), (first, last) = ends, others
    front = (np.sin(2 * turned) > 0) == is_left
    behind = np.where(front, high - corner - last, first - low - corner)
    before = np.where(front, first - high + corner, low + corner - last)
    steep = np.tan(_from_axis(turned))
    by_side = np.maximum(behind, 0.0) * steep
    by_end = np.maximum(before, 0.0) / np.maximum(steep, _HAIR)
    farther: Floats = np.minimum(np.maximum(by_side, by_end), wide)
    return farther


@once
def own_heading_errors(context: DriveContext) -> Floats:
    """How far (rad) ego's heading may be wrong, by state."""
    rows, columns = context.spans.spread(context.ego.rows), context.steps - context.own.tracks.first
    errors: Floats = context.own.heading_errors[rows, columns]
    return errors


def _heading_errors_of_others(context: DriveContext, cells: Cells) -> Floats:
    """How far (rad) headings of others may be wrong, for some cells."""
    rows, columns = context.tracks.rows[cells.rows], context.columns[cells.columns]
    errors: Floats = context.surroundings.heading_errors[rows, columns]
    return errors


def _noticeable(error: Floats) -> Floats:
    """Errors (rad) of headings, 0 for those that move no corner by much.

    By cell, so that bounds do not depend on which drives are processed together.
    """
    return np.where(error <= _KNOWN_RAD, 0.0, error)


def _at_most_by_turning(cells: Cells, turns: RoadExtents, error: Floats) -> Floats:
    """The most (m) that a body's side moves across the road if it turns by its heading's error."""
    size, wide = (
        cells.of(end) - cells.of(begin)
        for begin, end in ((turns.s_min, turns.s_max), (turns.d_min, turns.d_max))
    )
    most: Floats = error * np.hypot(size, wide)
    return most


def _by_turning(
    cells: Cells,
    turns: RoadExtents,
    other: RoadExtents,
    is_left: Flags,
    error: Floats,
    *,
    beside: Flags,
) -> tuple[Floats, Floats]:
    """How much (m) nearer and farther a body may be, turned by up to its heading's error, by cell.

    ``error`` is in rad; ``is_left``: the other is at its left; ``beside``: they overlap along the
    road.
    """
    turned = cells.of(turns.turned)
    angle = _from_axis(turned)
    low, high = cells.of(turns.s_min), cells.of(turns.s_max)
    wide, size = cells.of(turns.d_max) - cells.of(turns.d_min), high - low
    known = angle < _MOST_ASKEW_RAD
    cos, sin = np.cos(angle), np.where(known, np.sin(angle), 0.0)
    twice = np.where(known, np.cos(2 * angle), 1.0)
    box = _Box(
        np.clip((size * cos - wide * sin) / twice, 0.0, size),
        np.clip((wide * cos - size * sin) / twice, 0.0, wide),
        (low + high) / 2,
        others=(cells.of(other.s_min), cells.of(other.s_max)),
        is_left=is_left,
        beside=beside,
    )
    # The body is widest with its diagonal across
    diagonal = np.arctan2(box.length, box.width)
    widest = np.minimum(np.maximum(diagonal, angle - error), angle + error)
    measured = box.half_across(angle)
    nearer = box.half_across(widest) - measured
    askew = box.farther(turned) - measured
    farther = np.zeros(len(angle))
    for by in (-error, error, np.clip(_to_axis(turned), -error, error)):
        tried = box.farther(turned + by) - box.half_across(turned + by)
        farther = np.maximum(farther, tried - askew)
    # Of a body across the road the rectangle does not show the sides
    most = _at_most_by_turning(cells, turns, error)
    return np.where(known, nearer, most), np.where(known, farther, most)


def _to_axis(turned: Floats) -> Floats:
    """The angle (rad) by which a body has to turn to lie along the road, either way round."""
    to_axis: Floats = -((turned + np.pi / 2) % np.pi - np.pi / 2)
    return to_axis


def _from_axis(turned: Floats) -> Floats:
    return np.abs(_to_axis(turned))


@dataclass(frozen=True, eq=False, slots=True)
class _Box:
    """Bodies (m) with their ``middle`` along the road, and from where to where ``others`` are.

    ``is_left``: these are at their left; ``beside``: they are beside each other.
    """

    length: Floats
    width: Floats
    middle: Floats
    others: tuple[Floats, Floats]
    is_left: Flags
    beside: Flags

    def half_across(self, turned: Floats) -> Floats:
        """Half of how far the body extends across the road if it is turned like that."""
        sin, cos = np.abs(np.sin(turned)), np.abs(np.cos(turned))
        half: Floats = (self.length * sin + self.width * cos) / 2
        return half

    def farther(self, turned: Floats) -> Floats:
        """How much farther its side is from the other body than its rectangle along the road."""
        angle = _from_axis(turned)
        sin, cos = np.sin(angle), np.cos(angle)
        half = (self.length * cos + self.width * sin) / 2
        askew = _side_of_askew(
            turned,
            (self.middle - half, self.middle + half),
            self.width * sin,
            2 * self.half_across(turned),
            self.others,
            is_left=self.is_left,
        )
        return np.where(self.beside, askew, 0.0)
