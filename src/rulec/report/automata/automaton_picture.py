"""Picture of a rule's automaton: states, transitions with conditions, a legend."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import cos, pi, sin
from typing import Literal

from rulec.report.automata import automaton_layout as layout
from rulec.report.automata.automaton_model import Automaton, Fate, Transition
from rulec.report.pictures.drawing import canvas

HEAD = 8.0
"""The length of an arrowhead in px."""

CORNER = 17.0
"""The corner radius in px of a state that is not violated."""

PIECES = 10
"""Number of straight pieces in a curve."""

# Dashes, corners and words show the verdict; colours repeat it.
_STYLES: dict[Fate, str] = {"open": "state", "violated": "violated", "satisfied": "chosen"}

_LEGEND = {
    "accepted": "a trace that ends with this step is accepted",
    "rejected": "a trace that ends with this step is rejected",
}


def as_picture(automaton: Automaton, title: str) -> canvas.Picture:
    """Draw an automaton between its title and the legend of its lines."""
    drawing = layout.draw(automaton)
    used = {_line_style(transition) for transition in automaton.transitions}
    legend = [(style, text) for style, text in _LEGEND.items() if style in used]
    widest = max((canvas.text_width([text]) + 50 for _, text in legend), default=0)
    width = max(drawing.width, canvas.text_width([title]) * 1.1, widest) + 2 * canvas.MARGIN
    height = drawing.height + 3 * canvas.MARGIN + layout.LINE * (1 + len(legend))
    right = (width - drawing.width) / 2
    down = canvas.MARGIN + layout.LINE
    drawn = (canvas.moved(mark, right, down) for mark in _marks(drawing, automaton))
    marks = [
        canvas.LabelText(title, (canvas.MARGIN, canvas.MARGIN + 6), style="strong"),
        *drawn,
        *_legend(legend, height - canvas.MARGIN - layout.LINE * len(legend)),
    ]
    return canvas.Picture(title, width, height, tuple(marks))


def _line_style(transition: Transition) -> str:
    return "accepted" if transition.accepted else "rejected"


def _marks(drawing: layout.AutomatonDrawing, automaton: Automaton) -> Iterator[canvas.Mark]:
    first = drawing.states[0]
    x, y = first.middle
    top = y - first.height / 2
    yield canvas.Polyline(((x, top - 28), (x, top - HEAD + 1)), "accepted")
    yield _head((x, top), (0, 1), accepted=True)
    for line in drawing.lines:
        yield from _transition(line)
    for state in drawing.states:
        yield from _state(state, automaton.fates[state.number])


def _transition(line: layout.TransitionLine) -> Iterator[canvas.Mark]:
    transition = line.transition
    is_loop = transition.source == transition.target
    points, direction = _loop(line.points) if is_loop else _path(line.points)
    yield canvas.Polyline(tuple(points), _line_style(transition), transition.condition)
    yield _head(line.points[-1], direction, accepted=transition.accepted)
    yield from _text(line.text, line.label_at, "end" if line.leftward else "start")


def _loop(corners: Sequence[canvas.Point]) -> tuple[list[canvas.Point], tuple[int, int]]:
    start, (out, _), (x, y) = corners
    side = 1 if out > start[0] else -1
    reach, end = out + side * 6, (x + side * 6, y)
    return [start, *_curve(start, (reach, start[1] - 6), (reach, y + 6), end)], (-side, 0)


def _path(corners: Sequence[canvas.Point]) -> tuple[list[canvas.Point], tuple[int, int]]:
    down = 1 if corners[-1][1] > corners[0][1] else -1
    end = (corners[-1][0], corners[-1][1] - 6 * down)
    points = [corners[0]]
    for start, stop in pairwise([*corners[:-1], end]):
        if start[0] == stop[0]:
            points.append(stop)
        else:
            half = (start[1] + stop[1]) / 2
            points += _curve(start, (start[0], half), (stop[0], half), stop)
    return points, (0, down)


def _curve(*corners: canvas.Point) -> Iterator[canvas.Point]:
    for piece in range(1, PIECES + 1):
        t = piece / PIECES
        weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3)
        yield (
            sum(weight * x for weight, (x, _) in zip(weights, corners, strict=True)),
            sum(weight * y for weight, (_, y) in zip(weights, corners, strict=True)),
        )


def _head(tip: canvas.Point, direction: tuple[int, int], *, accepted: bool) -> canvas.Area:
    (x, y), (along_x, along_y) = tip, direction
    back_x, back_y = x - HEAD * along_x, y - HEAD * along_y
    half = HEAD / 2
    corners = (
        tip,
        (back_x + half * along_y, back_y + half * along_x),
        (back_x - half * along_y, back_y - half * along_x),
    )
    return canvas.Area((corners,), "ink" if accepted else "violated")


def _state(state: layout.AutomatonState, fate: Fate) -> Iterator[canvas.Mark]:
    box = canvas.centred(state.middle, state.width / 2, state.height / 2)
    outline = canvas.corners(box) if fate == "violated" else tuple(_rounded(box))
    yield canvas.Area((outline,), _STYLES[fate])
    yield from _text(state.text, state.middle, "middle")


def _rounded(rectangle: canvas.Rectangle) -> Iterator[canvas.Point]:
    left, top, right, bottom = rectangle
    centres = canvas.corners((left + CORNER, top + CORNER, right - CORNER, bottom - CORNER))
    for number, (x, y) in enumerate(centres):
        for piece in range(PIECES // 2 + 1):
            angle = pi + (number + piece / (PIECES // 2)) * pi / 2
            yield x + CORNER * cos(angle), y + CORNER * sin(angle)


def _text(
    lines: Sequence[str], middle: canvas.Point, anchor: Literal["start", "middle", "end"]
) -> Iterator[canvas.LabelText]:
    x, y = middle
    for number, text in enumerate(lines):
        yield canvas.LabelText(text, (x, y + layout.LINE * (number - (len(lines) - 1) / 2)), anchor)


def _legend(entries: Sequence[tuple[str, str]], top: float) -> Iterator[canvas.Mark]:
    for number, (style, text) in enumerate(entries):
        y = top + layout.LINE * number
        yield canvas.Polyline(((canvas.MARGIN, y), (canvas.MARGIN + 34, y)), style)
        yield canvas.LabelText(text, (canvas.MARGIN + 42, y))
