"""The words of recorded drives in the cells of a graph: values, bounds, or unknown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, hypot
from typing import Any

import numpy as np

from rulec.array_types import Flags
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.cell_words.conduct_words import CONDUCT, ConductWords
from rulec.cell_words.ego_boxes import EgoBoxes, body_size, ego_boxes
from rulec.cell_words.line_words import LineWords
from rulec.cell_words.place_words import (
    AT_LINE,
    LOOSE_M,
    NEEDS_CROSSING,
    NEEDS_JUNCTION,
    OF_LANES,
    OF_OTHERS,
    PlaceWords,
    SceneWords,
    Words,
    lanes_of,
    settled_by_place,
)
from rulec.cell_words.probe_drives import ProbeDrives, probe_drives
from rulec.cell_words.relation_words import FLOWS, RELATIONS, Relations
from rulec.cell_words.road_frame import RoadFrame
from rulec.diagnostics import RulecError
from rulec.extraction.recording_verdicts import names_read
from rulec.extraction.selection import RequestedDrives, chosen_side
from rulec.extraction.traffic_thresholds import USUAL
from rulec.partition import NavigationGraph
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.scenario.recorded.scene_origin import SceneOrigin
from rulec.trace import State
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval

_HAIR_S = 1e-6
_BEFORE_M, _BEYOND_M = 100.0, 250.0
"""Anything farther (m) behind or ahead of ego's possible places affects no word."""


@dataclass(frozen=True, slots=True, eq=False)
class CellWords:
    """The words in each cell of a graph.

    ``states[p][i]`` is the state of cell ``i`` of layer ``p``; ``told`` are the names that the
    recording supplies, and ``faults`` those that a fault of rulec has cost. ``types`` are all
    participants' types, the most specific first, by their ids in the recording; ``present`` are
    their first and last layers.
    """

    states: tuple[tuple[State, ...], ...]
    told: frozenset[str]
    types: Mapping[str, tuple[str, ...]]
    present: Mapping[str, tuple[int, int]]
    faults: Mapping[str, RulecError]


def cell_words(graph: NavigationGraph, rules: CompiledRulebook) -> CellWords | None:
    """The words that rules read in the cells of a recorded scene; None for any other scene.

    The scene's traffic keeps to the rules' side (``mirrored_scene.on_side_of``).
    """
    account = graph.scenario.account
    origin = None if account is None else account.origin
    if not isinstance(origin, SceneOrigin):
        return None
    side, mirrored = chosen_side(origin.recording, RequestedDrives(), rules.traffic)
    assert not mirrored
    of_others = NEEDS_JUNCTION | NEEDS_CROSSING
    probes = probe_drives(
        graph, origin, rules, side, of_others, in_time=OF_OTHERS, measured=RELATIONS
    )
    boxes = list(ego_boxes(graph, probes.recording.step_s))
    lanes = {
        lane
        for own in boxes
        for first, last in zip(*lanes_of(own, origin.lanes.straight), strict=True)
        for lane in range(first, last + 1)
    }
    try:
        half_m, ego_d = hypot(*body_size(graph)) / 2, graph.scenario.ego.d
        frame = RoadFrame(probes, half_m, ego_d, sorted(lanes))
    except ValueError:
        frame = None
    return _Words(graph, rules, probes, frame, boxes).all()


class _Words:
    """The words of a graph, layer by layer."""

    def __init__(
        self,
        graph: NavigationGraph,
        rules: CompiledRulebook,
        probes: ProbeDrives,
        frame: RoadFrame | None,
        boxes: Sequence[EgoBoxes],
    ) -> None:
        self._graph, self._probes, self._frame, self._boxes = graph, probes, frame, boxes
        self._vocabulary: Vocabulary = rules.vocabulary
        self._names = names_read(rules) & probes.told
        self._scene = self._scene_words()
        self._may_leave = frame is None or any(
            frame.leaving[first : last + 1].any()
            for boxes in self._boxes
            for first, last in zip(*lanes_of(boxes, probes.origin.lanes.straight), strict=True)
        )
        self._constants = self._scene.constants(self._names & {*self._vocabulary.constants})
        self._at_lines = PlaceWords(probes, self._names & AT_LINE)
        self._places = PlaceWords(probes, self._names)
        self._lines = LineWords(probes, frame, self._names, body_size(graph)[0])
        self._bodies = probes.among.recording.participants[:-1]
        self._rows = {body.id: row for row, body in enumerate(self._bodies)}
        self._now = [
            None if frame is None else frame.at(layer.start_s, own.s[1].max(initial=0.0))
            for layer, own in zip(graph.layers, boxes, strict=True)
        ]
        self._present = self._presences()

    def all(self) -> CellWords:
        """All words of all cells."""
        return CellWords(
            tuple(tuple(self._layer(number)) for number in range(len(self._graph.layers))),
            self._probes.told,
            {item: self._bodies[self._rows[item]].object_types for item in self._present},
            self._present,
            self._probes.faults,
        )

    def _scene_words(self) -> SceneWords:
        low = min(float(box.s[0].min()) for box in self._boxes if len(box.s[0]))
        high = max(float(box.s[1].max()) for box in self._boxes if len(box.s[1]))
        frame = self._frame

        def near(stretches: Sequence[tuple[float, float]]) -> bool:
            return any(
                not (end <= low - _BEFORE_M or start >= high + _BEYOND_M)
                for start, end in stretches
            )

        crossings = frame is None or near(frame.crossings)
        rails = any(
            "level_crossing" in lanelet.types
            for lanelet in self._probes.recording.lanelets.values()
        )
        junctions = frame is None or near(frame.junctions)
        return SceneWords(
            self._probes,
            self._names,
            no_junction=not (junctions or crossings or rails),
            no_crossing=not crossings,
            straight=frame is not None and frame.goes_straight,
        )

    def _presences(self) -> dict[str, tuple[int, int]]:
        """First and last layers of all that may count for ego or are on the scene's road near it.

        By their ids in the recording, since a participant that leaves the scene's road and comes
        back may be beside it meanwhile. Rules do not see participants that are too far away to
        count, wherever ego may be, nor before or after they are recorded. A participant beside only
        another lane's road is present for an ego that goes on in that lane.
        """
        spans: dict[str, tuple[int, int]] = {}
        on_road = [
            (obstacle.id, *self._graph.present[name])
            for name, obstacle in self._graph.objects.items()
        ]
        recorded = {item: self._recorded(item) for item, *_ in on_road}
        for number, boxes in enumerate(self._boxes):
            now = self._now[number]
            there = [
                item
                for item, first, last in on_road
                if first <= number <= last and number in recorded[item]
            ]
            if now is not None and len(boxes.s[0]):
                aside = USUAL.near_m + boxes.half_length[1].max() + now.loose_s
                begin, end = boxes.s[0].min() - aside, boxes.s[1].max() + aside
                far = (now.s[1] <= begin) | (now.s[0] >= end)
                there = [item for item in there if not far[self._rows[item]]]
                rows = np.flatnonzero(now.is_there & ~far).tolist()
                there += [self._bodies[row].id for row in rows]
                said = self._scene.present(self._states(number))
                there += [item for item in said if not far[self._rows[item]]]
            for item in there:
                first, last = spans.get(item, (number, number))
                spans[item] = min(first, number), max(last, number)
        return spans

    def _recorded(self, item: str) -> range:
        """The layers in which a participant is recorded, including gaps in its record."""
        body, origin = self._bodies[self._rows[item]], self._probes.origin
        starts = [layer.start_s for layer in self._graph.layers]
        if body.standing or not body.outlines:
            return range(len(starts))
        begin, end = (
            (step - origin.start.step) * origin.recording.step_s
            for step in (min(body.outlines), max(body.outlines))
        )
        there = [p for p, at in enumerate(starts) if begin - _HAIR_S <= at <= end + _HAIR_S]
        return range(there[0], there[-1] + 1) if there else range(0)

    def _states(self, number: int) -> list[int]:
        """The state of the scene's time at which a layer begins, or those before and after it."""
        at = self._graph.layers[number].start_s / self._probes.recording.step_s
        return sorted({int(np.floor(at + 1e-6)), int(np.ceil(at - 1e-6))})

    def _layer(self, number: int) -> Iterator[State]:
        layer, boxes = self._graph.layers[number], self._boxes[number]
        if not layer.cells:
            return
        items = [item for item, (first, last) in self._present.items() if first <= number <= last]
        shared = self._shared(number, items)
        places = self._places.of_cells(boxes)
        own = self._own_words(boxes)
        about = self._relations(boxes, number, items)
        crosses = self._lines.crossings(boxes, is_last=number == len(self._graph.layers) - 1)
        at_lines = self._at_lines_of(boxes, places, [*crosses.values()], about)
        own |= {name: [UNKNOWN if x else False for x in flags] for name, flags in crosses.items()}
        if "light" in self._names:
            own["light"] = self._lines.lights(boxes, at_lines, layer.start_s, crosses)
        doubtful = self._in_doubt(boxes)
        for cell, (place, at_line) in enumerate(zip(places, at_lines, strict=True)):
            state: Words = {**shared, **place, **at_line, **settled_by_place(place, self._names)}
            state |= doubtful[cell]
            state |= {name: values[cell] for name, values in own.items()}
            state |= {name: values[cell] for name, values in about.items()}
            yield state

    def _in_doubt(self, boxes: EgoBoxes) -> list[Words]:
        """The words that are unknown in each cell as drives in other lanes have others there."""
        low, high = boxes.s[0] - LOOSE_M, boxes.s[1] + LOOSE_M
        doubtful = np.zeros(len(low), dtype=bool)
        for start, end in () if self._frame is None else self._frame.other_lanes:
            doubtful |= (low <= end) & (high >= start)
        unknown = dict.fromkeys(self._names & OF_LANES, UNKNOWN)
        return [unknown if one else {} for one in doubtful.tolist()]

    def _at_lines_of(
        self,
        boxes: EgoBoxes,
        places: Sequence[Words],
        crosses: Sequence[Flags],
        about: Mapping[str, Sequence[Any]],
    ) -> list[Words]:
        """Words of signs and lights in each cell; where ego may have passed theirs, from before."""
        passes = np.any([np.zeros(len(places), dtype=bool), *crosses], axis=0)
        passes |= [one is not False for one in about.get("enters_junction", passes)]
        if not (self._at_lines.differ and passes.any()):
            return list(places)
        before = self._at_lines.of_cells(boxes, boxes.came)
        return [
            one if there else place
            for one, there, place in zip(before, passes.tolist(), places, strict=True)
        ]

    def _shared(self, number: int, items: Sequence[str]) -> Words:
        """The words that are the same in all cells of a layer, including unknown ones."""
        everywhere, about_all = self._scene.everywhere, self._scene.about_all
        of_others = self._scene.of_others(self._states(number))
        words: Words = {}
        for name in self._names:
            declaration = self._vocabulary.declarations.get(name)
            if declaration is None:
                continue
            if not declaration.parameters:
                words[name] = everywhere.get(name, self._by_motion(name))
            else:
                said = of_others.get(name, {}) | self._constants.get(name, {})
                if name == "leads_elsewhere" and self._may_leave:
                    # An ego that leaves the road for good has another one, on which others may be
                    # or not
                    said = {}
                words[name] = {item: said.get(item, about_all.get(name, UNKNOWN)) for item in items}
        return words

    def _by_motion(self, name: str) -> Any:
        """What the bounds of ego's motion imply everywhere: it moves ahead, on its lanes."""
        if self._graph.bounds is not None and name in ("reversing", "u_turn", "joins_road"):
            return False
        if name in ("lane_change", "straddling") and len(self._graph.scenario.road.lanes) == 2:
            return False
        return UNKNOWN

    def _own_words(self, boxes: EgoBoxes) -> dict[str, list[Any]]:
        """Words of ego's speed, by cell."""
        if "speed" not in self._names:
            return {}
        slow, fast = (speed * KMH_PER_MPS for speed in boxes.mean_speed)
        low = np.where(slow < 2 * USUAL.standing_kmh, 0.0, slow)
        ends = zip(low.tolist(), fast.tolist(), strict=True)
        return {"speed": [Interval(floor(x * 100) / 100, ceil(y * 100) / 100) for x, y in ends]}

    def _relations(
        self, boxes: EgoBoxes, number: int, items: Sequence[str]
    ) -> dict[str, list[Any]]:
        """The relations to others, by cell, and how slow all traffic around ego is."""
        before, now = self._now[max(number - 1, 0)], self._now[number]
        names = self._names & RELATIONS
        unknown = dict.fromkeys(items, UNKNOWN)
        if now is None or self._frame is None:
            return {name: [dict(unknown) for _ in boxes.s[0]] for name in names}
        relations = Relations(boxes, now, self._frame)
        flows = {name: relations.flow(FLOWS[name]) for name in self._names & FLOWS.keys()}
        counts = now.counts.tolist()
        rows = [(item, self._rows.get(item)) for item in items]
        sure = [(item, row) for item, row in rows if row is not None and counts[row]]
        conduct = ConductWords(boxes, (before or now, now), self._frame, relations)
        found: dict[str, list[Any]] = {**flows, **conduct.words(self._names & CONDUCT)}
        for name, values in relations.words(names).items():
            found[name] = [{**unknown, **{item: own[row] for item, row in sure}} for own in values]
        return found
