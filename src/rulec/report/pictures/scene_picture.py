"""Picture of a scene's layer: road, cells with signatures, obstacles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from rulec.partition import Cell, NavigationGraph, envelope
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.pictures import picture_captions as captions
from rulec.report.pictures.drawing import canvas
from rulec.report.pictures.drawing.canvas import (
    Area,
    LabelText,
    Mark,
    Picture,
    Placing,
    Point,
    Polyline,
)
from rulec.scenario import Box, Road
from rulec.scenario.motion import span, swept

_LANE_HEIGHT = 46.0
"""Height in px of a lane with the average width of the road's lanes."""

_TAKEN = {
    "lane": "the lanes of an obstacle",
    "clearance": "the lanes of an obstacle, or too close to it for ego's width",
    "body": "too close to an obstacle, or to the verge, for ego's width",
}

_UNREACHED = ", or where ego cannot get"


def scene_pictures(
    graph: NavigationGraph, layers: Sequence[int], maneuver: Maneuver | None
) -> list[Picture]:
    """A picture for each layer, with a maneuver's cells and bounds."""
    return [_picture(graph, layer, maneuver) for layer in layers]


def scene_legend(graph: NavigationGraph, maneuver: Maneuver | None) -> Picture:
    """Legend of the scene's colours and letters."""
    entries = [("cell", "a cell")]
    if any(cell.surface != "carriageway" for layer in graph.layers for cell in layer.cells):
        entries.append(("crossing", "a cell on a crossing"))
    if maneuver:
        entries.append(("chosen", "the maneuver's cell"))
    if graph.objects:
        entries += [
            ("body", "an obstacle as the interval begins"),
            ("swept", "what it sweeps in the interval"),
            ("taken", f"no cell: {_TAKEN[graph.extent]}{_UNREACHED if graph.bounds else ''}"),
        ]
    if graph.scenario.goal:
        entries.append(("goal", "the goal"))
    frame = _frame(graph)
    ratio = f"; across the road {frame.across / frame.along:.2g} times as large as along it"
    notes = [f"s along the road in m{ratio}", *captions.mirrored(graph)]
    if len(graph.objects) > captions.MOST_SPELLED:
        notes.insert(0, "numbers of cells as in the graph and in JSON")
    elif graph.objects:
        notes.insert(0, captions.meaning(graph))
    return captions.legend(entries, notes)


def _frame(graph: NavigationGraph) -> _Frame:
    road = graph.scenario.road
    return _Frame(road.outline, canvas.MARGIN + canvas.LINE_HEIGHT, len(road.lanes) - 1)


def _picture(graph: NavigationGraph, layer: int, maneuver: Maneuver | None) -> Picture:
    here, road, frame = graph.layers[layer], graph.scenario.road, _frame(graph)
    chosen = maneuver.nodes[layer] if maneuver else None
    heading = f"{here.start_s:g} s to {here.start_s + graph.step_s:g} s"
    labels = [LabelText(heading, (canvas.MARGIN, canvas.MARGIN), style="strong")]
    if maneuver:
        bounds = envelope(graph, maneuver.nodes[: layer + 1])[layer]
        right, left = min(d for _, d in bounds.d_right), max(d for _, d in bounds.d_left)
        low, high, right, left = (round(x, 2) for x in (bounds.s_min, bounds.s_max, right, left))
        text = f"cell {chosen}: s {low:g} … {high:g} m, d {right:g} … {left:g} m"
        labels.append(LabelText(text, (canvas.WIDTH - canvas.MARGIN, canvas.MARGIN), "end"))
    axis = list(_axis(frame))
    placing = Placing([mark.bounds for mark in [*labels, *axis] if isinstance(mark, LabelText)])
    marks: list[Mark] = [*labels, canvas.filled(frame.box(road.outline), "taken")]
    marks += [canvas.filled(frame.box(hole), "ground") for hole in road.holes()]
    order = sorted(range(len(here.cells)), key=lambda i: i == chosen)
    marks += [_cell(frame, here.cells[i], i, i == chosen) for i in order]
    marks += _lane_marks(frame, road)
    marks += _obstacle_marks(graph, frame, layer)
    if layer == 0:
        marks += _ego_marks(graph, frame, placing)
    if graph.scenario.goal and layer == len(graph.layers) - 1:
        marks.append(canvas.filled(frame.box(graph.scenario.goal), "goal"))
    bodies = _bodies(graph, frame, layer)
    outside = []
    for words, body in bodies:
        if not _fits(words, body):
            outside.append((words, body))
        elif placing.take(words):
            marks.append(replace(words, style="ink"))
    placing.taken += [body for _, body in bodies]
    cell_labels, key = _labels(frame, here.cells, placing)
    marks += cell_labels
    for words, body in outside:
        marks += placing.first_free(_beside(words, body))
    marks += axis
    height = frame.bottom + 14 + canvas.LINE_HEIGHT
    numbered = "   ".join(entry.replace(" ", "\xa0") for entry in key)
    below = canvas.paragraph(numbered, (canvas.MARGIN, height), canvas.TEXT_WIDTH, "faint")
    height += len(below) * canvas.LINE_HEIGHT
    return Picture(heading, canvas.WIDTH, height, (*marks, *below))


def _cell(frame: _Frame, cell: Cell, number: int, chosen: bool) -> Area:
    polygon = cell.polygon
    rings = [polygon.exterior, *polygon.interiors]
    style = "chosen" if chosen else "crossing" if cell.surface == "crossing" else "cell"
    shape = tuple(tuple(frame.at(s, d) for s, d in list(ring.coords)[:-1]) for ring in rings)
    return Area(shape, style, f"cell {number}: {captions.in_full(cell)}")


def _labels(
    frame: _Frame, cells: Sequence[Cell], placing: Placing
) -> tuple[list[LabelText], list[str]]:
    labels, key = [], []
    for number, cell in enumerate(cells):
        letters = captions.in_letters(cell)
        texts = [letters, str(number)] if letters else [str(number)]
        label = placing.place(texts, [frame.box(box) for box in cell.boxes])
        labels += [label] if label is not None else []
        if letters and (label is None or label.text != letters):
            key.append(f"{number} {letters}")
    return labels, key


@dataclass(frozen=True, slots=True)
class _Frame:
    """Maps positions on the road to positions in the picture."""

    outline: Box
    top: float
    lanes: int

    @property
    def along(self) -> float:
        """Px per metre of s."""
        return canvas.TEXT_WIDTH / (self.outline.s_max - self.outline.s_min)

    @property
    def across(self) -> float:
        """Px per metre of d."""
        return _LANE_HEIGHT * self.lanes / (self.outline.d_max - self.outline.d_min)

    @property
    def bottom(self) -> float:
        """The y coordinate of the road's lower border (px)."""
        return self.top + _LANE_HEIGHT * self.lanes

    def at(self, s: float, d: float) -> Point:
        """The point in the picture for a position on the road."""
        return (
            canvas.MARGIN + (s - self.outline.s_min) * self.along,
            self.top + (self.outline.d_max - d) * self.across,
        )

    def box(self, box: Box) -> canvas.Rectangle:
        """The part of a box that is on the road, in px."""
        outline = self.outline
        left, top = self.at(max(box.s_min, outline.s_min), min(box.d_max, outline.d_max))
        right, bottom = self.at(min(box.s_max, outline.s_max), max(box.d_min, outline.d_min))
        return left, top, right, bottom


def _axis(frame: _Frame) -> Iterator[Mark]:
    y = frame.bottom
    for s in captions.ticks(frame.outline.s_min, frame.outline.s_max, 12):
        x, _ = frame.at(s, frame.outline.d_min)
        yield Polyline(((x, y), (x, y + 4)), "axis")
        text = f"{s:g}"
        half = len(text) * canvas.CHARACTER / 2
        x = min(max(x, half), canvas.WIDTH - half)
        yield LabelText(text, (x, y + 11), "middle", "faint")


def _lane_marks(frame: _Frame, road: Road) -> Iterator[Polyline]:
    ends = {s for gap in road.missing for s in gap.s if road.s[0] < s < road.s[1]}
    for right, d in enumerate(road.lanes[1:-1], 1):
        for start, end in pairwise([road.s[0], *sorted(ends), road.s[1]]):
            gone = {gap.lane for gap in road.missing if gap.s[0] <= start and end <= gap.s[1]}
            if not {right, right + 1} <= gone:
                yield Polyline((frame.at(start, d), frame.at(end, d)), "lane")


def _obstacle_marks(graph: NavigationGraph, frame: _Frame, layer: int) -> Iterator[Mark]:
    start = graph.layers[layer].start_s
    for name in graph.layers[layer].objects:
        obstacle = graph.objects[name]
        area = swept(obstacle, start, start + graph.step_s)
        if area is not None:
            tip = f"{name}, {obstacle.type}: what it sweeps"
            yield canvas.filled(frame.box(area), "swept", tip)
    for words, body in _bodies(graph, frame, layer):
        yield canvas.filled(body, "body", f"{words.text}, {graph.objects[words.text].type}")


def _bodies(
    graph: NavigationGraph, frame: _Frame, layer: int
) -> list[tuple[LabelText, canvas.Rectangle]]:
    result = []
    for name in graph.layers[layer].objects:
        obstacle = graph.objects[name]
        moment = max(graph.layers[layer].start_s, span(obstacle.motion)[0])
        body = swept(obstacle, moment, moment)
        if body is not None and body.overlaps(frame.outline):
            left, top, right, bottom = frame.box(body)
            at = ((left + right) / 2, (top + bottom) / 2)
            result.append((LabelText(name, at, "middle", "name"), (left, top, right, bottom)))
    return result


def _fits(words: LabelText, body: canvas.Rectangle) -> bool:
    left, top, right, bottom = words.bounds
    return body[0] <= left and right <= body[2] and body[1] <= top and bottom <= body[3]


def _beside(words: LabelText, body: canvas.Rectangle) -> Iterator[LabelText]:
    left, top, right, bottom = words.bounds
    half, (x, y) = (right - left) / 2 + 5, words.at
    lift = (body[3] - body[1] + bottom - top) / 2 + 1
    after, before = body[2] + half, body[0] - half
    middles = (x, y - lift), (x, y + lift), (after, y), (before, y)
    for at in (*middles, (after, y - lift), (before, y + lift)):
        if half <= at[0] <= canvas.WIDTH - half:
            yield replace(words, at=at)


def _ego_marks(graph: NavigationGraph, frame: _Frame, placing: Placing) -> Iterator[Mark]:
    ego = graph.scenario.ego
    middle = frame.at(ego.s, ego.d)
    half_length, half_width = ego.length / 2 * frame.along, ego.width / 2 * frame.across
    body = canvas.centred(middle, max(half_length, 4), max(half_width, 4))
    yield canvas.filled(body, "ego", "ego at the start")
    placing.taken.append(body)
    yield from placing.first_free(_beside(LabelText("ego", middle, "middle", "name"), body))
