"""Obstacles and ego in a scene, and places for their names."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from rulec.partition import NavigationGraph
from rulec.report.pictures.drawing.label_placement import Placing, Rectangle
from rulec.report.pictures.drawing.marks import WIDTH, Area, LabelText, Mark, rectangle
from rulec.report.pictures.road_frame import Frame
from rulec.scenario.motion import span, swept


def obstacle_marks(graph: NavigationGraph, frame: Frame, layer: int) -> Iterator[Mark]:
    """Area swept by each obstacle in the layer, and its initial place."""
    start = graph.layers[layer].start_s
    for name in graph.layers[layer].objects:
        obstacle = graph.objects[name]
        area = swept(obstacle, start, start + graph.step_s)
        if area is not None:
            shape = rectangle(*frame.box(area))
            yield Area((shape,), "swept", f"{name}, {obstacle.type}: what it sweeps")
    for words, body in bodies(graph, frame, layer):
        tip = f"{words.text}, {graph.objects[words.text].type}"
        yield Area((rectangle(*body),), "body", tip)


def bodies(graph: NavigationGraph, frame: Frame, layer: int) -> list[tuple[LabelText, Rectangle]]:
    """Obstacles' names and bodies at the layer's start or their entry."""
    start = graph.layers[layer].start_s
    result = []
    for name in graph.layers[layer].objects:
        obstacle = graph.objects[name]
        first, _ = span(obstacle.motion)
        moment = max(start, first)
        body = swept(obstacle, moment, moment)
        if body is not None and body.overlaps(frame.outline):
            left, top, right, bottom = frame.box(body)
            at = ((left + right) / 2, (top + bottom) / 2)
            result.append((LabelText(name, at, "middle", "name"), (left, top, right, bottom)))
    return result


def fits(words: LabelText, body: Rectangle) -> bool:
    """Test for room for the words inside a body."""
    left, top, right, bottom = words.bounds
    return body[0] <= left and right <= body[2] and body[1] <= top and bottom <= body[3]


def beside(words: LabelText, body: Rectangle) -> Iterator[LabelText]:
    """Places for a name beside its body, or just above or below."""
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


def ego_marks(graph: NavigationGraph, frame: Frame, placing: Placing) -> Iterator[Mark]:
    """Ego at the first layer's start, large enough to be seen."""
    ego = graph.scenario.ego
    x, y = frame.at(ego.s, ego.d)
    half_length = max(ego.length / 2 * frame.along, 4)
    half_width = max(ego.width / 2 * frame.across, 4)
    shape = rectangle(x - half_length, y - half_width, x + half_length, y + half_width)
    yield Area((shape,), "ego", "ego at the start")
    body = (x - half_length, y - half_width, x + half_length, y + half_width)
    placing.taken.append(body)
    yield from placing.first_free(beside(LabelText("ego", (x, y), "middle", "name"), body))
