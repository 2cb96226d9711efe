"""The road in a scene with its axis, obstacles, and ego, and places for their names."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from rulec.partition import NavigationGraph
from rulec.report.pictures.drawing import canvas
from rulec.report.pictures.drawing.canvas import LabelText, Mark, Point, Polyline, Rectangle
from rulec.report.pictures.drawing.label_placement import Placing
from rulec.report.pictures.picture_captions import ticks
from rulec.scenario import Box, Road
from rulec.scenario.motion import span, swept

LANE_HEIGHT = 46.0
"""Of a lane as wide as the road's lanes are on average, in px."""


@dataclass(frozen=True, slots=True)
class Frame:
    """Mapping of places on the road to places in the picture."""

    outline: Box
    top: float
    lanes: int

    @property
    def along(self) -> float:
        """Px for a metre of s."""
        return canvas.TEXT_WIDTH / (self.outline.s_max - self.outline.s_min)

    @property
    def across(self) -> float:
        """Px for a metre of d."""
        return LANE_HEIGHT * self.lanes / (self.outline.d_max - self.outline.d_min)

    @property
    def bottom(self) -> float:
        """The lower border of the road, in px."""
        return self.top + LANE_HEIGHT * self.lanes

    def at(self, s: float, d: float) -> Point:
        """A place on the road."""
        return (
            canvas.MARGIN + (s - self.outline.s_min) * self.along,
            self.top + (self.outline.d_max - d) * self.across,
        )

    def box(self, box: Box) -> Rectangle:
        """A box as far as it is on the road."""
        outline = self.outline
        left, top = self.at(max(box.s_min, outline.s_min), min(box.d_max, outline.d_max))
        right, bottom = self.at(min(box.s_max, outline.s_max), max(box.d_min, outline.d_min))
        return left, top, right, bottom


def axis(frame: Frame) -> Iterator[Mark]:
    """Metres of s below the road."""
    y = frame.bottom
    for s in ticks(frame.outline.s_min, frame.outline.s_max, 12):
        x, _ = frame.at(s, frame.outline.d_min)
        yield Polyline(((x, y), (x, y + 4)), "axis")
        text = f"{s:g}"
        half = len(text) * canvas.CHARACTER / 2
        x = min(max(x, half), canvas.WIDTH - half)
        yield LabelText(text, (x, y + 11), "middle", "faint")


def lane_marks(frame: Frame, road: Road) -> Iterator[Polyline]:
    """Lines between lanes, where at least one of the two is there."""
    ends = {s for gap in road.missing for s in gap.s if road.s[0] < s < road.s[1]}
    for right, d in enumerate(road.lanes[1:-1], 1):
        for start, end in pairwise([road.s[0], *sorted(ends), road.s[1]]):
            gone = {gap.lane for gap in road.missing if gap.s[0] <= start and end <= gap.s[1]}
            if not {right, right + 1} <= gone:
                yield Polyline((frame.at(start, d), frame.at(end, d)), "lane")


def obstacle_marks(graph: NavigationGraph, frame: Frame, layer: int) -> Iterator[Mark]:
    """Area swept by each obstacle in the layer, and its initial place."""
    start = graph.layers[layer].start_s
    for name in graph.layers[layer].objects:
        obstacle = graph.objects[name]
        area = swept(obstacle, start, start + graph.step_s)
        if area is not None:
            tip = f"{name}, {obstacle.type}: what it sweeps"
            yield canvas.filled(frame.box(area), "swept", tip)
    for words, body in bodies(graph, frame, layer):
        yield canvas.filled(body, "body", f"{words.text}, {graph.objects[words.text].type}")


def bodies(graph: NavigationGraph, frame: Frame, layer: int) -> list[tuple[LabelText, Rectangle]]:
    """Obstacles' names and bodies at the layer's start or their entry."""
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


def fits(words: LabelText, body: Rectangle) -> bool:
    """Test for room for the words inside a body."""
    left, top, right, bottom = words.bounds
    return body[0] <= left and right <= body[2] and body[1] <= top and bottom <= body[3]


def beside(words: LabelText, body: Rectangle) -> Iterator[LabelText]:
    """Places for a name beside its body, or just above or below."""
    left, top, right, bottom = words.bounds
    half, (x, y) = (right - left) / 2 + 5, words.at
    lift = (body[3] - body[1] + bottom - top) / 2 + 1
    after, before = body[2] + half, body[0] - half
    middles = (x, y - lift), (x, y + lift), (after, y), (before, y)
    for at in (*middles, (after, y - lift), (before, y + lift)):
        if half <= at[0] <= canvas.WIDTH - half:
            yield replace(words, at=at)


def ego_marks(graph: NavigationGraph, frame: Frame, placing: Placing) -> Iterator[Mark]:
    """Ego at the first layer's start, large enough to be seen."""
    ego = graph.scenario.ego
    middle = frame.at(ego.s, ego.d)
    half_length, half_width = ego.length / 2 * frame.along, ego.width / 2 * frame.across
    body = canvas.centred(middle, max(half_length, 4), max(half_width, 4))
    yield canvas.filled(body, "ego", "ego at the start")
    placing.taken.append(body)
    yield from placing.first_free(beside(LabelText("ego", middle, "middle", "name"), body))
