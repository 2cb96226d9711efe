"""Layout of a rule's automaton: positions of states, conditions and lines.

The layered drawing of Sugiyama, Tagawa, Toda, "Methods for visual understanding of hierarchical
system structures" (1981): order by barycentres, then positions by least squares.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from textwrap import wrap

from rulec.report.automata.automaton_model import Automaton, Transition
from rulec.report.pictures.drawing.canvas import Point, text_width

LINE = 16.0
STATE_HEIGHT = 34.0
LAYER_GAP = 26.0
MORE_GAP = 2.0
"""Additional distance per line between two layers, to keep lines apart."""

LOOP = 30.0
MARGIN = 12.0
PORT = 20.0
WIDEST = 30
MOST_LINES = 5

MOST_STATES = 40
MOST_TRANSITIONS = 80
"""A larger automaton would make an unreadable picture."""


@dataclass(frozen=True, slots=True)
class AutomatonState:
    """A state's box as middle and size (px), with its number and text."""

    middle: Point
    width: float
    number: int
    text: tuple[str, ...]

    @property
    def height(self) -> float:
        """The box's height, which depends on its lines of text."""
        return _state_height(self.text)


@dataclass(frozen=True, slots=True)
class TransitionLine:
    """A transition as points from source to target, with its condition's position.

    A loop has the three points of its triangle; its condition is vertically centred on
    ``label_at``, and to its left if ``leftward``.
    """

    transition: Transition
    points: tuple[Point, ...]
    label_at: Point
    leftward: bool = False

    @property
    def text(self) -> tuple[str, ...]:
        """The lines of its condition."""
        return _broken(self.transition.label)


@dataclass(frozen=True, slots=True)
class AutomatonDrawing:
    """The whole drawing, in px from the upper left corner."""

    width: float
    height: float
    states: tuple[AutomatonState, ...]
    lines: tuple[TransitionLine, ...]


def is_too_large(automaton: Automaton) -> bool:
    """Whether a picture would be too large to be useful."""
    return len(automaton.fates) > MOST_STATES or len(automaton.transitions) > MOST_TRANSITIONS


def draw(automaton: Automaton) -> AutomatonDrawing:
    """Lay out an automaton from top to bottom."""
    return _AutomatonLayout(automaton).drawing()


def _broken(text: str) -> tuple[str, ...]:
    lines = wrap(text, WIDEST)
    if len(lines) > MOST_LINES:
        lines = [*lines[: MOST_LINES - 1], f"{lines[MOST_LINES - 1][: WIDEST - 2]} …"]
    return tuple(lines)


class _AutomatonLayout:
    """Layered layout: states in every other layer, lines with conditions between.

    A line that passes a layer has a box of its own there, so that it crosses no text. Boxes are
    numbered, those of states first.
    """

    def __init__(self, automaton: Automaton) -> None:
        self._texts = [
            (str(state),) if fate == "open" else (str(state), f"{fate} for good")
            for state, fate in enumerate(automaton.fates)
        ]
        self._loops: defaultdict[int, list[Transition]] = defaultdict(list)
        self._widths: list[float] = []
        self._boxes: list[LayoutBox] = []
        steps = []
        for transition in automaton.transitions:
            if transition.source == transition.target:
                self._loops[transition.source].append(transition)
            else:
                steps.append(transition)
        level = _levels(automaton)
        leaving = Counter(transition.source for transition in steps)
        arriving = Counter(transition.target for transition in steps)
        for state in range(len(automaton.fates)):
            self._add_state(state, 2 * level[state], max(leaving[state], arriving[state]))
        self._ways = [(transition, self._way(transition)) for transition in steps]

    def _add_state(self, state: int, layer: int, n_lines: int) -> None:
        text = self._texts[state]
        width = max(44.0, text_width(text) + 20, PORT * (n_lines + 1))
        sides = [width / 2 + MARGIN] * 2
        height = _state_height(text)
        for side, loop in enumerate(self._loops[state]):
            condition = _broken(loop.label)
            sides[side] = width / 2 + (LOOP + text_width(condition)) + MARGIN
            height = max(height, LINE * len(condition))
        right, left = sides
        self._widths.append(width)
        self._boxes.append(LayoutBox(layer, left, right, height))

    def _way(self, transition: Transition) -> list[int]:
        start, end = (self._boxes[state].layer for state in (transition.source, transition.target))
        text = _broken(transition.label)
        first = len(self._boxes)
        for layer in range(start + 1, end) if start < end else range(start - 1, end, -1):
            self._boxes.append(
                LayoutBox(layer, MARGIN, MARGIN + text_width(text), LINE * len(text))
            )
            text = ()
        return [transition.source, *range(first, len(self._boxes)), transition.target]

    def drawing(self) -> AutomatonDrawing:
        boxes = self._boxes
        links = [
            (a, b) if boxes[a].layer < boxes[b].layer else (b, a)
            for _, way in self._ways
            for a, b in pairwise(way)
        ]
        x = arrange(boxes, links)
        into = Counter(boxes[lower].layer for _, lower in links)
        # Half the height of each layer, within which lines are straight.
        bands: list[float] = []
        middles: list[float] = []
        bottom = MARGIN
        for layer in range(1 + max(box.layer for box in boxes)):
            height = max(box.height for box in boxes if box.layer == layer)
            top = bottom + LAYER_GAP + MORE_GAP * into[layer]
            bands.append(height / 2)
            middles.append(top + height / 2)
            bottom = top + height
        places = [(at, middles[box.layer]) for at, box in zip(x, boxes, strict=True)]
        states = [
            AutomatonState(places[state], self._widths[state], state, text)
            for state, text in enumerate(self._texts)
        ]
        width = max(at + box.right for at, box in zip(x, boxes, strict=True))
        lines = (*self._lines(places, bands), *self._loop_lines(states))
        return AutomatonDrawing(width, bottom + LAYER_GAP, tuple(states), lines)

    def _lines(self, places: Sequence[Point], bands: Sequence[float]) -> Iterator[TransitionLine]:
        ports = self._ports(places)
        reach = [bands[box.layer] for box in self._boxes]
        for number, (transition, way) in enumerate(self._ways):
            source, *between, target = way
            top, bottom = places[source][1], places[target][1]
            down = 1 if top < bottom else -1
            begin, end = ports[number, 0], ports[number, 1]
            points = [
                (begin, top + down * _state_height(self._texts[source]) / 2),
                (begin, top + down * reach[source]),
            ]
            for box in between:
                x, y = places[box]
                points += [(x, y - down * reach[box]), (x, y + down * reach[box])]
            points += [
                (end, bottom - down * reach[target]),
                (end, bottom - down * _state_height(self._texts[target]) / 2),
            ]
            x, y = places[way[1]]
            yield TransitionLine(transition, tuple(points), (x + 7, y))

    def _ports(self, places: Sequence[Point]) -> dict[tuple[int, int], float]:
        sides: defaultdict[tuple[int, bool], list[tuple[float, int, int]]] = defaultdict(list)
        for number, (_, way) in enumerate(self._ways):
            for end, state, beside in ((0, way[0], way[1]), (1, way[-1], way[-2])):
                below = self._boxes[beside].layer > self._boxes[state].layer
                sides[state, below].append((places[beside][0], number, end))
        ports = {}
        for (state, _), arriving in sides.items():
            pitch = min(self._widths[state] / (len(arriving) + 1), 2 * PORT)
            for index, (_, number, end) in enumerate(sorted(arriving)):
                ports[number, end] = places[state][0] + pitch * (index - (len(arriving) - 1) / 2)
        return ports

    def _loop_lines(self, states: Sequence[AutomatonState]) -> Iterator[TransitionLine]:
        for state in states:
            x, y = state.middle
            for loop, side in zip(self._loops[state.number], (1, -1), strict=False):
                edge = x + side * state.width / 2
                points = ((edge, y - 9), (edge + side * (LOOP - 8), y), (edge, y + 9))
                label_at = (edge + side * (LOOP - 5), y)
                yield TransitionLine(loop, points, label_at, leftward=side < 0)


def _state_height(text: Sequence[str]) -> float:
    return STATE_HEIGHT + LINE * (len(text) - 1)


def _levels(automaton: Automaton) -> list[int]:
    """The level of each state: below all connected states that rank before it.

    States are numbered breadth-first from the start. States with a final verdict rank last, because
    no transition leaves them.
    """

    def rank(state: int) -> tuple[bool, int]:
        return automaton.fates[state] != "open", state

    ends = [(transition.source, transition.target) for transition in automaton.transitions]
    meeting = [*ends, *((target, source) for source, target in ends)]
    level = [0] * len(automaton.fates)
    for state in sorted(range(len(level)), key=rank):
        above = (level[a] for a, b in meeting if b == state and rank(a) < rank(state))
        level[state] = max(above, default=-1) + 1
    return level


SWEEPS = 24


@dataclass(frozen=True, slots=True)
class LayoutBox:
    """A box in a layer: its extent left and right of its links' end, and its height."""

    layer: int
    left: float
    right: float
    height: float


def arrange(boxes: Sequence[LayoutBox], links: Sequence[tuple[int, int]]) -> list[float]:
    """The position of every box within its layer, from 0: where its links end.

    ``links`` are pairs of box numbers in adjacent layers, the earlier layer first. Boxes include
    their margins.
    """
    above: list[list[int]] = [[] for _ in boxes]
    below: list[list[int]] = [[] for _ in boxes]
    for first, second in links:
        below[first].append(second)
        above[second].append(first)
    layers: list[list[int]] = [[] for _ in range(1 + max(box.layer for box in boxes))]
    for number, box in enumerate(boxes):
        layers[box.layer].append(number)
    return _placed(_ordered(layers, above, below), boxes, above, below)


def _ordered(
    layers: list[list[int]], above: Sequence[Sequence[int]], below: Sequence[Sequence[int]]
) -> list[list[int]]:
    best, fewest = layers, _crossings(layers, below)
    current = list(layers)
    for sweep in range(SWEEPS):
        step = 1 if sweep % 2 == 0 else -1
        neighbours = above if step > 0 else below
        for fixed, number in pairwise(range(len(current))[::step]):
            place = {box: index for index, box in enumerate(current[fixed])}
            own = {box: index for index, box in enumerate(current[number])}
            current[number] = sorted(own, key=lambda box: _mean(neighbours[box], place, own[box]))
        crossings = _crossings(current, below)
        if crossings < fewest:
            best, fewest = list(current), crossings
    return best


def _mean(boxes: Sequence[int], place: Mapping[int, float], otherwise: float) -> float:
    return sum(place[box] for box in boxes) / len(boxes) if boxes else otherwise


def _crossings(layers: Sequence[Sequence[int]], below: Sequence[Sequence[int]]) -> int:
    total = 0
    for upper, lower in pairwise(layers):
        place = {box: index for index, box in enumerate(lower)}
        ends = ([place[target] for target in below[box]] for box in upper)
        total += sum(a > b for left, right in combinations(ends, 2) for a in left for b in right)
    return total


def _placed(
    layers: Sequence[Sequence[int]],
    boxes: Sequence[LayoutBox],
    above: Sequence[Sequence[int]],
    below: Sequence[Sequence[int]],
) -> list[float]:
    x: dict[int, float] = {}
    for layer in layers:
        x.update(_apart(layer, boxes, dict.fromkeys(layer, 0.0)))
    for sweep in range(SWEEPS):
        first, second = (above, below) if sweep % 2 == 0 else (below, above)
        for layer in layers if sweep % 2 == 0 else reversed(layers):
            desired = {box: _mean(first[box] or second[box], x, x[box]) for box in layer}
            x.update(_apart(layer, boxes, desired))
    left = min(x[number] - box.left for number, box in enumerate(boxes))
    return [x[number] - left for number in range(len(boxes))]


def _apart(
    layer: Sequence[int], boxes: Sequence[LayoutBox], desired: Mapping[int, float]
) -> dict[int, float]:
    """The positions nearest to those desired, in order and without overlaps.

    Least squares under an order constraint: pool adjacent violators.
    """
    offsets, reach = [], 0.0
    for number, box in enumerate(layer):
        reach += boxes[layer[number - 1]].right + boxes[box].left if number else 0.0
        offsets.append(reach)
    pools: list[tuple[float, int]] = []
    for box, offset in zip(layer, offsets, strict=True):
        total, count = desired[box] - offset, 1
        while pools and pools[-1][0] / pools[-1][1] > total / count:
            before, size = pools.pop()
            total, count = total + before, count + size
        pools.append((total, count))
    shifts = [total / count for total, count in pools for _ in range(count)]
    return {box: shift + offset for box, shift, offset in zip(layer, shifts, offsets, strict=True)}
