"""Words about ego and another participant, bounded over all places that ego may have in a cell.

Each set or interval contains what extraction finds for any of these places; see
``extraction/signals/relations.py`` for what the words mean.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.cell_words.ego_boxes import Bounds, EgoBoxes, column
from rulec.cell_words.road_frame import OthersNow, RoadFrame
from rulec.extraction.signals.flow_signals import TIMES_AS_FAST
from rulec.extraction.signals.measured_numbers import LONGEST_S
from rulec.extraction.traffic_thresholds import USUAL
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.scenario.paper_words import LATERALS, STATIONS
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf

RELATIONS = frozenset(
    {
        "station",
        "lateral",
        "gap",
        "lateral_gap",
        "speed_difference",
        "time_headway",
        "time_to_collision",
        "safe_gap",
        "ahead_for",
        "precedes",
        "one_between",
        "parts_soon",
        "holds_up_oncoming",
    }
)

BEHIND, BESIDE, IN_FRONT = 1, 2, 4
RIGHT, SAME, LEFT = 1, 2, 4
_ALL = 7
_HAIR_M = 0.02
_MAP_M = 2.0
"""The map may be displaced sideways by this (m) from where all traffic drives."""

FLOWS = {
    "congested": USUAL.congested_kmh,
    "walking_pace_flow": USUAL.walking_pace_kmh,
}
"""Word -> the median speed (km/h) below which it holds for traffic."""


class Relations:
    """The relations of ego in each cell of a layer (rows) to each of the others (columns)."""

    def __init__(self, boxes: EgoBoxes, others: OthersNow, frame: RoadFrame) -> None:
        self._boxes, self._others, self._frame = boxes, others, frame
        self._straight = frame.probes.origin.lanes.straight
        self._ahead = others.s[0] - frame.loose_s, others.s[1] + frame.loose_s
        # Front and rear of ego, at their least and greatest
        half = boxes.half_length
        self.front = column(boxes.s[0] + half[0]), column(boxes.s[1] + half[1])
        self.rear = column(boxes.s[0] - half[1]), column(boxes.s[1] - half[0])
        self._bent_d = column(frame.bent(boxes.s))
        self._aside_d = column(frame.bounds_apart(boxes.s)) + self._bent_d
        self.stations = self._stations()
        self.laterals = self._laterals()

    def _stations(self) -> np.ndarray[Any, np.dtype[np.int8]]:
        (front, far_front), (rear, far_rear) = self.front, self.rear
        (low, high), apart = self._others.s, self._frame.apart_s
        found = np.where(front <= low + apart, BEHIND, 0)
        found |= np.where((far_front > low - apart) & (rear < high + apart), BESIDE, 0)
        found |= np.where(far_rear >= high - apart, IN_FRONT, 0)
        return found.astype(np.int8)

    def _laterals(self) -> np.ndarray[Any, np.dtype[np.int8]]:
        """Sides by lanes: those that ego's middle is beside, and those in none of its lanes.

        A participant that is hardly in ego's lane but in the way of its body is in the lane.
        """
        boxes, others, straight = self._boxes, self._others, self._straight
        begin, end = others.right[0], others.left[1]
        low, high = self._sides()
        low, high = low + _HAIR_M, high - _HAIR_M
        width = column(boxes.half_width[1]) + self._frame.loose_d
        touches, count = others.perhaps.any(axis=1), others.perhaps.shape[1]
        first = np.where(touches, others.perhaps.argmax(axis=1), 0)
        last = np.where(touches, count - 1 - others.perhaps[:, ::-1].argmax(axis=1), count - 1)
        right_edge = np.where(touches, straight[first], begin)
        left_edge = np.where(touches, straight[last + 1], end)
        # A participant that reaches into ego's lane is in its way as far as ego's body is in theirs
        right_bound, left_bound = (straight[own_lane] for own_lane in self._own_lanes(low, high))
        # By how much is in doubt there, and drives consider what was so before
        loose = self._frame.place_m + _HAIR_M
        right = (high <= right_edge) & ((begin >= left_bound + loose) | (high + width < begin))
        left = (low >= left_edge) & ((end <= right_bound - loose) | (low - width > end))
        before, beyond = ((others.right[k] + others.left[k]) / 2 for k in (0, 1))
        found = np.where(high < before, RIGHT | SAME, np.where(low > beyond, SAME | LEFT, _ALL))
        found = np.where(right, RIGHT, np.where(left, LEFT, found))
        return np.where(self._surely_same(), SAME, found).astype(np.int8)

    def _surely_same(self) -> Flags:
        """Mask of others whose lanes contain ego's middle, wherever it is in the cell.

        Except those that reach beyond ego's lane and may be clear of ego sideways. Where the
        tolerance of places decides, extraction has an unknown value.
        """
        others, loose, straight = self._others, self._frame.apart_d, self._straight
        begin, end = others.right[0], others.left[1]
        low, high = self._sides()
        lanes, some = others.lanes, others.lanes.any(axis=1)
        first = np.where(some, lanes.argmax(axis=1), 0)
        last = np.where(some, lanes.shape[1] - 1 - lanes[:, ::-1].argmax(axis=1), -1)
        inside = (low + _HAIR_M >= straight[first]) & (high - _HAIR_M <= straight[last + 1])
        wide, reach = column(self._boxes.half_width[0]), USUAL.touching_m - loose
        right, left = self._own_lanes(low + _HAIR_M, high - _HAIR_M)
        # Of several lanes, the innermost bounds are exceeded first
        nearest = np.minimum(straight[right + 1], straight[left])
        farthest = np.maximum(straight[left - 1], straight[right])
        beyond = (end - nearest > reach) | (farthest - begin > reach)
        clear = np.maximum(others.right[1] - low - wide, high - wide - others.left[0]) > reach
        same: Flags = some & inside & ~(beyond & clear)
        return same

    def _sides(self) -> Bounds:
        """The range of places (m) across the road of ego's middle, by the lanes of drives."""
        low, high = self._boxes.d
        return column(low) - self._aside_d, column(high) + self._aside_d

    def _own_lanes(self, low: Floats, high: Floats) -> tuple[NDArray[intp], NDArray[intp]]:
        """The right bound of the first lane in which ego's middle is, and the left one of the last.

        As indices; ``low`` and ``high`` are the ends of its range across the road (m).
        """
        straight, count = self._straight, len(self._straight)
        right = np.clip(np.searchsorted(straight, low, "right") - 1, 0, count - 2)
        return right, np.clip(np.searchsorted(straight, high, "left"), 1, count - 1)

    @cached_property
    def gaps(self) -> Bounds:
        """The least and the greatest gap (m), negative where bodies are beside each other."""
        (low, high), (front, far_front), (rear, far_rear) = self._ahead, self.front, self.rear
        least = np.maximum(low - far_front, rear - high)
        inward = self._others.s[0] + self._frame.loose_s, self._others.s[1] - self._frame.loose_s
        return least, np.maximum(inward[0] - front, far_rear - inward[1])

    def words(self, names: frozenset[str]) -> Mapping[str, list[list[Any]]]:
        """Name -> its values, by cell and other participant."""
        found: dict[str, list[list[Any]]] = {}
        if "station" in names:
            found["station"] = _texts(self.stations, STATIONS)
        if "lateral" in names:
            found["lateral"] = _texts(self.laterals, LATERALS)
        near, far = (np.maximum(gap, 0.0) for gap in self.gaps)
        if "gap" in names:
            found["gap"] = _intervals(near, far)
        if "lateral_gap" in names:
            found["lateral_gap"] = _intervals(*self._aside())
        if "speed_difference" in names:
            found["speed_difference"] = _intervals(*self._differences())
        if "time_headway" in names:
            found["time_headway"] = _intervals(*self._headways(near, far))
        ahead = self._may_be_ahead()
        if "safe_gap" in names:
            found["safe_gap"] = _truths(~ahead | (near > self._safe_distance()), True)
        if "precedes" in names:
            found["precedes"] = _truths(~ahead, False)
        if "one_between" in names:
            # A participant ahead in ego's lane may be nearer than one in another lane
            nobody = np.broadcast_to(~ahead.any(axis=1, keepdims=True), ahead.shape)
            found["one_between"] = _truths(nobody, False)
        if "parts_soon" in names:
            # Ego's next move is what is being chosen: nobody is excused for it in advance
            found["parts_soon"] = _truths(np.ones(ahead.shape, dtype=bool), False)
        if "holds_up_oncoming" in names:
            clear = ~self._others.ever_come | self._within_own_half()[:, None]
            found["holds_up_oncoming"] = _truths(clear, False)
        if "ahead_for" in names:
            nothing = np.zeros(ahead.shape)
            found["ahead_for"] = _intervals(nothing, np.where(ahead, LONGEST_S, 0.0))
        if "time_to_collision" in names:
            found["time_to_collision"] = _intervals(
                np.where(ahead, 0.0, LONGEST_S), np.full(ahead.shape, LONGEST_S)
            )
        return found

    def _within_own_half(self) -> Flags:
        """Cells in which no part of ego is beyond the middle of a two-way road."""
        frame, wide = self._frame, self._boxes.half_width[1] - USUAL.touching_m
        own: Flags = self.gap_to_oncoming_lanes >= wide + frame.loose_d
        return own | frame.one_way

    @cached_property
    def gap_to_oncoming_lanes(self) -> Floats:
        """How far (m) ego's middle stays from the lanes of the other direction, by cell."""
        places = self.rear[0][:, 0], self.front[1][:, 0]
        return self._frame.gap_to_oncoming_lanes(places, self._boxes.d)

    def flow(self, below_kmh: float) -> list[Any]:
        """Whether the median speed of traffic around ego is below ``below_kmh``, by cell.

        A lane may flow where a vehicle may be much faster, and an empty lane may have others.
        """
        others, limit = self._others, below_kmh / KMH_PER_MPS
        near, far = self.gaps
        may = others.may_go_along & (near <= USUAL.near_m)
        must = others.goes_along & (far <= USUAL.flow_reach_m)
        low, high = (np.maximum(speed, 0.0) for speed in others.along)
        slow, fast = self._boxes.mean_speed
        may_be_slow = (may & (low < limit)).sum(axis=1) + (slow < limit)
        may_be_fast = (may & (high >= limit)).sum(axis=1) + (fast >= limit)
        is_slow = (must & (high < limit)).sum(axis=1) + (fast < limit)
        is_fast = (must & (low >= limit)).sum(axis=1) + (slow >= limit)
        no = (may.sum(axis=1) + 1 < USUAL.fewest) | (is_fast > may_be_slow)
        yes = (must.sum(axis=1) + 1 >= USUAL.fewest) & (is_slow > may_be_fast)
        # On half of the lanes that exist
        one_lane = others.lanes & (others.perhaps.sum(axis=1, keepdims=True) == 1)
        used = (must & (high < limit)).astype(int) @ one_lane.astype(int) > 0
        surely, perhaps = self._frame.travel_lanes(self._boxes.s)
        yes &= 2 * (used & surely).sum(axis=1) >= perhaps.sum(axis=1)
        flows = TIMES_AS_FAST * limit
        yes &= ~(may & (high >= flows)).any(axis=1) & (fast < flows)
        return [
            True if one else False if other else UNKNOWN
            for one, other in zip(yes.tolist(), no.tolist(), strict=True)
        ]

    def _aside(self) -> Bounds:
        boxes, others = self._boxes, self._others
        own, theirs = (self._frame.line_apart(ends) for ends in (boxes.s, others.s))
        loose = self._frame.loose_d + self._frame.stretched + column(own) + theirs + self._bent_d
        wide, narrow = column(boxes.half_width[1]), column(boxes.half_width[0])
        low, high = column(boxes.d[0]), column(boxes.d[1])
        least = np.maximum(others.d[0] - high - wide, low - wide - others.d[1]) - loose
        # Where lanes part, it is the farthest of the possible places
        (_, nearer), (farther, _) = others.right, others.left
        most = np.maximum(nearer - low - narrow, high - narrow - farther) + loose
        return np.maximum(least, 0.0), np.maximum(most, 0.0)

    def _differences(self) -> Bounds:
        standing = USUAL.standing_kmh / KMH_PER_MPS
        low, high = (np.asarray(speed) for speed in self._others.along)
        # A participant that may stand has no speed
        still = (np.minimum(np.abs(low), np.abs(high)) < standing) | (low * high < 0)
        low, high = (
            np.where(still, np.minimum(low, 0.0), low),
            np.where(still, np.maximum(high, 0.0), high),
        )
        slow, fast = self._boxes.mean_speed
        return (column(slow) - high) * KMH_PER_MPS, (column(fast) - low) * KMH_PER_MPS

    def _headways(self, near: Floats, far: Floats) -> Bounds:
        slow, fast = (column(speed) for speed in self._boxes.mean_speed)
        standing = USUAL.standing_kmh / KMH_PER_MPS
        may_stand = slow < 2 * standing
        longest = np.where(may_stand, LONGEST_S, far / np.maximum(slow, standing))
        shortest = near / np.maximum(fast, standing)
        return np.minimum(shortest, LONGEST_S), np.minimum(longest, LONGEST_S)

    def _may_be_ahead(self) -> Flags:
        """Mask of others that may be ahead in ego's lane, within the errors of places and map.

        In a wide lane, two participants at opposite edges are farther apart than these errors.
        """
        boxes, others, aside = self._boxes, self._others, _MAP_M + self._frame.place_m
        low, high = column(boxes.d[0]) - aside, column(boxes.d[1]) + aside
        before = self.front[0] <= others.s[0] + self._frame.loose_s
        near = (others.d[0] < high) & (others.d[1] > low)
        ahead: Flags = before & (near | (self.laterals & SAME > 0))
        return ahead

    def _safe_distance(self) -> Floats:
        fast = column(self._boxes.mean_speed[1])
        slowest = np.maximum(self._others.along[0], 0.0)
        safe: Floats = USUAL.reaction_s * fast + (fast**2 - slowest**2) / (2 * USUAL.braking_mps2)
        return safe + self._frame.place_m


def _texts(bits: np.ndarray[Any, Any], texts: Sequence[str]) -> list[list[Any]]:
    values = [_one_of(code, texts) for code in range(_ALL + 1)]
    return [[values[code] for code in row] for row in bits.tolist()]


def _one_of(code: int, texts: Sequence[str]) -> Any:
    among = [text for number, text in enumerate(texts) if code >> number & 1]
    if len(among) == 1:
        return among[0]
    return UNKNOWN if len(among) in (0, len(texts)) else OneOf(frozenset(among))


def _intervals(low: Floats, high: Floats) -> list[list[Any]]:
    low = np.floor(low * 100 + 1e-6) / 100
    high = np.maximum(np.ceil(high * 100 - 1e-6) / 100, low)
    unknown, exact = np.isnan(low) | np.isnan(high), low == high
    # These few are put in afterwards
    bounds = np.where(unknown, 0.0, (low, high))
    values: list[list[Any]] = [
        list(map(Interval, *ends)) for ends in zip(*bounds.tolist(), strict=True)
    ]
    for row, own in zip(*(unknown | exact).nonzero(), strict=True):
        values[row][own] = UNKNOWN if unknown[row, own] else float(low[row, own])
    return values


def _truths(known: Flags, value: bool) -> list[list[Any]]:
    return [[value if one else UNKNOWN for one in row] for row in known.tolist()]
