"""Picture of a scene's layer: road, cells with signatures, obstacles."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from textwrap import wrap

from rulec.partition import Cell, NavigationGraph, envelope
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.pictures.cell_signatures import MOST_SPELLED, in_full, in_letters, meaning
from rulec.report.pictures.drawing.axis_ticks import ticks
from rulec.report.pictures.drawing.label_placement import Placing
from rulec.report.pictures.drawing.marks import (
    LINE_HEIGHT,
    MARGIN,
    WIDTH,
    Area,
    LabelText,
    Mark,
    Picture,
    Polyline,
    rectangle,
)
from rulec.report.pictures.drawing.text_metrics import CHARACTER
from rulec.report.pictures.legend import LegendEntry, legend
from rulec.report.pictures.obstacle_marks import beside, bodies, ego_marks, fits, obstacle_marks
from rulec.report.pictures.road_frame import Frame
from rulec.scenario import Road

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
    entries = [LegendEntry("cell", "a cell"), LegendEntry("crossing", "a cell on a crossing")]
    if all(cell.surface == "carriageway" for layer in graph.layers for cell in layer.cells):
        del entries[1]
    if maneuver:
        entries.append(LegendEntry("chosen", "the maneuver's cell"))
    if graph.objects:
        entries += [
            LegendEntry("body", "an obstacle as the interval begins"),
            LegendEntry("swept", "what it sweeps in the interval"),
            LegendEntry("taken", f"no cell: {_TAKEN[graph.extent]}"),
        ]
    if graph.scenario.goal:
        entries.append(LegendEntry("goal", "the goal"))
    road = graph.scenario.road
    frame = Frame(road.outline, 0, len(road.lanes) - 1)
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
    frame = Frame(road.outline, MARGIN + LINE_HEIGHT, len(road.lanes) - 1)
    chosen = maneuver.nodes[layer] if maneuver else None
    heading = f"{start:g} s to {end:g} s"
    marks: list[Mark] = [LabelText(heading, (MARGIN, MARGIN), style="strong")]
    if maneuver and chosen is not None:
        bounds = envelope(graph, maneuver.nodes[: layer + 1])[layer]
        right, left = min(d for _, d in bounds.d_right), max(d for _, d in bounds.d_left)
        low, high, right, left = (round(x, 2) for x in (bounds.s_min, bounds.s_max, right, left))
        told = f"cell {chosen}: s {low:g} … {high:g} m, d {right:g} … {left:g} m"
        marks.append(LabelText(told, (WIDTH - MARGIN, MARGIN), "end"))
    axis = list(_axis(frame))
    placing = Placing([mark.bounds for mark in [*marks, *axis] if isinstance(mark, LabelText)])
    marks.append(Area((rectangle(*frame.box(road.outline)),), "taken"))
    marks += [Area((rectangle(*frame.box(hole)),), "ground") for hole in road.holes()]
    order = sorted(range(len(here.cells)), key=lambda i: i == chosen)
    marks += [_cell(frame, here.cells[i], i, i == chosen) for i in order]
    marks += _lane_marks(frame, road)
    marks += obstacle_marks(graph, frame, layer)
    if layer == 0:
        marks += ego_marks(graph, frame, placing)
    if graph.scenario.goal and layer == len(graph.layers) - 1:
        marks.append(Area((rectangle(*frame.box(graph.scenario.goal)),), "goal"))
    names = bodies(graph, frame, layer)
    marks += [
        replace(words, style="ink")
        for words, body in names
        if fits(words, body) and placing.take(words)
    ]
    for _, body in names:
        placing.taken.append(body)
    labels, key = _labels(frame, here.cells, placing)
    marks += labels
    marks += [
        label_text
        for words, body in names
        if not fits(words, body)
        for label_text in placing.first_free(beside(words, body))
    ]
    marks += axis
    height = frame.bottom + 14 + LINE_HEIGHT
    columns = int((WIDTH - 2 * MARGIN) / CHARACTER)
    for line in wrap("   ".join(one.replace(" ", "\xa0") for one in key), columns):
        marks.append(LabelText(line, (MARGIN, height), style="faint"))
        height += LINE_HEIGHT
    return Picture(heading, WIDTH, height, tuple(marks))


def _cell(frame: Frame, cell: Cell, number: int, chosen: bool) -> Area:
    polygon = cell.polygon
    rings = [polygon.exterior, *polygon.interiors]
    style = "chosen" if chosen else "crossing" if cell.surface == "crossing" else "cell"
    shape = tuple(tuple(frame.at(s, d) for s, d in list(ring.coords)[:-1]) for ring in rings)
    return Area(shape, style, f"cell {number}: {in_full(cell)}")


def _lane_marks(frame: Frame, road: Road) -> Iterator[Polyline]:
    """Lines between lanes, where at least one of the two is there."""
    ends = {s for gap in road.missing for s in gap.s if road.s[0] < s < road.s[1]}
    for right, d in enumerate(road.lanes[1:-1], 1):
        for start, end in pairwise([road.s[0], *sorted(ends), road.s[1]]):
            gone = {gap.lane for gap in road.missing if gap.s[0] <= start and end <= gap.s[1]}
            if not {right, right + 1} <= gone:
                yield Polyline((frame.at(start, d), frame.at(end, d)), "lane")


def _labels(
    frame: Frame, cells: Sequence[Cell], placing: Placing
) -> tuple[list[LabelText], list[str]]:
    """The cells' labels, and explanations of those shortened to a number."""
    label_texts, key = [], []
    for number, cell in enumerate(cells):
        letters = in_letters(cell)
        texts = [letters, str(number)] if letters else [str(number)]
        words = placing.place(texts, [frame.box(box) for box in cell.boxes])
        if words is not None:
            label_texts.append(words)
        if letters and (words is None or words.text != letters):
            key.append(f"{number} {letters}")
    return label_texts, key


def _axis(frame: Frame) -> Iterator[Mark]:
    low, high = frame.outline.s_min, frame.outline.s_max
    y = frame.bottom
    for s in ticks(low, high, 12):
        x, _ = frame.at(s, frame.outline.d_min)
        yield Polyline(((x, y), (x, y + 4)), "axis")
        width = len(f"{s:g}") * CHARACTER / 2
        x = min(max(x, width), WIDTH - width)
        yield LabelText(f"{s:g}", (x, y + 11), "middle", "faint")
