"""Words about lines at which ego may have to stop: whether it crosses one, and the light there.

Ego crosses a line between two layers, and a light may have changed by then; so the words of a cell
cover all moments since the layer before.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from math import ceil, floor
from typing import Any

import numpy as np

from rulec.array_types import Flags, Floats
from rulec.cell_words.ego_boxes import EgoBoxes, column
from rulec.cell_words.place_words import LOOSE_M, Words, hull, lanes_of
from rulec.cell_words.probe_drives import EVERY_M, ProbeDrives
from rulec.cell_words.road_frame import LaneLight, RoadFrame
from rulec.extraction.signals.map.line_signals import COLOURS, colours_at
from rulec.extraction.signals.map.stop_lines import LINE_REACH_M
from rulec.extraction.traffic_thresholds import USUAL
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.recording import STOP_SIGNS
from rulec.vocabulary.partial_values import UNKNOWN, OneOf

_LIT, _SIGNED = "crosses_light_line", "crosses_stop_line"

_DARK = "no_light"
_ANY = OneOf(frozenset(COLOURS.values()))

_SLOWEST_MPS = USUAL.standing_kmh / KMH_PER_MPS
_CROSSING_S = USUAL.touching_m / _SLOWEST_MPS
"""A moving vehicle is over a line that the map contains within this time (s)."""

_HAIR = 1e-6


class LineWords:
    """The words about lines, for a scene with these drives along its lanes."""

    def __init__(
        self, probes: ProbeDrives, frame: RoadFrame | None, names: frozenset[str], length_m: float
    ) -> None:
        self._probes, self._names = probes, names
        self._lights: tuple[LaneLight, ...] = () if frame is None else frame.lights
        self._straight = probes.origin.lanes.straight
        self._crossings = {
            name: tuple(_where_crossed(probes, name, length_m / 2))
            for name in (_LIT, _SIGNED)
            if name in names
        }
        lanelets = probes.recording.lanelets.values()
        # Where a drive ends between possible places of such a line, it has perhaps crossed it
        self._vague_signs = any(
            STOP_SIGNS & lanelet.signs and lanelet.stop_line is None for lanelet in lanelets
        )

    def crossings(self, boxes: EgoBoxes, *, is_last: bool) -> dict[str, Flags]:
        """Name -> mask of cells in which ego may have crossed such a line."""
        vague = LINE_REACH_M if is_last and self._vague_signs else 0.0
        return {
            name: _may_cross(boxes, lines, vague if name == _SIGNED else 0.0)
            for name, lines in self._crossings.items()
        }

    def lights(
        self,
        boxes: EgoBoxes,
        places: Sequence[Words],
        start_s: float,
        crossings: Mapping[str, Flags],
    ) -> list[Any]:
        """The light, by cell; ``places`` are the words of cells by place, at some time's lights."""
        first, last = lanes_of(boxes, self._straight)
        begin, end = boxes.front_before, boxes.s[1] + boxes.half_length[1]
        crosses = crossings.get(_LIT, np.zeros(len(places), dtype=bool))
        rows = zip(*(own.tolist() for own in (crosses, first, last, begin, end)), strict=True)
        known: dict[object, Any] = {}
        found = []
        for place, (may_cross, low, high, behind, ahead) in zip(places, rows, strict=True):
            near = tuple(
                number
                for number, light in enumerate(self._lights)
                if low <= light.lane <= high
                and behind - 2 * LINE_REACH_M <= light.end
                and light.end <= ahead + USUAL.light_reach_m + LINE_REACH_M
            )
            key = place.get("light", UNKNOWN), near, may_cross
            if key not in known:
                known[key] = self._shown(key[0], near, start_s, boxes.came_s if may_cross else 0.0)
            found.append(known[key])
        return found

    def _shown(self, said: Any, near: Sequence[int], start_s: float, since_s: float) -> Any:
        """What lights may show to ego at a time of the scene, or when it crossed their lines."""
        lights = [self._lights[number] for number in near]
        if said is UNKNOWN or (said == _DARK and not any(light.goes_dark for light in lights)):
            return said
        if not lights or (since_s and not all(light.drawn for light in lights)):
            return _ANY
        step_s, start = self._probes.recording.step_s, self._probes.origin.start.step
        begin = end = start_s / step_s
        if since_s:
            begin -= (since_s + _CROSSING_S) / step_s + 2
        steps = np.arange(start + floor(begin + _HAIR), start + ceil(end - _HAIR) + 1)
        shown = {colour for x in lights for colour in colours_at(x.lights, steps).tolist()}
        if "" in shown:
            return UNKNOWN
        dark = said == _DARK or (isinstance(said, OneOf) and _DARK in said.values)
        return hull([*sorted(shown), *([_DARK] if dark else [])])


def _may_cross(boxes: EgoBoxes, lines: Sequence[tuple[float, float]], reach_m: float) -> Flags:
    """Mask of cells that ego may have reached over one of the lines since the layer before."""
    ends: Floats = np.array(lines, dtype=np.float64).reshape(-1, 2)
    beyond = column(boxes.s[1] + boxes.half_length[1]) >= ends[:, 0] - LOOSE_M - reach_m
    before = column(boxes.front_before) <= ends[:, 1] + LOOSE_M
    found: Flags = np.any(beyond & before, axis=1)
    return found


def _where_crossed(probes: ProbeDrives, name: str, half_m: float) -> Iterator[tuple[float, float]]:
    """The intervals of ego's front in which it crosses a line, or may cross it.

    Includes places along a lane that were not probed.
    """
    for lane, begin, end in probes.stretches:
        own = sorted(
            (probe for probe in probes.lanes if probe.lane == lane and begin <= probe.s[0] <= end),
            key=lambda probe: float(probe.s[0]),
        )
        ends = [begin, *(float(at) for probe in own for at in (probe.s[0], probe.s[-1])), end]
        for number, (low, high) in enumerate(zip(ends[::2], ends[1::2], strict=True)):
            # The first state of a drive does not show what it has crossed
            if high - low > 2 * EVERY_M or 0 < number < len(own):
                yield low + half_m, high + half_m
        for probe in own:
            perhaps = [state.get(name, UNKNOWN) is not False for state in probe.states]
            steps = pairwise([float(probe.s[0]) - EVERY_M, *probe.s.tolist()])
            for (before, at), crosses in zip(steps, perhaps, strict=True):
                if crosses:
                    yield before + half_m, at + half_m
