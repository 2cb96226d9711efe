"""A rule's automaton as a picture that needs no other program: SVG."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from itertools import pairwise

from rulec.report.automata.automaton_layout import (
    LINE,
    STATE_HEIGHT,
    AutomatonDrawing,
    AutomatonState,
    TransitionLine,
    draw,
    text_width,
)
from rulec.report.automata.automaton_model import Automaton
from rulec.report.findings.source_excerpt import visible

MARGIN = 14.0

# Dashes and words tell the verdict; the colours, of which nobody is blind to both, repeat it.
_STYLE = """\
.ground { fill: #ffffff } .ink { fill: #1b1f24 }
text { font: 12px ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace }
.line { fill: none; stroke: #1b1f24; stroke-width: 1.3 }
.rejected { stroke: #b34700; stroke-dasharray: 6 4 }
.head { fill: #1b1f24 } .head-rejected { fill: #b34700 }
.state { fill: #f2f4f6; stroke: #1b1f24; stroke-width: 1.3 }
.violated { fill: #f9d9c5; stroke: #b34700; stroke-width: 2.4 }
.satisfied { fill: #cfe5f5; stroke: #0063a3; stroke-width: 2.4 }
@media (prefers-color-scheme: dark) {
  .ground { fill: #16191d } .ink, .head { fill: #e8eaed }
  .line, .state { stroke: #e8eaed } .state { fill: #262b31 }
  .rejected { stroke: #ff9d5c } .head-rejected { fill: #ff9d5c }
  .violated { fill: #5a2a0c; stroke: #ff9d5c } .satisfied { fill: #0d3a5c; stroke: #6cb8f0 }
}"""

_LEGEND = (
    (True, "a trace that ends with this step is accepted"),
    (False, "a trace that ends with this step is rejected"),
)


def as_svg(automaton: Automaton, name: str) -> str:
    """The picture; ``name`` is its title."""
    drawing = draw(automaton)
    shown = {one.accepted for one in automaton.transitions}
    legend = [words for words in _LEGEND if words[0] in shown]
    title = visible(name)
    width = max(
        drawing.width,
        text_width([title]) * 1.1,
        *(text_width([text]) + 50 for _, text in legend),
        0,
    )
    width += 2 * MARGIN
    height = drawing.height + 3 * MARGIN + LINE * (1 + len(legend))
    shift = (width - 2 * MARGIN - drawing.width) / 2 + MARGIN
    size = f'width="{width:.0f}" height="{height:.0f}"'
    box = f"0 0 {width:.0f} {height:.0f}"
    head = f'<text class="ink" x="{MARGIN}" y="{MARGIN + 10}" font-weight="bold">'
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="{box}">',
            f"<title>{escape(title)}</title>",
            f"<style>\n{_STYLE}\n</style>",
            f'<rect class="ground" {size}/>',
            f"{head}{escape(title)}</text>",
            f'<g transform="translate({shift:.1f} {MARGIN + LINE:.1f})">',
            *_body(drawing, automaton),
            "</g>",
            *_legend(legend, height - MARGIN - LINE * len(legend)),
            "</svg>",
        ]
    )


def _body(drawing: AutomatonDrawing, automaton: Automaton) -> Iterator[str]:
    first = drawing.states[0]
    x, y = first.middle
    top = y - STATE_HEIGHT / 2 - LINE * (len(first.text) - 1) / 2
    yield f'<path class="line" d="M{x:.1f} {top - 28:.1f} V{top - 7:.1f}"/>'
    yield _head((x, top), (0, 1), accepted=True)
    for line in drawing.lines:
        yield from _line(line)
    for state in drawing.states:
        yield from _state(state, automaton.fates[state.number])


def _line(line: TransitionLine) -> Iterator[str]:
    one = line.transition
    style = "line" if one.accepted else "line rejected"
    (x, y), *rest = line.points
    path = f"M{x:.1f} {y:.1f}"
    if one.source == one.target:
        (over, _), (end_x, end_y) = rest
        side = 1 if over > x else -1
        out = f"{over + side * 6:.1f}"
        path += f" C{out} {y - 6:.1f} {out} {end_y + 6:.1f} {end_x + side * 6:.1f} {end_y:.1f}"
        tip, way = (end_x, end_y), (-side, 0)
    else:
        down = 1 if line.points[-1][1] > y else -1
        for before, (to_x, to_y) in pairwise(line.points):
            if (to_x, to_y) == line.points[-1]:
                to_y -= 6 * down
            half = (before[1] + to_y) / 2
            curve = f" C{before[0]:.1f} {half:.1f} {to_x:.1f} {half:.1f} {to_x:.1f} {to_y:.1f}"
            path += curve if before[0] != to_x else f" V{to_y:.1f}"
        tip, way = line.points[-1], (0, down)
    yield f'<path class="{style}" d="{path}"><title>{escape(one.condition)}</title></path>'
    yield _head(tip, way, accepted=one.accepted)
    yield from _text(line.text, line.label_at, "end" if line.leftward else "start")


def _head(tip: tuple[float, float], way: tuple[int, int], *, accepted: bool) -> str:
    """An arrow's head that points ``way``: along x or y."""
    (x, y), (along_x, along_y) = tip, way
    back = (x - 8 * along_x, y - 8 * along_y)
    side = (4 * along_y, 4 * along_x)
    corners = [
        (x, y),
        (back[0] + side[0], back[1] + side[1]),
        (back[0] - side[0], back[1] - side[1]),
    ]
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in corners)
    return f'<polygon class="{"head" if accepted else "head-rejected"}" points="{points}"/>'


def _state(state: AutomatonState, fate: str) -> Iterator[str]:
    (x, y), lines = state.middle, len(state.text)
    height = STATE_HEIGHT + LINE * (lines - 1)
    style = "state" if fate == "open" else f"state {fate}"
    corner = 0 if fate == "violated" else 17
    yield (
        f'<rect class="{style}" x="{x - state.width / 2:.1f}" y="{y - height / 2:.1f}" '
        f'width="{state.width:.1f}" height="{height:.1f}" rx="{corner}"/>'
    )
    yield from _text(state.text, (x, y), "middle")


def _text(lines: Sequence[str], at: tuple[float, float], anchor: str) -> Iterator[str]:
    """Lines whose middle is at this height."""
    x, y = at
    for number, text in enumerate(lines):
        baseline = y + LINE * (number - (len(lines) - 1) / 2) + 4
        yield (
            f'<text class="ink" x="{x:.1f}" y="{baseline:.1f}" text-anchor="{anchor}">'
            f"{escape(text)}</text>"
        )


def _legend(entries: Sequence[tuple[bool, str]], top: float) -> Iterator[str]:
    for number, (accepted, words) in enumerate(entries):
        y = top + LINE * number
        style = "line" if accepted else "line rejected"
        yield f'<path class="{style}" d="M{MARGIN} {y:.1f} H{MARGIN + 34}"/>'
        yield f'<text class="ink" x="{MARGIN + 42}" y="{y + 4:.1f}">{escape(words)}</text>'
