"""The scene in one layer: the road, its cells with their signatures, and what obstacles sweep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from textwrap import wrap

from rulec.partition import Cell, NavigationGraph, envelope
from rulec.report.automaton_drawing import CHARACTER
from rulec.report.pictures.legend import Entry, legend
from rulec.report.pictures.marks import (
    LINE_HEIGHT,
    Area,
    Line,
    Mark,
    Picture,
    Point,
    Words,
    rectangle,
)
from rulec.report.pictures.placing import Placing, Rectangle
from rulec.report.pictures.scale import ticks
from rulec.report.pictures.signatures import MOST_SPELLED, in_full, in_letters, meaning
from rulec.runtime.cheapest import Maneuver
from rulec.scenario import Box
from rulec.scenario.motion import span, swept

WIDTH = 900.0
MARGIN = 14.0
LANE_HEIGHT = 46.0
"""Of a lane as wide as the road's lanes are on average, in px."""


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where places on the road are in the picture."""

    outline: Box
    top: float
    lanes: int

    @property
    def along(self) -> float:
        """Px for a metre of s."""
        return (WIDTH - 2 * MARGIN) / (self.outline.s_max - self.outline.s_min)

    @property
    def across(self) -> float:
        """Px for a metre of d."""
        return LANE_HEIGHT * self.lanes / (self.outline.d_max - self.outline.d_min)

    @property
    def bottom(self) -> float:
        return self.top + LANE_HEIGHT * self.lanes

    def at(self, s: float, d: float) -> Point:
        return (
            MARGIN + (s - self.outline.s_min) * self.along,
            self.top + (self.outline.d_max - d) * self.across,
        )

    def box(self, box: Box) -> Rectangle:
        """A box as far as it is on the road."""
        left, top = self.at(max(box.s_min, self.outline.s_min), min(box.d_max, self.outline.d_max))
        right, bottom = self.at(
            min(box.s_max, self.outline.s_max), max(box.d_min, self.outline.d_min)
        )
        return left, top, right, bottom


def scene_pictures(
    graph: NavigationGraph, layers: Sequence[int], maneuver: Maneuver | None
) -> list[Picture]:
    """A picture for each of these layers; ``maneuver`` is shown by its cells and its bounds."""
    return [_picture(graph, layer, maneuver) for layer in layers]


def scene_legend(graph: NavigationGraph, maneuver: Maneuver | None) -> Picture:
    """What the colours and the letters mean."""
    entries = [Entry("cell", "a cell"), Entry("crossing", "a cell on a crossing")]
    if all(cell.surface == "carriageway" for layer in graph.layers for cell in layer.cells):
        del entries[1]
    if maneuver:
        entries.append(Entry("chosen", "the maneuver's cell"))
    if graph.objects:
        entries += [
            Entry("body", "an obstacle as the interval begins"),
            Entry("swept", "what it sweeps in the interval"),
            Entry("taken", "no cell: the lanes of an obstacle"),
        ]
    if graph.scenario.goal:
        entries.append(Entry("goal", "the goal"))
    road = graph.scenario.road
    frame = _Frame(road.outline, 0, len(road.lanes) - 1)
    ratio = f"; across the road {frame.across / frame.along:.2g} times as large as along it"
    words = [f"s along the road in m{ratio}"]
    if 0 < len(graph.objects) <= MOST_SPELLED:
        words.insert(0, meaning(graph))
    if len(graph.objects) > MOST_SPELLED:
        words.insert(0, "numbers of cells as in the graph and in JSON")
    return legend(entries, words, WIDTH, MARGIN)


def _picture(graph: NavigationGraph, layer: int, maneuver: Maneuver | None) -> Picture:
    here, road = graph.layers[layer], graph.scenario.road
    start, end = here.start_s, here.start_s + graph.step_s
    frame = _Frame(road.outline, MARGIN + LINE_HEIGHT, len(road.lanes) - 1)
    chosen = maneuver.nodes[layer] if maneuver else None
    heading = f"{start:g} s to {end:g} s"
    marks: list[Mark] = [Words(heading, (MARGIN, MARGIN), style="strong")]
    if maneuver and chosen is not None:
        bounds = envelope(graph, maneuver.nodes[: layer + 1])[layer]
        right, left = min(d for _, d in bounds.d_right), max(d for _, d in bounds.d_left)
        told = f"cell {chosen}: s {bounds.s_min:g} … {bounds.s_max:g} m, d {right:g} … {left:g} m"
        marks.append(Words(told, (WIDTH - MARGIN, MARGIN), "end"))
    axis = list(_axis(frame))
    placing = Placing([one.bounds for one in [*marks, *axis] if isinstance(one, Words)])
    marks.append(Area((rectangle(*frame.box(road.outline)),), "taken"))
    marks += [Area((rectangle(*frame.box(hole)),), "ground") for hole in road.holes()]
    order = sorted(range(len(here.cells)), key=lambda i: i == chosen)
    marks += [_cell(frame, here.cells[i], i, i == chosen) for i in order]
    for d in road.lanes[1:-1]:
        marks.append(Line((frame.at(road.s[0], d), frame.at(road.s[1], d)), "lane"))
    marks += _obstacles(graph, frame, layer)
    if layer == 0:
        marks += _ego(graph, frame, placing)
    if graph.scenario.goal and layer == len(graph.layers) - 1:
        marks.append(Area((rectangle(*frame.box(graph.scenario.goal)),), "goal"))
    names = _bodies(graph, frame, layer)
    marks += [
        replace(words, style="ink")
        for words, body in names
        if _fits(words, body) and placing.take(words)
    ]
    for _, body in names:
        placing.taken.append(body)
    labels, key = _labels(frame, here.cells, placing)
    marks += labels
    marks += [
        found
        for words, body in names
        if not _fits(words, body)
        for found in placing.first_free(_beside(words, body))
    ]
    marks += axis
    height = frame.bottom + 14 + LINE_HEIGHT
    columns = int((WIDTH - 2 * MARGIN) / CHARACTER)
    for line in wrap("   ".join(one.replace(" ", "\xa0") for one in key), columns):
        marks.append(Words(line, (MARGIN, height), style="faint"))
        height += LINE_HEIGHT
    return Picture(heading, WIDTH, height, tuple(marks))


def _cell(frame: _Frame, cell: Cell, number: int, chosen: bool) -> Area:
    polygon = cell.polygon
    rings = [polygon.exterior, *polygon.interiors]
    style = "chosen" if chosen else "crossing" if cell.surface == "crossing" else "cell"
    shape = tuple(tuple(frame.at(s, d) for s, d in list(ring.coords)[:-1]) for ring in rings)
    return Area(shape, style, f"cell {number}: {in_full(cell)}")


def _obstacles(graph: NavigationGraph, frame: _Frame, layer: int) -> Iterator[Mark]:
    start = graph.layers[layer].start_s
    for name in graph.layers[layer].objects:
        obstacle = graph.objects[name]
        area = swept(obstacle, start, start + graph.step_s)
        if area is not None:
            shape = rectangle(*frame.box(area))
            yield Area((shape,), "swept", f"{name}, {obstacle.type}: what it sweeps")
    for words, body in _bodies(graph, frame, layer):
        tip = f"{words.text}, {graph.objects[words.text].type}"
        yield Area((rectangle(*body),), "body", tip)


def _bodies(graph: NavigationGraph, frame: _Frame, layer: int) -> list[tuple[Words, Rectangle]]:
    """The obstacles' names and bodies as the layer begins, or as they enter in its course."""
    start = graph.layers[layer].start_s
    found = []
    for name in graph.layers[layer].objects:
        obstacle = graph.objects[name]
        first, _ = span(obstacle.motion)
        moment = max(start, first)
        body = swept(obstacle, moment, moment)
        if body is not None and body.overlaps(frame.outline):
            left, top, right, bottom = frame.box(body)
            at = ((left + right) / 2, (top + bottom) / 2)
            found.append((Words(name, at, "middle", "name"), (left, top, right, bottom)))
    return found


def _fits(words: Words, body: Rectangle) -> bool:
    left, top, right, bottom = words.bounds
    return body[0] <= left and right <= body[2] and body[1] <= top and bottom <= body[3]


def _beside(words: Words, body: Rectangle) -> Iterator[Words]:
    """Places for a name that does not fit into its body: next to it, or just above or below."""
    left, top, right, bottom = words.bounds
    half, (x, y) = (right - left) / 2 + 5, words.at
    lift = (body[3] - body[1] + bottom - top) / 2 + 1
    for at in (
        (x, y - lift),
        (x, y + lift),
        (body[2] + half, y),
        (body[0] - half, y),
        (body[2] + half, y - lift),
        (body[0] - half, y + lift),
    ):
        if half <= at[0] <= WIDTH - half:
            yield replace(words, at=at)


def _ego(graph: NavigationGraph, frame: _Frame, placing: Placing) -> Iterator[Mark]:
    ego = graph.scenario.ego
    x, y = frame.at(ego.s, ego.d)
    half_length = max(ego.length / 2 * frame.along, 4)
    half_width = max(ego.width / 2 * frame.across, 4)
    shape = rectangle(x - half_length, y - half_width, x + half_length, y + half_width)
    yield Area((shape,), "ego", "ego at the start")
    body = (x - half_length, y - half_width, x + half_length, y + half_width)
    placing.taken.append(body)
    yield from placing.first_free(_beside(Words("ego", (x, y), "middle", "name"), body))


def _labels(
    frame: _Frame, cells: Sequence[Cell], placing: Placing
) -> tuple[list[Words], list[str]]:
    """The cells' labels, and what those mean that had to be shortened to a number."""
    found, key = [], []
    for number, cell in enumerate(cells):
        letters = in_letters(cell)
        texts = [letters, str(number)] if letters else [str(number)]
        words = placing.place(texts, [frame.box(box) for box in cell.boxes])
        if words is not None:
            found.append(words)
        if letters and (words is None or words.text != letters):
            key.append(f"{number} {letters}")
    return found, key


def _axis(frame: _Frame) -> Iterator[Mark]:
    low, high = frame.outline.s_min, frame.outline.s_max
    y = frame.bottom
    for s in ticks(low, high, 12):
        x, _ = frame.at(s, frame.outline.d_min)
        yield Line(((x, y), (x, y + 4)), "axis")
        width = len(f"{s:g}") * CHARACTER / 2
        x = min(max(x, width), WIDTH - width)
        yield Words(f"{s:g}", (x, y + 11), "middle", "faint")
