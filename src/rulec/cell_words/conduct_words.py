"""Words about what ego does among others, bounded over all places that it may have in a cell.

A word is known where the others, or the road, allow only one value for all of these places; see
``extraction/signals/`` for what the words mean.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.cell_words.ego_boxes import EgoBoxes, column
from rulec.cell_words.relation_words import BEHIND, BESIDE, IN_FRONT, LEFT, RIGHT, Relations
from rulec.cell_words.road_frame import OthersNow, RoadFrame
from rulec.extraction.signals.map.exit_room import ROOM_M
from rulec.extraction.traffic_thresholds import USUAL
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.vocabulary.partial_values import UNKNOWN

CONDUCT = frozenset(
    {
        "being_overtaken",
        "overtaking",
        "oncoming_clear",
        "straddling",
        "lane_change",
        "enters_junction",
        "exit_clear",
    }
)

_HAIR_M = 0.05


class ConductWords:
    """What ego does in each cell of a layer (rows) given where the others are (columns).

    ``others`` has them in the layer before, and now.
    """

    def __init__(
        self, boxes: EgoBoxes, others: Sequence[OthersNow], frame: RoadFrame, relations: Relations
    ) -> None:
        self._earlier, self._others = others
        self._boxes, self._frame, self._relations = boxes, frame, relations
        self._straight = frame.probes.origin.lanes.straight

    def words(self, names: frozenset[str]) -> Mapping[str, list[Any]]:
        """Name -> its values by cell."""
        never = {
            "being_overtaken": self._overtaken_by_nobody,
            "overtaking": self._overtakes_nobody,
            "straddling": self._within_a_lane,
            "lane_change": self._stays_in_lane,
            "enters_junction": self._at_no_entry,
        }
        found: dict[str, list[Any]] = {
            name: _known(never[name](), value=False) for name in never.keys() & names
        }
        always = {"oncoming_clear": self._meets_nobody, "exit_clear": self._has_room_beyond}
        return found | {name: _known(always[name](), value=True) for name in always.keys() & names}

    @cached_property
    def _lanes(self) -> Flags:
        """Mask of the lanes that ego's middle may be in, by cell."""
        (low, high), aside = self._boxes.d, _HAIR_M + self._frame.bent(self._boxes.s)
        found: Flags = (self._straight[None, :-1] <= column(high + aside)) & (
            self._straight[None, 1:] >= column(low - aside)
        )
        return found

    @cached_property
    def _may_share(self) -> Flags:
        """Mask of others that may reach into ego's lane."""
        found: Flags = self._lanes.astype(int) @ self._others.perhaps.T.astype(int) > 0
        return found

    def _overtaken_by_nobody(self) -> Flags:
        others = self._others
        side = RIGHT if self._frame.probes.among.side == "right" else LEFT
        faster = others.along[1] - column(self._boxes.mean_speed[0])
        comes = others.may_go_along & (faster * KMH_PER_MPS >= USUAL.clearly_faster_kmh)
        comes &= self._relations.stations & (BESIDE | IN_FRONT) > 0
        comes &= self._relations.laterals & side > 0
        comes &= self._relations.gaps[0] <= np.maximum(faster, 0.0) * USUAL.passed_s
        return _nobody(comes)

    def _overtakes_nobody(self) -> Flags:
        others = self._others
        side = LEFT if self._frame.probes.among.side == "right" else RIGHT
        fast = column(self._boxes.mean_speed[1])
        slower = (others.may_go_along | others.may_ride_along) & (others.along[0] < fast)
        slower &= self._relations.laterals & side > 0
        reach = np.maximum((fast - others.along[0]) * USUAL.catching_up_s, fast * USUAL.passed_s)
        return self._on_own_side() & _nobody(slower & (self._relations.gaps[0] <= reach))

    def _on_own_side(self) -> Flags:
        """Cells where ego is not beyond the middle of a two-way road, where it would overtake."""
        own: Flags = self._relations.gap_to_oncoming_lanes >= self._frame.loose_d
        return own | self._frame.one_way

    def _meets_nobody(self) -> Flags:
        """Cells where nobody is oncoming from now on; even a later one may meet ego in time."""
        found: Flags = np.full(len(self._boxes.sideways), not self._others.some_come)
        return found

    def _room(self, aside: Floats) -> Flags:
        """Cells with ``aside`` (m) or more to both bounds of ego's lane, wherever ego is."""
        (low, high), loose = self._boxes.d, self._frame.loose_d + self._frame.bent(self._boxes.s)
        lane = np.clip(np.searchsorted(self._straight, low, "right") - 1, 0, None)
        lane = np.minimum(lane, len(self._straight) - 2)
        inside = (low - aside - loose > self._straight[lane]) | (lane == 0)
        top = lane == len(self._straight) - 2
        found: Flags = inside & ((high + aside + loose < self._straight[lane + 1]) | top)
        return found

    def _within_a_lane(self) -> Flags:
        return self._room(self._boxes.half_width[1] - USUAL.touching_m)

    def _stays_in_lane(self) -> Flags:
        """Cells into which ego has come from no other lane since the layer before."""
        return self._room(self._boxes.sideways * self._boxes.came_s + USUAL.changed_m)

    def _at_no_entry(self) -> Flags:
        """Cells where ego's front is before all junctions, or was in them in the layer before."""
        (_, far_front), frame = self._relations.front, self._frame
        before = self._boxes.front_before
        away = np.ones(len(before), dtype=bool)
        for start, _ in frame.junctions:
            loose = frame.loose_s + _HAIR_M
            away &= (far_front[:, 0] < start - loose) | (before > start + loose)
        return away

    def _has_room_beyond(self) -> Flags:
        """Cells where nobody ahead in ego's lane may leave too little room behind what it enters.

        Neither now nor since the layer before, when ego may have entered it.
        """
        frame, loose = self._frame, self._frame.apart_s + _HAIR_M
        others, earlier = self._others, self._earlier
        nearest, farthest = np.fmin(others.s[0], earlier.s[0]), np.fmax(others.s[1], earlier.s[1])
        (_, far_front), (rear, _) = self._relations.front, self._relations.rear
        if frame.has_rails:
            return np.zeros(len(far_front), dtype=bool)
        ahead = others.may_go_along | earlier.may_go_along
        ahead = ahead & (self._relations.stations & BEHIND > 0) & self._may_share
        room = 2 * column(self._boxes.half_length[1]) + ROOM_M + loose
        short = np.zeros(ahead.shape, dtype=bool)
        for start, end in (*frame.junctions, *frame.crossings):
            enters = (far_front >= start - USUAL.approach_m - loose) & (rear <= end + loose)
            leaves_too_little = (farthest > start - loose) & (nearest < end + room)
            short |= enters & leaves_too_little
        return _nobody(ahead & short)


def _nobody(flags: Flags) -> Flags:
    """Cells (rows) in which no flag of the others is set."""
    found: Flags = ~np.any(flags, axis=1, keepdims=False)
    return found


def _known(flags: Flags, *, value: bool) -> list[Any]:
    return [value if flag else UNKNOWN for flag in flags.tolist()]
