"""The picture of one moment of a drive: the road from above, and who violates what.

Rings and lines are clipped to a rectangle (Sutherland and Hodgman 1974; Liang and Barsky 1984).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely

from rulec.recordings.recording import Points
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
from rulec.report.pictures.drives.drive_scene import Body, DriveScene, SceneViolation

_HEIGHT = 430.0
_TOP = canvas.MARGIN + canvas.LINE_HEIGHT
_LEAST_M = (80.0, 22.0)
"""The smallest area shown (m), along and up."""
_AROUND_M = np.array([14.0, 9.0])
_SMALLEST_PX = 5.0
_MOST_LISTED = 12
_SURFACES = {"lane": "road", "crossing": "zebra", "footway": "footway"}
_COLOURS = {"red": "red", "yellow": "yellow", "green": "green", "redYellow": "red"}


def drive_picture(scene: DriveScene, state: int, violation: SceneViolation | None) -> Picture:
    """The picture of a state; ``violation`` is the one in focus."""
    view = _view(scene, state, violation)
    heading = f"{scene.time_s(state):g} s"
    placing = Placing()
    marks: list[Mark] = [
        LabelText(heading, (canvas.MARGIN, canvas.MARGIN), style="strong"),
        canvas.filled(view.box, "verge"),
        *_ground(scene, view),
        *_trail(scene, view),
    ]
    against = set(violation.against) if violation else set()
    scale = list(_scale(view))
    placing.taken += [mark.bounds for mark in scale if isinstance(mark, LabelText)]
    placing.taken += _boxes(scene, state, view, {scene.ego, *against})
    labels = []
    # Smaller bodies over larger ones, so that none is hidden.
    for body in sorted(scene.bodies, key=Body.size, reverse=True):
        style = "own" if body.id == scene.ego else "against" if body.id in against else "vehicle"
        drawn = list(_body(body, state, view, style))
        marks += drawn
        if drawn:
            labels.append((style, body))
    marks += _lights(scene, state, view, placing)
    if violation is not None:
        marks += _link(violation, state, view, placing)
    order = ("own", "against", "vehicle")
    for style, body in sorted(labels, key=lambda pair: order.index(pair[0])):
        marks += _label(body, state, view, placing, speed=style != "vehicle")
    marks += [*_signs(scene, view, placing), *scale]
    words, height = _words(scene, violation, view.box[3] + canvas.LINE_HEIGHT)
    return Picture(heading, canvas.WIDTH, height, (*marks, *words))


def drive_entries(
    scene: DriveScene, violation: SceneViolation | None, picture: Picture
) -> list[tuple[str, str]]:
    """The styles that a picture has, with their meanings, for its legend."""
    entries = [("own", f"ego, {scene.ego}")]
    if violation is not None and violation.against:
        entries.append(("against", "whom the violation is against"))
    entries += [("vehicle", "others"), ("trail", "ego's way")]
    kinds = {mark.kind for mark in scene.marks}
    words = {"solid": "solid mark", "broken": "broken mark", "unsaid": "bound without a mark"}
    entries += [(kind, text) for kind, text in words.items() if kind in kinds]
    if any(area.surface == "crossing" for area in scene.areas):
        entries.append(("zebra", "pedestrian crossing"))
    drawn = {mark.style for mark in picture.marks}
    return [(style, text) for style, text in entries if style in drawn]


@dataclass(frozen=True, slots=True)
class _View:
    """The visible part of the world: left and top (m), px per metre, and its rectangle in px."""

    left: float
    top: float
    scale: float
    box: canvas.Rectangle

    def at(self, points: Points) -> list[Point]:
        """Points in the picture; y grows upwards in the world, but downwards here."""
        x = self.box[0] + (points[:, 0] - self.left) * self.scale
        y = self.box[1] + (self.top - points[:, 1]) * self.scale
        return list(zip(x.tolist(), y.tolist(), strict=True))

    def sees(self, point: Point, margin: float = 0.0) -> bool:
        left, top, right, bottom = self.box
        inside = left + margin <= point[0] <= right - margin
        return inside and top + margin <= point[1] <= bottom - margin

    def area(self, ring: Points, style: str, tip: str = "") -> Iterator[Area]:
        """The visible parts of a ring."""
        area = shapely.Polygon(self.at(ring))
        for part in shapely.get_parts(shapely.clip_by_rect(area, *self.box)):
            if part.geom_type == "Polygon" and not part.is_empty:
                yield Area((tuple(part.exterior.coords[:-1]),), style, tip)

    def lines(self, line: Points, style: str, tip: str = "") -> Iterator[Polyline]:
        """The visible parts of a line."""
        path = shapely.LineString(self.at(line))
        for part in shapely.get_parts(shapely.clip_by_rect(path, *self.box)):
            if part.geom_type == "LineString":
                yield Polyline(tuple(part.coords), style, tip)


def _view(scene: DriveScene, state: int, violation: SceneViolation | None) -> _View:
    """A view of ego and the objects of the violation, with some space around them."""
    wanted = {scene.ego, *(violation.against if violation else ())}
    outlines = [body.outline(state) for body in scene.bodies if body.id in wanted]
    points = np.concatenate([outline for outline in outlines if outline is not None])
    low, high = points.min(axis=0) - _AROUND_M, points.max(axis=0) + _AROUND_M
    width, height = np.maximum(high - low, _LEAST_M).tolist()
    scale = min(canvas.TEXT_WIDTH / width, _HEIGHT / height)
    tall = min(_HEIGHT, max(height * scale, 0.5 * _HEIGHT))
    x, y = ((low + high) / 2).tolist()
    box = (canvas.MARGIN, _TOP, canvas.WIDTH - canvas.MARGIN, _TOP + tall)
    return _View(x - canvas.TEXT_WIDTH / 2 / scale, y + tall / 2 / scale, scale, box)


def _ground(scene: DriveScene, view: _View) -> Iterator[Mark]:
    for area in scene.areas:
        yield from view.area(area.ring, _SURFACES[area.surface], area.tip)
    for mark in scene.marks:
        yield from view.lines(mark.line, mark.kind)


def _trail(scene: DriveScene, view: _View) -> Iterator[Mark]:
    ego = scene.bodies[0]
    yield from view.lines(ego.poses[~np.isnan(ego.poses[:, 0]), :2], "trail", "ego's way")


def _body(body: Body, state: int, view: _View, style: str) -> Iterator[Mark]:
    """A participant's outline, with a line across its front."""
    outline, row = body.outline(state), body.row(state)
    if outline is None or row is None:
        return
    tip = f"{body.id}, {body.type}, {body.speeds[row]:.0f} km/h"
    if np.ptp(outline, axis=0).max() * view.scale < _SMALLEST_PX:
        (middle,) = view.at(outline.mean(axis=0)[None])
        if view.sees(middle):
            half = _SMALLEST_PX / 2
            yield canvas.filled(canvas.centred(middle, half, half), style, tip)
        return
    yield from view.area(outline, style, tip)
    heading = body.poses[row, 2]
    ahead = np.array([np.cos(heading), np.sin(heading)])
    left = np.array([-ahead[1], ahead[0]])
    along, across = outline @ ahead, outline @ left
    if np.ptp(along) > np.ptp(across) * 1.2:
        nose = ahead * (along.max() - 0.26 * np.ptp(along))
        ends = [nose + left * side for side in (across.min(), across.max())]
        yield from view.lines(np.array([ends[0], ends[1]]), _FRONTS[style])


_FRONTS = {"own": "curve", "against": "link", "vehicle": "axis"}


def _boxes(
    scene: DriveScene, state: int, view: _View, ids: Collection[str]
) -> Iterator[canvas.Rectangle]:
    for body in scene.bodies:
        outline = body.outline(state)
        if body.id in ids and outline is not None:
            yield _bounds(view.at(outline))


def _bounds(points: Sequence[Point]) -> canvas.Rectangle:
    """The rectangle around some points."""
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def _label(
    body: Body, state: int, view: _View, placing: Placing, *, speed: bool
) -> Iterator[LabelText]:
    outline, row = body.outline(state), body.row(state)
    if outline is None or row is None:
        return
    x0, y0, x1, y1 = _bounds(view.at(outline))
    text = f"{body.id} · {body.speeds[row]:.0f} km/h" if speed else body.id
    half, x, y = canvas.text_width([text]) / 2 + 3, (x0 + x1) / 2, (y0 + y1) / 2
    places = [(x, y0 - 9), (x, y1 + 9), (x1 + half, y), (x0 - half, y)]
    places += [(x, y0 - 24), (x, y1 + 24)] if speed else []
    choices = (LabelText(text, at, "middle", "name") for at in places)
    bounds = (label for label in choices if _within(label, view))
    yield from placing.first_free(bounds)


def _within(label: LabelText, view: _View) -> bool:
    left, top, right, bottom = label.bounds
    return view.sees((left, top)) and view.sees((right, bottom))


def _link(violation: SceneViolation, state: int, view: _View, placing: Placing) -> Iterator[Mark]:
    """The line between ego and the other participant, with its length."""
    text = violation.gap_text(state)
    if not text:
        return
    ends = view.at(violation.links[state].reshape(2, 2))
    (ax, ay), (bx, by) = ends
    yield from view.lines(violation.links[state].reshape(2, 2), "link", f"distance {text}")
    length = max(np.hypot(bx - ax, by - ay), 1e-9)
    nx, ny = -(by - ay) / length * 5, (bx - ax) / length * 5
    for x, y in ends if length > 3 else ():
        yield Polyline(((x - nx, y - ny), (x + nx, y + ny)), "link")
    x, y = (ax + bx) / 2, (ay + by) / 2
    far = (12.0, 20.0, 28.0, 36.0, 48.0, 60.0)
    offsets = [way for d in far for way in ((0, -d), (0, d), (1.6 * d, 0), (-1.6 * d, 0))]
    choices = (LabelText(text, (x + dx, y + dy), "middle", "number") for dx, dy in offsets)
    yield from placing.first_free(choices)


def _lights(scene: DriveScene, state: int, view: _View, placing: Placing) -> Iterator[Mark]:
    for light in scene.lights:
        colour = light.colour_at(state)
        (x, y) = view.at(light.line.mean(axis=0)[None])[0]
        yield from view.lines(light.line, "solid", "the line of a light")
        if view.sees((x, y), 8):
            style = _COLOURS.get(colour, "light")
            ring = [
                (x + 8 * np.cos(turn), y + 8 * np.sin(turn))
                for turn in np.linspace(0, 2 * np.pi, 16, endpoint=False).tolist()
            ]
            yield Area((tuple(ring),), style, f"light: {colour or 'not known'}")
            letters = "RY" if colour == "redYellow" else colour[:1].upper() or "?"
            yield LabelText(letters, (x, y), "middle", "ink")
            placing.taken.append((x - 8, y - 8, x + 8, y + 8))


def _signs(scene: DriveScene, view: _View, placing: Placing) -> Iterator[Mark]:
    for sign in scene.signs:
        (at,) = view.at(np.array([sign.place]))
        label = LabelText(sign.text, at, "middle")
        if view.sees(at, 14) and placing.take(label):
            left, top, right, bottom = label.bounds
            yield canvas.filled((left - 3, top, right + 3, bottom), "board", f"sign: {sign.name}")
            yield label


def _scale(view: _View) -> Iterator[Mark]:
    """A scale bar of 10, 20 or 50 m, at the lower right."""
    metres = 10 if 10 * view.scale > 40 else 20 if 20 * view.scale > 40 else 50
    right, y = view.box[2] - 10, view.box[3] - 10
    left = right - metres * view.scale
    for (x0, y0), (x1, y1) in pairwise([(left, y - 4), (left, y), (right, y), (right, y - 4)]):
        yield Polyline(((x0, y0), (x1, y1)), "accepted")
    yield LabelText(f"{metres} m", ((left + right) / 2, y - 9), "middle", "name")


def _words(
    scene: DriveScene, violation: SceneViolation | None, y: float
) -> tuple[list[LabelText], float]:
    """The violation in words, and a line for each further violation of the drive."""
    labels: list[LabelText] = []
    lines: list[tuple[str, str]] = []
    if violation is not None:
        when = f"{violation.time_s:g} s"
        lines += [("strong", f"{when}  {violation.title}"), ("ink", violation.says)]
        lines += [("strong", f"measured {text}") for text in violation.measured]
        if violation.deciding_values:
            lines.append(("ink", f"with {', '.join(violation.deciding_values)}"))
    others = [own for own in scene.violations if own is not violation]
    lines += [
        ("faint", f"{own.time_s:g} s  {own.rule}: {own.short}") for own in others[:_MOST_LISTED]
    ]
    if len(others) > _MOST_LISTED:
        lines.append(("faint", f"and {len(others) - _MOST_LISTED} more"))
    lines += [("faint", note) for note in scene.notes]
    for style, text in lines:
        paragraph = canvas.paragraph(text, (canvas.MARGIN, y), canvas.TEXT_WIDTH, style)
        labels += paragraph
        y += len(paragraph) * canvas.LINE_HEIGHT + 2
    return labels, y


def chosen_moment(scene: DriveScene, at_s: float | None) -> tuple[int, SceneViolation | None]:
    """The state to draw with its violation: the first one, or the one nearest to a time."""
    ordered: Sequence[SceneViolation] = scene.violations
    if at_s is None:
        return (ordered[0].state, ordered[0]) if ordered else (scene.states // 2, None)
    state = scene.nearest_state(at_s)
    return state, min(ordered, key=lambda violation: abs(violation.state - state), default=None)
