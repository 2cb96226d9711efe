"""Signals of pedestrians at the crossing ahead, and of vehicles stopping there.

Intentions are not recorded. A pedestrian on the crossing uses it, unless it walks away from ego's
lane, which it has then crossed; one that stands at the kerb beside it waits to cross; one that
walks towards it is about to cross if it will be there soon. Whether ego must let across a
pedestrian that reaches ego's lane long after ego has left the crossing, as on the other side of a
wide road, is open.
"""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.junction_signals import at_unknown_way
from rulec.extraction.signals.map.map_signals import crossings_told, next_crossing
from rulec.extraction.signals.map.zone_signals import (
    crossings_lit,
    in_side_road,
    in_turn,
    side_road,
)
from rulec.extraction.signals.signal_columns import Measured, OfObjects
from rulec.extraction.signals.words import word, word_of_objects
from rulec.extraction.tracks.lane_sets import is_in
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.trace.cells import Cells
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.plain_arrays import ranges

_STOOD_S = 5.0
"""A pedestrian that stood this long before ego comes, and after it, has not stopped for ego."""

_AT_KERB_M = 1.0
"""So near (m) to the road's edge is the middle of one that waits at the kerb."""

_HAIR_MPS = 1e-3

_AROUND_S = 1.0
"""Who walks gets away from a place in this time, before and after."""

_WALKS_MPS = 1.4
"""The walking speed of pedestrians who do not wait."""

_USES = ("not_crossing", "waiting_to_cross", "about_to_cross", "entering_crossing", "on_crossing")


@word("crossing_use")
def _crossing_use(context: DriveContext) -> OfObjects | None:
    if not crossings_told(context):
        return None
    rows, used = _pedestrians(context), _used_ahead(context)
    own, unsure = np.zeros(context.relevant.shape, dtype=int), np.zeros_like(context.relevant)
    some = used.any(axis=1)
    if some.any():
        rows, used = rows[some], used[some]
        too_late, may_be = _too_late(context, rows, used)
        own[rows] = np.where(_past_ego(context, rows) | too_late, 0, used)
        unsure[rows] = (may_be | _is_far_off(context, rows)) & (own[rows] > 0)
        unsure[rows] |= _in_doubt(context, own[rows])
    return OfObjects(Measured(own, unsure, texts=_USES), context.tracks.of_type("pedestrian"))


def _in_doubt(context: DriveContext, uses: NDArray[intp]) -> Flags:
    """Mask of states around a change of use, for as long as walking the error of places takes.

    Only where a user states the error of places; otherwise the moment counts as measured.
    """
    error_s = context.thresholds.place_error_m / _WALKS_MPS
    steps = ceil(error_s / context.recording.step_s)
    changes = context.spans.changes(uses) if steps else np.zeros(uses.shape, dtype=bool)
    return context.spans.within(changes, steps, around=True)


@word("stopped_for_pedestrian")
def _stopped_for_pedestrian(context: DriveContext) -> OfObjects | None:
    if not crossings_told(context):
        return None
    stopped = np.zeros(context.relevant.shape, dtype=bool)
    if len(_pedestrians(context)):
        rows = _pedestrians(context)
        # At a crossing with lights, pedestrians that wait or come wait for the lights
        least = np.where(_is_lit(context), _USES.index("entering_crossing"), 1)
        waited_for = ((_used_ahead(context) >= least) & context.relevant[rows]).any(axis=0)
        states = waited_for.nonzero()[0]
        stopped[:, states] = _stopped(context, states)
    return OfObjects(
        Truth.known(stopped).unknown_at(_behind_another(context, stopped)),
        context.tracks.of_type("vehicle"),
    )


def _is_lit(context: DriveContext) -> Flags:
    """Mask of states in which a light directs the crossing ahead, or may do so."""
    (start, _), lit = next_crossing(context), np.zeros(context.states, dtype=bool)
    for place, lights in crossings_lit(context).items():
        lit |= (start == place) & any(lights)
    return lit


@word_of_objects("nearest_to_crossing")
def _nearest_to_crossing(context: DriveContext) -> Truth | None:
    if not crossings_told(context):
        return None
    start, _ = next_crossing(context)
    way = np.where(context.going_along, start - context.extents.s_max, np.inf)
    ahead = np.where((way >= 0) & (way <= context.thresholds.approach_m), way, np.inf)
    nearest = ahead.min(axis=0, initial=np.inf)
    near = np.isfinite(ahead) & (ahead == nearest)
    place = context.tolerances.place_m
    unsure = np.isfinite(ahead) & ~near & (ahead < nearest + 2 * place)
    unsure |= near & ((np.isfinite(ahead) & (ahead < nearest + 2 * place)).sum(axis=0) > 1)
    return Truth.known(near).unknown_at(unsure)


@word("crosses_side_road")
def _crosses_side_road(context: DriveContext) -> OfObjects:
    """Pedestrians that use the road into which ego turns without being let across by ego.

    An ego that waits in the junction until they are across has entered it lawfully. Who drives into
    it and then takes the way of one that steps onto the road meanwhile does so from then on.
    Unknown of those about a junction where the drive does not show which way ego takes.
    """
    rows, (crosses, unsure) = _pedestrians(context), np.zeros((2, *context.relevant.shape), bool)
    start, end = side_road(context)
    if len(rows) and np.isfinite(start).any():
        uses = _crossing_uses(context, (start, end), context.tracks.on_lane) > 0
        if (some := uses.any(axis=1)).any():
            rows, uses = rows[some], uses[some]
            taken, open_end, past = _takes_way(context, rows)
            uses |= in_turn(context) & (context.spans.next_state(uses) < past)
            crosses[rows], unsure[rows] = uses & taken, uses & open_end
    unsure |= at_unknown_way(context, _pedestrians(context))
    return OfObjects(Truth.known(crosses).unknown_at(unsure), context.tracks.of_type("pedestrian"))


def _takes_way(context: DriveContext, rows: NDArray[intp]) -> tuple[Flags, Flags, NDArray[intp]]:
    """Masks, for ``rows``, of pedestrians whose way ego takes, and where that is unknown.

    Also the next states in which ego is past them.

    They are on the lanes of ego's direction, and not past its own, while ego goes by or up to
    ``entering_s`` later; or they stood until it was gone, and went then. Not those behind whom ego
    goes at walking pace, or waits, until they are across. Unknown for those that ego does not reach
    while both are seen, or for which it still waits; and for those that have stood since
    ``_STOOD_S`` before ego comes and stay as long once it is gone, or stand at the edge of the road
    for that long from then on: they may not want to cross.
    """
    own, others = context.ego_extents, context.extents.part(rows, slice(None))
    spans, seen = context.spans, context.relevant[rows]
    limits, step_s = context.thresholds, context.recording.step_s
    on_lanes, last = in_side_road(context, rows) & seen, spans.end - 1
    stands = context.standing[rows]
    comes = spans.next_state(seen & (own.s_max >= others.s_min))
    reached, at = comes < spans.end, np.minimum(comes, last)
    goes = np.minimum(spans.next_state(own.s_min > others.s_max), last)
    steps_on = spans.next_state(on_lanes)
    # A pedestrian that turns along the road, as at its corner, has crossed it
    turns_along = ~stands & (np.abs(others.along) > np.abs(others.across))
    off = ~on_lanes | _past_ego(context, rows) | turns_along
    # Across before ego comes, having been on its lanes
    let_go = np.take_along_axis(off, at, axis=1) & (steps_on < at)
    across, waits_yet = _waited_for(context, at, goes, off)
    let_go |= across & (steps_on < spans.end)
    by_then = np.minimum(goes + round(limits.entering_s / step_s), last)
    in_way = np.take_along_axis(spans.next_state(~off), at, axis=1) <= by_then
    waited = spans.next_state(stands & seen & ~on_lanes) <= np.minimum(steps_on, goes)
    soon = spans.columns + round(limits.preparing_s / step_s)
    waited &= (steps_on <= soon) & (steps_on < spans.end)
    taken = reached & ~let_go & (in_way | waited)
    stood = round(_STOOD_S / step_s)
    stays_put = stands | ~_gets_away(context, rows)
    moves = spans.next_state(~stays_put & seen)
    moves = np.take_along_axis(moves, np.maximum(at - stood, spans.first), axis=1)
    # For a pedestrian standing at a lane's bound, errors of places alone may show a step over it
    stays = (~waited | (moves > steps_on)) & (moves > np.minimum(goes + stood, last))
    # One that stops at the kerb as ego comes, and stays, may wait for something else, as for green
    leaves = spans.next_state(seen & ~(stays_put & _at_kerb(context, rows, on_lanes)))
    stays |= np.take_along_axis(leaves, by_then, axis=1) > np.minimum(goes + stood, last)
    lost = spans.next_state(~seen) <= np.minimum(soon, last)
    unseen = (steps_on >= spans.end) & (lost | (soon >= spans.end))
    # As on the other half of a wide road, where it may stand because of others
    far = np.take_along_axis(_comes_s(context, rows) > limits.held_up_s, goes, axis=1)
    unsure = waits_yet | (taken & (stays | (far & ~in_way))) | (~let_go & ~taken & unseen)
    return taken, ~reached | unsure, goes


def _gets_away(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask, for ``rows``, of those whose places around a state are farther apart than they may err.

    Noise moves one that stands to and fro, at the speed of one that walks.
    """
    spans, tracks = context.spans, context.tracks
    reach = max(context.steps_in(_AROUND_S), 1)
    begin = np.maximum(spans.columns - reach, spans.first)
    end = np.minimum(spans.columns + reach, spans.end - 1)
    x, y = (at[rows][:, end] - at[rows][:, begin] for at in (tracks.x, tracks.y))
    # Where it is not seen around a state, its speed has to do
    away: Flags = ~(np.hypot(x, y) <= context.tolerances.place_m)
    return away


def _at_kerb(context: DriveContext, rows: NDArray[intp], on_lanes: Flags) -> Flags:
    """Mask, for ``rows``, of those off the lanes, or with their middle near the road's edge."""
    own, at_kerb = Cells.at(on_lanes), ~on_lanes
    (low_r, high_r), (low_l, high_l) = _from_edges(
        context, own.in_rows(rows, len(context.relevant))
    )
    from_edge = np.minimum((low_r + high_r) / 2, -(low_l + high_l) / 2)
    np.put(at_kerb, own.places, from_edge <= _AT_KERB_M)
    return at_kerb


def _waited_for(
    context: DriveContext, at: NDArray[intp], goes: NDArray[intp], off: Flags
) -> tuple[Flags, Flags]:
    """Masks of pedestrians for whom ego waits until they are across, and still waits at the end.

    At walking pace, ego lets them across before it is past or faster, or ``entering_s`` later; it
    still waits for others as the drive ends. Ego reaches them in the states ``at`` and is past in
    ``goes``; they are out of its way where ``off``.
    """
    spans, last = context.spans, context.spans.end - 1
    slow = context.ego.speed[0] * KMH_PER_MPS <= context.thresholds.walking_pace_kmh
    slows = spans.next_state(slow)[at]
    waits, since = slows < goes, np.minimum(slows, last)
    faster = spans.next_state(~slow)[since]
    across = np.take_along_axis(spans.next_state(off), since, axis=1)
    yet = waits & (faster >= spans.end) & (across >= spans.end)
    soon = faster + context.steps_in(context.thresholds.entering_s)
    return waits & (across <= np.minimum(soon, last)), yet


@once
def _pedestrians(context: DriveContext) -> NDArray[intp]:
    """The rows of pedestrians."""
    return context.tracks.of_type("pedestrian").nonzero()[0]


@once
def _used_ahead(context: DriveContext) -> NDArray[intp]:
    """How pedestrians use ego's present or next crossing: indices into ``_USES``, a row each."""
    return _crossing_uses(context, next_crossing(context), context.tracks.on_crosswalk)


def _crossing_uses(
    context: DriveContext, stretch: tuple[Floats, Floats], on_it: Flags
) -> NDArray[intp]:
    """Indices into ``_USES`` for pedestrians, a row each.

    ``stretch`` has begin and end of the crossing by state; ``on_it`` masks participants at a place
    for crossing, which is any place in the road if no crossing is drawn.
    """
    start, end = stretch
    others, tracks, limits = context.extents, context.tracks, context.thresholds
    rows = _pedestrians(context)
    if not len(rows):
        return np.zeros((0, context.states), dtype=int)
    # Room for pedestrians who do not walk exactly between the marks
    beside = others.s_max[rows] > start - limits.kerb_m
    beside &= others.s_min[rows] < end + limits.kerb_m
    uses, own = np.zeros(beside.shape, dtype=int), Cells.at(beside)
    if not len(own):
        return uses
    cells = own.in_rows(rows, len(context.relevant))
    (low_r, high_r), (low_l, high_l) = _from_edges(context, cells)
    to_road = np.maximum(-high_r, low_l).clip(0.0)
    walks = cells.of(tracks.speed) * KMH_PER_MPS >= limits.standing_kmh
    # The speed towards the middle of the road, across it (m/s)
    middle_r, middle_l = (low_r + high_r) / 2, (low_l + high_l) / 2
    across, left = cells.of(others.across), middle_r + middle_l
    towards = np.where(left < 0, across, -across)
    at_edge = np.minimum(middle_r, -middle_l) <= limits.at_edge_m
    at_edge &= np.abs(across) < np.abs(cells.of(others.along))
    crossing = cells.of(on_it) & cells.of(tracks.on_lane)
    waits = (to_road <= limits.kerb_m) & ~walks
    # A pedestrian that walks along the pavement and drifts a little towards the road does not come
    # to cross, nor does one that walks so at the very edge of a crossing
    approaches = walks & (towards > np.abs(cells.of(others.along)))
    on = crossing & ((cells.of(context.on_lanes) & ~at_edge) | ~walks | approaches)
    soon = approaches & (to_road <= towards * limits.about_to_s)
    enters = soon & (to_road <= towards * limits.entering_s)
    np.put(uses, own.places, np.select([on, enters, soon, waits], [4, 3, 2, 1], 0))
    return uses


def _from_edges(
    context: DriveContext, cells: Cells
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """How far (m) bodies begin and end left of the lanes' right edge, and of their left one.

    By cell, for the lanes that exist there.
    """
    others, count, sets = context.extents, context.existing_lanes.shape[1], context.lanes_there
    there = np.stack([is_in(cells.of(sets), lane) for lane in range(count)])
    ends = np.array(others.cells_from_bounds(cells, *range(count + 1)))
    edges = (there.argmax(axis=0), count - there[::-1].argmax(axis=0))
    right, left = (ends[edge, :, np.arange(len(edge))].T for edge in edges)
    return (right[0], right[1]), (left[0], left[1])


def _too_late(
    context: DriveContext, rows: NDArray[intp], uses: NDArray[intp]
) -> tuple[Flags, Flags]:
    """Masks of those that came to use the crossing too late for ego to wait, and that may have.

    For ``rows`` with their ``uses``. Ego can wait where, braking at once, it stops before them or
    before the crossing. Interruptions of up to ``away_s`` count as use. A pedestrian using it when
    first seen may have come just then; one on the crossing then has been about to cross for
    ``about_to_s``. In a mean, the place of a pedestrian shows late by half its time.
    """
    limits, used = context.thresholds, uses > 0
    speed, front = np.maximum(context.ego_extents.along[0], 0.0), context.ego_extents.s_max[0]
    start, _ = next_crossing(context)
    longest = context.steps_in(limits.away_s)
    spans = context.spans
    off = spans.columns - spans.latest(used) > longest
    seen_before = spans.latest(off & context.relevant[rows]) >= spans.first
    on_it = (uses == len(_USES) - 1) & ~seen_before
    earlier = np.where(on_it, limits.about_to_s, 0.0) + limits.smoothing_s / 2
    stop = speed**2 / (2 * limits.braking_mps2) - speed * earlier
    waits = front + stop <= np.maximum(start, context.extents.s_min[rows])
    begins = np.maximum(spans.latest(off | spans.changes(start)), spans.first)
    late = used & (spans.latest(used & waits) < begins)
    return late & seen_before, late & ~seen_before


def _past_ego(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask, for ``rows``, of pedestrians clear of ego's lane and body that walk away from them.

    If they then turn along the road, they count as past for ``away_s``, until they walk back or
    their middle is in ego's way: how far bodies reach is not known well. If ego's body turns away
    from them its middle counts: what reaches farther is its rear.
    """
    others = context.extents.part(rows, slice(None))
    own, bound = context.ego_extents, context.ego_lane
    low = np.where(own.across > 0, own.middle_from(bound), own.from_bound(bound)[0])
    high = np.where(own.across < 0, own.middle_from(bound + 1), own.from_bound(bound + 1)[1])
    leftmost, rightmost = np.maximum(high, 0.0), np.minimum(low, 0.0)
    (low_r, high_r), (low_l, high_l) = map(others.from_bound, (bound, bound + 1))
    on_left, on_right = low_l > leftmost, high_r < rightmost
    left, right = (low_l + high_l) / 2 > leftmost, (low_r + high_r) / 2 < rightmost
    # Outwards from ego's way
    leaves = np.where(left, others.across, np.where(right, -others.across, 0.0))
    least = context.thresholds.standing_kmh / KMH_PER_MPS
    spans = context.spans
    away = spans.latest((on_left | on_right) & (leaves > least))
    back = spans.latest(~(left | right) | (leaves < -least))
    longest = context.steps_in(context.thresholds.away_s)
    past: Flags = (away > back) & (spans.columns - away <= longest)
    return past


def _is_far_off(context: DriveContext, rows: NDArray[intp]) -> Flags:
    """Mask, for ``rows``, of pedestrians that reach ego's lane long after ego leaves the crossing.

    Ego keeps its speed, they walk towards its lane, and are ``held_up_s`` later.
    """
    _, end = next_crossing(context)
    speed = np.maximum(context.ego_extents.along[0], _HAIR_MPS)
    leaves_s = np.maximum(end - context.ego_extents.s_min[0], 0.0) / speed
    far: Flags = _comes_s(context, rows) > leaves_s + context.thresholds.held_up_s
    return far


def _comes_s(context: DriveContext, rows: NDArray[intp]) -> Floats:
    """How soon (s) pedestrians in ``rows`` reach ego's lane if they walk towards it."""
    others, bound = context.extents.part(rows, slice(None)), context.ego_lane
    (_, right_of), (left_of, _) = others.from_bound(bound), others.from_bound(bound + 1)
    way = np.maximum(np.maximum(left_of, -right_of), 0.0)
    comes: Floats = way / np.maximum(np.abs(others.across), _WALKS_MPS)
    return comes


def _behind_another(context: DriveContext, stopped: Flags) -> Flags:
    """Mask of those with another vehicle in their lane between them and the crossing.

    They may stop because of that one.
    """
    if not stopped.any():
        return stopped
    start, _ = next_crossing(context)
    others, lanes, cells = context.extents, context.lanes_within[0], Cells.at(stopped)
    between = context.tracks.of_type("vehicle")[:, None] & stopped.any(axis=0) & context.on_lanes
    between &= others.s_min < start
    before = Cells.at(between)
    # The vehicles of each column one after the other, and for each stopped one those in its column
    before = before.part(before.columns.argsort(kind="stable"))
    begins, ends = before.columns.searchsorted((cells.columns, cells.columns + 1))
    pairs, _ = ranges(begins, ends - begins)
    number = np.arange(len(cells)).repeat(ends - begins)
    ahead = before.of(others.s_min).take(pairs) >= cells.of(others.s_max).take(number)
    ahead &= (before.of(lanes).take(pairs) & cells.of(lanes).take(number)) != 0
    waits = np.zeros(len(cells), dtype=bool)
    waits[number[ahead]] = True
    return cells.laid(waits)


def _stopped(context: DriveContext, states: NDArray[intp]) -> Flags:
    """Mask of participants stopped on ego's lanes before the crossing ahead, in some states."""
    start, _ = next_crossing(context)
    stands = context.standing[:, states]
    way = start[states] - context.extents.s_max[:, states]
    stopped: Flags = stands & context.on_lanes[:, states]
    stopped &= (way >= 0) & (way <= 2 * context.thresholds.zone_m)
    return stopped
