"""Picture of a scene's layer: road, cells with signatures, obstacles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rulec.partition import Cell, NavigationGraph, envelope
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.pictures import road_marks
from rulec.report.pictures.drawing import canvas
from rulec.report.pictures.drawing.canvas import Area, LabelText, Mark, Picture
from rulec.report.pictures.drawing.label_placement import Placing
from rulec.report.pictures.picture_captions import (
    MOST_SPELLED,
    in_full,
    in_letters,
    legend,
    meaning,
)
from rulec.report.pictures.road_marks import Frame

_TAKEN = {
    "lane": "the lanes of an obstacle",
    "body": "too close to an obstacle, or to the verge, for ego's width",
}


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
            ("taken", f"no cell: {_TAKEN[graph.extent]}"),
        ]
    if graph.scenario.goal:
        entries.append(("goal", "the goal"))
    frame = _frame(graph)
    ratio = f"; across the road {frame.across / frame.along:.2g} times as large as along it"
    notes = [f"s along the road in m{ratio}"]
    if len(graph.objects) > MOST_SPELLED:
        notes.insert(0, "numbers of cells as in the graph and in JSON")
    elif graph.objects:
        notes.insert(0, meaning(graph))
    return legend(entries, notes)


def _frame(graph: NavigationGraph) -> Frame:
    road = graph.scenario.road
    return Frame(road.outline, canvas.MARGIN + canvas.LINE_HEIGHT, len(road.lanes) - 1)


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
    axis = list(road_marks.axis(frame))
    placing = Placing([mark.bounds for mark in [*labels, *axis] if isinstance(mark, LabelText)])
    marks: list[Mark] = [*labels, canvas.filled(frame.box(road.outline), "taken")]
    marks += [canvas.filled(frame.box(hole), "ground") for hole in road.holes()]
    order = sorted(range(len(here.cells)), key=lambda i: i == chosen)
    marks += [_cell(frame, here.cells[i], i, i == chosen) for i in order]
    marks += road_marks.lane_marks(frame, road)
    marks += road_marks.obstacle_marks(graph, frame, layer)
    if layer == 0:
        marks += road_marks.ego_marks(graph, frame, placing)
    if graph.scenario.goal and layer == len(graph.layers) - 1:
        marks.append(canvas.filled(frame.box(graph.scenario.goal), "goal"))
    bodies = road_marks.bodies(graph, frame, layer)
    outside = []
    for words, body in bodies:
        if not road_marks.fits(words, body):
            outside.append((words, body))
        elif placing.take(words):
            marks.append(replace(words, style="ink"))
    placing.taken += [body for _, body in bodies]
    cell_labels, key = _labels(frame, here.cells, placing)
    marks += cell_labels
    for words, body in outside:
        marks += placing.first_free(road_marks.beside(words, body))
    marks += axis
    height = frame.bottom + 14 + canvas.LINE_HEIGHT
    numbered = "   ".join(entry.replace(" ", "\xa0") for entry in key)
    below = canvas.paragraph(numbered, (canvas.MARGIN, height), canvas.TEXT_WIDTH, "faint")
    height += len(below) * canvas.LINE_HEIGHT
    return Picture(heading, canvas.WIDTH, height, (*marks, *below))


def _cell(frame: Frame, cell: Cell, number: int, chosen: bool) -> Area:
    polygon = cell.polygon
    rings = [polygon.exterior, *polygon.interiors]
    style = "chosen" if chosen else "crossing" if cell.surface == "crossing" else "cell"
    shape = tuple(tuple(frame.at(s, d) for s, d in list(ring.coords)[:-1]) for ring in rings)
    return Area(shape, style, f"cell {number}: {in_full(cell)}")


def _labels(
    frame: Frame, cells: Sequence[Cell], placing: Placing
) -> tuple[list[LabelText], list[str]]:
    """The cells' labels, and explanations of those shortened to a number."""
    labels, key = [], []
    for number, cell in enumerate(cells):
        letters = in_letters(cell)
        texts = [letters, str(number)] if letters else [str(number)]
        label = placing.place(texts, [frame.box(box) for box in cell.boxes])
        labels += [label] if label is not None else []
        if letters and (label is None or label.text != letters):
            key.append(f"{number} {letters}")
    return labels, key
