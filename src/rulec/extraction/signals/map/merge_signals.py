"""Signals of narrowings, where two lanes become one.

Two lanes beside each other become one where both lead to the same lane and to no other, or where
one of them ends. One of several ways on from a lane is not a lane that ends. A lane that merely has
no successor on the map may go on beyond it. Beside a lane from which vehicles only turn around,
no lane ends but the whole road.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.computed_once import once_a_road
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals import relations
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.signals.words import word
from rulec.recordings.recording import RAMPS, Lanelet, Recording
from rulec.scenario.recorded.route import lanelet_length, turns_back
from rulec.trace.partly_known.partly_known_values import Truth

_TAPERED = 0.6
"""A lane that ends is narrower at its end than this part of its width before."""

_JUST_BEFORE_M = 15.0
"""A vehicle farther from the narrowing when ego reaches it need not be let in yet."""

_WAY_M = 30.0
"""Longest way from the lanes before a junction, or an added lane, to those behind."""


@word("narrowing", "merged", "abreast_at_narrowing")
def _narrowings(context: DriveContext) -> SignalColumns:
    reach = context.thresholds.approach_m
    front, lane = context.ego_extents.s_max[0], context.ego_lane
    narrowing, merged, about_there = np.zeros((3, context.states), dtype=bool)
    abreast, perhaps_abreast = np.zeros((2, *context.relevant.shape), dtype=bool)
    lets_in = _could_let_in(context)
    for place, right, sure in merges(context):
        on_one = (lane == right) | (lane == right + 1)
        before = on_one & (front > place - reach) & (front <= place)
        other = np.where(lane == right, right + 1, right)
        there, lost = _there_with_ego(context, place) if before.any() else (False, False)
        beside = before & _beside_in(context, other) if before.any() else False
        # Beyond it other lanes may be beside the merged one
        beside &= context.extents.s_max <= place
        if sure:
            narrowing |= before
            merged |= on_one & (front > place) & (front <= place + reach)
            abreast |= beside & there & lets_in
            perhaps_abreast |= beside & (lost | (there & ~lets_in))
        else:
            about_there |= on_one & (np.abs(front - place) <= reach)
            perhaps_abreast |= beside
    return SignalColumns(
        {
            "narrowing": Truth(narrowing, narrowing | about_there),
            "merged": Truth(merged, merged | about_there),
        },
        {"abreast_at_narrowing": Truth(abreast, abreast | perhaps_abreast)},
    )


def _could_let_in(context: DriveContext) -> Flags:
    """Mask of vehicles that ego could let in, braking no harder than it may make others brake.

    From where it nears the narrowing. Whether the law asks for more from a vehicle that passes one
    that hardly moves is unknown.
    """
    limits, own, others = context.thresholds, context.ego_extents.along[0], context.extents.along
    could: Flags = own**2 - others**2 <= 2 * limits.disturbing_mps2 * limits.approach_m
    return could


def _there_with_ego(context: DriveContext, place: float) -> tuple[Flags, Flags]:
    """Masks of those at a narrowing, not ahead, when ego gets there; and of those lost by then.

    The latter are not recorded then, or ego does not get there. Those ahead go first anyway. Those
    level with ego whose front is through and ahead of ego's are lost, too: of two that squeeze in
    abreast, the later one does not surely take the other's turn.
    """
    arrives = context.spans.next_state(context.ego_extents.s_max[0] > place)
    never = arrives >= context.spans.end
    then = np.where(never, context.spans.columns, arrives)
    seen = context.relevant[:, then] & ~never
    ahead = relations.station(context)[:, then] == relations.BEHIND
    front = context.extents.s_max[:, then]
    is_first = (front > place) & (front > context.ego_extents.s_max[0, then])
    there: Flags = seen & ~ahead & ~is_first & (front >= place - _JUST_BEFORE_M)
    return there, ~seen | (~ahead & is_first)


def _beside_in(context: DriveContext, lane: NDArray[intp]) -> Flags:
    """Mask of vehicles that go ego's way beside it in a lane, given by state."""
    inside = context.in_lane(lane)
    beside: Flags = inside & (relations.station(context) == relations.BESIDE) & context.going_along
    return beside


@once_a_road
def merges(context: DriveContext) -> tuple[tuple[float, int, bool], ...]:
    """Places along the road where a lane and the next one to its left become one.

    The last value is False where one of them may go on beyond the map.
    """
    return tuple(_merges(context))


def _merges(context: DriveContext) -> Iterator[tuple[float, int, bool]]:
    rows, borders = context.road.rows, context.road.borders
    whole = "lanes" in context.recording.complete
    for piece, (row, after) in enumerate(pairwise(rows)):
        onward = {lanelet.id for lanelet in after if lanelet is not None}
        for right, (lanelet, other) in enumerate(pairwise(row)):
            # Traffic from a ramp gives way, and traffic that leaves does not go on beside the road
            if lanelet is None or other is None or (lanelet.types | other.types) & RAMPS:
                continue
            ways = [set(lanelet.successors) & onward for lanelet in (lanelet, other)]
            if ways[0] == ways[1] and len(ways[0]) == 1:
                if any(_is_one_of_several(context.recording, x) for x in (lanelet, other)):
                    continue
                yield float(borders[piece + 1]), right, True
            elif sum(bool(way) for way in ways) == 1:
                ends, goes = (lanelet, other) if not ways[0] else (other, lanelet)
                turned = all(turns_back(goes, x) for x in after if x and x.id in goes.successors)
                if not ends.successors and not turned:
                    yield float(borders[piece + 1]), right, whole or _tapers(ends)


def _is_one_of_several(recording: Recording, lanelet: Lanelet) -> bool:
    """Whether a lanelet is a short way from a lane from which others lead on, too."""
    before = [recording.lanelets[x] for x in lanelet.predecessors if x in recording.lanelets]
    return any(len(x.successors) > 1 for x in before) and lanelet_length(lanelet) < _WAY_M


def _tapers(lanelet: Lanelet) -> bool:
    widths = np.hypot(*(lanelet.left[[0, -1]] - lanelet.right[[0, -1]]).T)
    return bool(widths[1] < _TAPERED * widths[0])
