"""Layout of a rule's automaton: positions of states, conditions and lines."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from textwrap import wrap

from rulec.report.automata.automaton_model import Automaton, Transition
from rulec.report.automata.layered_layout import LayoutBox, arrange
from rulec.report.pictures.drawing.marks import Point
from rulec.report.pictures.drawing.text_metrics import text_width

LINE = 16.0
STATE_HEIGHT = 34.0
LAYER_GAP = 26.0
MORE_GAP = 2.0
"""The more lines there are between two layers, the more room they need to be told apart."""

LOOP = 30.0
MARGIN = 12.0
PORT = 20.0
WIDEST = 30
MOST_LINES = 5

MOST_STATES = 40
MOST_TRANSITIONS = 80
"""Beyond this nobody finds their way through a picture."""


@dataclass(frozen=True, slots=True)
class AutomatonState:
    """A state's box by its middle and size, with number and text."""

    middle: Point
    width: float
    number: int
    text: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TransitionLine:
    """A transition as points from source to target, with its condition's position.

    A loop has the three points of its triangle; its condition is centred on ``label_at`` in height,
    and stands to its left if ``leftward``.
    """

    transition: Transition
    points: tuple[Point, ...]
    label_at: Point
    text: tuple[str, ...]
    leftward: bool = False


@dataclass(frozen=True, slots=True)
class AutomatonDrawing:
    """All of it, in px from the upper left corner."""

    width: float
    height: float
    states: tuple[AutomatonState, ...]
    lines: tuple[TransitionLine, ...]


def is_too_large(automaton: Automaton) -> bool:
    """Would a picture be of no use?"""
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

    A line that goes on past a layer has a place of its own there, so that it passes no text.
    """

    def __init__(self, automaton: Automaton) -> None:
        self._automaton = automaton
        self._texts = [_state_text(automaton, state) for state in range(len(automaton.fates))]
        self._loops: dict[int, list[Transition]] = {}
        self._ways: list[tuple[Transition, list[int]]] = []
        level = _levels(automaton)
        self._layers: list[list[int]] = [[] for _ in range(2 * max(level) + 1)]
        self._boxes: dict[int, LayoutBox] = {}
        self._heights: dict[int, float] = {}
        self._widths: dict[int, float] = {}
        for transition in automaton.transitions:
            if transition.source == transition.target:
                self._loops.setdefault(transition.source, []).append(transition)
        for state in range(len(automaton.fates)):
            self._add_state(state, level[state])
        for one in automaton.transitions:
            if one.source != one.target:
                self._add_way(one, level)

    def _add_state(self, state: int, level: int) -> None:
        ends = [0, 0]
        for transition in self._automaton.transitions:
            if transition.source != transition.target:
                ends[0] += transition.source == state
                ends[1] += transition.target == state
        width = max(44.0, text_width(self._texts[state]) + 20, PORT * (max(ends) + 1))
        sides = [0.0, 0.0]
        height = STATE_HEIGHT + LINE * (len(self._texts[state]) - 1)
        for side, one in enumerate(self._loops.get(state, [])):
            text = _broken(one.label)
            sides[side] = LOOP + text_width(text)
            height = max(height, LINE * len(text))
        self._boxes[state] = LayoutBox(width / 2 + sides[1] + MARGIN, width / 2 + sides[0] + MARGIN)
        self._widths[state] = width
        self._heights[state] = height
        self._layers[2 * level].append(state)

    def _add_way(self, transition: Transition, level: Sequence[int]) -> None:
        """Add a line's places, with its condition next to its source."""
        start, end = 2 * level[transition.source], 2 * level[transition.target]
        step = 1 if start < end else -1
        way = [transition.source]
        for layer in range(start + step, end, step):
            place = len(self._boxes)
            labelled = layer == start + step
            text = _broken(transition.label) if labelled else ()
            self._boxes[place] = LayoutBox(MARGIN, MARGIN + text_width(text))
            self._heights[place] = LINE * len(text)
            self._layers[layer].append(place)
            way.append(place)
        self._ways.append((transition, [*way, transition.target]))

    def drawing(self) -> AutomatonDrawing:
        links = []
        for _, way in self._ways:
            downward = self._layer_of(way[0]) < self._layer_of(way[-1])
            links += [(a, b) if downward else (b, a) for a, b in pairwise(way)]
        x = arrange(self._layers, self._boxes, links)
        into = Counter(self._layer_of(lower) for _, lower in links)
        tops, bottom = [], MARGIN
        for number, layer in enumerate(self._layers):
            tops.append(bottom + LAYER_GAP + MORE_GAP * into[number])
            bottom = tops[-1] + max(self._heights[box] for box in layer)
        y = {
            box: top + max(self._heights[one] for one in layer) / 2
            for layer, top in zip(self._layers, tops, strict=True)
            for box in layer
        }
        states = tuple(
            AutomatonState((x[state], y[state]), self._widths[state], state, text)
            for state, text in enumerate(self._texts)
        )
        width = max(x[box] + self._boxes[box].right for box in x)
        return AutomatonDrawing(
            width, bottom + LAYER_GAP, states, (*self._lines(x, y), *self._loop_lines(states))
        )

    def _layer_of(self, box: int) -> int:
        return next(number for number, layer in enumerate(self._layers) if box in layer)

    def _band(self, box: int) -> float:
        """Half the height of a box's layer, where lines run straight."""
        layer = self._layers[self._layer_of(box)]
        return max(self._heights[one] for one in layer) / 2

    def _lines(self, x: dict[int, float], y: dict[int, float]) -> list[TransitionLine]:
        ports = self._ports(x)
        lines = []
        for number, (one, way) in enumerate(self._ways):
            down = 1 if y[way[0]] < y[way[-1]] else -1
            first, last = (self._half(way[0]), self._half(way[-1]))
            points = [(ports[number, 0], y[way[0]] + down * first)]
            points.append((ports[number, 0], y[way[0]] + down * self._band(way[0])))
            for box in way[1:-1]:
                reach = self._band(box)
                points += [(x[box], y[box] - down * reach), (x[box], y[box] + down * reach)]
            points.append((ports[number, 1], y[way[-1]] - down * self._band(way[-1])))
            points.append((ports[number, 1], y[way[-1]] - down * last))
            text = _broken(one.label)
            lines.append(TransitionLine(one, tuple(points), (x[way[1]] + 7, y[way[1]]), text))
        return lines

    def _half(self, state: int) -> float:
        return (STATE_HEIGHT + LINE * (len(self._texts[state]) - 1)) / 2

    def _ports(self, x: dict[int, float]) -> dict[tuple[int, int], float]:
        """Positions on states' sides where each line begins (0) and ends (1)."""
        sides: dict[tuple[int, bool], list[tuple[float, int, int]]] = {}
        for number, (_, way) in enumerate(self._ways):
            for end, state, beside in ((0, way[0], way[1]), (1, way[-1], way[-2])):
                below = self._layer_of(beside) > self._layer_of(state)
                sides.setdefault((state, below), []).append((x[beside], number, end))
        ports = {}
        for (state, _), arriving in sides.items():
            arriving.sort()
            pitch = min(self._widths[state] / (len(arriving) + 1), 2 * PORT)
            for index, (_, number, end) in enumerate(arriving):
                ports[number, end] = x[state] + pitch * (index - (len(arriving) - 1) / 2)
        return ports

    def _loop_lines(self, states: Sequence[AutomatonState]) -> list[TransitionLine]:
        lines = []
        for state, loops in self._loops.items():
            middle, y = states[state].middle
            for loop, side in zip(loops, (1, -1), strict=False):
                edge = middle + side * states[state].width / 2
                points = ((edge, y - 9), (edge + side * (LOOP - 8), y), (edge, y + 9))
                text = _broken(loop.label)
                at = (edge + side * (LOOP - 5), y)
                lines.append(TransitionLine(loop, points, at, text, leftward=side < 0))
        return lines


def _levels(automaton: Automaton) -> list[int]:
    """The level of each state: below every smaller-numbered state that it meets.

    States are numbered breadth-first from the start. Those in which the verdict is final come last,
    for nothing leads away from them.
    """
    final = [fate != "open" for fate in automaton.fates]
    order = sorted(range(len(final)), key=lambda state: (final[state], state))
    rank = {state: number for number, state in enumerate(order)}
    level = [0] * len(final)
    for state in order:
        for transition in automaton.transitions:
            ends = {transition.source, transition.target}
            if len(ends) == 2 and state in ends:
                (other,) = ends - {state}
                if rank[other] < rank[state]:
                    level[state] = max(level[state], level[other] + 1)
    return level


def _state_text(automaton: Automaton, state: int) -> tuple[str, ...]:
    fate = automaton.fates[state]
    return (str(state),) if fate == "open" else (str(state), f"{fate} for good")
